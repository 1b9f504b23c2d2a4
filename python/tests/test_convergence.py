"""Error bars by refinement, against a closed form; the rules of the bar are held in tests/command/converge.rs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fecontact as fc


def tube() -> tuple[dict[str, Any], float]:
    """A thick tube under a pressure inside, and Lamé's displacement of its bore."""
    a, b, p, young, nu = 1.0, 2.0, 0.7, 200.0, 0.3
    block = {
        "body": "tube",
        "corners": [[a, 0], [b, 0], [b, 0.5], [a, 0.5]],
        "elements": [4, 1],
        "sides": ["bottom", None, "top", "bore"],
    }
    case = {
        "section": "axisymmetric",
        "mesh": {"blocks": [block]},
        "watch": ["bore"],
        "bodies": {"tube": {"material": {"model": "linear", "E": young, "nu": nu}}},
        "steps": [
            {
                "name": "load",
                "duration": 1,
                "dt": {"initial": 0.5},
                "supports": [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}],
                "loads": [{"on": "bore", "traction": {"x": p}}],
            }
        ],
    }
    return case, (1 + nu) * p * a**2 / (young * (b**2 - a**2)) * ((1 - 2 * nu) * a + b**2 / a)


def test_the_bar_of_a_tube_holds_its_closed_form(tmp_path: Path) -> None:
    case, exact = tube()
    found = fc.converge(fc.Case(case), "bore.ux:end", out=tmp_path)
    assert list(found.runs["elements"]) == [4, 16, 64] and list(found.runs["increments"]) == [2, 4, 8]
    assert found.converges and found.bar is not None and found.order == pytest.approx(2, abs=0.2)
    error = abs(found.value - exact)
    assert error < found.bar < 2 * error
    assert found.extrapolated == pytest.approx(exact, abs=0.1 * error)
    assert f"converges with the order {found.order:.3g}" in found.verdict and "±" in repr(found)
    # A linear body: the increments change no more than round-off.
    assert found.by_increments == pytest.approx(0, abs=1e-9)
    ax = fc.plot.convergence(found)
    lines = {str(line.get_label()): np.asarray(line.get_ydata(), float) for line in ax.get_lines()}
    assert lines["runs"] == pytest.approx(found.runs["value"].to_numpy())
    assert lines["extrapolated"] == pytest.approx(found.extrapolated)
    # The last two runs lie on the curve of the order, which ends at the extrapolated value.
    curve = lines[f"order {found.order:.3g}"]
    assert [curve[0], curve[25]] == pytest.approx([found.extrapolated, found.value])
    assert curve[50] == pytest.approx(found.runs["value"].iloc[1])
    assert ax.get_title() == found.verdict
    assert fc.Result(tmp_path / "level_2").history["bore.ux"].iloc[-1] == found.value


def test_what_cannot_be_refined_is_refused() -> None:
    case = fc.Case(tube()[0])
    with pytest.raises(ValueError, match="levels: is 2"):
        fc.converge(case, "bore.ux:end", levels=2)
    with pytest.raises(ValueError, match="is not a measure"):
        fc.converge(case, "bore.ux")
    with pytest.raises(ValueError, match="has no column"):
        fc.converge(case, "bor.ux:end")
    with pytest.raises(ValueError, match="increments: is -1: give 0 or more"):
        case.refined(1, -1)
    nodes = {"nodes": [[1, 0], [2, 0], [2, 1], [1, 1]], "elements": {"tube": [[0, 1, 2, 3]]}, "edges": {"top": [[2, 3]], "bore": [[3, 0]]}}
    held = {**tube()[0], "mesh": {**nodes, "points": {"bottom": [0, 1]}}}
    with pytest.raises(fc.CaseError, match="mesh: the group `bottom` holds the nodes 0 and 1"):
        fc.converge(fc.Case(held), "bore.ux:end")


def test_a_mesh_at_hand_is_refined_as_its_blocks_are() -> None:
    case, _ = tube()
    on_mesh = fc.Case({**case, "mesh": fc.Mesh.from_blocks(case["mesh"]["blocks"])})
    values = [fc.converge(one, "bore.ux:end").runs["value"] for one in (fc.Case(case), on_mesh)]
    assert list(values[1]) == pytest.approx(list(values[0]), rel=1e-13)
