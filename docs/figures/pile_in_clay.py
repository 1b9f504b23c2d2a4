"""A load test of a pile in clay: load over settlement of its head, with what shaft and base bear, and its normal force over depth.

    fecontact run cases/pile_in_clay.json
    python3 docs/figures/pile_in_clay.py out/pile_in_clay cases/pile_in_clay.png

Needs numpy and matplotlib.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

folder, target = pathlib.Path(sys.argv[1]), sys.argv[2]


def table(name):
    rows = list(csv.DictReader((folder / name).open()))
    return rows, lambda column: np.array([float(row[column]) for row in rows])


rows, column = table("history.csv")
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), width_ratios=[1.6, 1], layout="constrained")
down = -1e3 * column("head.uy")
base = column("base.normal_force") - column("base.normal_force")[0]
shaft = -column("shaft.tangential_force") - column("soft_shaft.tangential_force")
left.plot(down, -column("head.fy"), label="head")
left.plot(down, shaft, label="shaft")
left.plot(down, base, label="base")
left.set(xlabel="settlement of the head [mm]", title="load [kN]")
left.legend()
sections, force = table("sections.csv")
stations = [name.removesuffix(".y") for name in sections[0] if name.endswith(".y")]
depth = [float(sections[0][f"{name}.y"]) for name in stations]
times = column("time")
ends = {step: max(k for k, row in enumerate(rows) if row["step"] == step) for step in ("load", "unload", "load again")}
for step, k in ends.items():
    at = int(np.abs(force("time") - times[k]).argmin())
    right.plot([-force(f"{name}.axial_force")[at] for name in stations], depth, label=f"{step}: {-float(rows[k]['head.fy']):.0f} kN")
    print(step, rows[k]["head.fy"], shaft[k], base[k], down[k])
right.set(xlabel="normal force [kN]", ylabel="y [m]", title="in the pile")
right.legend(fontsize=8)
figure.savefig(target, dpi=100)
