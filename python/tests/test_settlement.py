"""Stiffness and permeability of clay from the record of a settlement in time."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import squares

import fecontact as fc
from fecontact.calibration import Run

STIFFNESS, PERMEABILITY = "bodies.clay.material.E", "bodies.clay.pore_fluid.permeability"
TRUTH = {STIFFNESS: 0.9, PERMEABILITY: 1.0}
SETTLEMENT = "clay_top.uy"


def oedometer() -> fc.Case:
    """A sample of the height 1, of M = 1 and c_v = 1, under a load of 1 that is put on at once, drained at its top."""
    nodes, elements, edges = squares("clay", (0.0, 0.0), (0.125, 1.0), (1, 12), 0)
    lists = lambda part: {name: array.tolist() for name, array in part.items()}  # noqa: E731
    fluid = {"bulk_modulus": 1e6, "porosity": 0.5, "permeability": 1, "unit_weight": 1}
    held = [{"on": "clay_bottom", "ux": 0, "uy": 0}, {"on": "clay_left", "ux": 0}, {"on": "clay_right", "ux": 0}]
    return fc.Case(
        mesh={"nodes": nodes.tolist(), "elements": lists(elements), "edges": lists(edges)},
        watch=["clay_top"],
        bodies={"clay": {"material": {"model": "linear", "E": 0.9, "nu": 0.2}, "pore_fluid": fluid}},
        steps=[
            {
                "name": "load",
                "duration": 1.5,
                "dt": {"initial": 0.005, "max": 0.05},
                "supports": held,
                "loads": [{"on": "clay_top", "dead_pressure": "1"}],
                "drainage": [{"on": "clay_top", "pressure": 0}],
            }
        ],
    )


def settlement(t: np.ndarray) -> np.ndarray:
    """Terzaghi's degree of consolidation, of M = 1 the settlement."""
    m = 0.5 * np.pi * (2 * np.arange(2000)[:, None] + 1)
    return 1 - (2 / m**2 * np.exp(-(m**2) * np.asarray(t))).sum(axis=0)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hidden_truth(seed: int) -> None:
    """Terzaghi's series with noise is the record, at times in proportion to their squares as they are read in the laboratory."""
    times = np.linspace(0.1, 1.2, 40) ** 2
    record = -settlement(times) + 0.005 * np.random.default_rng(seed).normal(size=times.size)
    found = fc.fit(Run(oedometer(), {SETTLEMENT: (times, record)}), free=list(TRUTH), start={STIFFNESS: 2.0, PERMEABILITY: 0.3})
    for place, value in TRUTH.items():
        assert found.table["value"][place] == pytest.approx(value, rel=0.03), found.table
    assert found.runs <= 15
