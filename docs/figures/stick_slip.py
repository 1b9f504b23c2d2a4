"""Three ruptures of a block that is dragged by its top: the force over time, and how fast every point slips while they run.

    fecontact run cases/stick_slip.json
    python3 docs/figures/stick_slip.py out/stick_slip cases/stick_slip.png

Needs numpy, matplotlib, xarray and zarr.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import xarray
from matplotlib.colors import LogNorm

folder, target = pathlib.Path(sys.argv[1]), sys.argv[2]
C_R, START = 1.258e6, 200.0

rows = list(csv.DictReader((folder / "history.csv").open()))
time, tangential, normal = (np.array([float(row[key]) for row in rows]) for key in ("time", "interface.tangential_force", "interface.normal_force"))
store = xarray.open_zarr(folder / "interface.zarr")
order = np.argsort(store["interface.x"].values)
x, times = store["interface.x"].values[order], store["time"].values
rate = np.abs(store["interface.slip_rate"].values[:, order])
fast = np.flatnonzero(rate.max(axis=1) > START)
onsets = times[fast[np.concatenate([[True], np.diff(times[fast]) > 0.01])]]

figure, panels = plt.subplots(1, 4, figsize=(12, 3), layout="constrained", width_ratios=[1.3, 1, 1, 1])
panels[0].plot(time, tangential / normal, "k-", lw=0.8)
panels[0].plot(onsets, np.interp(onsets - 5e-5, time, tangential / normal), "o", color="C3", ms=4)
panels[0].set(xlabel="time [s]", title="friction over normal force", ylim=(0, 0.3))
for panel, onset in zip(panels[1:], onsets):
    during = (times > onset - 1e-5) & (times < onset + 1.1e-4)
    drawn = panel.pcolormesh(x, 1e6 * (times[during] - onset), np.maximum(rate[during], 1), norm=LogNorm(1, 2000), cmap="inferno", shading="nearest")
    panel.plot([80, 118], [0, 38e6 / C_R], color="white", lw=1, ls="--")
    panel.set(xlabel="x [mm]", title=f"slip rate at {onset:.3f} s")
panels[1].set_ylabel("time [µs]")
panels[1].text(100, 4, "c_R", color="white", fontsize=9)
plt.colorbar(drawn, ax=panels[3], label="mm/s")
figure.savefig(target, dpi=85)
