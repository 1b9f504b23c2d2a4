"""A hub shrunk on a shaft that turns in it: hoop stress after cooling, shear stress over turns, heat.

    fecontact run cases/shrink_fit.json
    python3 docs/figures/shrink_fit.py out/shrink_fit cases/shrink_fit.png

The dashed line is μ p of a long slide, with Lamé's pressure of the two rings, the bore held:
p = E α ΔT/(k_shaft + k_hub), k_hub = (c² + b²)/(c² − b²) + ν, k_shaft = (1 − ν)(1 − s)/(1 + s (1 − ν)/(1 + ν)), s = a²/b²,
and μ where weakening and recovery are equal, κ (μ/μ_k − 1) v = ξ (1 − μ/μ_s). Needs numpy, matplotlib and pyvista.
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
a, b, c, thickness, young, nu, shrink = 10.0, 20.0, 40.0, 20.0, 2e5, 0.3, 1.2e-5 * 150
mu_s, mu_k, kappa, xi, speed = 0.25, 0.15, 20.0, 0.01, 20.0 * 0.001
square = a**2 / b**2
k_hub = (c**2 + b**2) / (c**2 - b**2) + nu
k_shaft = (1 - nu) * (1 - square) / (1 + square * (1 - nu) / (1 + nu))
pressure = young * shrink / (k_shaft + k_hub)
mu = (xi + kappa * speed) / (xi / mu_s + kappa * speed / mu_k)

rows = list(csv.DictReader((folder / "history.csv").open()))
column = lambda key, step: np.array([float(row[key]) for row in rows if row["step"] == step])
area = 2 * np.pi * b * thickness

reader = pyvista.get_reader(folder / "solid.pvd")
reader.set_active_time_value(min(reader.time_values, key=lambda time: abs(time - 150.0)))
grid = reader.read().combine()
cells = [np.array(grid.get_cell(cell).point_ids) for cell in range(grid.n_cells)]
x, y = grid.points[:, 0], grid.points[:, 1]
xx, yy, _, xy = (grid["stress"][:, k] for k in range(4))
hoop = (xx * y**2 + yy * x**2 - 2 * xy * x * y) / (x**2 + y**2)

figure, (left, middle, right) = plt.subplots(1, 3, figsize=(10, 3.4), layout="constrained", width_ratios=(1.25, 1, 1))
drawn = PolyCollection([grid.points[ids, :2] for ids in cells], array=np.array([hoop[ids].mean() for ids in cells]), cmap="RdBu_r")
drawn.set(clim=(-250, 250), antialiased=False)
left.add_collection(drawn)
left.set(xlim=(-41, 41), ylim=(-41, 41), aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title="hoop stress, cooled [MPa]")
plt.colorbar(drawn, ax=left)
for name, label, color in (("turn", "first turn", "C0"), ("turn again", "after 1000 s of rest", "C1")):
    angle = 0.001 * (column("time", name) - column("time", name)[0] + column("dt", name)[0])
    middle.plot(1e3 * angle, column("fit.tangential_force", name) / area, color=color, label=label)
    right.plot(1e3 * angle, 1e-3 * column("fit.frictional_heat", name), color=color, label=label)
middle.axhline(mu * pressure, color="0.4", linestyle="--", linewidth=1, label="μ p, Lamé")
middle.set(xlabel="angle [mrad]", title="shear stress of the fit [MPa]", xlim=(0, 10), ylim=(0, None))
middle.legend(frameon=False, loc="lower right")
right.set(xlabel="angle [mrad]", title="heat of friction [J]", xlim=(0, 10), ylim=(0, None))
figure.savefig(target, dpi=100)
print(f"Lamé: p = {pressure:.2f} MPa, mu = {mu:.4f}")
