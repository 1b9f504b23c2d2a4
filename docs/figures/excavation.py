"""An excavation in stages: the deformed bodies that are left with their plastic strain, and deflection and bending moment of the wall by stage.

    fecontact run cases/excavation.json
    python3 docs/figures/excavation.py out/excavation cases/excavation.png

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

folder, target = pathlib.Path(sys.argv[1]), sys.argv[2]
ENLARGED = 40
HIDDEN = 32
STAGES = {"1 m": 201, "2 m": 301, "3 m": 401, "4 m": 501}

reader = pyvista.get_reader(folder / "solid.pvd")


def frame(time):
    reader.set_active_time_value(time)
    return reader.read()[0]


figure, (left, right, bent) = plt.subplots(1, 3, figsize=(11, 4), width_ratios=[2.6, 1, 1], layout="constrained")
grid = frame(STAGES["4 m"])
places = grid.points[:, :2] + ENLARGED * grid["displacement"][:, :2]
shown = [k for k in range(grid.n_cells) if grid.cell_data["vtkGhostType"][k] != HIDDEN]
cells = [np.array(grid.get_cell(k).point_ids) for k in shown]
strain = [100 * np.nanmean(np.nan_to_num(grid["equivalent_plastic_strain"][ids])) for ids in cells]
bodies = PolyCollection([places[ids[:4]] for ids in cells], array=np.array(strain), cmap="magma_r", edgecolors="grey", linewidths=0.2)
bodies.set_clim(0, 1)
left.add_collection(bodies)
left.set(xlim=(-6.3, 12), ylim=(-12, 1), aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"after 4 m, displacements × {ENLARGED}")
figure.colorbar(bodies, ax=left, shrink=0.8, extend="max", label="plastic strain [%]")

# The wall is the only body with elements of its thickness at its head.
wall = np.unique([grid.get_cell(k).point_ids for k in shown if np.abs(grid.get_cell(k).points[:, 0] - 0.2).max() < 0.21 and grid.get_cell(k).points[:, 1].min() > -8.01])
face = wall[np.isclose(grid.points[wall, 0], 0)]
face = face[np.argsort(grid.points[face, 1])]
for stage, time in STAGES.items():
    right.plot(1e3 * frame(time)["displacement"][face, 0], grid.points[face, 1], label=stage)
right.set(xlabel="deflection [mm]", ylabel="y [m]", title="deflection of the wall")
right.legend(title="excavated")
rows = list(csv.DictReader((folder / "sections.csv").open()))
names = [name.removesuffix(".y") for name in rows[0] if name.endswith(".y")]
for stage, time in STAGES.items():
    row = min(rows, key=lambda row: abs(float(row["time"]) - time))
    moments = [float(row[f"{name}.moment"]) for name in names]
    bent.plot(moments, [float(row[f"{name}.y"]) for name in names])
    print(stage, min(moments), max(moments))
bent.set(xlabel="moment [kNm/m]", title="bending moment")
figure.savefig(target, dpi=90)
