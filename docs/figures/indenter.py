"""A rigid disk pressed into rubber, dragged along it and rolling: the body while it is dragged, the forces, and friction over time.

    fecontact run cases/indenter.json
    python3 docs/figures/indenter.py out/indenter cases/indenter.png

Needs numpy, matplotlib and pyvista.
"""

import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib.collections import PolyCollection

folder, target = sys.argv[1:]
rows = list(csv.DictReader((pathlib.Path(folder) / "history.csv").open()))
column = lambda name: np.array([float(row[name]) for row in rows])
time = column("time")

case = json.loads((pathlib.Path(__file__).parents[2] / "cases" / "indenter.json").read_text())
circle = case["contacts"]["indentation"]["master"]["circle"]
reader = pyvista.get_reader(pathlib.Path(folder) / "solid.pvd")
frames = np.array(reader.time_values)
reader.set_active_time_value(frames[np.abs(frames - 3).argmin()])
grid = reader.read().combine()
row = int(np.abs(time - 3).argmin())

figure, axes = plt.subplot_mosaic([["body", "body"], ["left", "right"]], figsize=(9, 6), height_ratios=[0.8, 1], layout="constrained")
body, left, right = axes["body"], axes["left"], axes["right"]
places = (grid.points + grid["displacement"])[:, :2]
corners = [np.array(grid.get_cell(cell).point_ids)[:4] for cell in range(grid.n_cells)]
drawn = PolyCollection([places[ids] for ids in corners], array=np.array([grid["von_mises"][ids].mean() for ids in corners]), cmap="viridis", edgecolors="face")
body.add_collection(drawn)
centre = np.array(circle["centre"]) + [column("disk.ux")[row], column("disk.uy")[row]]
body.add_patch(plt.Circle(centre, circle["radius"], facecolor="0.85", edgecolor="black"))
body.autoscale()
body.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal", ylim=(None, places[:, 1].max() + 0.6 * circle["radius"]), title="t = 3 s, dragged")
figure.colorbar(drawn, ax=body, label="von Mises stress [MPa]", shrink=0.8)
for name, label in (("disk.fy", "down, −F_y"), ("disk.fx", "along x, F_x")):
    left.plot(time, -column(name) if name == "disk.fy" else column(name), label=label)
left.set(xlabel="time [s]: pressed to 1, dragged to 3, rolled to 5", ylabel="force on the disk [N/mm]", xlim=(0, 5))
left.legend(frameon=False)
right.plot(time, np.abs(column("indentation.tangential_force")) / column("indentation.normal_force"))
right.axhline(0.3, color="0.6", linestyle=":", linewidth=1)
right.set(xlabel="time [s]", ylabel="|Q|/N [-]", xlim=(0, 5), ylim=(0, 0.35))
figure.savefig(target, dpi=100)
