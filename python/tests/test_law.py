"""Laws alone, and laws written in Python."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY, command

import fecontact as fc

PAPER: dict[str, Any] = {
    "law": "super_subloading",
    "mu_s": 0.4,
    "mu_k": 0.2,
    "alpha_t": 1000.0,
    "r": 100.0,
    "kappa": 10.0,
    "xi": 0.002,
}


def wave(n: int = 400) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    time = np.linspace(0.0, 20.0, n)
    return time, 0.02 * np.sin(time) + 0.001 * time, 98.1 * (1.0 + 0.3 * np.cos(1.7 * time))


@pytest.mark.parametrize("friction", [PAPER, {"law": "coulomb", "mu": 0.3, "alpha_t": 1e3}])
def test_drive_gives_what_the_command_line_writes(program: Path, tmp_path: Path, friction: dict[str, Any]) -> None:
    time, slip, pressure = wave()
    test = {"friction": friction, "table": np.stack([time, slip, pressure], axis=1).tolist()}
    (tmp_path / "test.json").write_text(json.dumps(test))
    told = command(program, "law", tmp_path / "test.json", "--out", tmp_path / "out")
    assert told.returncode == 0, told.stderr
    table = fc.Result(tmp_path / "out")._table("law.csv")
    drive = fc.law(friction).drive(time, slip, pressure)
    for name in table:
        np.testing.assert_array_equal(drive[name], table[name], err_msg=name)
    assert set(table) == set(drive)


@pytest.mark.parametrize("normal", [None, {"stiffness": 30.0}, {"constant_volume": True, "alpha_n": 500.0}])
def test_an_interface_that_opens_is_driven_as_by_the_command_line(
    program: Path, tmp_path: Path, normal: dict[str, Any] | None
) -> None:
    time = np.linspace(0.0, 20.0, 400)
    slip, dilatancy = 0.02 * time, fc.model.Dilatancy(structure=0.1)
    table = np.stack([time, slip, np.full_like(time, 98.1)], axis=1).tolist()
    test = {"friction": PAPER, "dilatancy": dilatancy, "table": table, **({"normal": normal} if normal else {})}
    (tmp_path / "test.json").write_text(json.dumps(test))
    told = command(program, "law", tmp_path / "test.json", "--out", tmp_path / "out")
    assert told.returncode == 0, told.stderr
    written = fc.Result(tmp_path / "out")._table("law.csv")
    drive = fc.law(PAPER).drive(time, slip, 98.1, dilatancy=dilatancy, normal=normal)
    for name in written:
        np.testing.assert_array_equal(drive[name], written[name], err_msg=name)
    assert {"dilation", "gap"} <= set(drive) and drive.dilation[-1] > 0
    assert (drive.pressure[-1] > 98.1) == (normal is not None)


def test_many_sets_at_once_are_each_as_alone() -> None:
    time, slip, pressure = wave(120)
    mu_s, xi = np.array([[0.3], [0.4]]), np.array([0.0, 0.002, 0.2])
    law = fc.law({**PAPER, "mu_s": mu_s, "xi": xi})
    drive = law.drive(time, slip, pressure)
    assert law.shape == (2, 3) and drive.traction.shape == (2, 3, 120) and drive.slip.shape == (2, 3, 120)
    one = fc.law({**PAPER, "mu_s": 0.4, "xi": 0.2}).drive(time, slip, pressure)
    np.testing.assert_array_equal(drive.traction[1, 2], one.traction)
    slips = np.linspace(0.5, 1.5, 6).reshape(2, 3, 1) * slip
    many = law.drive(time, slips, 98.1, threads=1)
    alone = fc.law({**PAPER, "mu_s": 0.3, "xi": 0.002}).drive(time, slips[0, 1], 98.1)
    np.testing.assert_array_equal(many.mu[0, 1], alone.mu)


def test_tangents_are_those_of_the_answers() -> None:
    """Central differences over the last step of a path."""
    time, slip, pressure = (array[:50] for array in wave(400))
    law = fc.law(PAPER)
    at = law.drive(time, slip, pressure)
    for name, course, h in (("dtraction_dslip", slip, 1e-9), ("dtraction_dpressure", pressure, 1e-5)):
        ends = []
        for sign in (1.0, -1.0):
            moved = course.copy()
            moved[-1] += sign * h
            arrays = (moved, pressure) if course is slip else (slip, moved)
            ends.append(law.drive(time, *arrays).traction[-1])
        assert at[name][-1] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-4), name


@pytest.mark.parametrize(
    "friction",
    [
        PAPER,
        {**PAPER, "m": 1.5, "n": 0.8},
        {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-3, "a": 0.01, "b": 0.015, "D_c": 1e-3, "alpha_t": 1e4},
        {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-3, "a": 0.02, "b": 0.015, "D_c": 1e-3, "alpha_t": 1e4},
        {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.3, "D_c": 0.01, "alpha_t": 1e4},
        {"law": "coulomb", "mu": 0.3, "alpha_t": 1e3},
    ],
)
def test_steady_sliding_is_where_a_long_drive_ends(friction: dict[str, Any]) -> None:
    rates = np.array([1e-4, 1e-3, 0.02])
    expected = fc.law(friction).steady(rates)
    for rate, coefficient in zip(rates, expected):
        duration = 20.0 / rate
        time = np.linspace(0.0, duration, 4001)
        drive = fc.law(friction).drive(time, rate * time, 10.0)
        assert drive.traction[-1] / 10.0 == pytest.approx(coefficient, rel=1e-6), rate


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fc.law("coulomb", mu=0.3).drive([0, 1], 0.0, 1.0), "law: friction: the key `alpha_t` is missing"),
        (lambda: fc.law("coulom", mu=0.3), "did you mean `coulomb`"),
        (lambda: fc.law("coulomb", muu=0.3, alpha_t=1.0), "did you mean `mu`"),
        (lambda: fc.law("coulomb", mu=[0.3, -1.0], alpha_t=1.0).drive([0, 1], 0.0, 1.0), '"mu" is -1'),
        (lambda: fc.law("coulomb", mu=[0.3, 1.0], alpha_t=[1.0, 2.0, 3.0]), r"mu \(2,\), alpha_t \(3,\)"),
        (lambda: fc.law(PAPER).drive([0, 1, 2], [0.0, 1.0], 1.0), r"slip: has the shape \(2,\): must be \(3,\), as time has"),
        (lambda: fc.law(PAPER).drive([0, 1, 1], 0.0, 1.0), "times must increase"),
        (lambda: fc.law(PAPER).drive([0, 1, np.nan], 0.0, 1.0), r"time\[2\]: is nan"),
        (lambda: fc.law(PAPER).drive([0, 1], 0.0, 1.0, traction=9.0), "traction: is 9, above the initial strength"),
        (lambda: fc.law("prescribed", slip_rate=1.0, alpha_t=1.0).steady(1.0), "has no steady sliding"),
        (lambda: fc.law(PAPER).drive([0, 1], 0.0, 1.0, traction=np.nan), "law: traction: is nan: must be a finite number"),
        (lambda: fc.law(PAPER).slider([0, 1], 0.0, 1.0, stiffness=1, mass=1, force=np.inf), "law: force: is inf: must be a finite number"),
        (lambda: fc.law(PAPER).drive([], [], 1.0), r"law: time: has the shape \(0,\): must be \(n,\), n ≥ 2"),
        (lambda: fc.law(PAPER).drive(1.0, 1.0, 1.0), r"law: time: has the shape \(\): must be \(n,\), n ≥ 2"),
        (lambda: fc.law(PAPER).drive([0, 1], 0.0, 1.0, normal={"stiffness": 1.0}, by=["mu_s"]), "by: the traction is differentiated at given"),
        (lambda: fc.law(PAPER).drive([0, 1], 0.0, 1.0, dilatancy={"structure": 1.0}), "dilatancy.structure: is 1: it makes tan ψ = 1"),
        (lambda: fc.law({**PAPER, "xi": []}), r"the parameters have the shape \(0,\): give one set of them or more"),
        (lambda: fc.law(PAPER).steady([1.0, -1.0]), "rate: is -1.0: must be positive"),
    ],
)
def test_bad_drives(call: Any, message: str) -> None:
    with pytest.raises(fc.CaseError, match=message):
        call()


ALONE = {
    "coulomb": {"mu": 0.6},
    "adhesion": {"strength": 0.3},
    "slip_weakening": {"mu_s": 0.6, "mu_d": 0.5, "D_c": 1e-2},
    "rate_and_state": {"f_0": 0.6, "a": 0.01, "b": 0.015, "D_c": 1e-3, "V_0": 1e-3},
    "super_subloading": {"mu_s": 0.6, "mu_k": 0.5, "r": 1e3, "kappa": 10, "xi": 0.001},
}


@pytest.mark.parametrize("name", ALONE)
@pytest.mark.parametrize("pressure", [[1.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 1.0]])
def test_a_sample_without_pressure(name: str, pressure: list[float]) -> None:
    """It carries nothing, and what comes after is what a thousand times as many samples of the same path give."""
    law, time = fc.law(name, alpha_t=1e3, **ALONE[name]), np.arange(3.0)
    coarse = law.drive(time, 1e-3 * time, pressure)
    often = np.linspace(0.0, 2.0, 2001)
    fine = law.drive(often, 1e-3 * often, np.interp(often, time, pressure))
    assert (coarse.traction[np.array(pressure) <= 0.0] == 0.0).all()
    np.testing.assert_allclose(coarse.traction, fine.traction[::1000], rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(coarse.mu, fine.mu[::1000], rtol=1e-5)
    if name == "coulomb" and pressure == [1.0, 0.0, 1.0]:
        np.testing.assert_allclose(coarse.traction, [0.0, 0.0, 0.6], atol=1e-15)


def coulomb(old: Any, slip: Any, pressure: Any, dt: Any, *, mu: float, alpha_t: float) -> dict[str, Any]:
    """Coulomb friction as the built-in law has it, dissipation included."""
    trial = old["traction"] + alpha_t * slip
    sign, strength = np.sign(trial), mu * pressure
    slides = np.abs(trial) > strength
    traction = np.where(slides, sign * strength, trial)
    # Where |q|, rising from q₀ to the trial, meets μ p, which goes from μ p₀ to μ p.
    start, before = sign * old["traction"], mu * old["pressure"]
    rise, fall = np.abs(trial) - start, before - strength
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip((before - start) / (rise + fall), 0.0, 1.0)
    at_yield = start + np.nan_to_num(share) * rise
    plastic = np.where(slides, (trial - traction) / alpha_t, 0.0)
    return {
        "traction": traction,
        "dtraction_dslip": np.where(slides, 0.0, alpha_t),
        "dtraction_dpressure": np.where(slides, sign * mu, 0.0),
        "plastic_increment": plastic,
        "dissipation": 0.5 * (at_yield + strength) * np.abs(plastic),
    }


def test_a_law_in_python_is_the_built_in_one() -> None:
    fc.friction_law("python_coulomb")(coulomb)
    time, slip, pressure = wave(300)
    ours = fc.law("registered", name="python_coulomb", parameters={"mu": 0.3}, alpha_t=1e3).drive(time, slip, pressure)
    theirs = fc.law("coulomb", mu=0.3, alpha_t=1e3).drive(time, slip, pressure)
    for name in ("traction", "plastic_slip", "dissipation", "dtraction_dslip", "dtraction_dpressure"):
        np.testing.assert_allclose(ours[name], theirs[name], rtol=1e-12, atol=1e-13, err_msg=name)


def test_a_law_in_python_in_a_case(document: dict[str, Any]) -> None:
    fc.friction_law("python_coulomb")(coulomb)
    base = document["contacts"]["base"]
    base["friction"] = {"law": "coulomb", "mu": 0.3, "alpha_t": 2e3}
    theirs = fc.Case(document).run(progress=False).history
    base["friction"] = fc.model.Registered(name="python_coulomb", parameters={"mu": 0.3}, alpha_t=2e3)
    ours = fc.Case(document).run(progress=False).history
    assert len(ours) == len(theirs)
    for name in ("time", "base.normal_force", "base.tangential_force", "base.mean_slip", "friction_dissipation", "iterations"):
        np.testing.assert_allclose(ours[name], theirs[name], rtol=1e-9, atol=1e-12, err_msg=name)


def test_a_law_remembers_its_variables() -> None:
    """q = η λ̇ with a count of increments: variables go from increment to increment, and begin as they are told."""

    @fc.friction_law("counting", variables={"count": 5.0})
    def counting(old: Any, slip: Any, pressure: Any, dt: Any, *, alpha_t: float) -> dict[str, Any]:
        stick = old["traction"] + alpha_t * slip
        return {
            "traction": stick,
            "dtraction_dslip": alpha_t,
            "dtraction_dpressure": 0.0,
            "plastic_increment": 0.0,
            "count": old["count"] + 1.0,
        }

    drive = fc.law("registered", name="counting", alpha_t=2.0).drive([0, 1, 2, 3], [0, 1, 2, 3], 1.0)
    assert drive["count"].tolist() == [6, 7, 8, 9] and drive.traction.tolist() == [0, 2, 4, 6]


def test_a_law_remembers_any_number_of_variables(document: dict[str, Any]) -> None:
    """Each point remembers the last forty slips, newest first; a run that is resumed half way has the same ones at its end."""
    names = [f"slip_{k}" for k in range(40)]

    @fc.friction_law("remembering", variables=dict.fromkeys(names, -1.0))
    def remembering(old: Any, slip: Any, pressure: Any, dt: Any, *, alpha_t: float) -> dict[str, Any]:
        shifted = dict(zip(names, [slip, *(old[name] for name in names[:-1])]))
        tangents = {"traction": 0.0, "dtraction_dslip": 0.0, "dtraction_dpressure": 0.0, "plastic_increment": slip}
        return tangents | shifted

    slips = np.arange(50.0)
    drive = fc.law("registered", name="remembering", alpha_t=2.0).drive(slips, slips**2, 1.0)
    assert [drive[name][-1] for name in names] == [97.0 - 2.0 * k for k in range(40)]

    document["contacts"]["base"]["friction"] = {"law": "registered", "name": "remembering", "alpha_t": 2e3}
    whole, half = fc.Simulation(document), fc.Simulation(document)
    next(half), next(half)
    resumed = fc.Simulation.resume(document, half.save())
    list(whole), list(resumed)
    for name in names:
        np.testing.assert_array_equal(whole.contacts["base"][name], resumed.contacts["base"][name], err_msg=name)
    assert (whole.contacts["base"]["slip_0"] > 0.0).any() and (whole.contacts["base"]["slip_39"] == -1.0).any()


LACKING = {"traction": 1.0}


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (ValueError("no idea"), "no idea"),
        (LACKING, "did not return `dtraction_dslip`"),
        ({"traction": np.zeros(77)}, "`traction` of the shape .77,.: must be"),
        ({"traction": np.nan}, "`traction` = NaN"),
        ({"traction": np.array(1.0 + 2.0j)}, "`traction` of the type complex128: must be real numbers"),
        ({"traction": "0.3"}, "`traction` of the type <U3: must be real numbers"),
        ({"tractoin": 1.0}, "returned `tractoin`; known are traction"),
        (7, "must return a dict"),
    ],
)
def test_laws_that_fail(document: dict[str, Any], returned: Any, message: str) -> None:
    @fc.friction_law("failing")
    def failing(old: Any, slip: Any, pressure: Any, dt: Any, *, alpha_t: float) -> Any:
        if isinstance(returned, Exception):
            raise returned
        full = {"traction": 0.0, "dtraction_dslip": 0.0, "dtraction_dpressure": 0.0, "plastic_increment": 0.0}
        return returned if returned is LACKING or not isinstance(returned, dict) else {**full, **returned}

    document["contacts"]["base"]["friction"] = {"law": "registered", "name": "failing", "alpha_t": 2e3}
    with pytest.raises(fc.Stopped, match=f"the friction law `failing` failed: .*{message}") as caught:
        fc.Case(document).run(progress=False)
    assert isinstance(caught.value.__cause__, (ValueError, TypeError))
    result = caught.value.result
    assert result is not None and result.status == "stopped" and result.summary["reason"] == str(caught.value)
    with pytest.raises((ValueError, TypeError), match=message):
        list(fc.Simulation(document))
    with pytest.raises((ValueError, TypeError), match=message):
        fc.law("registered", name="failing", alpha_t=1.0).drive([0, 1], [0, 1], 1.0)


def test_the_end_of_an_iteration_within_a_law_is_not_that_of_the_run(document: dict[str, Any]) -> None:
    @fc.friction_law("ending")
    def ending(old: Any, slip: Any, pressure: Any, dt: Any, *, alpha_t: float) -> Any:
        raise StopIteration

    document["contacts"]["base"]["friction"] = {"law": "registered", "name": "ending", "alpha_t": 2e3}
    with pytest.raises(RuntimeError, match="the friction law `ending` failed: StopIteration") as caught:
        list(fc.Simulation(document))
    assert isinstance(caught.value.__cause__, StopIteration)


def test_laws_that_nobody_has_registered(program: Path, document: dict[str, Any], tmp_path: Path) -> None:
    document["contacts"]["base"]["friction"] = {"law": "registered", "name": "nobodys"}
    with pytest.raises(fc.CaseError, match="base.friction.name: no law `nobodys` is registered in this program"):
        fc.Case(document).check()
    (tmp_path / "case.json").write_text(json.dumps(document))
    told = command(program, "check", tmp_path / "case.json")
    assert told.returncode == 2 and "no law `nobodys` is registered in this program; none is" in told.stderr
    with pytest.raises(TypeError, match="law `three`: must be a function"):
        fc.friction_law("three")(3)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("names", "message"),
    [
        *(([name], f"a variable cannot be named `{name}`") for name in ("q", "p", "slip", "time", "pressure", "dilation", "gap", "Slip")),
        *(([name], "must begin with a letter") for name in ("", " ", "a,b", "a.b", "../a", "<b>", "a\x1b[31m", "a\n", "1a", "a" * 65)),
        (["a", "A"], "`a` and `A` differ at most in capitals"),
        (["r"], "`R` and `r` differ at most in capitals"),
    ],
)
def test_names_of_variables_are_checked(names: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=f"law `named`: .*{message}"):
        fc.friction_law("named", variables=dict.fromkeys(names, 0.0))(coulomb)


def test_every_name_of_the_outputs_is_taken(document: dict[str, Any], tmp_path: Path) -> None:
    """All that results say of a contact point by name; only what laws themselves say, R, mu and structure, may be a variable."""
    base = document["contacts"]["base"]
    base.update(fluid_pressure=0.1, dilatancy={"rate": 0.01, "limit": 1e-4}, wear=1e-6)
    result = fc.Case(document).run(tmp_path / "out", progress=False)
    frame = result.fields.contact[-1]
    interface = result.interface["base"]
    names = {*frame.point_data, *interface.data_vars, *interface.coords, *interface.dims}
    names |= set(fc.law(PAPER).drive([0, 1], [0, 1], 1.0))
    names |= set(fc.Simulation(document).contacts["base"])
    assert {"fluid_pressure", "wear", "dilation", "total_slip", "elastic_slip", "evaluations", "position"} <= names
    free = set()
    for name in names:
        try:
            fc.friction_law("named", variables={name: 0.0})(coulomb)
        except ValueError:
            continue
        free.add(name)
    assert free == {"R", "mu", "structure"}


def test_answers_of_a_law_have_the_shape_of_its_points(document: dict[str, Any]) -> None:
    """One number for all points is a number, and not an array of one: the shape of something else."""
    asked = []

    @fc.friction_law("shapely", variables={"count": 0.0})
    def shapely(old: Any, slip: Any, pressure: Any, dt: Any, *, alpha_t: float, shape: float) -> Any:
        asked.append(slip.size)
        count = {0: 1.0, 1: np.ones(1), 2: np.ones((1, slip.size)), 3: np.ones((slip.size, 1))}[int(shape)]
        return {"traction": 0 * slip, "dtraction_dslip": 0.0, "dtraction_dpressure": 0.0, "plastic_increment": 0.0, "count": count}

    for shape in range(4):
        document["contacts"]["base"]["friction"] = {"law": "registered", "name": "shapely", "parameters": {"shape": shape}}
        if shape == 0:
            fc.Case(document).run(progress=False, threads=1)
            assert max(asked) > 1
            continue
        with pytest.raises(fc.Stopped, match=r"the friction law `shapely` failed: .*it returned `count` of the shape \(\d+,.*: must be \(\d+,\)"):
            fc.Case(document).run(progress=False, threads=1)


def test_the_stiffness_is_not_a_parameter_of_its_own(document: dict[str, Any]) -> None:
    fc.friction_law("python_coulomb")(coulomb)
    parameters = {"mu": 0.3, "alpha_t": 7.0}
    document["contacts"]["base"]["friction"] = {"law": "registered", "name": "python_coulomb", "parameters": parameters}
    with pytest.raises(fc.CaseError, match='contacts.base.friction: "parameters.alpha_t" is 7, but'):
        fc.Case(document).check()


def test_committed_law_test_is_read() -> None:
    test = json.loads((REPOSITORY / "cases" / "law" / "monotone.json").read_text())
    assert fc.law(test["friction"]).drive([0, 1], [0, 0.1], 50.0).traction[-1] > 0


def test_sets_of_parameters_may_differ_in_words() -> None:
    both = fc.law({**PAPER, "approach": ["logarithmic", "cotangent"]}).drive(*wave(50)).traction
    for one, approach in zip(both, ("logarithmic", "cotangent")):
        np.testing.assert_array_equal(one, fc.law({**PAPER, "approach": approach}).drive(*wave(50)).traction)


def test_drives_are_copied_and_pickled() -> None:
    drive = fc.law("coulomb", mu=[0.3, 0.4], alpha_t=1e3).drive([0.0, 1.0, 2.0], [0.0, 0.1, 0.0], 2.0)
    for other in (copy.copy(drive), copy.deepcopy(drive), pickle.loads(pickle.dumps(drive))):
        assert list(other) == list(drive) and repr(other) == repr(drive)
        for name in drive:
            np.testing.assert_array_equal(other[name], drive[name])
    assert copy.deepcopy(drive).traction is not drive.traction
    with pytest.raises(AttributeError, match="a drive has no `tractoin`; it has time, slip"):
        _ = drive.tractoin
