"""Factor of safety, against the closed form of a block on a slope; the slope of Bishop is in tests/published/safety.rs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import fecontact as fc


def block(mu: float, slope: float = 20.0) -> dict[str, Any]:
    """A heavy block on a plane, stuck by Coulomb friction."""
    s, c = math.sin(math.radians(slope)), math.cos(math.radians(slope))
    corners = [[x * c - y * s, x * s + y * c] for x, y in ((0, 0), (4, 0), (4, 1), (0, 1))]
    return {
        "mesh": {"blocks": [{"body": "block", "corners": corners, "elements": [8, 2], "sides": ["base", None, None, None]}]},
        "bodies": {"block": {"material": {"model": "linear", "E": 1e5, "nu": 0.3, "density": 1}}},
        "contacts": {
            "base": {
                "slave": "base",
                "master": {"plane": {"point": [0, 0], "normal": [-s, c]}},
                "friction": {"law": "coulomb", "mu": mu},
            }
        },
        "steps": [{"name": "weight", "duration": 1, "dt": {"initial": 0.1}, "loads": [{"on": "block", "gravity": {"y": -1}}]}],
        "output": {"fields": False, "report": False},
    }


def test_a_block_slides_at_its_factor(tmp_path: Path) -> None:
    """F = tan φ/tan β."""
    mu = math.tan(math.radians(25))
    exact = mu / math.tan(math.radians(20))
    found = fc.safety(fc.Case(block(mu)), contacts=["base"], within=0.02, out=tmp_path)
    assert found.stands - 0.005 < exact < found.fails + 0.005
    assert 0 < found.fails - found.stands <= 0.02 * (1 + 1e-9)
    assert list(found.trials["factor"]) == sorted(found.trials["factor"])
    assert found.trials.set_index("factor")["stands"][found.stands]
    assert not found.trials.set_index("factor")["stands"][found.fails]
    written = pd.read_csv(tmp_path / "safety.csv")
    assert list(written["factor"]) == list(found.trials["factor"])
    assert found.mechanism.folder == tmp_path / f"F_{found.fails:g}"


def test_what_has_no_factor_is_refused() -> None:
    case = fc.Case(block(0.5))
    with pytest.raises(ValueError, match="within: is 0: must be above 0"):
        fc.safety(case, within=0)
    with pytest.raises(fc.CaseError, match="bodies"):
        fc.safety(case, bodies=["blok"])
    with pytest.raises(fc.CaseError, match="has no strength"):
        fc.safety(case, bodies=["block"])
    with pytest.raises(fc.Stopped, match="stand even when divided by 1.1: give a larger `most`"):
        fc.safety(case, most=1.1)


def test_a_mesh_at_hand_has_a_factor_too() -> None:
    document = block(0.5)
    mesh = fc.Mesh.from_blocks(document["mesh"]["blocks"])
    found = fc.safety(fc.Case({**document, "mesh": mesh}), within=0.2, threads=1)
    assert found.stands <= 0.5 / math.tan(math.radians(20)) <= found.fails + 0.005
