"""A velocity step of sepiolite, after which friction rises for hundreds of micrometres: rate-and-state friction with a negative b.

    python3 cases/laboratory/rising_step.py

fits the excerpt in rising_step.csv, and lets information criteria choose. Needs the Python package. Units: µm, s; tractions over the pressure.
"""

from __future__ import annotations

import pathlib

import numpy as np

import fecontact as fc
from fecontact.calibration import SpringSlider, compare, read

# Rate before the step [µm/s], and friction there
SLOW, BEFORE = 0.2, 0.4546
COMMON = {"a": (1e-4, 0.05), "D_c": (1.0, 500.0), "f_0": (0.3, 0.6), "stiffness": (1e-4, 3e-2)}
BESIDE = {
    "b positive": {"b": (1e-4, 0.05)},
    "b negative": {"b": (-0.05, -1e-4)},
    "b negative, and a drift": {"b": (-0.05, -1e-4), "drift": (-1e-3, 1e-3)},
}


def fitted(name: str) -> fc.Fit:
    """The fit of one of these."""
    data = read(pathlib.Path(__file__).parent / "rising_step.csv")
    time, way, friction = data[["time_s", "load_point_um", "friction"]].to_numpy().T
    slider = SpringSlider(time - time[0], way, 1.0, friction, initial=BEFORE)
    return fc.fit(slider, "rate_and_state", {**COMMON, **BESIDE[name]}, V_0=SLOW, alpha_t=10.0, evolution="slip")


def main() -> None:
    """Print the table."""
    fits = {name: fitted(name) for name in BESIDE}
    chosen = compare(fits)
    print("| law | a | b | D_c [µm] | rms | AICc |\n|---|---|---|---|---|---|")
    for name, fit in fits.items():
        values = [f"{fit.table['value'][key]:.3g}" for key in ("a", "b", "D_c")]
        rms = np.sqrt(np.mean(fit.residuals[0] ** 2))
        print(" | ".join([f"| {name}", *values, f"{rms:.2g}", f"{chosen['AICc'][name]:.0f}"]) + " |")


if __name__ == "__main__":
    main()
