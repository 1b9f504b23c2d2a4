"""Places of cases that hold a number."""

from __future__ import annotations

import re
from collections.abc import Mapping
from numbers import Real
from typing import Any

from ._paths import shown
from ._plain import refused
from .case import Case


def value_at(case: Case, place: str) -> tuple[str, float]:
    """A place as :meth:`Case.replace` has it, and the number there, which may be a default.

    Raises:
        CaseError: there is no number at the place, or 0.
    """
    written, value = _found(case, case._document, place)
    if value is None:
        written, value = _found(case, case.resolved()._document, place)
    if value is None:
        # Says what there is instead.
        case.replace({written: 1.0})
        raise refused(case._path, place, "has no value here: give one to begin with")
    if isinstance(value, bool) or not isinstance(value, Real):
        raise refused(case._path, place, f"is {shown(value)}: only a number can be fitted")
    if value == 0:
        raise refused(case._path, place, "is 0, and values are varied by a fraction of themselves: give another value in the case")
    return written, float(value)


def _found(case: Case, document: Any, place: str) -> tuple[str, Any]:
    """A place with numbers for steps that it names, and what stands there; None if nothing does."""
    written, at = "", document
    for part in re.findall(r"[^.\[\]]+", place):
        if not isinstance(at, list):
            written, at = f"{written}.{part}" if written else part, at.get(part) if isinstance(at, Mapping) else None
            continue
        of_name = {entry["name"]: k for k, entry in enumerate(at) if isinstance(entry, Mapping) and "name" in entry}
        k = of_name.get(part, int(part) if part.isascii() and part.isdigit() else len(at))
        if k >= len(at):
            there = ", ".join([f"0 to {len(at) - 1}", *of_name])
            raise refused(case._path, place, f"there is no `{part}` in {written}; there is {there}")
        written, at = f"{written}[{k}]", at[k]
    return written, at
