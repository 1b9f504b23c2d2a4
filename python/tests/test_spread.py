"""Uncertainty of results by that of values of the case, to first order: against sampled runs."""

from __future__ import annotations

import os

import numpy as np
import pytest
from test_fits_through_runs import FORCE, FRICTION, pushed

import fecontact as fc

DEVIATIONS = {FRICTION + "mu_k": 0.004, FRICTION + "mu_s": 0.004, "bodies.block.material.E": 0.2}
VALUES = {FRICTION + "mu_k": 0.2, FRICTION + "mu_s": 0.4, "bodies.block.material.E": 10.0}
# SAMPLES=400 takes minutes.
SAMPLES = int(os.environ.get("SAMPLES", "24"))


@pytest.fixture(scope="module")
def differentiated() -> fc.Result:
    return pushed().run(gradients=list(DEVIATIONS), progress=False)


def test_spread_is_that_of_sampled_runs(differentiated: fc.Result) -> None:
    spread, table = differentiated.spread(DEVIATIONS)[FORCE].to_numpy(), differentiated.gradients
    drawn = np.random.default_rng(5).standard_normal((SAMPLES, len(DEVIATIONS))) * list(DEVIATIONS.values())
    case = pushed()
    trials = [{place: VALUES[place] + more for place, more in zip(DEVIATIONS, row)} for row in drawn]
    histories = [case.replace(trial).run(progress=False).history[FORCE].to_numpy() for trial in trials]
    sampled = np.std(histories, axis=0, ddof=1)
    seen = sampled > 0.05 * sampled.max()
    assert seen.sum() > 10
    # What the derivatives make of these very draws is left to the second order, a hundredth.
    slopes = np.stack([table[f"d({FORCE})/d({place})"] for place in DEVIATIONS])
    predicted = np.std(drawn @ slopes, axis=0, ddof=1)
    assert np.abs(predicted[seen] / sampled[seen] - 1).max() < 0.05
    # The deviation of a sample of n is off by its 1/√(2 (n − 1)) part, four times which is rare.
    assert np.abs(spread[seen] / sampled[seen] - 1).max() < 4 / np.sqrt(2 * (SAMPLES - 1))
    # Each of the values counts.
    for place in DEVIATIONS:
        without = differentiated.spread({other: sd for other, sd in DEVIATIONS.items() if other != place})
        assert (without[FORCE].to_numpy() < spread).any()


def test_spread_is_the_root_of_the_squares(differentiated: fc.Result) -> None:
    table = differentiated.gradients
    spread = differentiated.spread(DEVIATIONS)
    expected = np.sqrt(sum((table[f"d({FORCE})/d({place})"] * sd) ** 2 for place, sd in DEVIATIONS.items()))
    np.testing.assert_allclose(spread[FORCE], expected, rtol=1e-14)
    np.testing.assert_array_equal(spread["time"], differentiated.history["time"])
    assert spread.attrs["units"][FORCE] == differentiated.history.attrs["units"][FORCE]


@pytest.mark.parametrize(
    ("deviations", "message"),
    [
        ({}, "give standard deviations by place"),
        ({FRICTION + "xi": 1.0}, "no derivatives by contacts.base.friction.xi; it has those by contacts.base.friction.mu_k"),
        ({FRICTION + "mu_k": -1.0}, "is -1.0: must be zero or positive"),
        ({FRICTION + "mu_k": float("nan")}, "is nan: must be zero or positive"),
    ],
)
def test_bad_deviations_are_refused(differentiated: fc.Result, deviations: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        differentiated.spread(deviations)


def test_a_run_without_derivatives_has_no_spread(result: fc.Result) -> None:
    with pytest.raises(FileNotFoundError, match="asks for derivatives"):
        result.spread(DEVIATIONS)
