"""Figures of the friction law alone: traction over slip, the coefficient and the state over time, pressure where it varies, and what
rest gives back.

    python3 docs/figures/law.py target/release/fecontact cases/law

Runs every test of the folder under constant load and writes its SVG beside it. Needs numpy and matplotlib.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9, "lines.linewidth": 1, "legend.frameon": False})


def driven(test):
    """Columns and summary of a test."""
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, "law", test, "--out", out], check=True, stderr=subprocess.DEVNULL)
        summary = json.loads((pathlib.Path(out) / "summary.json").read_text())
        return np.genfromtxt(pathlib.Path(out) / "law.csv", delimiter=",", names=True), summary


def figure(test):
    rows, summary = driven(test)
    units = summary["units"]
    labels = {key: f" [{units[key]}]" if key in units else "" for key in ("time", "length", "stress")}
    time, slip, pressure, traction = (rows[name] for name in ("time", "slip", "pressure", "traction"))
    holds = summary["holds"]
    varies = np.ptp(pressure) > 0
    panels = ["path", "mu", "slip", "state"] + (["pressure", "loop"] if varies else []) + (["ageing"] if len(holds) > 2 else [])
    lines = -(-len(panels) // 2)
    drawn, axes = plt.subplots(lines, 2, figsize=(8.6, 2.6 * lines), layout="constrained")
    at = dict(zip(panels, axes.flat))
    for panel in axes.flat[len(panels) :]:
        panel.remove()
    at["path"].plot(slip, traction)
    at["path"].set(xlabel="slip" + labels["length"], ylabel="traction q" + labels["stress"])
    pressed = pressure > 0
    ratio = np.where(pressed, traction / np.where(pressed, pressure, 1), np.nan)
    at["mu"].plot(time, ratio, label="q/p")
    backwards = np.nanmin(ratio) < 0
    for sign in (1, -1) if backwards else (1,):
        at["mu"].plot(time, sign * rows["mu"], "k:", label=("±μ" if backwards else "μ") if sign > 0 else None)
    at["slip"].plot(time, slip, label="total")
    at["slip"].plot(time, rows["plastic_slip"], "--", label="plastic")
    at["slip"].set(ylabel="slip" + labels["length"])
    at["state"].plot(time, rows["R"], label="R")
    at["state"].plot(time, rows["structure"], "--", label="structure 1/R*")
    for name in ("mu", "slip", "state"):
        at[name].set(xlabel="time" + labels["time"])
        at[name].legend()
    if varies:
        at["pressure"].plot(time, pressure)
        at["pressure"].set(xlabel="time" + labels["time"], ylabel="pressure p" + labels["stress"])
        at["loop"].plot(pressure, traction)
        at["loop"].set(xlabel="pressure p" + labels["stress"], ylabel="traction q" + labels["stress"])
    if "ageing" in at:
        at["ageing"].semilogx([hold["duration"] for hold in holds], [hold["peak"]["coefficient"] for hold in holds], "o", ms=4)
        at["ageing"].set(xlabel="hold duration" + labels["time"], ylabel="peak |q|/p")
    drawn.suptitle(summary["title"], fontsize=10)
    drawn.savefig(test.with_suffix(".svg"), metadata={"Date": None})


for test in sorted(folder.glob("*.json")):
    if "normal" not in json.loads(test.read_text()):
        figure(test)
