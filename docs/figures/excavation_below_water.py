"""An excavation below the water table: pressure and flow of the water at the end, what acts on both faces of the wall, and how it bends, by stage.

    python3 docs/figures/excavation_below_water.py target/release/fecontact cases/excavation_below_water.png

Runs cases/excavation_below_water.json. Needs numpy and matplotlib.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.tri import Triangulation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from results import Run, committed, table

program, target = sys.argv[1:]
STAGES = ["install", "1 m", "2 m", "3 m", "4 m", "wait"]
THICK, HIDDEN = 0.5, 32

run = Run(program, committed("cases/excavation_below_water.json"))
steps = np.array(run.history["step"])
ends = {stage: run.history["time"][np.flatnonzero(steps == stage)[-1]] for stage in STAGES}

figure, (field, water, normal, shear, moved, bent) = plt.subplots(1, 6, figsize=(16, 4.4), width_ratios=[2.5, 1.1, 1, 1, 1, 1], layout="constrained")
solid = run.frame("solid")
places, borders = solid["places"], np.r_[0, solid["offsets"]]
cells = [solid["connectivity"][start:end][:4] for start, end, ghost in zip(borders, borders[1:], solid["vtkGhostType"]) if ghost != HIDDEN]
wet = [cell for cell in cells if np.isfinite(solid["pore_pressure"][cell]).all()]
sides = np.array([[cell[k] for k in corners] for cell in wet for corners in ((0, 1, 2), (0, 2, 3))])
pressure = np.nan_to_num(solid["pore_pressure"])
plane = Triangulation(places[:, 0], places[:, 1], sides)
drawn = field.tripcolor(plane, pressure, shading="gouraud", cmap="viridis")
field.tricontour(plane, pressure, levels=[0], colors="w", linestyles="--")
field.fill_between([0, THICK], -9, 0, color="grey")
flux = solid["water_flux"]
middles = np.array([places[cell, :2].mean(axis=0) for cell in wet])
flows = np.array([flux[cell, :2].mean(axis=0) for cell in wet])
# One arrow of a patch of a metre, all of one length.
spread = {tuple(np.floor(at).astype(int)): k for k, at in enumerate(middles)}
few = list(spread.values())
strength = np.maximum(np.linalg.norm(flows[few], axis=1, keepdims=True), 1e-12)
field.quiver(*middles[few].T, *(flows[few] / strength).T, color="w", scale=28, width=0.003)
field.set(xlim=(-6, 12), ylim=(-14, 0.5), xlabel="x [m]", ylabel="y [m]", title="pressure and flow of the water after a month [kPa]")
figure.colorbar(drawn, ax=field)

for number, stage in enumerate(STAGES):
    found = run.frame("contact", ends[stage])
    for face, sign in ((THICK, 1), (0, -1)):
        on = np.flatnonzero(np.isclose(found["Points"][:, 0], face) & (found["state"] > 0))
        on = on[np.argsort(found["Points"][on, 1])]
        label = stage if sign == 1 else None
        for axes, name in ((water, "fluid_pressure"), (normal, "pressure"), (shear, "traction")):
            axes.plot(sign * found[name][on], found["Points"][on, 1], f"C{number}", label=label)
for axes, title in ((water, "water [kPa]"), (normal, "effective p [kPa]"), (shear, "shear q [kPa]")):
    axes.set(title=title, xlabel="pit | ground", ylim=(-9.2, 0.2))
    axes.axvline(0, color="grey", linewidth=0.8)
# At the corners of the tip it grows with finer elements.
normal.set_xlim(-90, 60)
sections = table(run.folder / "sections.csv")
names = [name.removesuffix(".y") for name in sections if name.endswith(".y")]
for number, stage in enumerate(STAGES[1:], 1):
    row = np.abs(sections["time"] - ends[stage]).argmin()
    moments = [sections[f"{name}.moment"][row] for name in names]
    bent.plot(moments, [sections[f"{name}.y"][row] for name in names], f"C{number}")
    at = np.abs(run.history["time"] - ends[stage]).argmin()
    outlets = {name: run.history[f"{name}.discharge"][at] for name in ("far", "pit_2", "pit_3", "pit_4")}
    print(stage, "head", run.history["head.ux"][at], "moment", np.nanmin(moments), np.nanmax(moments), "outlets", outlets)
    solid = run.frame("solid", ends[stage])
    wall = np.flatnonzero(solid["body"] == solid["body wall"][0])
    face = np.unique([solid["connectivity"][end - 8 : end] for end in solid["offsets"][wall]])
    face = face[np.isclose(solid["Points"][face, 0], 0)]
    face = face[np.argsort(solid["Points"][face, 1])]
    moved.plot(1e3 * solid["displacement"][face, 0], solid["Points"][face, 1], f"C{number}")
moved.set(xlabel="displacement [mm]", title="movement of the wall", ylim=(-9.2, 0.2))
bent.legend(*water.get_legend_handles_labels(), fontsize=8, loc="lower right")
bent.set(xlabel="moment [kNm/m]", title="bending of the wall", ylim=(-9.2, 0.2))
figure.savefig(target, dpi=80)
