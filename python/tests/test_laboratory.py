"""The measured events of the 4 m fault: the numbers of cases/laboratory/README.md."""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
import pytest
from conftest import REPOSITORY

# As the script prints them
FOUND = {"mu_s": 0.3295, "mu_k": 0.3236, "xi": 0.2817}


@pytest.fixture(scope="module")
def script() -> Any:
    spec = importlib.util.spec_from_file_location("spring_slider", REPOSITORY / "cases" / "laboratory" / "spring_slider.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
