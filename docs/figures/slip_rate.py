"""Slip rate of a contact over place and time: of the whole run, or of its largest events, each in a time of its own beside the slopes
of the wave speeds.

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

folder, target, *rest = sys.argv[1:]
result = fc.Result.open(folder)
contact = result.contacts[0]
high = float(np.abs(result.interface[contact].slip_rate.values).max())
low = 1e-5 * high
look = {"cmap": "inferno_r", "norm": LogNorm(low, high), "rasterized": True}


def whole():
    figure, panel = plt.subplots(figsize=(8, 5), layout="constrained")
    fc.plot.interface(result, contact, "slip_rate", ax=panel, **look)
    panel.set(title="")
    return figure


def of_events(count):
    data, events = result.interface[contact], result.events
    events = events[events["contact"] == contact]
    largest = events.loc[events["mean_slip"].abs().nlargest(count).index].sort_values("onset")
    order = np.argsort(data.position.values, kind="stable")
    place, times, rates = data.position.values[order], data.time.values, np.abs(data.slip_rate.values[:, order])
    length, time = (f" [{result.units[of]}]" if of in result.units else "" for of in ("length", "time"))
    across = min(3, len(largest))
    lines = -(-len(largest) // across)
    figure, panels = plt.subplots(lines, across, figsize=(3.7 * across, 3.4 * lines), layout="constrained", squeeze=False)
    for panel in panels.flat[len(largest) :]:
        panel.set_axis_off()
    for k, (panel, (_, event)) in enumerate(zip(panels.flat, largest.iterrows()), 1):
        begin, end = event["onset"] - 0.1 * event["duration"], event["onset"] + event["duration"]
        rows = np.flatnonzero((times >= begin) & (times <= end))
        shown = np.maximum(rates[rows], low)
        colours = panel.pcolormesh(place, times[rows] - event["onset"], shown, shading="nearest", **look)
        for name, speed, dashes in zip(("c_R", "c_s", "c_p"), result.summary["wave_speeds"], ("-", "--", ":")):
            ends = np.clip([event["position"] - speed * event["duration"], event["position"] + speed * event["duration"]], place[0], place[-1])
            way = np.array([ends[0], event["position"], ends[1]])
            panel.plot(way, np.abs(way - event["position"]) / speed, "C0", ls=dashes, lw=1, label=name)
        panel.set(title=f"{k}: onset {event['onset']:.7g} {time[2:-1]}",
                  xlabel="position" + length, ylabel="time after it" + time, ylim=(begin - event["onset"], event["duration"]))
    panels[0, 0].legend()
    figure.colorbar(colours, ax=panels, label="slip rate" + (f" [{length[2:-1]}/{time[2:-1]}]" if length and time else ""), shrink=0.7)
    return figure


figure = of_events(int(rest[1])) if rest[:1] == ["--events"] else whole()
figure.savefig(target, dpi=110)
