"""Maps of the stability of steady sliding, by the super/subloading law: computed against the linear theory.

    mkdir -p out && cargo test --release --test time -- --ignored --nocapture maps_of_stability > out/stability.txt
    python3 docs/figures/stability.py out/stability.txt docs/figures/stability.svg

Draws what the test prints: filled where a deviation grew in the run, open where it decayed, their size by how fast; the line is
where the theory has it neither grow nor decay. Needs numpy and matplotlib.
"""

import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy as np

source, target = sys.argv[1:]
rows = {}
for line in open(source):
    cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
    if len(cells) == 5 and cells[0].split()[-1] in ("slider", "slabs"):
        rows.setdefault(cells[0], []).append([float(cell) for cell in cells[1:] if cell])
if len(rows) != 4:
    sys.exit(f"{source}: two maps and their boundaries expected")

plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
figure, axes = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
for panel, name in zip(axes, ("slider", "slabs")):
    x, y, theory, found = np.array(rows[name]).T
    boundary = np.array(rows[f"boundary of {name}"])
    panel.plot(*boundary[np.argsort(boundary[:, 1 if name == "slider" else 0])].T, "k-", lw=1, label="theory: neutral")
    size = 12 + 45 * np.minimum(1, np.abs(found) / 5)
    for grows, face, label in ((True, "C3", "deviation grew"), (False, "none", "deviation decayed")):
        which = (found > 0) == grows
        panel.scatter(x[which], y[which], size[which], facecolor=face, edgecolor="C3" if grows else "C0", label=label)
    panel.set_yscale("log")
    panel.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
axes[0].set(xlabel="$K/k_c$", ylabel=r"$\hat m = M b^2/k_c$", title=r"spring-slider, $\hat c = c\,b/k_c = 0.1$")
axes[1].set(xscale="log", xlabel="wave number $kH$", ylabel="$k_c H/G$", title=r"two slabs of height $H$, $\eta b H/G = 0.05$")
axes[1].set_xticks([0.5, 1, 2, 4], ["0.5", "1", "2", "4"])
axes[1].minorticks_off()
axes[1].set_yticks([0.3, 1, 3, 8], ["0.3", "1", "3", "8"])
axes[0].set_yticks([0.005, 0.01, 0.02, 0.04, 0.08], ["0.005", "0.01", "0.02", "0.04", "0.08"])
figure.legend(*axes[1].get_legend_handles_labels(), frameon=False, ncols=3, loc="outside lower center")
figure.savefig(target, metadata={"Date": None})
