"""Ironing: forces on the die on several meshes, and the bodies half way on the first of them.

    fecontact run cases/validation/ironing_q8.json
    fecontact run cases/validation/ironing_q4.json
    for kind in q4 q8; do       # the finer meshes
        sed "s/ironing_$kind.msh/ironing_${kind}_fine.msh/" cases/validation/ironing_$kind.json > cases/validation/ironing_${kind}_fine.json
        fecontact run cases/validation/ironing_${kind}_fine.json
    done
    python3 docs/figures/ironing.py cases/validation/ironing.png out/ironing_q8 out/ironing_q8_fine out/ironing_q4 out/ironing_q4_fine

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

target, *folders = sys.argv[1:]
HALF_WAY = 6.0

figure, (left, right) = plt.subplots(1, 2, figsize=(11.5, 3.8), layout="constrained")
for folder in folders:
    rows = list(csv.DictReader((pathlib.Path(folder) / "history.csv").open()))
    time = [float(row["time"]) for row in rows]
    [line] = left.plot(time, [abs(float(row["die_top.fy"])) / 1e6 for row in rows], label=pathlib.Path(folder).name, linewidth=1)
    left.plot(time, [abs(float(row["die_top.fx"])) / 1e6 for row in rows], color=line.get_color(), linewidth=1)
left.text(1.6, 415, "normal")
left.text(1.6, 145, "tangential")
left.set(xlabel="time [-]: pressed to 1, dragged to 11", ylabel="force on the die [10⁶]", xlim=(0, 11), ylim=(0, 450))
left.legend(loc="center", fontsize=8)

reader = pyvista.get_reader(pathlib.Path(folders[0]) / "solid.pvd")
reader.set_active_time_value(min(reader.time_values, key=lambda time: abs(time - HALF_WAY)))
grid = reader.read().combine()
places = (grid.points + grid["displacement"])[:, :2]
corners = [np.array(grid.get_cell(cell).point_ids)[:4] for cell in range(grid.n_cells)]
stress = np.array([grid["von_mises"][ids].mean() / 1e6 for ids in corners])
drawn = PolyCollection([places[ids] for ids in corners], array=stress, cmap="viridis", edgecolors="black", linewidths=0.4)
right.add_collection(drawn)
right.set(xlim=(3, 9.5), ylim=(-2.6, 1), aspect="equal", xlabel="x [-]", ylabel="y [-]", title=f"{pathlib.Path(folders[0]).name}, t = {HALF_WAY:g}")
plt.colorbar(drawn, ax=right, label="von Mises stress [10⁶]", shrink=0.8)
figure.savefig(target, dpi=100)
