"""Slip rate of a contact over place and time: of the whole run, in which every cell shows the fastest slip within it, or of its largest
events, each in a time of its own beside the slopes of the wave speeds.

    python3 docs/figures/slip_rate.py out/tpv3 docs/figures/tpv3.svg
    python3 docs/figures/slip_rate.py out/slip_front cases/slip_front_run.png
    python3 docs/figures/slip_rate.py out/slip_front cases/slip_front.png --events 6

Needs the package (pip install ./python).
"""

import sys

import matplotlib

matplotlib.use("agg")
import fecontact as fc
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

# Cells of the whole run, and decades below the fastest slip that have a colour.
CELLS, DECADES = 240, 5

folder, target, *rest = sys.argv[1:]
result = fc.Result.open(folder)
contact = result.contacts[0]
data = result.interface[contact]
order = np.argsort(data.position.values, kind="stable")
place, times = data.position.values[order], data.time.values
rates = np.abs(data.slip_rate.values[:, order])
low, high = rates.max() * 10.0**-DECADES, rates.max()
length, time = (result.units.get(of, "") for of in ("length", "time"))


def drawn(panel, heights, values):
    look = {"cmap": "inferno_r", "norm": LogNorm(low, high), "rasterized": True, "shading": "nearest"}
    panel.set(xlabel=f"position along the slave [{length}]")
    return panel.pcolormesh(place, heights, np.ma.masked_less(values, low), **look)


def whole():
    figure, panel = plt.subplots(figsize=(8, 5), layout="constrained")
    edges = np.linspace(0, times[-1], CELLS + 1)
    # A row stands for the time since the row before.
    first, last = np.searchsorted(times, edges[:-1], "right"), np.searchsorted(times, edges[1:])
    cells = [rates[a : min(b, times.size - 1) + 1].max(axis=0) for a, b in zip(first, last)]
    colours = drawn(panel, 0.5 * (edges[1:] + edges[:-1]), np.array(cells))
    panel.set(ylabel=f"time [{time}]")
    figure.colorbar(colours, label=f"slip rate [{length}/{time}]")
    return figure


def of_events(count):
    events = result.events[result.events["contact"] == contact]
    largest = events.loc[events["mean_slip"].abs().nlargest(count).index].sort_values("onset")
    across = min(3, len(largest))
    lines = -(-len(largest) // across)
    figure, panels = plt.subplots(lines, across, figsize=(3.7 * across, 3.3 * lines), layout="constrained", squeeze=False)
    for panel in panels.flat[len(largest) :]:
        panel.set_axis_off()
    power = int(np.floor(np.log10(largest["duration"].median()) / 3)) * 3
    scaled = {0: "", -3: "m", -6: "µ", -9: "n"}.get(power, f"1e{power} ") + time
    for panel, (_, event) in zip(panels.flat, largest.iterrows()):
        onset, duration, origin = event["onset"], event["duration"], event["position"]
        rows = np.flatnonzero((times >= onset - 0.1 * duration) & (times <= onset + duration))
        colours = drawn(panel, (times[rows] - onset) / 10.0**power, rates[rows])
        for name, speed, dashes in zip(("c_R", "c_s", "c_p"), result.summary["wave_speeds"], ("-", "--", ":")):
            ends = np.clip([origin - speed * duration, origin, origin + speed * duration], place[0], place[-1])
            panel.plot(ends, np.abs(ends - origin) / speed / 10.0**power, "C0", ls=dashes, lw=1, label=name)
        panel.set(title=f"event {event['event']}: {onset:.6g} {time}", ylabel=f"time since onset [{scaled}]")
    panels.flat[0].legend()
    figure.colorbar(colours, ax=panels, label=f"slip rate [{length}/{time}]", shrink=0.7)
    return figure


figure = of_events(int(rest[1])) if rest[:1] == ["--events"] else whole()
figure.savefig(target, dpi=110)
