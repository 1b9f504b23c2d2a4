"""Measured records: the events of the 4 m fault (cases/laboratory/README.md), a velocity step and a load test (docs/validation/records.md)."""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY

# As the script prints them
FOUND = {"mu_s": 0.3295, "mu_k": 0.3236, "xi": 0.2817}


def loaded(name: str) -> Any:
    spec = importlib.util.spec_from_file_location(name, REPOSITORY / "cases" / "laboratory" / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def script() -> Any:
    return loaded("spring_slider")


@pytest.fixture(scope="module")
def cycle(script: Any) -> Any:
    data = script.events()
    machine = script.machine(data)
    stiffness, rate = machine["stiffness"][0], machine["rate"][0]

    def ridden(**changes: float) -> dict[str, float]:
        given = {**FOUND, **script.GIVEN, "stiffness": stiffness, **changes}
        told = script.cycle({name: np.array([value]) for name, value in given.items()}, rate)
        found = {name: float(value[0]) for name, value in told.items()}
        return {**found, "drop": found["before"] - found["after"]}

    return ridden


def test_drop_slip_and_recurrence_are_those_of_the_events(script: Any, cycle: Any) -> None:
    data, told = script.events(), cycle()
    assert data["time"].size == 46
    for name, value in told.items():
        error = data[name].std(ddof=1) / np.sqrt(46)
        assert abs(value - data[name].mean()) < 2.5 * error, (name, value)
    # Equilibrium before and after: the drop is what slip takes from the spring; it recurs when the load point has made up for it,
    # and for what creeps meanwhile.
    machine = script.machine(data)
    assert machine["stiffness"][0] == pytest.approx(0.6031, abs=1e-3) and machine["rate"][0] == pytest.approx(0.00808, abs=1e-5)
    assert told["drop"] == pytest.approx(machine["stiffness"][0] * told["slip"], rel=0.01)
    assert 1.0 < told["interval"] * machine["rate"][0] / told["slip"] < 1.06


def test_what_the_events_determine_and_what_not(script: Any, cycle: Any) -> None:
    data, told = script.events(), cycle()
    error = {name: data[name].std(ddof=1) / np.sqrt(46) for name in ("before", "after")}
    # An undamped slider swings through: |q| falls as far below the kinetic strength as it was above.
    moved = cycle(mu_k=FOUND["mu_k"] + 5e-4)
    assert moved["after"] - told["after"] > 2.0 * error["after"]
    assert told["before"] + told["after"] == pytest.approx(4.0 * FOUND["mu_k"], rel=2e-3)
    slower = cycle(xi=FOUND["xi"] / 3.0)
    assert told["before"] - slower["before"] > 3.0 * error["before"]
    # A tenth of the mass, or three times the approach to sliding, is not seen.
    for changes in ({"mass": script.MASS / 10.0}, {"r": 3.0 * script.GIVEN["r"]}):
        other = cycle(**changes)
        assert all(abs(other[name] - told[name]) < 2.0 * error[name] for name in error), (changes, other, told)


def test_a_velocity_step_of_basalt_has_the_constants_of_its_authors() -> None:
    step = loaded("velocity_step")
    found = step.fitted(step.excerpt(), "ageing")
    value = found.table["value"]
    # The inversion published with the whole record: D_c = 6.74 µm, b − a = 5.6e-4; the mean friction of the excerpt before the step.
    assert value["D_c"] == pytest.approx(6.74, rel=0.15)
    assert 0 < value["b"] - value["a"] < 1e-3
    assert value["f_0"] == pytest.approx(0.6077, abs=5e-4)
    assert not found.words


@pytest.mark.slow
def test_friction_that_rises_after_a_step_asks_for_a_negative_b() -> None:
    step = loaded("rising_step")
    positive, negative = (step.fitted(name, 565.0) for name in ("b positive", "b negative"))
    # Before the step friction is f₀; from rate to rate steady friction differs by a − b per e-fold, (0.501 − 0.4546)/ln 10.
    value = negative.table["value"]
    assert value["f_0"] == pytest.approx(step.BEFORE, abs=1e-3)
    assert value["a"] - value["b"] == pytest.approx((0.501 - 0.4546) / np.log(10), rel=0.05)
    assert negative.noise < 0.3 * positive.noise


@pytest.mark.slow
def test_the_shaft_of_a_pile_carries_what_its_head_did() -> None:
    test = loaded("pile_load_test")
    found = test.fitted(test.PRESSURES["from 50 kPa on"])
    _, load = test.record()
    assert np.sqrt(np.mean(found.residuals[0] ** 2)) < 0.02 * load.max()
    # Equilibrium: the strength of the whole shaft under 200 kPa in the mean is the largest load, but for what has not yet slid to R = 1.
    friction = found.table["value"]["contacts.shaft.friction.mu_s"]
    assert friction * 200 * test.PERIMETER * test.LENGTH == pytest.approx(load.max(), rel=0.03)
