"""A patch that breaks again and again: slip rate over place and the rows of the results, and slip over time within and outside the patch.

    fecontact run cases/cycle.json
    python3 docs/figures/cycle.py out/cycle cases/cycle.png

Needs the package (pip install ./python).
"""

import sys

import matplotlib

matplotlib.use("agg")
import fecontact as fc
import matplotlib.pyplot as plt
import numpy as np

folder, target = sys.argv[1:]
YEAR = 365.25 * 86400.0

result = fc.Result.open(folder)
fault = result.interface["fault"]
years = fault.time.values / YEAR
figure, (rate, slip) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
fc.plot.interface(result, "fault", "slip_rate", x="x", y="row", ax=rate, cmap="inferno")
rows = rate.get_yticks().astype(int)
rate.set_yticks(rows, [f"{years[row]:.2f}" for row in rows])
rate.set(ylabel="time [years], rows of the results evenly spaced", title="")
for place, told in ((0.0, "in the middle of the patch"), (-7500.0, "where the fault creeps")):
    point = int(np.argmin(np.abs(fault.x.values - place)))
    slip.plot(years, fault.slip.values[:, point], label=told)
slip.plot(years, 1e-9 * years * YEAR, "k:", linewidth=1, label="displacement of the sides")
slip.set(xlabel="time [years]", ylabel="slip [m]")
slip.legend()
figure.savefig(target, dpi=100)
