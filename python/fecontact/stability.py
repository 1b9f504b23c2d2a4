"""Factor of safety: by what factor the strengths can be divided at the end of a case before they fail."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from . import _native
from ._paths import path as as_path
from ._plain import count
from .case import Case
from .errors import RunWarning, Stopped
from .result import Result


@dataclass(frozen=True)
class Safety:
    """A factor of safety (:func:`fecontact.safety`).

    Attributes:
        stands: the largest factor that stands.
        fails: the least factor that fails.
        trials: one row per trial, by factor: ``stands``, the fraction of its step ``reached``, the largest ``displacement`` [L], and its
            ``growth`` over the elastic one.
        mechanism: results of the trial that fails with the least factor; the displacements of its last frames show how.
    """

    stands: float
    fails: float
    trials: pd.DataFrame
    mechanism: Result

    def __repr__(self) -> str:
        return f"<factor of safety: {self.stands} to {self.fails}>"


def safety(
    case: Case,
    bodies: Sequence[str] = (),
    contacts: Sequence[str] = (),
    within: float = 0.01,
    most: float = 10.0,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
) -> Safety:
    """Find the factor of safety: run a case, then divide the strengths of bodies and contacts at its end by growing factors until they
    fail, and bisect. The same as ``fecontact safety``.

    Args:
        case: the case; supports and loads do not change at its end.
        bodies: names of bodies whose strength is divided; without bodies and contacts, all that have one.
        contacts: names of contacts whose strength is divided.
        within: largest distance between the factor that stands and the one that fails.
        most: largest factor that is tried.
        out: folder of the results, with the folders ``end`` and ``F_…``, and ``safety.csv``; default: a temporary one.
        threads: number of threads; default: all cores.

    Raises:
        CaseError: the case is invalid, or something named has no strength that a factor could divide.
        ValueError: ``within`` or ``most`` is invalid.
        Stopped: the case itself stopped while solving, or it stands with the largest factor.
    """
    for name, value, least in (("within", within, 0.0), ("most", most, 1.0)):
        if not least < value < float("inf"):
            raise ValueError(f"{name}: is {value}: must be above {least:g}")
    if case.mesh is not None:
        case = Case({**case.document, "mesh": case.mesh.document()}, folder=os.path.dirname(case._path))
    holder = None
    if out is None:
        holder = tempfile.TemporaryDirectory(prefix="fecontact-", ignore_cleanup_errors=True)
        out = holder.name
    out, threads = as_path(out, "out"), count(threads, "threads")
    rows: list[tuple[float, bool, float, float, float]] = []

    def poll(messages: list[str], tried: list[tuple[float, bool, float, float, float]]) -> None:
        rows.extend(tried)
        for text in messages:
            warnings.warn(text, RunWarning, stacklevel=3)

    stands, fails = _native.safety(case._native, out, [list(bodies), list(contacts)], [within, most], threads, poll)
    if fails is None:
        raise Stopped(f"the strengths stand even when divided by {stands}: give a larger `most`")
    trials = pd.DataFrame(rows, columns=["factor", "stands", "reached", "displacement", "growth"]).sort_values("factor", ignore_index=True)
    return Safety(stands, fails, trials, Result(Path(out, f"F_{fails:g}"), _holder=holder))
