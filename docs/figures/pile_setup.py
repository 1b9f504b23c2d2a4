"""A driven pile is pulled after longer and longer waits: its capacity, what of it water and healing gave, and the tractions on its shaft.

    python3 docs/figures/pile_setup.py target/release/fecontact cases/pile_setup.png

Runs cases/pile_setup.json in parts: it is driven once, waits with and without healing, and is pulled after every wait. Needs numpy and matplotlib.
"""

import copy
import pathlib
import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.tri import Triangulation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from results import Run, committed

program, target = sys.argv[1:]
HOUR, DAY = 3600, 86400
WAITS = {"an hour": HOUR, "six hours": 6 * HOUR, "a day": DAY, "a week": 7 * DAY, "a month": 30 * DAY, "a year": 365 * DAY, "ten years": 3650 * DAY}
DRAWN = {"an hour": "C0", "a week": "C1", "ten years": "C2"}
WHOLE = committed("cases/pile_setup.json")
DRIVE, WAIT, PULL = WHOLE["steps"]


def part(steps, after=None, healing=True):
    case = copy.deepcopy(WHOLE)
    case |= {"steps": copy.deepcopy(steps), "output": {"every": 1000, "report": False}}
    if after:
        case["begin_with"] = str(after.folder)
    if not healing:
        case["contacts"]["shaft"]["friction"]["xi"] = 0
    return Run(program, case)


def along(run):
    """Depth, pressure and traction of the points of the shaft at the end."""
    found = run.frame()
    order = np.argsort(found["places"][:, 1])
    return [values[order] for values in (found["places"][:, 1], found["pressure"], found["traction"])]


driven = part([DRIVE])
capacities, shafts = {}, {}
for healing in (True, False):
    run, waited, found = driven, 0, []
    for name, wait in {"none": 0, **WAITS}.items():
        if wait:
            step = {**WAIT, "duration": wait - waited, "dt": {**WAIT["dt"], "max": max(WAIT["dt"]["initial"], (wait - waited) / 5)}}
            run, waited = part([step], run, healing), wait
        # What has not drained yet has no drainage to end.
        pulled = part([PULL if wait else {**PULL, "drainage": []}], run, healing)
        held = pulled.history["shaft.tangential_force"]
        best = held.argmax()
        found.append(held[best])
        shafts[name, healing] = along(run), along(pulled)
        ratio = held[best] / pulled.history["shaft.normal_force"][best]
        print(f"{name:10} healing {healing!s:5}: pulled {held[best]:6.1f}, friction {ratio:.4f}, before that normal force {run.last('shaft.normal_force'):6.1f}, water {run.last('shaft.fluid_force'):6.1f}")
    capacities[healing] = np.array(found)

figure, (field, normal, shear, gained) = plt.subplots(1, 4, figsize=(13, 4.6), width_ratios=[0.8, 1, 1, 1.7], layout="constrained")
solid = driven.frame("solid")
places, ends = solid["places"], np.r_[0, solid["offsets"]]
cells = [solid["connectivity"][start:end][:4] for start, end in zip(ends, ends[1:])]
wet = [cell for cell in cells if np.isfinite(solid["pore_pressure"][cell]).all()]
sides = np.array([[cell[k] for k in corners] for cell in wet for corners in ((0, 1, 2), (0, 2, 3))])
water = field.tripcolor(Triangulation(places[:, 0], places[:, 1], sides), np.nan_to_num(solid["pore_pressure"]), shading="gouraud", cmap="viridis")
side = places[[k for cell in cells if not np.isfinite(solid["pore_pressure"][cell]).all() for k in cell]]
edge = side[np.argsort(side[:, 1])]
edge = np.array([[edge[np.isclose(edge[:, 1], y), 0].max(), y] for y in np.unique(edge[:, 1].round(6))])
field.fill_betweenx(edge[:, 1], 0, edge[:, 0], color="grey")
field.set(xlim=(0, 2), ylim=(-10, 0.5), xlabel="r [m]", ylabel="y [m]", title="excess pressure, driven [kPa]")
figure.colorbar(water, ax=field)
for name, colour in DRAWN.items():
    (y, pressure, _), (below, _, traction) = shafts[name, True]
    normal.plot(pressure, y, colour, label=name)
    shear.plot(traction, below, colour)
    shear.plot(shafts[name, False][1][2], shafts[name, False][1][0], colour, linestyle="--")
normal.plot(shafts["none", True][0][1], shafts["none", True][0][0], "k", label="driven")
normal.set(xlabel="effective pressure p [kPa]", title="on the shaft after", ylim=(-8.2, 0.5))
normal.legend(frameon=False, loc="upper right")
shear.plot([], [], "grey", linestyle="--", label="without healing")
shear.set(xlabel="shear q [kPa]", title="at the end of the pull", ylim=(-8.2, 0.5))
shear.legend(frameon=False, loc="upper right")
days = np.array(list(WAITS.values())) / DAY
at_once = capacities[False][0]
water, all_of_it = capacities[False][1:], capacities[True][1:]
gained.fill_between(days, 0, at_once, color="0.85", label="at once")
gained.fill_between(days, at_once, water, color="C0", alpha=0.5, label="by water that leaves")
gained.fill_between(days, water, all_of_it, color="C1", alpha=0.5, label="by healing")
gained.plot(days, all_of_it, "k.-")
gained.set(xscale="log", xlabel="wait [d]", title="capacity [kN]", ylim=0, xlim=(days[0], days[-1]))
gained.legend(frameon=False, loc="upper left")
figure.savefig(target, dpi=90)
