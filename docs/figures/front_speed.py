"""Speed of fronts against the equation of motion of a crack's tip.

    mkdir -p out && cargo test --release --test published -- --ignored --nocapture fronts_on_fine > out/front_speed.txt
    python3 docs/figures/front_speed.py out/front_speed.txt docs/figures/front_speed.svg

Draws the tables that the test prints: l/l_c, speed over c_R, and that of the equation. Needs numpy and matplotlib.
"""

import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

source, target = sys.argv[1:]
tables, law = {}, None
for line in open(source):
    if line.strip().strip('"') in ("slip_weakening", "super_subloading"):
        law = line.strip().strip('"')
    cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
    if law and len(cells) == 4 and cells[0][:1].isdigit():
        tables.setdefault(law, []).append([float(cell) for cell in cells[:3]])
if len(tables) != 2:
    sys.exit(f"{source}: two tables expected, {len(tables)} found")

plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
figure, (speeds, off) = plt.subplots(2, 1, sharex=True, figsize=(5, 4.6), height_ratios=[3, 1], layout="constrained")
for (law, rows), mark in zip(tables.items(), "os"):
    l, found, expected = np.array(rows).T
    if mark == "o":
        speeds.plot(l, expected, "k-", label="Freund's equation of motion")
    name = law.replace("_", " ").replace("super ", "super/")
    (points,) = speeds.plot(l, found, mark, mfc="none", label=name)
    off.plot(l, 100 * (found / expected - 1), mark, mfc="none", color=points.get_color())
speeds.set_ylabel("front speed $v/c_R$")
speeds.legend(frameon=False)
off.axhline(0, color="k", lw=0.8)
off.set(xlabel="length behind the front $l/l_c$", ylabel="off [%]", ylim=(-5, 5))
figure.savefig(target, metadata={"Date": None})
