"""A footing pressed into clay fast and slowly: load, and what of it the water bears, over settlement.

    fecontact run cases/footing_fast.json
    fecontact run cases/footing_slow.json
    python3 docs/figures/footing.py out/footing_fast out/footing_slow cases/footing.png

Needs matplotlib.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt

folders, target = sys.argv[1:3], sys.argv[3]
HALF_WIDTH, SURCHARGE = 1.0, 20.0

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
for folder, label in zip(folders, ["in seven days", "in three hundred years"]):
    rows = [row for row in csv.DictReader((pathlib.Path(folder) / "history.csv").open()) if row["step"] == "press"]
    settlement = [-1e3 * float(row["footing.uy"]) for row in rows]
    load = [SURCHARGE - float(row["footing.fy"]) / HALF_WIDTH for row in rows]
    left.plot(settlement, load, label=label)
    right.plot(settlement, [float(row["clay.excess_pore_pressure"]) for row in rows], label=label)
left.set(xlabel="settlement [mm]", ylabel="mean pressure below the footing [kPa]", ylim=0)
right.set(xlabel="settlement [mm]", ylabel="mean excess pressure of the water [kPa]")
left.legend(frameon=False)
figure.savefig(target, dpi=110)
