"""A pile pulled out of the ground: uplift of the ground at the peak, q/p along the shaft, and the pull.

    fecontact run cases/pile.json
    python3 docs/figures/pile.py out/pile cases/pile.png

The dashed lines are the integrals of μ_s p and μ_k p over the shaft, p as it is at the start. Needs
numpy, matplotlib, pyvista, xarray and zarr.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista
import xarray
from matplotlib.collections import PolyCollection

folder, target = pathlib.Path(sys.argv[1]), sys.argv[2]
MU_S, MU_K, RADIUS = 0.6, 0.3, 0.5

rows = list(csv.DictReader((folder / "history.csv").open()))
lift = 1e3 * np.array([float(row["pile_head.uy"]) for row in rows])
pull = np.array([float(row["pile_head.fy"]) for row in rows])
peak = pull.argmax()

reader = pyvista.get_reader(folder / "solid.pvd")
reader.set_active_time_value(min(reader.time_values, key=lambda time: abs(time - float(rows[peak]["time"]))))
grid = reader.read().combine()
cells = [np.array(grid.get_cell(cell).point_ids) for cell in range(grid.n_cells)]
uplift = np.array([1e3 * grid["displacement"][ids, 1].mean() for ids in cells])

store = xarray.open_zarr(folder / "interface.zarr")
depth, order = store["shaft.y"].values, store["shaft.y"].values.argsort()
pressure = store["shaft.pressure"].values
with np.errstate(divide="ignore", invalid="ignore"):
    mobilized = np.where(pressure > 0, np.abs(store["shaft.traction"].values) / pressure, np.nan)
ends = np.linspace(depth.min(), depth.max(), 2001)
bearing = 2 * np.pi * RADIUS * np.trapezoid(5 - 8 * ends, ends)

figure, (left, middle, right) = plt.subplots(1, 3, figsize=(10, 3.8), layout="constrained")
ground = PolyCollection([grid.points[ids, :2] for ids in cells], array=uplift, cmap="viridis", antialiaseds=False)
left.add_collection(ground)
left.set(xlim=(0, 6), ylim=(-15, 0.5), xlabel="r [m]", ylabel="z [m]", title="uplift at the peak [mm]")
plt.colorbar(ground, ax=left)
drawn = middle.pcolormesh(lift[-len(mobilized):], depth[order], mobilized[:, order].T, cmap="inferno", vmin=0, vmax=MU_S, shading="nearest")
middle.set(xlabel="uplift of the head [mm]", ylabel="z [m]", title="q/p along the shaft")
plt.colorbar(drawn, ax=middle)
right.plot(lift, pull)
for coefficient, name in ((MU_S, "μ_s"), (MU_K, "μ_k")):
    right.axhline(coefficient * bearing, color="black", linestyle="--", linewidth=0.8)
    right.text(lift[-1], coefficient * bearing, f"{name} ∫ p 2πa dz", ha="right", va="bottom", fontsize=8)
right.set(xlabel="uplift of the head [mm]", title="pull [kN per full turn]", ylim=(0, 1.1 * MU_S * bearing))
figure.savefig(target, dpi=100)
