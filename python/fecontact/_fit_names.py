"""Checks of the free parameters of a fit and of their ranges."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

from ._native import schema
from ._records import OF_RECORDS

Ranges = Mapping[str, tuple[float, float]]


def check_names(law: str, names: Iterable[str]) -> None:
    """Check that the law or the machine has parameters of these names; those of a registered law are not checked.

    Raises:
        ValueError: a name is unknown; the message suggests the nearest known one.
    """
    known = _known(law)
    for name in names if known else ():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1, 0.5)
            meant = f"did you mean {near[0]}? " if near else ""
            raise ValueError(f"free: {name}: {law} has no such parameter; {meant}it has {', '.join(known)}")


def _known(law: str) -> list[str]:
    definitions = json.loads(schema("law"))["$defs"]
    laws = definitions["FrictionParameters"]["oneOf"]
    bond = [f"bond.{name}" for name in definitions["BondParameters"]["properties"]]
    own = [list(one["properties"]) for one in laws if one["properties"]["law"].get("const") == law]
    return [name for name in own[0] if name != "law"] + bond + list(OF_RECORDS) if own and law != "registered" else []


def no_room(ranges: Ranges, why: str) -> ValueError | None:
    """Message that the law accepts no point in the ranges of the parameters named by its error; empty if it names none."""
    spoken = [f"{name} {low:g} to {high:g}" for name, (low, high) in ranges.items() if re.search(rf"\b{re.escape(name)}\b", why)]
    return ValueError(f"free: no start in the ranges ({', '.join(spoken)}) is valid: {why}") if spoken else None


def check_room(law: str, ranges: Ranges, fixed: Mapping[str, Any]) -> None:
    """Check that mu_s can exceed mu_k: super/subloading friction is fitted with mu_s raised to mu_k where a trial has it below.

    Raises:
        ValueError: the ranges leave mu_s below mu_k.
    """
    highest, lowest = ranges.get("mu_s", (fixed.get("mu_s"),))[-1], ranges.get("mu_k", (fixed.get("mu_k"),))[0]
    if law != "super_subloading" or highest is None or lowest is None or highest >= lowest:
        return
    if refusal := no_room(ranges, f"mu_s is at most {highest}, and mu_k at least {lowest}: mu_s must not be less than mu_k"):
        raise refusal
