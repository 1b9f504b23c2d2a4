"""Quantities of results: names, units and meanings, as the program lists them (``fecontact schema results``)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache

from . import _native


@cache
def _files() -> dict[str, dict[str, dict[str, str]]]:
    """Quantities of every file by name, without the prefixes of contacts, sets, bodies and probes."""
    listed = json.loads(_native.schema("results"))
    return {file: {entry["name"].rsplit(".", 1)[-1]: entry for entry in entries} for file, entries in listed.items()}


def _known(name: str) -> dict[str, str]:
    # newton.csv counts slipping points under the name of a length.
    return next((all_[name] for file, all_ in _files().items() if name in all_ and file != "newton.csv"), {})


def spoken(name: str) -> str:
    """Name of a quantity in figures."""
    return _known(name).get("spoken", name)


def unit(column: str, units: Mapping[str, str]) -> str | None:
    """Unit of a column, as far as it is labelled by the units of a case."""
    name = column.rsplit(".")[-1]
    known = _known(name) or _known(name.removeprefix("mean_"))
    return units.get(known.get("of", ""))


def unit_in(file: str, column: str, units: Mapping[str, str]) -> str:
    """Unit of a column of a table: as labelled by the units of a case, else composed of F, L and T or their labels; empty if dimensionless."""
    own, name = _files().get(file, {}), column.rsplit(".")[-1]
    known = own.get(name) or _known(name) or _known(name.removeprefix("mean_"))
    labels = {"F": units.get("force", "F"), "L": units.get("length", "L"), "T": units.get("time", "T")}
    return units.get(known.get("of", ""), "".join(labels.get(letter, letter) for letter in known.get("unit", "")))


def name_of_now(name: str) -> str:
    """Present name of a quantity of a store; earlier versions used other names for some."""
    store = _files()["interface.zarr"]
    return next((now for now, entry in store.items() if entry.get("formerly") == name), name)
