"""Sand sheared between two plates under constant normal stiffness, beside a smooth and a rough upper plate.

    fecontact run cases/soil_shear_box.json
    python3 docs/figures/soil_shear_box.py out/soil_shear_box cases/soil_shear_box.png

Above the two boxes at the end, with the plates drawn where they are and the plastic strain of the sand; below shear stress, normal stress
and slip at both plates of each box. The dotted line is the normal stress of spring and elastic sand in series under the dilation that was
computed, (N₀ + δ/(1/K + H/(M L)))/L. Needs numpy, matplotlib and pyvista.
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
length, height, spring, modulus = 0.1, 0.04, 2e4, 3e4 * 0.75 / (1.25 * 0.5)
# Names of the upper and the lower contact of each box, and where the box begins.
boxes = {"smooth above, rough below": ("smooth", "rough_below_smooth", 0.0), "rough above, rough below": ("rough", "rough_below_rough", 0.13)}
rows = list(csv.DictReader((folder / "history.csv").open()))
column = lambda key: np.array([float(row[key]) for row in rows])

figure = plt.figure(figsize=(10, 6), layout="constrained")
grid = figure.add_gridspec(2, 3, height_ratios=[1, 1.2])
picture = figure.add_subplot(grid[0, :])
reader = pyvista.get_reader(folder / "solid.pvd")
reader.set_active_time_value(reader.time_values[-1])
solid = reader.read().combine()
places = (solid.points + solid["displacement"])[:, :2] * 1e3
corners = [np.array(solid.get_cell(cell).point_ids)[:4] for cell in range(solid.n_cells)]
strain = [100 * solid["equivalent_plastic_strain"][ids].mean() for ids in corners]
drawn = picture.add_collection(PolyCollection([places[ids] for ids in corners], array=strain, cmap="viridis", edgecolors="black", linewidths=0.3))
plt.colorbar(drawn, ax=picture, label="plastic strain [%]", shrink=0.8)
for (name, (above, _, begin)), colour in zip(boxes.items(), ("C0", "C1")):
    moved, lifted = (1e3 * column(f"{above}_plate.{key}")[-1] for key in ("ux", "uy"))
    for shift, bottom, kind in ((moved, 1e3 * height + lifted, above), (0, -4, "rough")):
        plate = plt.Rectangle((1e3 * begin + shift - 4, bottom), 1e3 * length + 8, 4, fc="0.75", hatch="///" if kind == "rough" else None, ec="0.4", lw=0.5)
        picture.add_patch(plate)
    picture.text(1e3 * (begin + length / 2), 1e3 * height + 6, name, ha="center", color=colour)
picture.set(xlim=(-6, 246), ylim=(-5, 52), aspect="equal", xlabel="x [mm]", ylabel="y [mm]")

panels = [figure.add_subplot(grid[1, k]) for k in range(3)]
for (name, (above, below, _)), colour in zip(boxes.items(), ("C0", "C1")):
    way = 1e3 * column(f"{above}_plate.ux")
    panels[0].plot(way, column(f"{above}.tangential_force") / length, color=colour, label=name)
    panels[1].plot(way, column(f"{above}.normal_force") / length, color=colour)
    dilation = sum(column(f"{contact}.mean_dilation") for contact in (above, below) if f"{contact}.mean_dilation" in rows[0])
    pressure = 100 + dilation / (1 / spring + height / (modulus * length)) / length
    panels[1].plot(way, pressure, color=colour, linestyle=":", linewidth=1)
    for contact, line in ((above, "-"), (below, "--")):
        panels[2].plot(way, 1e3 * np.abs(column(f"{contact}.mean_slip")), color=colour, linestyle=line, label="above" if line == "-" else "below")
for panel, title in zip(panels, ("shear stress [kPa]", "normal stress [kPa]", "slip above, below (dashed) [mm]")):
    panel.set(xlabel="displacement of the upper plate [mm]", title=title, xlim=(0, 8), ylim=(0, None))
panels[0].legend(frameon=False, fontsize=8, loc=(0.1, 0.4))
figure.savefig(target, dpi=100)
