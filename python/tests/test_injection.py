"""Storage and transmissivity of a fault from the record of an injection into it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import squares

import fecontact as fc
from fecontact.calibration import Run

FLOW = "contacts.base.fluid_pressure.flow."
TRUTH = {FLOW + "storage": 2e-3, FLOW + "transmissivity": 1e-2}
VISCOSITY, RATE, LENGTH, SHUT, END = 5.0, 0.02, 4.0, 4.0, 10.0
PRESSURE = "base.largest_fluid_pressure"
# Share of the largest pressure.
NOISE = 0.01


def injection() -> fc.Case:
    """A fault between a block and a plane, into whose end water is pumped; then the well is shut. Its other end is impervious."""
    nodes, elements, edges = squares("block", (0.0, 0.0), (LENGTH, 1.0), (20, 1), 0)
    lists = lambda part: {name: array.tolist() for name, array in part.items()}  # noqa: E731
    flow = {"storage": 2e-3, "transmissivity": 1e-2, "viscosity": VISCOSITY, "wells": [{"at": [0, 0], "rate": RATE, "until": SHUT}]}
    return fc.Case(
        mesh={"nodes": nodes.tolist(), "elements": lists(elements), "edges": lists(edges)},
        bodies={"block": {"material": {"model": "linear", "E": 1e4, "nu": 0.2}}},
        contacts={
            "base": {
                "slave": "block_bottom",
                "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "sliding": "small",
                "friction": {"law": "coulomb", "mu": 0.6},
                "initial": {"pressure": 100, "balanced": True},
                "fluid_pressure": {"flow": flow},
            }
        },
        steps=[{"name": "pump", "duration": END, "dt": {"initial": 0.25, "max": 0.25}, "supports": [{"on": "block_top", "ux": 0, "uy": 0}]}],
    )


def pressure(t: np.ndarray, storage: float, transmissivity: float) -> np.ndarray:
    """Pressure at the well: q t/(S L) + q η L/T (1/3 − 2/π² Σ exp(−k² π² D t/L²)/k²), less the same since the well was shut."""
    diffusivity = transmissivity / VISCOSITY / storage
    k = np.arange(1, 400)[:, None]

    def since(t: np.ndarray) -> np.ndarray:
        decays = (np.exp(-((k * math.pi / LENGTH) ** 2) * diffusivity * t) / k**2).sum(axis=0)
        even = RATE * t / (storage * LENGTH)
        return np.where(t > 0, even + RATE * VISCOSITY * LENGTH / transmissivity * (1 / 3 - 2 / math.pi**2 * decays), 0.0)

    t = np.asarray(t)
    return since(t) - since(np.maximum(t - SHUT, 0.0))


def test_the_run_has_the_closed_form() -> None:
    history = injection().run(progress=False).history
    expected = pressure(history["time"].to_numpy(), *TRUTH.values())
    # At the shut well other nodes have the larger pressure only later, by less than this.
    np.testing.assert_allclose(history[PRESSURE], expected, atol=4e-3 * expected.max())


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hidden_truth(seed: int) -> None:
    """The closed form with noise is the record: the fit through runs finds what it was made with."""
    times = np.linspace(0.25, END, 40)
    true = pressure(times, *TRUTH.values())
    noise = NOISE * true.max() * np.random.default_rng(seed).normal(size=times.size)
    record = Run(injection(), {PRESSURE: (times, true + noise)})
    found = fc.fit(record, free=list(TRUTH), start={FLOW + "storage": 4e-3, FLOW + "transmissivity": 8e-3})
    for place, value in TRUTH.items():
        assert found.table["value"][place] == pytest.approx(value, rel=0.03), found.table
        assert found.table["high"][place] < 1.1 * found.table["low"][place]
    assert found.runs <= 15


def test_a_far_end_that_is_not_felt_tells_nothing() -> None:
    """A record that ends before the far end is felt has S T alone, of p = q √(4 η t/(π S T)): the fit says so."""
    times = np.linspace(0.25, 2.5, 40)
    true = pressure(times, *TRUTH.values())
    noise = NOISE * true.max() * np.random.default_rng(0).normal(size=times.size)
    record = Run(injection(), {PRESSURE: (times, true + noise)})
    found = fc.fit(record, free=list(TRUTH), start={FLOW + "storage": 4e-3, FLOW + "transmissivity": 8e-3})
    assert any("trade off" in word for word in found.words), found.words
    assert np.prod(found.table["value"]) == pytest.approx(2e-5, rel=0.1)
