"""A law fitted to a record of direct shear with a rest: the record, the fit, and what the record tells of each parameter.

    target/python/bin/python docs/figures/calibration.py docs/figures/calibration.svg

The record of `python/notebooks/calibration.ipynb`: it is made by a law whose parameters are known, with noise. Prints the table of
the fit. Needs the package (`pip install ./python`).
"""

import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

import fecontact as fc
from fecontact.calibration import Interface

FREE = ["mu_s", "mu_k", "r", "kappa", "xi"]
NAMES = ["$\\mu_s$", "$\\mu_k$", "$r$", "$\\kappa$", "$\\xi$"]
truth = {"mu_s": 0.62, "mu_k": 0.45, "alpha_t": 400.0, "r": 60.0, "kappa": 4.0, "xi": 0.02}

# Slide for 20 s, rest for 40 s, slide again twice as fast; the pressure is 2 MPa, then 3 MPa.
time = np.linspace(0, 80, 1201)
rate = np.select([time <= 20, time <= 60], [0.05, 0.0], 0.1)
slip = np.concatenate([[0], np.cumsum(rate[1:] * np.diff(time))])
pressure = np.where(time <= 70, 2.0, np.minimum(3.0, 2.0 + 0.5 * (time - 70)))
exact = fc.law("super_subloading", **truth).drive(time, slip, pressure).traction
measured = exact + 0.02 * np.random.default_rng(1).normal(size=time.size)
short = time <= 20
fits = {"the whole record": slice(None), "its first slide alone": short}

plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
figure, (record, told) = plt.subplots(1, 2, figsize=(9, 3.4), width_ratios=[3, 2], layout="constrained")
record.plot(time, measured, ".", ms=1, color="0.6", label="measured", rasterized=True)
for k, (name, part) in enumerate(fits.items()):
    found = fc.fit(Interface(time[part], slip[part], pressure[part], measured[part]), free=FREE, alpha_t=truth["alpha_t"])
    print(f"{name}:\n{found}\n")
    if k == 0:
        record.plot(time, found.law.drive(time, slip, pressure).traction, lw=1, label="fitted")
    table = found.table.assign(truth=[truth[name] for name in found.table.index]).loc[FREE]
    # An interval without an end leaves the picture.
    value, low, high = ((table[column] / table.truth).clip(1e-6, 1e6) for column in ("value", "low", "high"))
    place = np.arange(len(FREE)) + 0.2 * k - 0.1
    told.errorbar(place, value, [value - low, high - value], fmt="os"[k], mfc="none", capsize=3, label=name)
told.axhline(1, color="k", lw=0.6)
told.set(ylabel="found over true, 95 %", yscale="log", ylim=(0.05, 20))
told.set_xticks(range(len(FREE)), NAMES)
record.set(xlabel="time: slide, rest, slide faster [s]", ylabel="traction [MPa]", title="record and fit")
told.set_title("what each record tells")
record.legend(frameon=False)
told.legend(frameon=False, fontsize=8, loc="lower left")
figure.savefig(sys.argv[1], metadata={"Date": None}, dpi=150)
