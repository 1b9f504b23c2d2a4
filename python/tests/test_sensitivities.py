"""Derivatives of laws by their parameters: against differences of several steps, along paths with all that can happen."""

from __future__ import annotations

import time as clock
from typing import Any

import numpy as np
import pytest

import fecontact as fc
from fecontact import _fit_problem, calibration
from fecontact.calibration import Holds, Interface, SpringSlider

SUPER = {"law": "super_subloading", "mu_s": 0.6, "mu_k": 0.4, "alpha_t": 2000.0, "r": 400.0, "kappa": 40.0, "xi": 0.05, "tolerance": 1e-12}
RATE = {"law": "rate_and_state", "a": 0.02, "b": 0.025, "f_0": 0.6, "V_0": 1e-3, "D_c": 0.05, "alpha_t": 2e3}
LAWS: dict[str, dict[str, Any]] = {
    "linear": SUPER,
    "exponents": {**SUPER, "m": 1.3, "n": 0.8, "elastic_core": 0.2, "structure": 1.3},
    "cotangent": {**SUPER, "m": 2.0, "n": 1.5, "approach": "cotangent"},
    "static": {**SUPER, "kappa": 0.0, "n": 2.0, "structure": 1.2},
    "coulomb": {"law": "coulomb", "mu": 0.4, "alpha_t": 50.0},
    "slip_weakening": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.4, "D_c": 0.05, "cohesion": 0.1, "alpha_t": 100.0},
    "ageing": RATE,
    "slip": {**RATE, "evolution": "slip", "theta": 3.0},
}
# Steps relative to the parameter; differences of fourth order are as right as 1e-10 with one of them.
STEPS = (1e-3, 1e-4)


def path(n: int = 241) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sliding, ten times as fast, held, slowly again, and back, under a pressure that varies."""
    time = np.linspace(0.0, 40.0, n)
    rate = np.select([time < 8, time < 14, time < 24, time < 32], [0.002, 0.02, 0.0, 0.005], -0.005)
    return time, np.concatenate([[0.0], np.cumsum(rate[1:] * np.diff(time))]), 1.0 + 0.3 * np.sin(time)


def study(value: float, answer: Any, exact: np.ndarray) -> list[float]:
    """Largest error of the differences of every step, relative to the largest derivative."""
    errors = []
    for step in STEPS:
        far, near, back, behind = answer(value * (1.0 + step * np.array([2.0, 1.0, -1.0, -2.0])))
        differences = (8.0 * (near - back) - (far - behind)) / (12.0 * step * value)
        errors.append(float(np.abs(exact - differences).max() / np.abs(exact).max()))
    return errors


@pytest.mark.parametrize("name", LAWS)
def test_derivatives_are_those_of_differences(name: str) -> None:
    given = LAWS[name]
    known = [by for by in fc.law(given).sensitivities() if given.get(by)]
    assert set(known) == {by for by, value in given.items() if isinstance(value, float) and value != 0.0} - {"tolerance"}
    drive = fc.law(given).drive(*path(), by=known)
    for by in known:
        exact = drive[f"dtraction_d{by}"]
        errors = study(given[by], lambda values, by=by: fc.law({**given, by: values}).drive(*path()).traction, exact)
        # Sub-steps of rate and state are chosen for 1e-6 f_0 p: where a parameter changes their choice, differences jump.
        assert min(errors) < (5e-4 if given["law"] == "rate_and_state" else 1e-8), (by, errors)


def test_derivatives_where_a_parameter_is_nothing() -> None:
    # One-sided: there is no negative weakening, recovery or core.
    given = {**SUPER, "kappa": 0.0, "xi": 0.0, "structure": 1.2}
    drive = fc.law(given).drive(*path(), by=["kappa", "xi", "elastic_core"])
    for by, step in (("kappa", 1e-5), ("xi", 1e-6), ("elastic_core", 1e-6)):
        base, near, far = fc.law({**given, by: [0.0, step, 2 * step]}).drive(*path()).traction
        differences = (4.0 * near - 3.0 * base - far) / (2.0 * step)
        exact = drive[f"dtraction_d{by}"]
        assert np.abs(exact - differences).max() < 1e-4 * np.abs(exact).max(), by


def test_derivatives_by_exponents_that_are_one() -> None:
    # The steps of the law are others for m = n = 1, of the same equations: right to what their tolerance leaves.
    drive = fc.law(SUPER).drive(*path(), by=["m", "n"])
    for by in ("m", "n"):
        below, above = fc.law({**SUPER, by: [1.0 - 1e-3, 1.0 + 1e-3]}).drive(*path()).traction
        exact = drive[f"dtraction_d{by}"]
        assert np.abs(exact - (above - below) / 2e-3).max() < 1e-4 * np.abs(exact).max(), by


def test_derivatives_where_the_coefficients_meet() -> None:
    """Finite at mu_s = mu_k, for any exponents and far along the sliding curve; moved together, both move q = μ p as it slides."""
    time, slip, _ = path(200)
    for m in (0.1, 0.5, 1.0, 2.0):
        for n in (0.1, 0.5, 1.0, 2.0):
            for kappa, xi, r, core in ((40.0, 0.05, 400.0, 0.0), (0.0, 0.0, 1e7, 0.5), (0.0, 5.0, 1e7, 0.999)):
                law = fc.law("super_subloading", mu_s=0.4, mu_k=0.4, alpha_t=2e3, r=r, kappa=kappa, xi=xi, m=m, n=n, elastic_core=core)
                drive = law.drive(time, slip, 1.0, by=law.sensitivities())
                columns = np.stack([drive[f"dtraction_d{name}"] for name in law.sensitivities()])
                assert np.isfinite(columns).all(), (m, n, kappa)
                # The end slides backwards: −μ p.
                assert drive.dtraction_dmu_s[-1] + drive.dtraction_dmu_k[-1] == pytest.approx(-1.0, rel=1e-3), (m, n, kappa)
                # Nothing weakens: how fast it would does not matter.
                np.testing.assert_allclose(columns[[law.sensitivities().index(name) for name in ("kappa", "xi", "m", "n")]], 0.0, atol=1e-9)


def test_what_is_not_differentiated() -> None:
    assert fc.law({**{k: v for k, v in SUPER.items() if k != "tolerance"}, "integration": "backward_euler"}).sensitivities() == []
    assert fc.law("frictionless").sensitivities() == []
    with pytest.raises(fc.CaseError, match="no derivative of the law by mass; there are derivatives by mu, alpha_t"):
        fc.law(LAWS["coulomb"]).drive([0, 1], [0, 1], 1.0, by=["mass"])


def test_a_record_of_ten_thousand_samples_takes_well_under_a_second() -> None:
    start = clock.process_time()
    fc.law({**SUPER, "tolerance": 1e-8}).drive(*path(10_000), by=["mu_s", "mu_k", "alpha_t", "r", "kappa", "xi"])
    assert clock.process_time() - start < 0.5


def problem(record: Any, free: dict[str, float], **fixed: float) -> tuple[Any, np.ndarray]:
    space = calibration.Space("super_subloading", {name: (value / 9.0, value * 9.0) for name, value in free.items()}, fixed)
    return calibration._Problem([record], space, None), space.coordinates(np.array(list(free.values())))


PARAMETERS = {name: value for name, value in SUPER.items() if isinstance(value, float) and name != "tolerance"}
# Slow, ten times as fast, and held
LED = np.linspace(0.0, 3.0, 121)
RECORDS = {
    "interface": (Interface(*path(), np.zeros(241)), {}),
    "series": (SpringSlider(*path(), np.zeros(241)), {"stiffness": 50.0}),
    "inertia": (SpringSlider(LED, np.interp(LED, [0, 1, 2, 3], [0, 0.05, 0.35, 0.35]), 1.0, 0 * LED), {"stiffness": 50.0, "mass": 0.01}),
    "holds": (Holds([1.0, 10.0, 100.0], np.zeros(3), rate=0.1, slide=0.5, pressure=2.0), {}),
}


@pytest.mark.parametrize("name", RECORDS)
def test_jacobians_of_records(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    record, machine = RECORDS[name]
    one, point = problem(record, {**PARAMETERS, **machine}, tolerance=1e-12)
    exact, errors = one.jacobian(point), []
    for step in (1e-4, 1e-5, 1e-6, 1e-7):
        monkeypatch.setattr(_fit_problem, "STEP", step)
        errors.append(np.abs(one.differences(point) - exact) / np.abs(exact).max(axis=0))
    # Each parameter has a best step of its own. Steps of a slider that are halved make differences jump, by what they may err.
    least = np.min(errors, axis=0)
    assert (np.median(least, axis=0) < 1e-7).all() and (least.max(axis=0) < (1e-3 if name == "inertia" else 1e-6)).all(), least.max(axis=0)


def test_jacobian_where_the_kinetic_coefficient_would_be_the_greater() -> None:
    record = RECORDS["interface"][0]
    for changes in ({"mu_s": 0.35}, {"mu_s": 0.35, "structure": 1.3}, {"structure": 1.9}):
        free = {**PARAMETERS, **changes}
        one, point = problem(record, free, tolerance=1e-12)
        exact, differences = one.jacobian(point), one.differences(point)
        scale = np.abs(exact).max()
        assert np.abs(exact - differences).max() < 1e-6 * scale, changes
