"""Cycles of earthquakes: how fast every point of the fault slips, and the fastest of them.

    cargo run --release --example dipping_fault -- 60 1 100 800e3 600 out/bp3
    fecontact run out/bp3/bp3.json
    python3 docs/figures/cycles.py out/bp3 docs/figures/bp3.svg

Reads `interface.zarr` and draws the slip rate over place and rows of the history, which are dense where slip is fast, down to
40 km, and the fastest point over time. Needs numpy, matplotlib, xarray and zarr.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np
import xarray

folder, target = sys.argv[1:]
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
YEAR = 365 * 86400.0
DEEPEST = 40e3

store = xarray.open_zarr(pathlib.Path(folder) / "interface.zarr")
down = np.hypot(store["fault.x"], store["fault.y"]).values
order = np.argsort(down)[np.sort(down) <= DEEPEST]
rate = np.log10(np.maximum(np.abs(store["fault.slip_rate"].values[:, order]), 1e-14))
years = store["time"].values / YEAR

figure, (above, below) = plt.subplots(2, 1, figsize=(8, 6), height_ratios=[2, 1], layout="constrained")
rows = np.arange(len(years))
drawn = above.pcolormesh(rows, down[order] / 1e3, rate.T, cmap="inferno_r", vmin=-12, vmax=0, rasterized=True, shading="nearest")
ticks = np.linspace(0, len(rows) - 1, 7).astype(int)
above.set_xticks(ticks, [f"{years[tick]:.1f}" for tick in ticks])
above.set_xlabel("time [years], rows of the results evenly spaced")
above.set_ylabel("down dip [km]")
above.invert_yaxis()
plt.colorbar(drawn, ax=above, label="log₁₀ slip rate [m/s]")
below.plot(years, rate.max(axis=1), linewidth=0.8)
below.set_xlabel("time [years]")
below.set_ylabel("log₁₀ fastest point [m/s]")
figure.savefig(target, metadata={"Date": None})
