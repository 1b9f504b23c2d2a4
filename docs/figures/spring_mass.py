"""Friction of a spring–mass problem over time in several runs, and how much of it is slip: elastic and plastic.

    fecontact run cases/paper/spring_mass_3.json
    fecontact run cases/paper/spring_mass_3_damped.json
    python3 docs/figures/spring_mass.py cases/paper/spring_mass_3.svg out/spring_mass_3 out/spring_mass_3_damped

Needs numpy and matplotlib.
"""

import json
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

target, *folders = map(pathlib.Path, sys.argv[1:])
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9, "legend.frameon": False})

# More columns than can be told apart in the picture.
COLUMNS = 1200


def thinned(time, *columns):
    """The first, least and largest of every column: the picture stays the same."""
    pieces = np.array_split(np.arange(time.size), min(COLUMNS, time.size))
    rows = sorted({k for piece in pieces for of in columns for k in (piece[0], piece[of[piece].argmin()], piece[of[piece].argmax()])})
    return [column[rows] for column in (time, *columns)]


figure, (friction, elastic, plastic) = plt.subplots(3, 1, figsize=(8, 7), sharex=True, layout="constrained")
for k, folder in enumerate(folders):
    with (folder / "history.csv").open() as file:
        names = file.readline().strip().split(",")
        wanted = ["time", "base.tangential_force", "base.normal_force", "base.mean_elastic_slip", "base.mean_slip"]
        table = np.loadtxt(file, delimiter=",", usecols=[names.index(name) for name in wanted], unpack=True)
    look = {"lw": 0.8, "ls": ("-", "--", "-.")[k % 3], "label": folder.name}
    time, force, normal, reversible, slip = thinned(*table)
    friction.plot(time, force, **look)
    elastic.plot(time, reversible, **look)
    plastic.plot(time, slip, **look)
law = json.loads((folders[0] / "summary.json").read_text())["friction"]["base"]
for name in ("mu_s", "mu_k"):
    friction.plot(time, law[name] * normal, "k:", lw=0.8)
    friction.annotate(f"{name} × normal force", (time[-1], law[name] * normal[-1]), ha="right", va="bottom", fontsize=8)
friction.set(ylabel="friction")
friction.margins(y=0.1)
elastic.set(ylabel="elastic slip")
plastic.set(ylabel="plastic slip", xlabel="time")
plastic.legend(loc="upper left")
figure.savefig(target, metadata={"Date": None})
