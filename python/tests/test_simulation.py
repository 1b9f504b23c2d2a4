"""A run increment by increment."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import command

import fecontact as fc


def test_iterating_gives_the_bits_of_a_run(document: dict[str, Any], result: fc.Result) -> None:
    simulation, history = fc.Simulation(document), result.history
    for (_, row), increment in zip(history.iterrows(), simulation, strict=True):
        assert (increment.time, increment.dt, increment.iterations) == (row["time"], row["dt"], row["iterations"])
        assert simulation.reaction("block_top").tolist() == [row["block_top.fx"], row["block_top.fy"]]
        assert simulation.contacts["base"].force.tolist() == [row["base.force_x"], row["base.force_y"]]
    assert simulation.is_complete and simulation.report["increments"] == len(history)


def test_arrays_are_views_that_cannot_be_written(document: dict[str, Any]) -> None:
    simulation = fc.Simulation(document)
    increment = next(simulation)
    displacement = increment.displacement
    assert displacement.shape == simulation.nodes.shape and displacement.dtype == np.float64
    assert not displacement.flags.owndata and not displacement.flags.writeable
    with pytest.raises(ValueError):
        displacement[0, 0] = 1.0
    with pytest.raises(ValueError):
        displacement.setflags(write=True)
    # The same memory every time, which outlives what gave it.
    assert np.shares_memory(displacement, increment.displacement)
    before = displacement.copy()
    del increment
    list(simulation)
    del simulation
    np.testing.assert_array_equal(displacement, before)


def test_contact_fields(document: dict[str, Any]) -> None:
    simulation = fc.Simulation(document)
    for _ in simulation:
        pass
    base = simulation.contacts["base"]
    assert base.position.shape == (6, 2) and base["pressure"].shape == (6,)
    assert (np.diff(base.position[:, 0]) > 0).all() and set(base["state"]) <= {0.0, 1.0, 2.0}
    assert (base["traction"] <= 0.4 * base["pressure"] * (1 + 1e-9)).all()
    with pytest.raises(LookupError, match="contacts have no field `pres`; they have gap, pressure"):
        base["pres"]
    with pytest.raises(LookupError, match="did you mean `block_top`"):
        simulation.reaction("block_to")


def test_bar_fields() -> None:
    rod = {"points": [[0, 0], [2, 0]], "ea": 100, "start": {"on": "left"}, "end": {"on": "right"}}
    steps = [{"name": "pull", "duration": 1, "supports": [{"on": "left", "ux": 0, "uy": 0}, {"on": "right", "ux": 0.1, "uy": 0}]}]
    mesh = {"nodes": [[0, 0], [2, 0]], "points": {"left": [0], "right": [1]}}
    simulation = fc.Simulation({"mesh": mesh, "bars": {"rod": rod}, "steps": steps})
    for _ in simulation:
        pass
    own = simulation.bars["rod"]
    np.testing.assert_allclose(own["axial_force"], [5.0])
    np.testing.assert_allclose(own.position, [[0, 0], [2.1, 0]])
    assert set(own) == {"moment", "slip", "bond_shear", "bond_normal", "axial_force", "shear_force", "yielding"}
    with pytest.raises(LookupError, match="bars have no field `axial`; they have moment"):
        own["axial"]


def test_saved_runs_go_on_to_the_same_bits(document: dict[str, Any], result: fc.Result, tmp_path: Path) -> None:
    case = fc.Case(document)
    simulation = fc.Simulation(case)
    for _ in range(4):
        next(simulation)
    saved = simulation.save()
    for _ in range(2):
        again = fc.Simulation.resume(case, saved)
        assert [increment.time for increment in again] == result.history["time"].tolist()[4:]
        assert again.reaction("block_top")[0] == result.history["block_top.fx"].iloc[-1]
    simulation.write(tmp_path)
    assert (tmp_path / "checkpoint.bin").is_file()
    simulation.prescribe("block_top", ux=0.0, by=3.0)
    with pytest.raises(fc.Stopped, match="was changed by its caller"):
        simulation.write(tmp_path)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"bodies.block.material.E": 5}, "`bodies.block.material.E` is now 5 and was 100"),
        ({"steps[1].supports[0].ux": {"rate": 0.2}}, "`steps[1].supports[0].ux.rate` is now 0.2 and was 0.1"),
        ({"contacts.base.friction.mu_s": 0.5, "newton": {"tolerance": 1e-6}}, "`contacts.base.friction.mu_s` is now 0.5 and was 0.4"),
    ],
)
def test_a_changed_case_is_refused_in_the_words_of_the_command_line(
    program: Path, document: dict[str, Any], tmp_path: Path, change: dict[str, Any], told: str
) -> None:
    case = fc.Case(document, folder=tmp_path)
    case.run(tmp_path / "out", progress=False)
    changed = case.replace(change)
    changed.write(tmp_path / "case")
    by_command = command(program, "run", tmp_path / "case", "--resume", "--out", tmp_path / "out")
    assert by_command.returncode == 2
    simulation = fc.Simulation(case)
    for _ in range(4):
        next(simulation)
    with pytest.raises(fc.CaseError, match="the case has changed since its checkpoint was written") as caught:
        fc.Simulation.resume(changed, simulation.save())
    assert told in str(caught.value) and f"error: {caught.value}\n" == by_command.stderr


def test_a_mesh_at_hand_that_has_changed_is_refused(document: dict[str, Any]) -> None:
    nodes = np.array(document["mesh"]["nodes"])
    parts = {kind: {name: np.array(group) for name, group in document["mesh"][kind].items()} for kind in ("elements", "edges")}
    case = fc.Case({**document, "mesh": fc.Mesh(nodes, **parts)})
    simulation = fc.Simulation(case)
    next(simulation)
    moved = case.replace({"mesh": fc.Mesh(1.5 * nodes, **parts)})
    with pytest.raises(fc.CaseError, match="mesh: its nodes are at other positions; the run cannot be resumed from its checkpoint"):
        fc.Simulation.resume(moved, simulation.save())


def test_what_is_to_come_may_have_changed(document: dict[str, Any]) -> None:
    case = fc.Case(document)
    simulation = fc.Simulation(case)
    while simulation.step == "press":
        next(simulation)
    # Between two steps: the next one has not begun, and is that of the new case.
    changed = case.replace({"title": "other", "watch": [], "steps[1].supports[0].ux": {"rate": 0.2}})
    again = fc.Simulation.resume(changed, simulation.save())
    straight = fc.Simulation(changed)
    list(straight)
    list(again)
    assert again.reaction("block_top").tolist() == straight.reaction("block_top").tolist()
    assert again.displacement("block_top")[0] == pytest.approx(0.8, rel=1e-12)
    # Once it is led, what its caller has done to it holds, and so it is one that has begun.
    simulation.prescribe("block_top", ux=0.1, by=2.0)
    with pytest.raises(fc.CaseError, match="steps.1..supports.0..ux.rate` is now 0.2 and was 0.1"):
        fc.Simulation.resume(changed, simulation.save())
    # A step that comes behind the last one goes on from its end.
    list(simulation)
    longer = case.replace({"steps": [*document["steps"], {"name": "rest", "duration": 1}]})
    further = fc.Simulation.resume(longer, simulation.save())
    assert not further.is_complete and further.step == "rest" and [one.step for one in further] == ["rest"] * 4


def test_a_run_that_was_stopped_goes_on_from_what_was_saved(document: dict[str, Any], result: fc.Result, tmp_path: Path) -> None:
    case = fc.Case(document)
    simulation = fc.Simulation(case)
    for _ in range(4):
        next(simulation)
    simulation.stop()
    assert list(simulation) == [] and simulation.is_complete
    again = fc.Simulation.resume(case, simulation.save())
    assert [increment.time for increment in again] == result.history["time"].tolist()[4:]
    # Its checkpoint is one of the middle of a run, with which nothing can begin.
    simulation.write(tmp_path)
    with pytest.raises(fc.CaseError, match="the run is not complete"):
        fc.Case({**document, "begin_with": str(tmp_path)}).check()


def test_a_servo_finds_the_force_that_is_wanted() -> None:
    from fecontact.examples.servo import servo

    felt = servo(wanted=1.5)
    assert len(felt) > 50
    # It comes nearer with every increment, and is there at the end.
    errors = [abs(force - 1.5) for _, force in felt[len(felt) // 2 :]]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 1e-3 * 1.5


def hung() -> dict[str, Any]:
    """A point mass on a spring of 10 along x and y, to which loads are given."""
    return {
        "mesh": {"nodes": [[0, 0]], "points": {"ball": [0]}},
        "point_masses": {"ball": {"mass": 1.0}},
        "steps": [
            {
                "name": "hang",
                "duration": 10,
                "dt": {"initial": 1.0},
                "loads": [{"on": "ball", "spring": {"kx": 10, "ky": 10}}, {"on": "ball", "force": {"y": -2}}],
            },
        ],
    }


def test_loads_are_led() -> None:
    simulation = fc.Simulation(hung())
    next(simulation)
    # f = -2 t/10 on a spring of 10, so far.
    assert simulation.displacement("ball")[1] == pytest.approx(-0.02, rel=1e-12)
    # From -0.2 now to 3 at t = 5, evenly: at t = 2 a quarter of the way; then held.
    simulation.load("ball", force={"x": 1.0, "y": 3.0}, by=5.0)
    next(simulation)
    assert simulation.displacement("ball") == pytest.approx([0.025, 0.06], rel=1e-12)
    while simulation.time < 7.0:
        next(simulation)
    assert simulation.displacement("ball") == pytest.approx([0.1, 0.3], rel=1e-12)
    # At once, and in both directions again; the spring's driver moves too.
    simulation.load("ball", force={"x": -1.0, "y": 0.0})
    simulation.load("ball", spring={"kx": 20, "ky": 10, "driver": {"y": 0.5}})
    next(simulation)
    assert simulation.displacement("ball") == pytest.approx([-0.05, 0.5], rel=1e-12)
    # A load that ends does so evenly.
    simulation.load("ball", force=None, by=10.0)
    next(simulation)
    assert simulation.displacement("ball") == pytest.approx([-0.025, 0.5], rel=1e-12)


def test_loads_led_are_saved_and_forgotten_in_the_next_step() -> None:
    document = hung()
    document["steps"].append({"name": "on", "duration": 2})
    case = fc.Case(document)
    simulation = fc.Simulation(case)
    next(simulation)
    simulation.load("ball", force={"y": 1.0})
    again = fc.Simulation.resume(case, simulation.save())
    for one in (simulation, again):
        one.load("ball", force={"y": 2.0}, by=2.0)
        next(one)
        assert one.displacement("ball")[1] == pytest.approx(0.2, rel=1e-12)
    list(again)
    # The next step has its own: what the case says.
    assert again.displacement("ball")[1] == pytest.approx(-0.2, rel=1e-12)


def test_many_changes_cost_no_memory_and_no_time() -> None:
    document = hung()
    document["steps"][0]["dt"] = {"initial": 1e-3}
    simulation = fc.Simulation(document)
    for k, _ in enumerate(simulation):
        if k >= 2000:
            break
        simulation.load("ball", force={"y": float(k % 7)}, by=simulation.time + 1e-3)
    assert simulation.displacement("ball")[1] == pytest.approx(0.1 * (1999 % 7), rel=1e-9)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"on": "bal", "force": {"y": 1}}, "load.on.*did you mean `ball`"),
        ({"on": "ball", "forse": {"y": 1}}, "did you mean `force`"),
        ({"on": "ball"}, "must give exactly one of"),
        ({"on": "ball", "force": {"y": float("nan")}}, "load: force.y: is nan"),
        ({"on": "ball", "force": {"y": 1}, "by": -1.0}, "by: is -1: must not be before the current time"),
    ],
)
def test_bad_loads(given: dict[str, Any], message: str) -> None:
    simulation = fc.Simulation(hung())
    next(simulation)
    with pytest.raises(fc.CaseError, match=message):
        simulation.load(**given)
    # What was there is there still.
    next(simulation)
    assert simulation.displacement("ball")[1] == pytest.approx(-0.04, rel=1e-12)


def test_bad_motions(document: dict[str, Any]) -> None:
    simulation = fc.Simulation(document)
    next(simulation)
    with pytest.raises(AttributeError, match="no `lead`: it is called `prescribe`"):
        simulation.lead("block_top", ux=1.0, by=2.0)  # type: ignore[attr-defined]
    with pytest.raises(LookupError, match="`block_bottom` has no support along x"):
        simulation.prescribe("block_bottom", ux=1.0, by=2.0)
    with pytest.raises(fc.CaseError, match="by: is 0"):
        simulation.prescribe("block_top", ux=1.0, by=0.0)
    with pytest.raises(fc.CaseError, match="ux: is nan|ux: is NaN"):
        simulation.prescribe("block_top", ux=float("nan"), by=2.0)


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"max": 1e-300}, "increments: max: is 1e-300: at the time 5e0 increments below .* are lost in round-off"),
        ({"min": 1e-300}, "increments: min: is 1e-300: at the time 5e0 increments below .* are lost in round-off"),
        ({"max": 1e-12}, "increments: increments of at most 1e-12 make 4.0e12 of them .*: make them longer"),
        ({"min": 0.5, "max": 0.1}, "increments: min = 0.5 is above max = 0.1: increments must have room between them"),
        ({"min": 0.5}, "increments: min = 0.5 is above max = 0.25"),
        ({"max": float("nan")}, "increments: max: is NaN: must be positive"),
        ({"min": -1.0}, "increments: min: is -1: must be positive"),
        ({"max": float("inf")}, "increments: max: is inf: must be positive"),
    ],
)
def test_bad_bounds_of_increments(document: dict[str, Any], bounds: dict[str, float], message: str) -> None:
    simulation = fc.Simulation(document)
    while simulation.step == "press":
        next(simulation)
    with pytest.raises(fc.CaseError, match=message):
        simulation.increments(**bounds)
    # What was there is there still.
    assert next(simulation).dt == pytest.approx(0.25)


def test_increments_are_bounded(document: dict[str, Any]) -> None:
    simulation = fc.Simulation(document)
    while simulation.step == "press":
        next(simulation)
    simulation.increments(max=0.05)
    assert next(simulation).dt == pytest.approx(0.05)
