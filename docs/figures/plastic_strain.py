"""Bodies that yield: the plastic strain of a frame, and what a case is about over time.

    fecontact run cases/retaining_wall.json
    python3 docs/figures/plastic_strain.py out/retaining_wall cases/retaining_wall.png wall
    fecontact run cases/ironed_strip.json
    python3 docs/figures/plastic_strain.py out/ironed_strip cases/ironed_strip.png tool

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

folder, target, what = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
rows = list(csv.DictReader((folder / "history.csv").open()))
column = lambda name: np.array([float(row[name]) for row in rows])

reader = pyvista.get_reader(folder / "solid.pvd")
reader.set_active_time_value(reader.time_values[-1])
grid = reader.read().combine()
places = grid.points[:, :2] + grid["displacement"][:, :2]
cells = [np.array(grid.get_cell(cell).point_ids) for cell in range(grid.n_cells)]
strain = [grid["equivalent_plastic_strain"][ids].mean() for ids in cells]

# A strip is as wide as the figure and lower than a wall.
size, ratios = ((8, 6), [1.4, 1]) if what == "wall" else ((8, 4.4), [0.55, 1])
figure, (above, below) = plt.subplots(2, 1, figsize=size, height_ratios=ratios, layout="constrained")
unit = json.loads((folder / "summary.json").read_text())["units"]["length"]
above.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
bodies = PolyCollection([places[ids[: 3 if len(ids) in (3, 6) else 4]] for ids in cells], array=np.array(strain), cmap="magma_r", edgecolors="face", linewidths=0.2)
bodies.set_clim(0, 0.3 if what == "wall" else 1)
above.add_collection(bodies)
above.autoscale()
above.set_aspect("equal")
where = {"ax": above} if what == "wall" else {"ax": above, "orientation": "horizontal", "location": "top", "aspect": 60}
figure.colorbar(bodies, label="equivalent plastic strain [-]", **where)
if what == "wall":
    above.set_xlim(-1, 10)
    below.plot(1e3 * column("back.ux"), column("back.fx"))
    below.set(xlabel="displacement of the wall [mm]", ylabel="reaction of the wall [kN/m]")
    friction = below.twinx()
    friction.plot(1e3 * column("back.ux"), -column("face.tangential_force") / column("face.normal_force"), "C1")
    friction.set_ylabel("friction / normal force [-]")
else:
    below.plot(column("time"), -column("tool.fy"), label="normal force, −F_y")
    below.plot(column("time"), column("tool.fx"), label="tangential force, F_x")
    below.set(xlabel="time [s]", ylabel="force [N/mm]")
    below.legend()
figure.savefig(target, dpi=90)
