"""Deformed bodies, coloured by a field, and what the interface does below them.

    fecontact run cases/block_on_ground.json
    python3 docs/figures/bodies.py out/block_on_ground cases/block_on_ground.png --scale 10 --at 6 --profile R 3.5 5 6 6.5 7.5
    fecontact run cases/tube.json
    python3 docs/figures/bodies.py out/tube cases/tube.png --edges

Draws the frame nearest to a time (the last one unless told), displacements enlarged; with --profile a field of the contact along
the slave at several times. Needs numpy, matplotlib and pyvista.
"""

import argparse
import json
import pathlib

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib.collections import PolyCollection

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("target")
arguments.add_argument("--field", default="von_mises")
arguments.add_argument("--scale", type=float, default=1.0)
arguments.add_argument("--at", type=float)
arguments.add_argument("--edges", action="store_true")
arguments.add_argument("--profile", nargs="+", metavar=("FIELD", "TIME"))
told = arguments.parse_args()


units = json.loads((told.folder / "summary.json").read_text())["units"]


def unit(of):
    """The label of a unit in brackets, if the case has it; that of stresses is made of force and length."""
    label = units.get(of) or (f"{units['force']}/{units['length']}²" if of == "stress" and {"force", "length"} <= units.keys() else "")
    return f" [{label}]" if label else ""


def frame(name, at):
    """What a .pvd holds at the time nearest to `at`, and that time."""
    reader = pyvista.get_reader(told.folder / name)
    times = np.array(reader.time_values)
    time = times[-1 if at is None else np.abs(times - at).argmin()]
    reader.set_active_time_value(time)
    return reader.read().combine(), time


def bodies(axes):
    """Elements where they are, coloured by the mean of the field at their corners."""
    grid, time = frame("solid.pvd", told.at)
    places = (grid.points + told.scale * grid["displacement"])[:, :2]
    cells = [grid.get_cell(cell) for cell in range(grid.n_cells)]
    corners = [np.array(cell.point_ids)[: 3 if len(cell.point_ids) in (3, 6) else 4] for cell in cells]
    values = np.array([grid[told.field][ids].mean() for ids in corners])
    edges = {"edgecolors": "black", "linewidths": 0.4} if told.edges else {"antialiaseds": False}
    drawn = PolyCollection([places[ids] for ids in corners], array=values, cmap="viridis", **edges)
    drawn.set_clim(0, np.quantile(values, 0.999))
    axes.add_collection(drawn)
    axes.autoscale()
    axes.set_aspect("equal")
    axes.set(xlabel="x" + unit("length"), ylabel="y" + unit("length"))
    enlarged = f", displacements ×{told.scale:g}" if told.scale != 1 else ""
    axes.set_title(f"t = {time:.3g} {units.get('time', '')}{enlarged}", fontsize=10)
    label = "von Mises stress" + unit("stress") if told.field == "von_mises" else told.field.replace("_", " ")
    plt.colorbar(drawn, ax=axes, label=label, shrink=0.7)


def profiles(axes):
    """A field of the contact along the slave at several times."""
    name, *times = told.profile
    for number, at in enumerate(times):
        line, time = frame("contact.pvd", float(at))
        order = np.argsort(line.points[:, 0])
        colour = plt.cm.viridis(0.9 * number / max(1, len(times) - 1))
        axes.plot(line.points[order, 0], line[name][order], color=colour, label=f"t = {time:.3g} {units.get('time', '')}")
    axes.set_xlabel("x along the slave" + unit("length"))
    axes.set_ylabel(f"{name} [-]" if name in ("R", "mu", "structure") else name)
    axes.legend(fontsize=8)


figure, axes = plt.subplots(1 + bool(told.profile), 1, figsize=(8, 7 if told.profile else 4), squeeze=False, layout="constrained")
bodies(axes[0, 0])
if told.profile:
    profiles(axes[1, 0])
figure.savefig(told.target, dpi=100)
