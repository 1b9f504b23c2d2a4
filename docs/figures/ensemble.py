"""Slip fronts whose times are chaotic: ensembles of runs that differ in the numbering of their nodes alone.

    python3 docs/figures/ensemble.py run target/release/fecontact 1.25 20 out/ensemble     runs 20 on elements of 1.25 mm (goes on where it was)
    python3 docs/figures/ensemble.py compare out/ensemble docs/figures/ensemble.svg        tables and figure of all sizes there

A run is `cases/slip_front.json` on blocks whose corners begin elsewhere and turn the other way. Compared are the fronts that cross the
whole interface: force at the onset, time since the one before, and drop of the force, size against size by the Kolmogorov–Smirnov test of two samples.
The first one of a run stands apart: the same start leads to it, many numberings give it the same force, and it is no sample of a distribution.
Needs numpy, scipy and matplotlib.
"""

import csv
import json
import pathlib
import subprocess
import sys

LENGTH, HEIGHT, GROWTH, ROWS, PRESSURE = 120.0, 40.0, 1.1, 15, 5.0
# The longest halt of a front [s], and F_t/F_n behind one that has crossed
HALT, CROSSED = 0.01, 0.125
QUANTITIES = {"force": "F_t/F_n at the onset", "since": "time since the last [s]", "drop": "drop of F_t/F_n"}


def turned(block, turns, mirrored):
    """The same block, seen from another corner, or the other way round."""
    corners, (n, m), (g, h), sides = (block[key] for key in ("corners", "elements", "grading", "sides"))
    for _ in range(turns):
        corners, (n, m), (g, h), sides = corners[1:] + corners[:1], (m, n), (h, 1 / g), sides[1:] + sides[:1]
    if mirrored:
        corners, (n, m), (g, h), sides = corners[:1] + corners[:0:-1], (m, n), (h, g), sides[::-1]
    return {**block, "corners": corners, "elements": [n, m], "grading": [g, h], "sides": sides}


def mesh(size, number):
    """Both blocks on elements of this size; every number another numbering."""
    fine = round(1.25 / size)
    columns, rows, growth = 96 * fine, ROWS * fine, (GROWTH ** (1 / fine)) ** (ROWS * fine - 1)
    corners = lambda low, high: [[0, low], [LENGTH, low], [LENGTH, high], [0, high]]
    block = {"body": "block", "corners": corners(0, HEIGHT), "elements": [columns, rows], "grading": [1, growth],
             "sides": ["block_bottom", "block_right", "block_top", "block_left"]}
    base = {"body": "base", "corners": corners(-HEIGHT, 0), "elements": [columns, rows], "grading": [1, 1 / growth],
            "sides": ["base_bottom", "base_right", "base_top", "base_left"]}
    blocks = [turned(block, number % 4, number // 4 % 2), turned(base, (number + number // 8) % 4, number // 2 % 2)]
    return {"blocks": blocks if number % 2 else blocks[::-1]}


def run(program, size, count, folder):
    """The runs that are not there yet."""
    case = json.loads(pathlib.Path("cases/slip_front.json").read_text())
    case["output"] = {"every": 1000, "fields": False, "report": False, "fronts": case["output"]["fronts"]}
    for number in range(int(count)):
        out = pathlib.Path(folder) / f"{size}_{number:02}"
        summary = out / "summary.json"
        if summary.exists() and json.loads(summary.read_text())["status"] == "completed":
            continue
        out.mkdir(parents=True, exist_ok=True)
        path = out / "case.json"
        path.write_text(json.dumps({**case, "mesh": mesh(float(size), number)}))
        subprocess.run([program, "run", path, "--out", out, "--quiet", "--threads", "1"], check=True)
        print(out, len(crossing(out)), "crossing", flush=True)


def crossing(folder):
    """Force, time since the last and drop of the fronts that cross, halts on the way included: they leave F_t/F_n near μ_k = 0.1,
    while fronts that stop leave 0.14 and more.
    """
    rows = list(csv.DictReader(open(folder / "history.csv")))
    history = [(float(row["time"]), float(row["interface.tangential_force"]) / (PRESSURE * LENGTH)) for row in rows]
    spans = []
    for event in csv.DictReader(open(folder / "events.csv")):
        onset, end = float(event["onset"]), float(event["onset"]) + float(event["duration"])
        if spans and onset - spans[-1][1] < HALT:
            spans[-1][1] = max(end, spans[-1][1])
        else:
            spans.append([onset, end])
    events, last = [], None
    for onset, end in spans:
        before = [force for time, force in history if time <= onset][-1]
        after = min(force for time, force in history if onset <= time <= end + HALT)
        if after < CROSSED:
            events.append({"force": before, "since": None if last is None else onset - last, "drop": before - after})
            last = onset
    return events


def compare(folder, target):
    """Tables and figure of all sizes."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    import numpy as np
    from scipy.stats import ks_2samp

    runs = {}
    for out in sorted(pathlib.Path(folder).iterdir()):
        if (out / "summary.json").exists() and json.loads((out / "summary.json").read_text())["status"] == "completed":
            runs.setdefault(float(out.name.split("_")[0]), []).append(crossing(out))
    sizes = sorted(runs, reverse=True)
    plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
    figure, panels = plt.subplots(1, 3, figsize=(9, 2.8), layout="constrained", sharey=True)
    print("| element [mm] | runs | F_t/F_n at the onset of the first | fronts after it | " + " | ".join(f"{name}: mean ± deviation" for name in QUANTITIES.values()) + " |")
    print("|" + "---|" * (4 + len(QUANTITIES)))
    later = {size: [event for events in runs[size] for event in events[1:]] for size in sizes}
    samples = {size: {key: np.array([event[key] for event in later[size]]) for key in QUANTITIES} for size in sizes}
    for size in sizes:
        first = sorted(f"{events[0]['force']:.3f}" for events in runs[size])
        told = ", ".join(f"{first.count(force)} × {force}" for force in dict.fromkeys(first))
        cells = [f"{values.mean():.3f} ± {values.std():.3f}" for values in samples[size].values()]
        print(f"| {size} | {len(runs[size])} | {told} | {len(later[size])} | {' | '.join(cells)} |")
    for coarse, fine in zip(sizes, sizes[1:]):
        told = [f"{key} {ks_2samp(samples[coarse][key], samples[fine][key]).pvalue:.2f}" for key in QUANTITIES]
        print(f"\n{coarse} against {fine} mm: p = {', '.join(told)}")
    for panel, (key, name) in zip(panels, QUANTITIES.items()):
        for size in sizes:
            values = np.sort(samples[size][key])
            panel.step(values, np.arange(1, len(values) + 1) / len(values), where="post", label=f"{size} mm")
        panel.set(xlabel=name, ylim=(0, 1))
    panels[0].set_ylabel("share of the fronts after the first")
    panels[0].legend(frameon=False)
    figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    {"run": run, "compare": compare}[sys.argv[1]](*sys.argv[2:])
