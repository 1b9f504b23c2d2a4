"""Bodies that yield: the plastic strain of a frame, and what a case is about over time.

    fecontact run cases/retaining_wall.json
    python3 docs/figures/plastic_strain.py out/retaining_wall cases/retaining_wall.png wall
    fecontact run cases/ironed_strip.json
    python3 docs/figures/plastic_strain.py out/ironed_strip cases/ironed_strip.png tool

Needs numpy, matplotlib and pyvista.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib.collections import PolyCollection

folder, target, what = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
rows = list(csv.DictReader((folder / "history.csv").open()))
column = lambda name: np.array([float(row[name]) for row in rows])

reader = pyvista.get_reader(folder / "solid.pvd")
reader.set_active_time_value(reader.time_values[-1])
grid = reader.read().combine()
places = grid.points[:, :2] + grid["displacement"][:, :2]
cells = [np.array(grid.get_cell(cell).point_ids) for cell in range(grid.n_cells)]
strain = [grid["equivalent_plastic_strain"][ids].mean() for ids in cells]

figure, (above, below) = plt.subplots(2, 1, figsize=(8, 6), height_ratios=[1.4, 1], layout="constrained")
bodies = PolyCollection([places[ids[:4]] for ids in cells], array=np.array(strain), cmap="magma_r", edgecolors="face", linewidths=0.2)
bodies.set_clim(0, 0.3 if what == "wall" else 1)
above.add_collection(bodies)
above.autoscale()
above.set_aspect("equal")
figure.colorbar(bodies, ax=above, label="equivalent plastic strain")
if what == "wall":
    above.set_xlim(-1, 10)
    below.plot(1e3 * column("back.ux"), column("back.fx"))
    below.set(xlabel="way of the wall [mm]", ylabel="push [kN/m]")
    friction = below.twinx()
    friction.plot(1e3 * column("back.ux"), -column("face.tangential_force") / column("face.normal_force"), "C1")
    friction.set_ylabel("friction / normal force")
else:
    below.plot(column("time"), -column("tool.fy"), label="press")
    below.plot(column("time"), column("tool.fx"), label="drag")
    below.set(xlabel="time [s]", ylabel="force [N/mm]")
    below.legend()
figure.savefig(target, dpi=90)
