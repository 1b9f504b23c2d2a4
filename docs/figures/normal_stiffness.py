"""An interface that dilates with its structure under constant normal load, constant normal stiffness and constant volume.

    python3 docs/figures/normal_stiffness.py target/release/fecontact cases/law/shaft.svg

Runs `cases/law/shaft.json` as it is, under constant load and at constant volume. The dotted lines are where μ = μ_k with all structure lost,
p = p₀ + K d with d = d_S (μ_s − μ_k)/κ. Needs numpy and matplotlib.
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

program, target = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9, "lines.linewidth": 1, "legend.frameon": False})
test = json.loads(pathlib.Path("cases/law/shaft.json").read_text())
law, start, (stiffness, own) = test["friction"], test["initial"]["pressure"], test["normal"].values()
dilated = test["dilatancy"]["structure"] * (law["mu_s"] - law["mu_k"]) / law["kappa"]
variants = {
    "constant load": ({"alpha_n": own}, 0.0),
    "constant stiffness": (test["normal"], stiffness / (1 + stiffness / own)),
    "constant volume": ({"constant_volume": True, "alpha_n": own}, own),
}

figure, panels = plt.subplots(2, 2, figsize=(8, 5.6), layout="constrained")
shear, path, normal, opening = panels.flat
with tempfile.TemporaryDirectory() as folder:
    for color, (name, (confinement, effective)) in zip(("C0", "C1", "C2"), variants.items()):
        variant, place = copy.deepcopy(test), pathlib.Path(folder) / "shaft.json"
        variant["normal"] = confinement
        place.write_text(json.dumps(variant))
        subprocess.run([program, "law", place, "--out", place.with_suffix("")], check=True, stderr=subprocess.DEVNULL)
        rows = np.genfromtxt(place.with_suffix("") / "law.csv", delimiter=",", names=True)
        residual = start + effective * dilated
        shear.plot(rows["slip"], rows["traction"], color=color, label=name)
        shear.plot([6, 12], 2 * [law["mu_k"] * residual], color=color, linestyle=":")
        path.plot(rows["pressure"], rows["traction"], color=color)
        normal.plot(rows["slip"], rows["pressure"], color=color)
        normal.plot([6, 12], 2 * [residual], color=color, linestyle=":")
        opening.plot(rows["slip"], rows["gap"], color=color)
limit = np.array([0, 700])
path.plot(limit, law["mu_k"] * limit, color="0.6", linestyle="--", linewidth=0.8)
path.plot(limit, law["mu_s"] * limit, color="0.6", linestyle="--", linewidth=0.8)
shear.set(xlabel="slip [mm]", ylabel="q [kPa]", xlim=(0, 24), ylim=(0, None))
path.set(xlabel="p [kPa]", ylabel="q [kPa]", xlim=(0, 700), ylim=(0, 400))
normal.set(xlabel="slip [mm]", ylabel="p [kPa]", xlim=(0, 24), ylim=(0, None))
opening.set(xlabel="slip [mm]", ylabel="gap [mm]", xlim=(0, 24))
shear.legend()
figure.savefig(target, metadata={"Date": None})
