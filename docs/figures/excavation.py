"""An excavation in stages: the deformed bodies that are left with their plastic strain, and the wall's deflection by stage.

    fecontact run cases/excavation.json
    python3 docs/figures/excavation.py out/excavation cases/excavation.png

Needs numpy, matplotlib and pyvista.
"""

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
STAGES = {"1 m": 101, "2 m": 201, "3 m": 301, "4 m": 401}

reader = pyvista.get_reader(folder / "solid.pvd")


def frame(time):
    reader.set_active_time_value(time)
    return reader.read()[0]


figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), width_ratios=[2.6, 1], layout="constrained")
grid = frame(STAGES["4 m"])
places = grid.points[:, :2] + ENLARGED * grid["displacement"][:, :2]
shown = [k for k in range(grid.n_cells) if grid.cell_data["vtkGhostType"][k] != HIDDEN]
cells = [np.array(grid.get_cell(k).point_ids) for k in shown]
strain = [100 * np.nanmean(np.nan_to_num(grid["equivalent_plastic_strain"][ids])) for ids in cells]
bodies = PolyCollection([places[ids[:4]] for ids in cells], array=np.array(strain), cmap="magma_r", edgecolors="grey", linewidths=0.2)
bodies.set_clim(0, 1)
left.add_collection(bodies)
left.set(xlim=(-6.3, 12), ylim=(-12, 1), aspect="equal", title=f"plastic strain [%], displacements × {ENLARGED}")
figure.colorbar(bodies, ax=left, shrink=0.8, extend="max")

wall = np.unique([grid.get_cell(k).point_ids for k in range(grid.n_cells) if grid.cell_data["body"][k] == grid.cell_data["body"].max()])
face = wall[np.isclose(grid.points[wall, 0], 0)]
face = face[np.argsort(grid.points[face, 1])]
for stage, time in STAGES.items():
    right.plot(1e3 * frame(time)["displacement"][face, 0], grid.points[face, 1], label=stage)
right.set(xlabel="deflection [mm]", ylabel="y [m]", title="wall")
right.legend(title="dug")
figure.savefig(target, dpi=90)
