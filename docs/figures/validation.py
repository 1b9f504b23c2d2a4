"""Figures of the pages in docs/validation that runs of seconds make, each against its reference.

    python3 docs/figures/validation.py target/release/fecontact docs/figures

Writes hertz.svg, partial_slip.svg, greco.svg, wedge.svg, coulomb_drag.svg and rings.svg. Needs numpy and matplotlib.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import greco_exact
from closed_forms import tube
from problems import along, ellipse, greco_bottom, partial_slip_of
from results import Run, committed

program, target = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})


def saved(figure, name):
    figure.savefig(target / f"{name}.svg", metadata={"Date": None})


def hertz():
    a, p0 = 6.2146, 3585.4
    figure, panel = plt.subplots(figsize=(5, 3.2), layout="constrained")
    place = np.linspace(0, a, 400)
    panel.plot(place, p0 * ellipse(place, a), "k-", lw=1, label="Hertz")
    for case, name, mark in (("hertz_q8_small_strain", "small strain, Q8", "o"), ("hertz_q8", "large displacements, Q8", "s")):
        x, p = along(Run(program, committed(f"cases/validation/{case}.json")))
        panel.plot(x, p, mark, mfc="none", ms=4, label=name)
    panel.set(xlabel="x [mm]", ylabel="pressure [MPa]", xlim=(0, None), ylim=(0, None))
    panel.legend(frameon=False)
    saved(figure, "hertz")


def partial_slip():
    of = partial_slip_of(Run(program, committed("cases/validation/mindlin.json")))
    a, c, p0 = of["a"], of["c"], of["p0"]
    place = np.linspace(-a, a, 2001)
    figure, panel = plt.subplots(figsize=(5, 3.2), layout="constrained")
    panel.plot(place / a, 0.3 * ellipse(place, a), "k--", lw=0.8, label="μ p/p₀, Hertz")
    panel.plot(place / a, 0.3 * (ellipse(place, a) - c / a * ellipse(place, c)), "k-", lw=1, label="q/p₀, Cattaneo and Mindlin")
    panel.plot(of["x"] / a, 0.3 * of["p"] / p0, "s", mfc="none", ms=3, label="μ p/p₀")
    panel.plot(of["x"] / a, of["q"] / p0, "o", mfc="none", ms=3, label="q/p₀")
    panel.set(xlabel="x/a", ylim=(0, 0.4))
    panel.legend(frameon=False, ncols=2, fontsize=8)
    saved(figure, "partial_slip")


def greco():
    run, x, u = greco_bottom(program)
    figure, (panel, under) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
    panel.plot(x, u, "-", lw=1, label="here")
    panel.plot([0, 1.25, 5, 7.5, 11.25], [28.65, 27.27, 22.90, 19.84, 15.0], "ko", mfc="none", label="mean of several codes")
    panel.set(xlabel="x along the bottom [mm]", ylabel="$u_x$ [µm]", xlim=(-0.5, 40), ylim=(0, None))
    panel.legend(frameon=False)
    frame, exact = run.frame("contact"), greco_exact.bottom(40)
    order = np.argsort(frame["Points"][:, 0])[:-1]  # without the supported corner
    for name, field, reference, colour in (("p", "pressure", exact[2], "C0"), ("q", "traction", exact[3], "C1")):
        under.plot(exact[0], reference, "-", lw=1, color=colour, label=f"{name}, states met exactly")
        under.plot(x[order], frame[field][order], "o", mfc="none", ms=3, color=colour, label=f"{name} here")
    under.set(xlabel="x along the bottom [mm]", ylabel="[MPa]", xlim=(-0.5, 40), ylim=(0, None))
    under.legend(frameon=False, fontsize=8)
    saved(figure, "greco")


def wedge():
    run = Run(program, committed("cases/validation/wedge.json"))
    figure, panel = plt.subplots(figsize=(5, 2.8), layout="constrained")
    push = run.history["time"] > 1
    panel.axhline(0.4 / 0.97, color="k", lw=0.8, label="equilibrium")
    panel.plot(run.history["block_left.ux"][push], run.history["block_left.fx"][push] / 25, ".-", ms=4, lw=0.8, label="here")
    panel.set(xlabel="displacement of the block", ylabel="F/G", ylim=(0, 0.5))
    panel.legend(frameon=False, loc="lower right")
    saved(figure, "wedge")


def coulomb_drag():
    run = Run(program, committed("cases/coulomb_drag_5k.json"))
    figure, panel = plt.subplots(figsize=(5, 3.2), layout="constrained")
    increment = np.arange(1, 26)
    panel.plot(increment, np.abs(run.history["block_top.fy"]) / 1e3, ".-", lw=0.8, label="F_n")
    panel.plot(increment, np.abs(run.history["block_top.fx"]) / 1e3, ".-", lw=0.8, label="F_t")
    panel.plot([5, 25, 25], [990.413, 961.231, 288.252], "ko", mfc="none", label="GetFEM, CalculiX")
    panel.set(xlabel="increment: 5 press, 20 drag", ylabel="force on the top [10³]", ylim=(0, None))
    panel.legend(frameon=False)
    saved(figure, "coulomb_drag")


def rings():
    run, exact, (a, b) = tube(program)
    frame = run.frame("solid")
    row = np.abs(frame["Points"][:, 1] - 0.25) < 1e-9
    place = np.linspace(a, b, 200)
    figure, panel = plt.subplots(figsize=(5, 2.8), layout="constrained")
    panel.plot(place, 1e3 * exact(place), "k-", lw=1, label="Lamé")
    panel.plot(frame["Points"][row, 0], 1e3 * frame["displacement"][row, 0], "o", mfc="none", ms=4, label="here")
    panel.set(xlabel="r", ylabel="10³ $u_r$")
    panel.legend(frameon=False)
    saved(figure, "rings")


for draw in (hertz, partial_slip, greco, wedge, coulomb_drag, rings):
    draw()
