"""Tables of docs/validation/water.md: python3 docs/faults_and_water.py PROGRAM NAME prints one.

Needs numpy.
"""

import sys
from math import erfc, exp, log10, pi, sqrt

import numpy as np

from results import Run, text_of

DAY = 86400.0
# Slip at x = 0 after 100 and 365 days [m], and the largest slip rate there [log10 m/s] with its time [d]: boundary elements on a graded
# grid, extrapolated, and CYCLAPS.
BP6 = {"ageing": [0.17511, 0.20683, -6.758, 89.08], "slip": [0.24678, 0.27206, -5.9094, 42.41]}
# The source of BP6: diffusivity [m²/s], rate over storage and the root of the diffusivity [Pa/√s]
DIFFUSIVITY, RATE, OFF = 0.1, 1.25e-6 / (1e-8 * 0.1 * sqrt(0.1)), 100 * DAY


def grading(length, count, first):
    """Ratio of the last of so many lengths to the first, which grow in a geometric series to a sum."""
    low, high = 1.0 + 1e-12, 3.0
    for _ in range(200):
        ratio = (low + high) / 2
        low, high = (ratio, high) if first * (ratio**count - 1) / (ratio - 1) < length else (low, ratio)
    return low ** (count - 1)


def sides_of_a_fault(edge, core, far, count, up):
    """Blocks of two bodies along a fault on y = 0: even within the core, graded to the far sides."""
    aside, away, blocks = grading(far - core, count, edge), grading(far, up, edge), []
    for body, sign in [("lower", -1), ("upper", 1)]:
        for [low, high], parts, ratio in [([-far, -core], count, 1 / aside), ([-core, core], round(2 * core / edge), 1.0), ([core, far], count, aside)]:
            corners = [[low, 0], [high, 0], [high, sign * far], [low, sign * far]]
            sides = [f"{body}_fault", None, f"{body}_far", None]
            blocks.append({"body": body, "corners": corners, "elements": [parts, up], "grading": [ratio, away], "sides": sides})
    return {"blocks": blocks}


def source(t):
    """Pressure of a source at x = 0 from a time on, as an expression."""
    return f"sqrt({t})*(exp(-x^2/({4 * DIFFUSIVITY}*{t}))/sqrt(pi) - abs(x)/sqrt({4 * DIFFUSIVITY}*{t})*erfc(abs(x)/sqrt({4 * DIFFUSIVITY}*{t})))"


def bp6(edge, evolution):
    """SEAS BP6-QD-A (ageing) and -S (slip): a fault that strengthens with rate, into which water is injected for 100 days."""
    shear, wave = 2670 * 3464.0**2, 3464.0
    # G* = G/(1 − ν) in the plane stands for G across it.
    modulus, poisson = 0.75 * shear, 0.25
    material = {"model": "linear", "E": 2 * modulus * (1 + poisson), "nu": poisson, "density": 2670}
    alpha_t = 100 * shear / edge
    friction = {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-6, "a": 0.007, "b": 0.005, "D_c": 0.004, "theta": 10**10.6123183191346,
                "evolution": evolution, "alpha_t": alpha_t}
    water = f"max(0, {RATE}*({source('max(t, 1e-9)')} - {source(f'max(t - {OFF}, 1e-9)')}))"
    scheme, dt = {"quasi_dynamic": {"tolerance": 1e-5, "every": 1}}, {"initial": 10}
    return {
        "title": "BP6",
        "mesh": sides_of_a_fault(edge, 6000.0, 240e3, 40, 60),
        "bodies": {"lower": {"material": material}, "upper": {"material": material}},
        "contacts": {"fault": {
            "slave": "upper_fault", "master": "lower_fault", "sliding": "small", "radiation_damping": shear / (2 * wave), "friction": friction,
            "along": {"law": [{"where": "abs(x) - 20000", "friction": {"law": "prescribed", "slip_rate": 0, "alpha_t": alpha_t}}]},
            "fluid_pressure": water, "initial": {"pressure": 50e6, "traction": 29.2e6, "balanced": True}}},
        "steps": [
            {"name": "inject", "duration": OFF, "scheme": scheme, "dt": dt,
             "supports": [{"on": "lower_far", "ux": 0, "uy": 0}, {"on": "upper_far", "ux": 0, "uy": 0}]},
            {"name": "spread", "duration": 265 * DAY, "scheme": scheme, "dt": dt}],
        "output": {"fields": False, "report": False},
    }


def bp6_table(program):
    """Slip and largest slip rate of BP6 on elements that are halved."""
    rows = [["state law", "elements [m]", "time steps", "slip after 100 d [m]", "after 365 d [m]", "largest log₁₀ V", "at [d]"]]
    for evolution in ["ageing", "slip"]:
        for edge in [250.0, 125.0, 62.5] if evolution == "ageing" else [125.0, 62.5]:
            run = Run(program, bp6(edge, evolution))
            time, x = run.history["time"], run.interface("fault.x")
            middle = np.abs(x if x.ndim == 1 else x[0]).argmin()
            slip, rate = (run.interface(f"fault.{name}")[:, middle] for name in ["slip", "slip_rate"])
            slip, rate, peak = slip[-len(time):], np.abs(rate[-len(time):]), np.abs(rate[-len(time):]).argmax()
            at = abs(slip[np.abs(time - OFF).argmin()])
            end, reference = abs(slip[-1]), BP6[evolution]
            off = [f"{value:.5f} ({100 * (value / reference - 1):+.2f} %)" for value, reference in [(at, reference[0]), (end, reference[1])]]
            rows.append([evolution, f"{edge:g}", str(len(time)), *off, f"{log10(rate[peak]):.3f}", f"{time[peak] / DAY:.2f}"])
        slips = [f"{value:.5f}" for value in BP6[evolution][:2]]
        rows.append([evolution, "reference", "", *slips, f"{BP6[evolution][2]:.3f}", f"{BP6[evolution][3]:.2f}"])
    return rows


def along(run, x, name):
    """Places of the points of the fault over a length, ascending, with an array at the end of the run."""
    x = run.interface(f"fault.{x}")
    x, values = x if x.ndim == 1 else x[0], run.interface(f"fault.{name}")[-1]
    order = np.argsort(x)
    return x[order], np.abs(values[order])


def injection(ratio, half):
    """A fault of constant friction whose middle is held at a pressure: T, the half-length of its crack at the end."""
    diffusivity, time, friction, pressure, water = 0.1, 2.0, 0.6, 1e-3, 5e-4
    mesh = sides_of_a_fault(half / 16, 1.5 * half, 60 * half, 14, 18)
    for block in mesh["blocks"]:
        block["kind"] = "Q8"
    body = {"material": {"model": "linear", "E": 2.5, "nu": 0.25}}
    return {
        "title": "self-similar injection", "mesh": mesh, "bodies": {"lower": body, "upper": body},
        "contacts": {"fault": {
            "slave": "upper_fault", "master": "lower_fault", "sliding": "small", "friction": {"law": "coulomb", "mu": friction},
            "fluid_pressure": f"{water}*erfc((abs(x) + 1e-9)/(2*sqrt({diffusivity}*t + 1e-30)))",
            "initial": {"pressure": pressure, "traction": friction * (pressure - ratio * water), "balanced": True}}},
        "steps": [{"name": "inject", "duration": time, "dt": {"initial": 0.2, "max": 0.2},
                   "supports": [{"on": "lower_far", "ux": 0, "uy": 0}, {"on": "upper_far", "ux": 0, "uy": 0}]}],
        "output": {"exact": True, "fields": False, "report": False},
    }


def flowing(case, half, per_slip=0.0):
    """The same whose water flows along the fault from its middle, where the pressure is held; a mesh that is finer where only water goes."""
    mesh = sides_of_a_fault(half / 16, 4 * half, 60 * half, 20, 18)
    for block in mesh["blocks"]:
        block["kind"] = "Q8"
    case["mesh"] = mesh
    case["contacts"]["fault"]["fluid_pressure"] = {"flow": {
        "storage": 1, "transmissivity": 0.1, "viscosity": 1, "per_slip": per_slip, "wells": [{"at": [0, 0], "pressure": 5e-4}]}}
    return case


# A fault that opens its own permeability, k1 = 2000: slip over f P (1 - nu)/G and p/P at places, by tests/published/permeable_fault.py with 320 and
# 640 cells, extrapolated.
PERMEABLE = {0.0: (0.5515, 1.0), 0.2: (0.5001, 0.8682), 0.4: (0.3916, 0.7266), 0.6: (0.2554, 0.5705)}


def water_along_table(program):
    """Water that flows along a fault: the crack that grows with it, also where slip opens the fault."""
    rows = [["problem", "quantity", "reference", "ours", "difference"]]
    for ratio, length, middle, side in [(0.1, 3.64052, 0.447123, 0.0981815), (0.5, 0.791607, 0.468661, 0.233735), (0.9, 0.139813, 0.100051, 0.0534441)]:
        half = length * sqrt(4 * 0.1 * 2.0)
        x, slip = along(Run(program, flowing(injection(ratio, half), half)), "x", "slip")
        x, slip = x / half, slip / (0.6 * 5e-4 * half * 0.75)
        found = [slip[np.abs(x - place).argmin()] for place in [0.0, 0.5, 0.875, 0.90625]]
        near, nearer = (value ** (2 / 3) for value in found[2:])
        tip = 0.875 + near * 0.03125 / (near - nearer)
        values = [("slip at the middle", middle, found[0]), ("slip half way", side, found[1]), ("λ", length, tip * length)]
        rows += [[f"T = {ratio:g}", name, f"{value:.5f}", f"{ours:.5f}", f"{100 * (ours / value - 1):+.2f} %"] for name, value, ours in values]
    run = Run(program, flowing(injection(0.5, 0.7), 0.7, 2000.0))
    x, slip = along(run, "x", "slip")
    at, pressure = along(run, "x", "fluid_pressure")
    for place, (way, held) in PERMEABLE.items():
        ours = np.interp(place, x, slip) / (0.6 * 5e-4 * 0.75)
        rows.append(["permeability by slip", f"slip at {place:g}", f"{way:.4f}", f"{ours:.4f}", f"{100 * (ours / way - 1):+.2f} %"])
        if place:
            ours = np.interp(place, at, pressure) / 5e-4
            rows.append(["permeability by slip", f"p/P at {place:g}", f"{held:.4f}", f"{ours:.4f}", f"{100 * (ours / held - 1):+.2f} %"])
    return rows


def injection_table(program):
    """Slip and length of the crack, over those of the closed form."""
    rows = [["T", "quantity", "reference", "ours", "difference"]]
    for ratio, length, middle, side in [(0.1, 3.64052, 0.447123, 0.0981815), (0.5, 0.791607, 0.468661, 0.233735), (0.9, 0.139813, 0.100051, 0.0534441)]:
        half = length * sqrt(4 * 0.1 * 2.0)
        x, slip = along(Run(program, injection(ratio, half)), "x", "slip")
        x, slip = x / half, slip / (0.6 * 5e-4 * half * 0.75)
        found = [slip[np.abs(x - place).argmin()] for place in [0.0, 0.5, 0.875, 0.90625]]
        near, nearer = (value ** (2 / 3) for value in found[2:])
        tip = 0.875 + near * 0.03125 / (near - nearer)
        values = [("slip at the middle", middle, found[0]), ("slip half way", side, found[1]), ("λ", length, tip * length)]
        rows += [[f"{ratio:g}", name, f"{value:.5f}", f"{ours:.5f}", f"{100 * (ours / value - 1):+.2f} %"] for name, value, ours in values]
    return rows


def reservoir(edge, friction):
    """A reservoir of 225 m that a vertical fault displaces by 75 m, depleted by 25 MPa."""
    inner, far, count = 225.0, 20e3, 32
    ratio, fine, blocks = grading(far - inner, count, edge), round(2 * inner / edge), []
    for body, sign in [("left", -1), ("right", 1)]:
        for x0, x1, nx, gx in [(0.0, inner, fine // 2, 1.0), (inner, far, count, ratio)]:
            for y0, y1, ny, gy in [(-far, -inner, count, 1 / ratio), (-inner, inner, fine, 1.0), (inner, far, count, ratio)]:
                corners = [[sign * x0, y0], [sign * x1, y0], [sign * x1, y1], [sign * x0, y1]]
                sides = [f"{body}_bottom" if y0 == -far else None, f"{body}_far" if x1 == far else None, None, None if x0 else f"{body}_fault"]
                blocks.append({"body": body, "corners": corners, "elements": [nx, ny], "grading": [gx, gy], "sides": sides})
    rock = {"model": "linear", "E": 14.95e9, "nu": 0.15}
    water = {"left": (-150, 75), "right": (-75, 150)}
    return {
        "title": "displaced reservoir", "mesh": {"blocks": blocks},
        "bodies": {name: {"material": rock, "pore_pressure": {"pressure": f"-25e6*t*(signum(y - {low}) - signum(y - {high}))/2", "biot": 0.9}}
                   for name, (low, high) in water.items()},
        "contacts": {"fault": {
            "slave": "left_fault", "master": "right_fault", "sliding": "small", "method": "node_to_segment", "friction": friction,
            "initial": {"pressure": 60e6, "balanced": True}}},
        "steps": [{"name": "deplete", "duration": 1, "dt": {"initial": 1}, "supports": [
            {"on": "left_far", "ux": 0}, {"on": "right_far", "ux": 0}, {"on": "left_bottom", "uy": 0}, {"on": "right_bottom", "uy": 0}]}],
        "output": {"exact": True, "fields": False, "report": False},
    }


def reservoir_table(program):
    """Slip without friction, and shear of a fault that sticks, over depth."""
    rows = [["place [m]", "slip, reference [m]", "ours", "difference", "shear of a stuck fault, reference [MPa]", "ours", "difference"]]
    y, slip = along(Run(program, reservoir(12.5, {"law": "frictionless"})), "y", "slip")
    stuck = Run(program, reservoir(12.5, {"law": "coulomb", "mu": 0.9, "alpha_t": 4e12}))
    at, shear = along(stuck, "y", "traction")
    for place, way, traction in [(0, 0.181731, 4.088248), (50, 0.181731, 5.474311), (100, 0.121154, 3.095975), (125, 0.060577, 1.104989)]:
        found = [values[np.abs(x - place).argmin()] for x, values in [(y, slip), (at, shear / 1e6)]]
        off = [f"{100 * (ours / value - 1):+.2f} %" for ours, value in zip(found, [way, traction])]
        rows.append([str(place), f"{way:.5f}", f"{found[0]:.5f}", off[0], f"{traction:.4f}", f"{found[1]:.4f}", off[1]])
    return rows


SLOW_WATER = {"bp6": bp6_table}
WATER = {"self_similar_injection": injection_table, "displaced_reservoir": reservoir_table, "water_along_a_fault": water_along_table}

if __name__ == "__main__":
    print(text_of({**SLOW_WATER, **WATER}[sys.argv[2]](sys.argv[1])))
