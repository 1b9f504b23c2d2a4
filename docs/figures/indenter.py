"""A rigid disk pressed into rubber, dragged along it and rolling: forces, and friction over the way.

    fecontact run cases/indenter.json
    python3 docs/figures/indenter.py out/indenter cases/indenter.png

Needs numpy and matplotlib.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

folder, target = sys.argv[1:]
rows = list(csv.DictReader((pathlib.Path(folder) / "history.csv").open()))
column = lambda name: np.array([float(row[name]) for row in rows])
time = column("time")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
for name, label in (("disk.fy", "down, −F_y"), ("disk.fx", "along the way, F_x")):
    left.plot(time, -column(name) if name == "disk.fy" else column(name), label=label)
left.set(xlabel="time [s]: pressed until 1, dragged until 3, rolled until 5", ylabel="force on the disk [N/mm]", xlim=(0, 5))
left.legend(frameon=False)
right.plot(time, np.abs(column("indentation.tangential_force")) / column("indentation.normal_force"))
right.axhline(0.3, color="0.6", linestyle=":", linewidth=1)
right.set(xlabel="time [s]", ylabel="|Q|/N", xlim=(0, 5), ylim=(0, 0.35))
figure.savefig(target, dpi=100)
