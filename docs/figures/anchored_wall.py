"""An excavation beside an anchored wall: the deformed bodies with their plastic strain, the anchor, its force, and the wall's deflection.

    fecontact run cases/anchored_wall.json
    python3 docs/figures/anchored_wall.py out/anchored_wall cases/anchored_wall.png

Needs numpy, matplotlib and pyvista.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib.collections import LineCollection, PolyCollection

folder, target = pathlib.Path(sys.argv[1]), sys.argv[2]
ENLARGED = 40
HIDDEN = 32
STAGES = {"2 m": 201, "anchor": 251, "3 m": 351, "4 m": 451}


def frame(name, time):
    reader = pyvista.get_reader(folder / f"{name}.pvd")
    reader.set_active_time_value(time)
    return reader.read()[0]


def places(grid):
    return grid.points[:, :2] + ENLARGED * grid["displacement"][:, :2]


figure, (left, middle, right) = plt.subplots(1, 3, figsize=(12, 4), width_ratios=[2.6, 1, 1], layout="constrained")
grid = frame("solid", STAGES["4 m"])
at = places(grid)
cells = [np.array(grid.get_cell(k).point_ids) for k in range(grid.n_cells) if grid.cell_data["vtkGhostType"][k] != HIDDEN]
strain = [100 * np.nanmean(np.nan_to_num(grid["equivalent_plastic_strain"][ids])) for ids in cells]
bodies = PolyCollection([at[ids[:4]] for ids in cells], array=np.array(strain), cmap="magma_r", edgecolors="grey", linewidths=0.2)
bodies.set_clim(0, 1)
left.add_collection(bodies)
bars = frame("bars", STAGES["4 m"])
lines = LineCollection(places(bars)[bars.cell_connectivity.reshape(-1, 2)], array=bars.cell_data["axial_force"], cmap="viridis", linewidths=3)
left.add_collection(lines)
left.set(xlim=(-6.3, 12), ylim=(-12, 1), aspect="equal", xlabel="x [m]", ylabel="y [m]", title=f"after 4 m, displacements × {ENLARGED}")
figure.colorbar(bodies, ax=left, shrink=0.8, extend="max", label="plastic strain [%]")
figure.colorbar(lines, ax=left, shrink=0.8, label="force in the anchor [kN/m]")

wall = np.unique([grid.get_cell(k).point_ids for k in range(grid.n_cells) if grid.cell_data["body"][k] == grid.cell_data["body"].max()])
face = wall[np.isclose(grid.points[wall, 0], 0)]
face = face[np.argsort(grid.points[face, 1])]
for stage, time in STAGES.items():
    middle.plot(1e3 * frame("solid", time)["displacement"][face, 0], grid.points[face, 1], label=stage)
middle.set(xlabel="deflection [mm]", ylabel="y [m]", title="deflection of the wall")
middle.legend(loc="lower right")

grout = bars.cell_data["bar"] == 0
ends = bars.points[bars.cell_connectivity.reshape(-1, 2)[grout]][:, :, :2]
along = np.linalg.norm(ends.mean(axis=1) - ends[0, 0], axis=1)
for stage, time in list(STAGES.items())[1:]:
    right.plot(along, frame("bars", time).cell_data["axial_force"][grout], marker=".", label=stage)
right.set(xlabel="along the grout [m]", ylabel="axial force [kN/m]", title="force in the grout", ylim=(0, None))
right.legend()
figure.savefig(target, dpi=90)
