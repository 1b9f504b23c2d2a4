"""A velocity step of sepiolite, after which friction rises for hundreds of micrometres and falls again: rate-and-state friction with a
negative b, and with two states.

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
# Up to where friction rises, and beyond, where it falls [s]
UNTIL = {565.0: "31, to 540 s", 1e3: "40, to 982 s"}
COMMON = {"a": (1e-4, 0.05), "D_c": (1.0, 500.0), "f_0": (0.3, 0.6), "stiffness": (1e-4, 3e-2)}
BESIDE = {
    "b positive": {"b": (1e-4, 0.05)},
    "b negative": {"b": (-0.05, -1e-4)},
    "b negative, and a drift": {"b": (-0.05, -1e-4), "drift": (-1e-3, 1e-3)},
    "two states": {"b": (-0.05, -1e-4), "b_2": (1e-4, 0.05), "D_c2": (100.0, 10000.0)},
}


def fitted(name: str, until: float) -> fc.Fit:
    """The fit of one of these to the rows up to a time after the step [s]."""
    data = read(pathlib.Path(__file__).parent / "rising_step.csv")
    data = data[data["time_s"] < until]
    time, way, friction = data[["time_s", "load_point_um", "friction"]].to_numpy().T
    slider = SpringSlider(time - time[0], way, 1.0, friction, initial=BEFORE)
    return fc.fit(slider, "rate_and_state", {**COMMON, **BESIDE[name]}, V_0=SLOW, alpha_t=10.0, evolution="slip")


def main() -> None:
    """Print the table."""
    print("| rows | law | a | b | D_c [µm] | b_2 | D_c2 [µm] | rms | AICc |\n|---|---|---|---|---|---|---|---|---|")
    for until, said in UNTIL.items():
        fits = {name: fitted(name, until) for name in BESIDE}
        chosen = compare(fits)
        for name, fit in fits.items():
            found = [fit.table["value"].get(key) for key in ("a", "b", "D_c", "b_2", "D_c2")]
            values = ["" if value is None else f"{value:.3g}" for value in found]
            rms = np.sqrt(np.mean(fit.residuals[0] ** 2))
            print(" | ".join([f"| {said}", name, *values, f"{rms:.2g}", f"{chosen['AICc'][name]:.0f}"]) + " |")


if __name__ == "__main__":
    main()
