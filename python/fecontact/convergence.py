"""Error bars of a number of a run, from runs with refined meshes and increments."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from . import _native
from ._plain import a_name
from .case import Case


@dataclass(frozen=True)
class Convergence:
    """How a number converges with refinement (:func:`fecontact.converge`).

    Attributes:
        measure: the number, ``"base.tangential_force:max"``.
        runs: one row per run, the coarsest first: elements, increments, and the value.
        order: observed order of convergence; None if the differences alternate or are round-off.
        extrapolated: value extrapolated to elements and increments of zero size; None if it does not converge.
        bar: error bar of the value of the last run; None if it does not converge.
        by_increments: fraction of the last difference that is due to the increments, the rest being due to the mesh; None if nothing
            differs, or explicit increments follow from the mesh.
        settled: whether it has no error bar, but has changed by less than asked from level to level.
        verdict: the same in words.
    """

    measure: str
    runs: pd.DataFrame
    order: float | None
    extrapolated: float | None
    bar: float | None
    by_increments: float | None
    settled: bool
    verdict: str

    @property
    def value(self) -> float:
        """Value of the last run."""
        return float(self.runs["value"].iloc[-1])

    @property
    def converges(self) -> bool:
        """Whether there is an error bar."""
        return self.bar is not None

    def __repr__(self) -> str:
        bar = "" if self.bar is None else f": {self.value:.8g} ± {self.bar:.2g}, extrapolated {self.extrapolated:.8g}"
        return f"<{self.measure} {self.verdict}{bar}>"


def converge(
    case: Case,
    measure: str,
    levels: int = 3,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    within: float = 1e-3,
) -> Convergence:
    """Run a case as it is, then with successively halved elements and increments, and judge the convergence of a number: its
    observed order, its extrapolated value and its error bar, or that it does not converge. The finest mesh is run once more with the
    increments of the previous level, which gives the part of the last difference that is due to the increments.

    The same as ``fecontact converge``. Blocks keep their arcs; other meshes are refined within the boundaries that they have.

    Args:
        case: the case; its own mesh is the coarsest.
        measure: a column of the history or the probes, or one over another, and what is taken of it: ``"base.tangential_force:max"``, ``:min``, ``:end``,
            or ``:mean`` (over time), in a step alone ``"base.tangential_force/base.normal_force:max@drag"``.
        levels: number of runs, 3 or more; the last three count.
        out: folder of the results, with a folder ``level_k`` for each run, and ``level_k_longer_increments``; default: a temporary one.
        threads: number of threads of a run.
        within: fraction of the number by which it may change from level to level without an order (``settled``).

    Raises:
        CaseError: the case is invalid, or a group of nodes in its mesh stands for a side.
        ValueError: the measure is invalid, or there are fewer than three levels.
        Stopped: a run stopped while solving.
    """
    measure = a_name(measure, "measure", "measure")
    if levels < 3:
        raise ValueError(f"levels: is {levels}: an order of convergence needs 3 or more")
    finest, longer = case.refined(levels - 1), case.refined(levels - 1, levels - 2)
    with tempfile.TemporaryDirectory(prefix="fecontact-", ignore_cleanup_errors=True) as holder:

        def measured(name: str, refined: Case) -> dict[str, Any]:
            folder = Path(holder if out is None else out, name)
            summary = refined.run(out=folder, threads=threads, progress=False).summary
            value = _native.measured(os.fspath(folder), measure)
            return {"elements": summary["elements"], "increments": summary["increments"], "value": value}

        rows = [measured(f"level_{level}", case.refined(level)) for level in range(levels)]
        values = [float(row["value"]) for row in rows]
        by_increments = None
        if finest.document != longer.document:
            other = measured(f"level_{levels - 1}_longer_increments", longer)
            by_increments = _native.fraction_of_increments(values, other["value"])
    order, extrapolated, bar, settled, verdict = _native.judge(values, within)
    return Convergence(measure, pd.DataFrame(rows), order, extrapolated, bar, by_increments, settled, verdict)
