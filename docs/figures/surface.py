"""Motion of the surface in cycles of earthquakes: hanging wall against foot wall.

    cargo run --release --example dipping_fault -- 60 1 100 800e3 320 out/bp3
    fecontact run out/bp3/bp3.json
    python3 docs/figures/surface.py out/bp3 docs/figures/bp3_surface.svg

Points are those of FDRA (Y. Sun, SEAS benchmark BP3-QD, thrust under 60 degrees, 2021) in the listed years, against its station 16 km out on
the foot wall, so that the whole model may move. Prints a row a year. Needs numpy and matplotlib.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

folder, target = sys.argv[1:]
YEAR = 365 * 86400.0

# year: displacement [m], to the right and up, 16 km out on the hanging wall and at the trace, less that 16 km out on the foot wall
FDRA = {
    100: ((-0.73032, 1.86891), (-0.53878, 0.59380)),
    150: ((-1.09613, 2.83684), (-0.82386, 0.89946)),
    200: ((-1.61018, 4.11626), (-1.33544, 1.31098)),
    250: ((-1.97948, 5.10908), (-1.62923, 1.62255)),
    270: ((-2.12866, 5.51758), (-1.75357, 1.75070)),
    300: ((-3.34874, 6.84879), (-3.06140, 4.63396)),
}

rows = list(csv.DictReader(open(pathlib.Path(folder) / "probes.csv")))
years = np.array([float(row["time"]) for row in rows]) / YEAR
at = {name: np.array([[float(row[f"{name}.u{axis}"]) for axis in "xy"] for row in rows]) for name in ("foot_16", "trace", "hang_16")}

plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
figure, panels = plt.subplots(1, 2, figsize=(8, 3), layout="constrained", sharex=True)
print("| year | 16 km out: FDRA [m] | ours | trace: FDRA [m] | ours | largest difference |\n|---|---|---|---|---|---|")
found = {name: np.array([[np.interp(year, years, (at[name] - at["foot_16"])[:, i]) for i in (0, 1)] for year in FDRA]) for name in ("hang_16", "trace")}
for row, (year, published) in enumerate(FDRA.items()):
    ours = [found["hang_16"][row], found["trace"][row]]
    largest = max(np.hypot(*(a - b)) / np.hypot(*b) for a, b in zip(ours, published))
    cells = [f"{a[0]:.3f}, {a[1]:.3f} | {b[0]:.3f}, {b[1]:.3f}" for a, b in zip(published, ours)]
    print(f"| {year} | {' | '.join(cells)} | {100 * largest:.1f} % |")
for panel, place, name, title in zip(panels, (0, 1), ("hang_16", "trace"), ("16 km from the trace", "at the trace")):
    for i, (color, way) in enumerate((("C0", "to the right"), ("C1", "up"))):
        panel.plot(years, (at[name] - at["foot_16"])[:, i], color=color, lw=1, label=way)
        panel.plot(list(FDRA), [values[place][i] for values in FDRA.values()], "o", color=color, ms=4, mfc="none")
    panel.set(xlabel="year", title=f"hanging wall {title}", xlim=(0, 320))
panels[0].set_ylabel("displacement against the foot wall [m]")
panels[0].legend(frameon=False)
figure.savefig(target, metadata={"Date": None})
