"""Arrivals of the two ruptures of the healing benchmark, on several meshes.

    fecontact run cases/healing/healing.json        # and others
    python3 docs/figures/healing.py docs/figures/healing.svg DIR [DIR ...]

Draws when points came to slip faster than 0.1 m/s, from the `fronts.csv` of each folder, named by the folder. Needs numpy and
matplotlib.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

target, *folders = sys.argv[1:]
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
figure, panels = plt.subplots(1, 2, figsize=(8, 3.6), sharey=True, layout="constrained")
for k, folder in enumerate(map(pathlib.Path, folders)):
    with open(folder / "fronts.csv") as file:
        rows = [(float(row["x"]) / 1e3, float(row["arrival"])) for row in csv.DictReader(file)]
    for panel, begin, end in ((panels[0], 0, 5), (panels[1], 5, 15)):
        seen = sorted({x: t for x, t in reversed(rows) if begin <= t < end}.items())
        panel.plot([t for _, t in seen], [x for x, _ in seen], ".", ms=(5, 2, 3)[k % 3], label=folder.name)
panels[0].set(xlabel="time [s]", ylabel="x [km]", title="first rupture")
panels[1].set(xlabel="time [s]", title="reload and second rupture")
panels[1].legend(frameon=False)
figure.savefig(target, metadata={"Date": None})
