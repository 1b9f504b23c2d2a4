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
left.set(xlabel="uplift of the head [mm]", title="pull [kN per full turn]", ylim=(0, None))
left.legend()
for time in (2, 4, 6, 8, 11, 20):
    k = int(np.abs(times - time).argmin())
    ratio = np.abs(store["shaft.traction"].values[k]) / store["shaft.pressure"].values[k]
    right.plot(ratio[order], depth[order], label=f"{times[k]:.0f} mm")
right.set(xlabel="q/p", ylabel="z [m]", title="friction along the shaft, first pull")
right.legend(title="uplift", fontsize=8)
figure.savefig(target, dpi=100)
