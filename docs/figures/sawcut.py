"""A sample with a saw cut at four angles: its meshes, and the stress that it bears.

    python3 docs/figures/sawcut.py target/release/fecontact cases/sawcut.png

Runs `cases/sawcut.json` with other values of `mesh.parameters.angle`. The dotted lines are the closed form of two blocks that slide on a plane
under uniform stress, Δσ = μ σ₃/(sin θ cos θ − μ cos² θ), with the law's μ of steady sliding at the slip rate V/sin θ. Needs numpy and
matplotlib.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

program, target = sys.argv[1:]
case = json.loads(pathlib.Path("cases/sawcut.json").read_text())
width, height, count = 40.0, 100.0, 10
law, pressure, rate = case["contacts"]["cut"]["friction"], 10.0, 0.005
angles = (45, 50, 55, 60)

figure = plt.figure(figsize=(10, 4.2), layout="constrained")
left, right = figure.subfigures(1, 2, width_ratios=[1, 1.3])
ax = right.subplots()
with tempfile.TemporaryDirectory() as folder:
    for panel, color, angle in zip(left.subplots(1, len(angles)), ("C0", "C1", "C2", "C3"), angles):
        case["mesh"]["parameters"]["angle"] = angle
        path = pathlib.Path(folder) / f"{angle}.json"
        path.write_text(json.dumps(case))
        subprocess.run([program, "run", path, "--out", path.with_suffix(""), "--quiet"], check=True)
        rows = list(csv.DictReader((path.with_suffix("") / "history.csv").open()))
        column = lambda key: np.array([float(row[key]) for row in rows if row["step"] == "compress"])
        ax.plot(-column("top.uy"), -column("top.fy") / width, color=color, label=f"{angle}°")
        sin, cos = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        lost = law["kappa"] * rate / sin
        mu = (lost + law["xi"]) / (lost / law["mu_k"] + law["xi"] / law["mu_s"])
        ax.axhline(mu * pressure / (sin * cos - mu * cos**2), color=color, linestyle=":", linewidth=1)
        rise = 0.5 * width * np.tan(np.radians(angle))
        ends = np.array([0.5 * height - rise, 0.5 * height + rise])
        x = np.linspace(0, width, count + 1)
        # Sizes of the elements double from the cut to the plates.
        share = np.cumsum([0, *(0.5 ** np.linspace(0, 1, 12))])
        cut = np.interp(x, [0, width], ends)
        for far in (0.0, height):
            rows = np.array([far + (cut - far) * part for part in (share / share[-1])])
            panel.plot(x, rows.T, color="0.5", linewidth=0.4)
            panel.plot(np.broadcast_to(x, rows.shape), rows, color="0.5", linewidth=0.4)
        panel.plot([0, width], ends, color=color, linewidth=2)
        panel.set(aspect="equal", title=f"{angle}°")
        panel.axis("off")
ax.set(xlabel="shortening [mm]", ylabel="Δσ [MPa]", xlim=(0, None), ylim=(0, None))
ax.legend(frameon=False, title="angle of the cut")
figure.savefig(target, dpi=100)
