"""The 4 m fault: computed against measured.

    fecontact run cases/laboratory/fault_4m.json
    python3 docs/figures/laboratory.py out/fault_4m docs/figures/laboratory.svg

Reads `history.csv` and `events.csv` of the run, draws the mean shear stress over time between the measured stresses before and
after events, and prints a row an event: the drop of the mean stress, the mean slip and the time since the event before. Then the speeds of fronts,
measured and computed. Needs numpy and matplotlib.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

# Means and standard deviations over events 2 to 56 of FB03-087 (see cases/laboratory/README.md) [MPa]
BEFORE, AFTER = (0.6562, 0.0050), (0.6365, 0.0035)
LENGTH = 4.0
MEASURED = pathlib.Path(__file__).parent / "../../cases/laboratory/fault_4m_events.csv"

folder, target = map(pathlib.Path, sys.argv[1:])
with open(folder / "history.csv") as file:
    rows = list(csv.DictReader(file))
time, force, slip = (np.array([float(row[key]) for row in rows]) for key in ("time", "fault.tangential_force", "fault.mean_slip"))
stress = force / LENGTH
with open(folder / "events.csv") as file:
    events = [(float(row["onset"]), float(row["x"]), float(row["front_speed"])) for row in csv.DictReader(file)]
print("| onset [s] | after [s] | begins at [m] | drop [MPa] | slip [mm] | front [m/s] |\n|---|---|---|---|---|---|")
last = None
for onset, x, speed in events:
    # From where slip sets in to when its waves are gone.
    before, after = np.interp([onset - 2e-3, onset + 0.1], time, stress)
    slipped = np.diff(np.interp([onset - 2e-3, onset + 0.1], time, slip))[0]
    since = "" if last is None else f"{onset - last:.2f}"
    print(f"| {onset:.2f} | {since} | {x:.2f} | {before - after:.4f} | {1e3 * slipped:.4f} | {speed:.0f} |")
    last = onset

print("\n| fronts | events | mean [m/s] | from | to |\n|---|---|---|---|---|")
with open(MEASURED) as file:
    measured = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["front_m_per_s"]]
speeds = {
    f"measured, {name}": [float(row["front_m_per_s"]) for row in measured if row["start"] == start]
    for start, name in (("W", "from the west"), ("E", "from the east"))
}
speeds["computed, faster than 1 mm/s"] = [speed for _, _, speed in events]
for name, values in speeds.items():
    print(f"| {name} | {len(values)} | {np.mean(values):.0f} | {min(values):.0f} | {max(values):.0f} |")

plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
figure, panel = plt.subplots(figsize=(7, 3.2), layout="constrained")
for (mean, spread), name, color in ((BEFORE, "measured before events", "C3"), (AFTER, "measured after events", "C2")):
    panel.axhspan(mean - spread, mean + spread, color=color, alpha=0.25, lw=0, label=name)
# Of the waves after an event only the course remains.
keep = np.concatenate([[True], np.diff(np.floor(time / 0.01)) > 0])
panel.plot(time[keep], stress[keep], "k-", lw=0.9, label="computed")
panel.set(xlabel="time [s]", ylabel="mean shear stress [MPa]", ylim=(0.62, 0.68))
panel.legend(frameon=False, ncols=3, loc="upper left")
figure.savefig(target, metadata={"Date": None})
