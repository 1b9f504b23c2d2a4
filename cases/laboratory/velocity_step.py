"""A velocity step of basalt as a spring-slider of rate-and-state friction: which values, and how sure they are.

    python3 cases/laboratory/velocity_step.py [WHOLE]

fits the excerpt in velocity_step.csv, and with WHOLE, a file with the columns time_s, load_point_um and friction of the whole record, that one too (a
minute). Needs the Python package. Units: µm, s; tractions over the pressure.
"""

from __future__ import annotations

import pathlib
import sys

import pandas as pd

import fecontact as fc
from fecontact.calibration import SpringSlider, read

# The step in the whole record [s after its first row], and what is fitted of it, as in the inversion of its authors.
STEP, FROM, UNTIL = 68.58, 58.0, 90.0
# Rates of the load point [µm/s], and friction before the step
SLOW, FAST, BEFORE = 2.973, 10.147, 0.6077
FREE = {"a": (1e-3, 0.03), "b": (1e-3, 0.03), "D_c": (0.5, 50.0), "f_0": (0.5, 0.7), "stiffness": (5e-4, 2e-2)}
FOUND = ("a", "b", "D_c", "stiffness")


def excerpt() -> pd.DataFrame:
    """The committed means."""
    return read(pathlib.Path(__file__).parent / "velocity_step.csv")


def fitted(data: pd.DataFrame, evolution: str) -> fc.Fit:
    """The fit of rate-and-state friction behind a spring, which slides steadily at the lower rate before."""
    time, way, friction = data[["time_s", "load_point_um", "friction"]].to_numpy().T
    slider = SpringSlider(time - time[0], way - way[0], 1.0, friction, initial=BEFORE)
    return fc.fit(slider, "rate_and_state", FREE, V_0=3.0, alpha_t=10.0, evolution=evolution)


def row(name: str, found: fc.Fit) -> str:
    """A line of the table: values with their intervals."""
    cells = [f"{value:.3g} ({low:.3g} to {high:.3g})" for value, low, high in found.table.loc[list(FOUND), ["value", "low", "high"]].to_numpy()]
    return " | ".join([f"| {name}", *cells]) + " |"


def main() -> None:
    """Print the table."""
    print("| record, law of state | a | b | D_c [µm] | k/σ [1/µm] |\n|---|---|---|---|---|")
    records = {"excerpt": excerpt()}
    if len(sys.argv) > 1:
        whole = read(sys.argv[1])
        records["whole, load point as measured"] = led = whole[whole["time_s"].between(FROM, UNTIL)]
        since = led["time_s"] - STEP
        records["whole, load point even"] = led.assign(load_point_um=since.where(since > 0, since * SLOW / FAST) * FAST)
    for name, data in records.items():
        for evolution in ("ageing", "slip"):
            print(row(f"{name}, {evolution}", fitted(data, evolution)))


if __name__ == "__main__":
    main()
