"""A load test of a steel pile through the run of a case: friction along the shaft, and what the record does not tell.

    python3 cases/laboratory/pile_load_test.py [PICTURE]

Needs the Python package. Units: kN, m.
"""

from __future__ import annotations

import pathlib
import sys
from typing import Any

import numpy as np

import fecontact as fc
from fecontact.calibration import Run, read

# The pile: length in the ground [m], perimeter of the box around its section [m], and axial stiffness EA [kN]
LENGTH, PERIMETER, AXIAL = 16.2, 1.45, 2009e2 * 16.2
RADIUS = PERIMETER / (2 * np.pi)
# Effective pressure of the ground on the shaft: assumed, all with the same mean of 200 kPa
PRESSURES = {"even": 200, "growing with depth": "-24.69*y", "from 50 kPa on": "50 - 18.52*y"}
FREE = {"contacts.shaft.friction.mu_s": (0.3, 0.8), "contacts.shaft.friction.r": (20.0, 3000.0), "bodies.soil.material.E": (5e3, 5e6)}


def record() -> tuple[np.ndarray, np.ndarray]:
    """Settlement [m] and load [kN]."""
    settlement, load = read(pathlib.Path(__file__).parent / "pile_load_test.csv").to_numpy().T
    return settlement / 1000, load


def case(pressure: float | str) -> fc.Case:
    """The pile as an elastic rod of the same perimeter and stiffness in elastic ground; nothing below its tip."""
    settlement, _ = record()
    outer, columns, rows = 20 * RADIUS, 12, 24
    friction = {"law": "super_subloading", "mu_s": 0.5, "mu_k": 0.1, "r": 300, "kappa": 0, "xi": 0, "alpha_t": 1e6}
    contents: dict[str, Any] = {
        "title": "load test of a pile",
        "section": "axisymmetric",
        "units": {"length": "m", "force": "kN", "time": "s"},
        "mesh": {
            "blocks": [
                {"body": "pile", "corners": [[0, -LENGTH], [RADIUS, -LENGTH], [RADIUS, 0], [0, 0]], "elements": [1, rows], "kind": "Q8",
                 "sides": [None, "shaft", "head", None]},
                {"body": "soil", "corners": [[RADIUS, -LENGTH], [outer, -LENGTH], [outer, 0], [RADIUS, 0]], "elements": [columns, rows],
                 "grading": [12, 1], "kind": "Q8", "sides": [None, "far", None, "wall"]},
            ]
        },
        "bodies": {
            "pile": {"material": {"model": "linear", "E": AXIAL / (np.pi * RADIUS**2), "nu": 0.0}},
            "soil": {"material": {"model": "linear", "E": 1e5, "nu": 0.3}},
        },
        "contacts": {"shaft": {"slave": "shaft", "master": "wall", "friction": friction, "initial": {"pressure": pressure, "balanced": True}}},
        "steps": [
            {"name": "test", "duration": len(settlement) - 1, "dt": {"initial": 0.25, "max": 0.5},
             "supports": [{"on": "head", "uy": {"table": [[k, -way] for k, way in enumerate(settlement)]}}, {"on": "far", "ux": 0, "uy": 0}]}
        ],
        "watch": ["head"],
        "output": {"fields": False, "report": False},
    }
    return fc.Case(contents)


def fitted(pressure: float | str) -> fc.Fit:
    """The fit of the loads at all but the first of the measured settlements."""
    _, load = record()
    times = np.arange(1.0, load.size)
    return fc.fit(Run(case(pressure), measured={"head.fy": (times, -load[1:])}), free=FREE)


def main() -> None:
    """Print the table, and draw the record beside the fits."""
    settlement, load = record()
    names = ["mu_s", "r", "E"]
    print("| pressure on the shaft | μ | r [1/m] | E of the ground [MPa] | rms over the largest load |\n|---|---|---|---|---|")
    found = {}
    for name, pressure in PRESSURES.items():
        found[name] = fit = fitted(pressure)
        rows = fit.table[["value", "low", "high"]].to_numpy() * np.array([[1.0], [1.0], [1e-3]])
        cells = [f"{value:.3g} ({low:.3g} to {high:.3g})" if np.isfinite(high) else "not determined" for value, low, high in rows]
        assert [place.rsplit(".", 1)[1] for place in fit.table.index] == names
        off = np.sqrt(np.mean(fit.residuals[0] ** 2)) / load.max()
        print(" | ".join([f"| {name}", *cells, f"{100 * off:.1f} %"]) + " |")
    if len(sys.argv) > 1:
        draw(settlement, load, found)


def draw(settlement: np.ndarray, load: np.ndarray, found: dict[str, fc.Fit]) -> None:
    """Load over settlement."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(6.5, 4), layout="constrained")
    ax.plot(1000 * settlement, load, "o", color="black", markersize=4, label="measured")
    for name, fit in found.items():
        ax.plot(1000 * settlement[1:], load[1:] - fit.residuals[0], label=f"pressure {name}")
    ax.set(xlabel="settlement of the head [mm]", ylabel="load [kN]", xlim=(0, None), ylim=(0, None))
    ax.legend(frameon=False)
    figure.savefig(sys.argv[1])


if __name__ == "__main__":
    main()
