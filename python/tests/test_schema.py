"""The schemas that ``fecontact schema`` prints: they accept the cases of this repository and refuse what the reader refuses.

(That every key is explained and that no object takes unknown ones: ``tests/command/schema.rs``.)
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from conftest import DOCUMENT, REPOSITORY
from jsonschema import Draft202012Validator

import fecontact as fc

CASE = Draft202012Validator(fc.schema("case"))
LAW = Draft202012Validator(fc.schema("law"))
CASES = REPOSITORY / "cases"
LAW_TEST: dict[str, Any] = {
    "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1000},
    "initial": {"pressure": 1},
    "path": [{"duration": 1, "slip": "sin(t)", "pressure": {"table": [[0, 1], [1, 2]]}}],
}


def changed(document: dict[str, Any], *places: Any, value: Any) -> Any:
    new = json.loads(json.dumps(document))
    at = new
    for place in places[:-1]:
        at = at[place]
    at[places[-1]] = value
    return new


def test_schemas_are_valid_themselves() -> None:
    Draft202012Validator.check_schema(fc.schema("case"))
    Draft202012Validator.check_schema(fc.schema("law"))
    assert fc.schema() == fc.schema("case")


@pytest.mark.parametrize("path", sorted(CASES.rglob("*.json")), ids=lambda path: str(path.relative_to(CASES)))
def test_committed_cases_are_accepted(path: Path) -> None:
    schema = LAW if path.is_relative_to(CASES / "law") else CASE
    schema.validate(json.loads(path.read_text()))


@pytest.mark.parametrize(
    "places, value",
    [
        (("contact",), {}),
        (("steps",), {}),
        (("mesh",), 3),
        (("bodies", "block", "colour"), "red"),
        (("bodies", "block", "material", "young"), 1),
        (("bodies", "block", "material", "E"), "soft"),
        (("bodies", "block", "material", "model"), "rubber"),
        (("bodies", "block", "material"), {"E": 1, "nu": 0.3}),
        (("bodies", "block", "material"), {"model": "neohookean", "E": 1, "nu": 0.3}),
        (("bodies", "block", "material"), {"model": "linear", "E": 1}),
        (("bodies", "block", "material"), {"model": "linear", "E": 1, "nu": 0.3, "rho": 1}),
        (("contacts", "base", "points"), 2.5),
        (("contacts", "base", "master"), {"plane": {"point": [0, 0]}}),
        (("contacts", "base", "friction", "mus"), 1),
        (("steps", 0, "scheme"), "newmrk"),
        (("steps", 0, "dt"), {"min": 1}),
        (("steps", 0, "supports", 0, "uz"), 0),
        (("steps", 0, "supports", 0, "ux"), {"rat": 1}),
        (("steps", 0, "supports", 0, "on"), {"node": -1}),
    ],
)
def test_what_the_schema_refuses_is_refused_by_the_reader(places: tuple[Any, ...], value: Any) -> None:
    bad = changed(DOCUMENT, *places, value=value)
    assert not CASE.is_valid(bad)
    with pytest.raises(fc.CaseError):
        fc.Case(bad).check()


@pytest.mark.parametrize(
    "material",
    [
        {"model": "neo_hookean", "E": 1.0, "nu": 0.3, "density": 2.0},
        {"model": "saint_venant_kirchhoff", "E": 1.0, "nu": 0.3},
    ],
)
def test_what_the_schema_accepts_is_read(material: dict[str, Any]) -> None:
    good = changed(DOCUMENT, "bodies", "block", "material", value=material)
    CASE.validate(good)
    fc.Case(good).check()


@pytest.mark.parametrize(
    "places, value",
    [
        (("mesh",), "a.msh"),
        (("path",), [[0, 0, 1]]),
        (("table",), [[0, 0]]),
        (("friction", "law"), "rubber"),
        (("initial", "presure"), 1),
        (("path", 0, "durations"), 1),
        (("path", 0, "slip"), [1]),
    ],
)
def test_bad_tests_of_a_law_are_refused(places: tuple[Any, ...], value: Any) -> None:
    LAW.validate(LAW_TEST)
    assert not LAW.is_valid(changed(LAW_TEST, *places, value=value))
