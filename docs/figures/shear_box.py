"""A joint sheared under constant load, constant normal stiffness and constant volume: shear stress, normal stress and dilation.

    python3 docs/figures/shear_box.py target/release/fecontact cases/shear_box.png

Runs `cases/shear_box.json` as it is, without its spring, and with the height held. The dotted lines are those of two elastic bars
between spring and joint, after friction has come down to μ_k: p = p₀ + d/(A/K + 2 H (1 − ν²)/E), with the dilation d that was computed;
K is 0, that of the spring, infinite. For dilation: d = d_max (1 − exp(−tan ψ u/d_max)), as if no part of the displacement u were elastic.
Needs numpy and matplotlib.
"""

import copy
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
case = json.loads(pathlib.Path("cases/shear_box.json").read_text())
length, height, young, nu = 100.0, 40.0, 2000.0, 0.2
law, dilatancy = (case["contacts"]["joint"][key] for key in ("friction", "dilatancy"))

constant_load, constant_volume = copy.deepcopy(case), copy.deepcopy(case)
for other in (constant_load, constant_volume):
    del other["steps"][0]["loads"][1]
constant_volume["steps"][1]["supports"][0]["uy"] = {"rate": 0}
variants = {"constant load": (constant_load, 0.0), "constant stiffness": (case, 800.0), "constant volume": (constant_volume, np.inf)}

figure, panels = plt.subplots(1, 3, figsize=(10, 3.4), layout="constrained")
keys = ("joint.tangential_force", "joint.normal_force", "joint.mean_dilation")
titles = ("shear stress [MPa]", "normal stress [MPa]", "dilation [mm]")
with tempfile.TemporaryDirectory() as folder:
    for color, (name, (variant, stiffness)) in zip(("C0", "C1", "C2"), variants.items()):
        path = pathlib.Path(folder) / "case.json"
        path.write_text(json.dumps(variant))
        subprocess.run([program, "run", path, "--out", path.with_suffix(""), "--quiet"], check=True)
        rows = [row for row in csv.DictReader((path.with_suffix("") / "history.csv").open()) if row["step"] == "shear"]
        column = lambda key: np.array([float(row[key]) for row in rows])
        way, (shear, normal, dilation) = column("top.ux"), map(column, keys)
        found = (shear / length, normal / length, dilation)
        for panel, values in zip(panels, found):
            panel.plot(way, values, color=color, label=name)
        give = 2 * height * (1 - nu**2) / young
        pressure = found[1][0] + dilation * (1.0 / (length / stiffness + give) if stiffness > 0 else 0.0)
        free = dilatancy["limit"] * -np.expm1(-way * dilatancy["rate"] / dilatancy["limit"])
        for panel, values in zip(panels, (law["mu_k"] * pressure, pressure, free)):
            panel.plot(way, values, color=color, linestyle=":", linewidth=1)
for panel, title in zip(panels, titles):
    panel.set(xlabel="displacement of the upper half [mm]", title=title, xlim=(0, 4), ylim=(0, None))
panels[0].legend(frameon=False)
figure.savefig(target, dpi=100)
