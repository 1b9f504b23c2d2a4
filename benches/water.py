"""What water that flows costs: runs of bodies with it and of the same bodies without, alternating, on one thread.

    python3 benches/water.py target/release/fecontact [NAME …]

prints the processor time of a solve, or of an explicit increment, with its ratio to that of the dry twin; names pick rows.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median

# Pairs of runs
RUNS = 5

WATER = {"bulk_modulus": 20, "porosity": 0.5, "permeability": 0.01, "unit_weight": 1}


def block(kind, name, elements, low, high):
    """A rectangle of so many elements, with names of its lower and upper side."""
    corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    return {"body": name, "kind": kind, "corners": corners, "elements": elements, "sides": [f"{name}_bottom", f"{name}_right", f"{name}_top", f"{name}_left"]}


def body(law, wet, **more):
    own = {"material": {"model": law, "E": 0.9, "nu": 0.2, "density": 1}, **more}
    return {**own, "pore_fluid": WATER} if wet else own


def consolidation(law, wet):
    """A strip on a square of 52 × 52 Q8, 19 456 unknowns with the pressures: static increments, each longer than the one before."""
    step = {"name": "load", "duration": 20, "dt": {"initial": 0.01, "max": 4},
            "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}],
            "loads": [{"on": "soil_top", "dead_pressure": "0.05*(1-exp(-t))*max(0, 1 - x*x)"}]}
    if wet:
        step["drainage"] = [{"on": "soil_top", "pressure": 0}]
    return {"mesh": {"blocks": [block("Q8", "soil", [52, 52], [0, -4], [4, 0])]}, "bodies": {"soil": body(law, wet)}, "steps": [step]}


def shaken(law, wet, cut, increments):
    """100 × 50 Q4 under a load that swings, in one body or in two that are pressed together: explicit increments of a given length."""
    blocks = [block("Q4", "low", [100, 25 if cut else 50], [0, -1], [2, -0.5 if cut else 0])]
    stressed = {"initial_stress": {"components": {"xx": 0, "yy": -0.1, "zz": 0, "xy": 0}}} if cut else {}
    bodies, top = {"low": body(law, wet, **stressed)}, "low_top"
    supports = [{"on": "low_bottom", "ux": 0, "uy": 0}]
    case = {}
    if cut:
        blocks.append(block("Q4", "high", [90, 25], [0, -0.5], [2, 0]))
        bodies["high"], top = body(law, wet, **stressed), "high_top"
        case["contacts"] = {"cut": {"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.3}, "initial": {"pressure": 0.1}}}
    dt = 5e-4
    step = {"name": "load", "duration": increments * dt, "scheme": {"explicit": {}}, "dt": {"initial": dt, "max": dt}, "supports": supports,
            "loads": [{"on": top, "dead_pressure": f"{0.1 if cut else 0}+0.01*(1-cos(3*t))"}]}
    if wet:
        step["drainage"] = [{"on": top, "pressure": 0}]
    return {**case, "mesh": {"blocks": blocks}, "bodies": bodies, "steps": [step], "output": {"interval": 0.2 * increments * dt}}


CASES = {
    "static Q8, 20k unknowns, hencky": lambda wet: consolidation("hencky", wet),
    "static Q8, 20k unknowns, linear": lambda wet: consolidation("linear", wet),
    "explicit, linear": lambda wet: shaken("linear", wet, False, 400),
    "explicit, hencky": lambda wet: shaken("hencky", wet, False, 200),
    "explicit, linear, contact": lambda wet: shaken("linear", wet, True, 200),
}


def processor_time(program, case, folder):
    """Processor seconds of a run, and its solves or explicit increments."""
    path, out = folder / "case.json", folder / "out"
    case.setdefault("output", {}).update({"fields": False, "report": False, "checkpoint": 1e9})
    path.write_text(json.dumps(case))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "run", path, "--out", out, "--quiet", "--threads", "1"], check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads((out / "summary.json").read_text())
    count = summary["newton_iterations"] or summary["increments"]
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, count


def main():
    program, names = os.path.abspath(sys.argv[1]), sys.argv[2:]
    print("| run | ms dry | ms wet | wet/dry |\n|---|---|---|---|")
    for name, case in CASES.items():
        if names and not any(part in name for part in names):
            continue
        each = {False: [], True: []}
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(RUNS):
                for wet in (False, True):
                    seconds, count = processor_time(program, case(wet), Path(folder))
                    each[wet].append(1e3 * seconds / count)
        ratio = median(wet / dry for dry, wet in zip(each[False], each[True]))
        print(f"| {name} | {median(each[False]):.2f} | {median(each[True]):.2f} | {ratio:.2f} |", flush=True)


main()
