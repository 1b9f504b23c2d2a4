"""Quantities of results: names, units and meanings, as the program lists them (``fecontact schema results``)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache

from . import _native


@cache
def _known() -> dict[str, dict[str, str]]:
    """By their names, without those of contacts, sets, bodies and probes before them."""
    files = json.loads(_native.schema("results"))
    # newton.csv counts slipping points under the name of a length.
    drawn = [entry for name, entries in files.items() if name != "newton.csv" for entry in entries]
    return {entry["name"].rsplit(".", 1)[-1]: entry for entry in drawn}


def spoken(name: str) -> str:
    """What a quantity is called in figures."""
    return _known().get(name, {}).get("spoken", name)


def unit(column: str, units: Mapping[str, str]) -> str | None:
    """The unit of a column, as far as the units of a case label it."""
    name = column.rsplit(".")[-1]
    known = _known().get(name) or _known().get(name.removeprefix("mean_"), {})
    return units.get(known.get("of", ""))


def name_of_now(name: str) -> str:
    """What a quantity of a store is called now; versions before called some otherwise."""
    return next((now for now, entry in _known().items() if entry.get("formerly") == name), name)
