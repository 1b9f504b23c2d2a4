"""A bond beside friction without a mesh: closed forms, and parameters found in shear and tension tests of a rock joint."""

import numpy as np
import pytest

import fecontact as fc
from fecontact.calibration import Interface, PullOff

TIME = np.linspace(0.0, 1.0, 201)


def joint(**parameters):
    return fc.law("coulomb", mu=0.5, alpha_t=1e6, bond={"strength": 2.0, "residual": 0.5, "slip": 1e-3, "tension": 1.0, "opening": 2e-4, **parameters})


def test_shear_softens_to_residual():
    drive = joint().drive(TIME, 3e-3 * TIME, 4.0)
    # c + μ p at first, c_r + μ p beyond the slip D, linear between.
    assert drive.traction.max() == pytest.approx(4.0, rel=2e-2)
    assert drive.traction[-1] == pytest.approx(2.5, rel=1e-6)
    middle = drive.traction[np.searchsorted(3e-3 * TIME, 5e-4)]
    assert middle == pytest.approx(2.0 + 2.0 - 1.5 * 0.5, rel=2e-2)
    assert drive["bond"][-1] == pytest.approx(0.0, abs=1e-9)


def test_tension_falls_over_the_opening():
    opening = 3e-4 * TIME
    drive = joint().drive(TIME, 0.0, 0.0, opening=opening)
    expected = np.where(opening > 0.0, np.clip(1.0 - opening / 2e-4, 0.0, None), 0.0)
    assert -drive["pressure"][1:] == pytest.approx(expected[1:], abs=1e-9)
    # Work of the tension: t δ/2.
    assert drive["dissipation"][-1] == pytest.approx(0.5 * 1.0 * 2e-4, rel=1e-2)


def test_sets_of_bonds():
    strengths = np.array([1.0, 2.0, 3.0])
    drive = fc.law("coulomb", mu=0.5, alpha_t=1e6, bond={"strength": strengths, "opening": 1e-3}).drive(TIME, 1e-3 * TIME, 4.0)
    assert drive.traction[:, -1] == pytest.approx(2.0 + strengths, rel=1e-6)


def test_a_rock_joint_is_fitted():
    truth = joint()
    random = np.random.default_rng(1)
    shear = []
    for pressure in (1.0, 4.0):
        q = truth.drive(TIME, 3e-3 * TIME, pressure).traction
        shear.append(Interface(TIME, 3e-3 * TIME, pressure, q + 0.01 * random.normal(size=q.size), sigma=0.01))
    pulled = -truth.drive(TIME, 0.0, 0.0, opening=3e-4 * TIME)["pressure"]
    tension = PullOff(TIME, 3e-4 * TIME, pulled + 0.01 * random.normal(size=pulled.size), sigma=0.01)
    free = {"mu": (0.2, 1.0), "bond.strength": (1.0, 5.0), "bond.residual": (0.1, 1.0), "bond.slip": (3e-4, 3e-3), "bond.tension": (0.3, 1.5), "bond.opening": (5e-5, 1e-3)}
    found = fc.fit([*shear, tension], "coulomb", free, alpha_t=1e6, starts=2)
    for name, value in {"mu": 0.5, "bond.strength": 2.0, "bond.residual": 0.5, "bond.slip": 1e-3, "bond.tension": 1.0, "bond.opening": 2e-4}.items():
        row = found.table.loc[name]
        assert row["low"] <= value <= row["high"] or row["value"] == pytest.approx(value, rel=0.02), (name, row)


def test_what_cannot_be():
    with pytest.raises(fc.CaseError, match="opening"):
        fc.law("coulomb", mu=0.5, alpha_t=1e6).drive(TIME, 0.0, 1.0, opening=TIME)
    with pytest.raises(fc.CaseError, match="bond"):
        joint().slider(TIME, TIME, 1.0, stiffness=1.0, mass=1.0)
    with pytest.raises(ValueError, match="bond.strength"):
        fc.fit(Interface(TIME, TIME, 1.0, TIME), "coulomb", {"bond.strengt": (1.0, 2.0)}, mu=0.5, alpha_t=1e6)
