"""A pile pulled out of clay, left, and pulled again: the pull over the uplift of its head, and q/p along the shaft.

    fecontact run cases/pile_in_clay.json
    python3 docs/figures/pile_in_clay.py out/pile_in_clay cases/pile_in_clay.png

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

folder, target = pathlib.Path(sys.argv[1]), sys.argv[2]
rows = list(csv.DictReader((folder / "history.csv").open()))
store = xarray.open_zarr(folder / "interface.zarr")
depth = store["shaft.y"].values
order = depth.argsort()
times = store["time"].values

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
for step, label in (("pull", "first pull"), ("pull again", "after 28 hours")):
    own = [row for row in rows if row["step"] == step]
    lift = 1e3 * np.array([float(row["head.uy"]) for row in own])
    pull = np.array([float(row["head.fy"]) for row in own])
    left.plot(lift, pull, label=label)
    print(step, f"peak {pull.max():.1f} at {lift[pull.argmax()]:.1f} mm, last {pull[-1]:.1f}")
left.set(xlabel="uplift of the head [mm]", ylabel="pull [kN per full turn]", ylim=(0, None))
left.legend()
for time in (2, 4, 6, 8, 11, 20):
    k = int(np.abs(times - time).argmin())
    q, p = (np.abs(store[f"shaft.{name}"].values[k][order]) for name in ("traction", "pressure"))
    # Weighted means of three neighbouring points.
    means = lambda values: np.convolve(values, [0.25, 0.5, 0.25], mode="valid")
    right.plot(means(q) / means(p), depth[order][1:-1], label=f"{times[k]:.0f} mm")
right.set(xlabel="q/p along the shaft, first pull [-]", ylabel="z [m]", xlim=(0, 0.22))
right.legend(title="uplift", fontsize=8, loc="center left")
figure.savefig(target, dpi=100)
