"""Spring-sliders with inertia: against closed forms and scipy, and machines found from their records."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import fecontact as fc
from fecontact.calibration import SpringSlider

LAW = {"mu_s": 0.6, "mu_k": 0.4, "alpha_t": 2000.0, "r": 400.0, "kappa": 40.0, "xi": 0.5}
STIFFNESS, MASS = 50.0, 0.01
TIME = np.linspace(0.0, 4.0, 401)
# Slow, ten times as fast, held, and between: the fast slide stirs up an oscillation that friction feeds.
LOAD_POINT = np.interp(TIME, [0.0, 1.0, 2.0, 3.2, 4.0], [0.0, 0.05, 0.35, 0.35, 0.47])


@pytest.fixture(scope="module")
def scipys() -> np.ndarray:
    """The force by scipy, from the rate equations of the law and M ü = k (w − u) − q."""
    from scipy.integrate import solve_ivp

    mu_s, mu_k, alpha_t, r, kappa, xi = LAW.values()

    def rates(t: float, y: np.ndarray) -> list[float]:
        u, v, q, mu = y
        ratio, sign = min(max(abs(q) / mu, 1e-15), 1.0), 1.0 if q >= 0.0 else -1.0
        approach, heals = -r * np.log(ratio), xi * (1.0 - mu / mu_s)
        # λ of consistency, |q|˙ = (R μ p)˙ with p = 1; where it were negative R falls elastically.
        lam = max((alpha_t * v * sign - ratio * heals) / (alpha_t + approach * mu - ratio * kappa * (mu / mu_k - 1.0)), 0.0)
        pull = STIFFNESS * (np.interp(t, TIME, LOAD_POINT) - u)
        return [v, (pull - q) / MASS, alpha_t * (v - sign * lam), heals - kappa * (mu / mu_k - 1.0) * lam]

    state, slips = np.array([0.0, 0.0, 1e-12, mu_s]), [0.0]
    for ends in zip(TIME[:-1], TIME[1:]):
        state = solve_ivp(rates, ends, state, "LSODA", rtol=1e-10, atol=1e-13).y[:, -1]
        slips.append(state[0])
    return STIFFNESS * (LOAD_POINT - np.array(slips))


def test_a_slider_that_sticks_swings_on_two_springs() -> None:
    # M ü = k V t − (k + α_t) u,   u = k V/(k + α_t) (t − sin(ω t)/ω),   and F₀ stays what it was
    k, alpha_t, rate, mass = 3.0, 20.0, 0.2, 0.5
    time = np.linspace(0.0, 5.0, 101)
    omega = np.sqrt((k + alpha_t) / mass)
    exact = k * rate / (k + alpha_t) * (time - np.sin(omega * time) / omega)
    for given, start in ((rate * time, 0.0), (rate * time + 7.0, 0.1)):
        slider = fc.law("coulomb", mu=10.0, alpha_t=alpha_t).slider(
            time, given, 1.0, stiffness=k, mass=mass, force=start, by=["stiffness", "mass", "alpha_t", "mu"], tolerance=1e-11
        )
        np.testing.assert_allclose(slider.slip, exact, atol=1e-6)
        np.testing.assert_allclose(slider.force, start + k * (rate * time - exact), atol=3e-6)
        # ∂u/∂M through ω alone: ∂ω/∂M = −ω/(2M)
        by_omega = k * rate / (k + alpha_t) * (np.sin(omega * time) / omega**2 - time * np.cos(omega * time) / omega)
        np.testing.assert_allclose(slider.dforce_dmass, k * by_omega * omega / (2.0 * mass), atol=1e-4)
        assert not slider.dforce_dmu.any() and slider.slip.shape == (101,)


def test_a_slider_is_that_of_scipy(scipys: np.ndarray) -> None:
    errors = []
    for tolerance in (1e-6, 1e-8):
        slider = fc.law("super_subloading", **LAW).slider(TIME, LOAD_POINT, 1.0, stiffness=STIFFNESS, mass=MASS, tolerance=tolerance)
        errors.append(np.abs(slider.force - scipys).max())
    # Steps go with the cube root of the tolerance, errors with their square.
    assert errors[1] < 2e-4 and errors[0] > 5.0 * errors[1], errors


@pytest.mark.parametrize("evolution", ["ageing", "slip"])
def test_two_states_are_those_of_scipy(evolution: str) -> None:
    # Velocity steps up and down, on a driven contact and behind a spring with inertia, by scipy's stiff integrator at 1e-10.
    from scipy.integrate import solve_ivp

    f_0, reference, a, b, length, b_2, length_2 = 0.6, 1.0, 0.01, 0.012, 5.0, -0.006, 60.0
    alpha_t, stiffness, mass = 0.5, 0.02, 0.05
    time = np.linspace(0.0, 60.0, 61)
    way = np.interp(time, [0.0, 10.0, 35.0, 60.0], [0.0, 10.0, 260.0, 310.0])

    def evolved(v: float, x: float, length: float) -> float:
        v = max(abs(v), 1e-300)
        return (reference * np.exp(-x) - v) / length if evolution == "ageing" else -v / length * (x + np.log(v / reference))

    def rate(q: float, x: float, y: float) -> float:
        return float(2.0 * reference * np.exp(-(f_0 + b * x + b_2 * y) / a) * np.sinh(q / a))

    def driven(t: float, z: np.ndarray, v: float) -> list[float]:
        q, x, y = z
        slip = rate(q, x, y)
        return [alpha_t * (v - slip), evolved(slip, x, length), evolved(slip, y, length_2)]

    def ridden(t: float, z: np.ndarray, v: float) -> list[float]:
        u, speed, force, *z = z
        return [speed, (force - z[0]) / mass, stiffness * (v - speed), *driven(t, np.array(z), speed)]

    def ends(rates: object, start: list[float], at: int) -> np.ndarray:
        state, found = np.array(start), [start[at]]
        for k in range(time.size - 1):
            v = way[k + 1] - way[k]
            state = solve_ivp(rates, (0.0, 1.0), state, "LSODA", args=(v,), rtol=1e-10, atol=1e-12).y[:, -1]
            found.append(state[at])
        return np.array(found)

    law = fc.law("rate_and_state", f_0=f_0, V_0=reference, a=a, b=b, D_c=length, b_2=b_2, D_c2=length_2, evolution=evolution, alpha_t=alpha_t)
    drive = law.drive(time, way, 1.0, traction=0.6)
    exact = ends(driven, [0.6, 0.0, 0.0], 0)
    # 1e-6 of f₀ p, and a few of them one after another
    np.testing.assert_allclose(drive.traction, exact, atol=2e-6)
    assert abs(exact[34] - 0.6 - (a - b - b_2) * np.log(10.0)) < 2e-3, "and the steady state is nearly reached"
    slider = law.slider(time, way, 1.0, stiffness=stiffness, mass=mass, force=0.6, tolerance=1e-9)
    exact = ends(ridden, [0.0, 0.0, 0.6, 0.6, 0.0, 0.0], 2)
    np.testing.assert_allclose(slider.force, exact, atol=5e-5)


def test_a_law_in_python_is_asked_about_once_a_step() -> None:
    # LuGre: q = p (σ₀ z + σ₁ ż), ż = v − σ₀ |v| z/g(v); the mass sticks, breaks loose and sticks again.
    from scipy.integrate import solve_ivp

    sigma_0, sigma_1, mu_s, mu_k, v_s = 1e3, 0.3, 0.4, 0.3, 1e-2
    pressure, stiffness, mass, rate, asked = 10.0, 20.0, 1.0, 0.05, [0]

    @fc.friction_law("lugre", {"z": 0.0})
    def lugre(old: Any, slip: Any, pressure: Any, dt: Any, *, alpha_t: float) -> dict[str, Any]:
        asked[0] += 1
        dt = np.maximum(dt, 1e-9)
        v = slip / dt
        fall = (mu_s - mu_k) * np.exp(-((v / v_s) ** 2))
        g, dg = mu_k + fall, -2.0 * fall * v / v_s**2
        a, da = sigma_0 * abs(slip) / g, sigma_0 * (np.sign(slip) / g - abs(slip) / g**2 * dg / dt)
        z = (old["z"] + slip) / (1.0 + a)
        dz = (1.0 - z * da) / (1.0 + a)
        mu = sigma_0 * z + sigma_1 * (z - old["z"]) / dt
        return {
            "traction": pressure * mu,
            "dtraction_dslip": pressure * (sigma_0 + sigma_1 / dt) * dz,
            "dtraction_dpressure": mu,
            "plastic_increment": slip - (z - old["z"]),
            "z": z,
        }

    def rates(t: float, y: np.ndarray) -> list[float]:
        u, v, z = y
        dz = v - sigma_0 * abs(v) * z / (mu_k + (mu_s - mu_k) * np.exp(-((v / v_s) ** 2)))
        return [v, (stiffness * (rate * t - u) - pressure * (sigma_0 * z + sigma_1 * dz)) / mass, dz]

    time = np.linspace(0.0, 4.0, 41)
    slider = fc.law("registered", name="lugre", alpha_t=1e4).slider(time, rate * time, pressure, stiffness=stiffness, mass=mass, tolerance=1e-9)
    exact = solve_ivp(rates, (0.0, 4.0), [0.0, 0.0, 0.0], "LSODA", t_eval=time, rtol=1e-10, atol=1e-13).y
    # The law is an implicit Euler method in z, whose error goes with the step: 10 000 of them here, and twice as many calls would be two a step.
    np.testing.assert_allclose(slider.force, stiffness * (rate * time - exact[0]), atol=2e-4)
    assert 10_000 < asked[0] < 14_000


def test_mass_and_stiffness_of_a_machine_are_found(scipys: np.ndarray) -> None:
    noise = 2e-3 * np.random.default_rng(6).normal(size=TIME.size)
    free = {name: (LAW[name] / 3.0, LAW[name] * 3.0) for name in ("mu_s", "mu_k", "kappa", "xi")}
    machine = {"stiffness": (30.0, 80.0), "mass": (0.004, 0.025)}
    record = SpringSlider(TIME, LOAD_POINT, 1.0, scipys + noise)
    truth = {**{name: LAW[name] for name in free}, "stiffness": STIFFNESS, "mass": MASS}
    # Events that come sooner or later make many hollows in the sum of squares: a search needs a start from which they are the same ones.
    beside = {name: 1.1 * value for name, value in truth.items()}
    found = fc.fit(record, free={**free, **machine}, r=LAW["r"], alpha_t=LAW["alpha_t"], starts=1, start=beside)
    for name, value in truth.items():
        assert found.table["low"][name] <= value <= found.table["high"][name], found
        assert found.parameters[name] == pytest.approx(value, rel=0.02), name
    assert found.noise == pytest.approx(2e-3, rel=0.15) and abs(found.memory) < 0.2
    # The period tells k/M far better than either.
    assert any("stiffness and mass trade off" in text for text in found.words), found.words
    # The law itself is without the machine.
    assert "mass" not in found.law.parameters and found.predicted(record).shape == TIME.shape
    # A machine that is known
    given = {name: value for name, value in truth.items() if name != "mu_k"}
    known = fc.fit(record, free={"mu_k": (0.35, 0.45)}, r=LAW["r"], alpha_t=LAW["alpha_t"], starts=1, **given)
    assert known.words == [] and known.parameters["mu_k"] == pytest.approx(0.4, rel=2e-3)


def test_a_record_that_begins_under_a_force() -> None:
    start = {"stiffness": STIFFNESS, "mass": MASS}
    for force in (0.0, 0.2):
        law = {"law": "super_subloading", **LAW}
        record = SpringSlider(TIME, LOAD_POINT, 1.0, TIME, initial=force)
        slider = fc.law(law).slider(TIME, LOAD_POINT, 1.0, **start, force=force)
        assert slider.force[0] == force
        np.testing.assert_array_equal(record.predicted({**law, **start}), slider.force)
        by = ["mass", "mu_k"]
        derivatives = record.derivatives({**law, **start}, by)
        exact = fc.law(law).slider(TIME, LOAD_POINT, 1.0, **start, force=force, by=by)
        np.testing.assert_array_equal(derivatives, np.stack([exact.dforce_dmass, exact.dforce_dmu_k], axis=-1))


def test_what_cannot_be_ridden() -> None:
    law = fc.law("super_subloading", **LAW)
    with pytest.raises(fc.CaseError, match=r"slider.mass: is 0: must be positive"):
        law.slider([0, 1], [0, 1], 1.0, stiffness=1.0, mass=0.0)
    with pytest.raises(fc.CaseError, match=r"stiffness: has the shape \(2,\): must be \(\)"):
        law.slider([0, 1], [0, 1], 1.0, stiffness=[1.0, 2.0], mass=1.0)
    with pytest.raises(fc.CaseError, match="no derivative of the law by mu; there are derivatives by mu_s, .*, stiffness, mass"):
        law.slider([0, 1], [0, 1], 1.0, stiffness=1.0, mass=1.0, by=["mu"])
    with pytest.raises(fc.Stopped, match="the slider takes too many steps at the time .*: check mass and stiffness"):
        law.slider([0, 1e9], [0, 1e9], 1.0, stiffness=1e9, mass=1e-9)
    with pytest.raises(ValueError, match="alpha_t: a spring-slider needs it"):
        fc.fit(SpringSlider(TIME, LOAD_POINT, 1.0, TIME), free={"mu_s": (0.4, 0.8)}, mu_k=0.3, r=1.0, stiffness=1.0, mass=1.0)


def test_the_former_name_is_refused_with_the_new_one() -> None:
    with pytest.raises(AttributeError, match="no `ride`: it is called `slider`"):
        fc.law("coulomb", mu=0.3, alpha_t=1e3).ride  # type: ignore[attr-defined]  # noqa: B018
