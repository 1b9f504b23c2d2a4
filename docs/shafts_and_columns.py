"""Tables of the quick tier: a shaft that slips in its ground, a column that buckles while it yields, against closed forms.

Every function runs cases and returns rows, the head first. Needs numpy.
"""

from math import log, pi, sqrt, tanh

import numpy as np

from closed_forms import block
from problems import HEAD, row
from results import Run, table

# Shafts --------------------------------------------------------------------------------------------------------------------------

G, NU, FAR, LENGTH = 1e4, 0.3, 5.0, 20.0
STIFF = 1e8


def elastic(shear, nu=NU):
    return {"model": "linear", "E": 2 * shear * (1 + nu), "nu": nu}


def yielding(hardening):
    """Ground that yields in shear at 1; there dτ/dγ_p = H/3."""
    return {"model": "von_mises", "E": 2 * G * (1 + NU), "nu": NU, "sigma_y": sqrt(3), "H": hardening}


def rigid_shaft_case(ground, friction, way):
    """A rigid shaft of radius 1 that is pulled out of ground held at r = FAR.

    One row of rings of height 1 that stay level, as in a long layer, at first under a pressure of 10 all round."""
    mesh = [block("ground", [[1, 0], [FAR, 0], [FAR, 1], [1, 1]], [24, 1], ["bottom", "far", "top", "wall"], kind="Q8", grading=[20, 1])]
    body = {"material": ground, "element": "reduced", "initial_stress": {"components": {"xx": -10, "yy": -10, "zz": -10}}}
    contact = {"slave": "wall", "master": {"plane": {"point": [1, 0], "normal": [1, 0]}}, "rigid_body": "shaft", "friction": {**friction, "alpha_t": STIFF},
               "initial": {"of_bodies": True}}
    held = [{"on": "bottom", "ux": 0}, {"on": "top", "ux": 0}, {"on": "far", "ux": 0, "uy": 0}, {"on": "shaft", "uy": way}]
    step = {"name": "pull", "duration": 1, "dt": {"initial": 0.01, "max": 0.01}, "supports": held,
            "loads": [{"on": "top", "pressure": "10"}, {"on": "bottom", "pressure": "10"}]}
    return {"title": "a rigid shaft", "section": "axisymmetric", "mesh": {"blocks": mesh}, "bodies": {"ground": body},
            "rigid_bodies": {"shaft": {"reference": [1, 0]}}, "contacts": {"shaft": contact}, "steps": [step], "output": {"fields": False}}


def rigid_shaft(program, *told):
    """The traction on the shaft over its way."""
    run = Run(program, rigid_shaft_case(*told))
    return run.history["shaft.uy"], abs(run.history["shaft.fy"]) / (2 * pi)


def way_of(traction, hardening=None):
    """How far a rigid shaft of radius 1 moves under a traction τ₀, where τ = τ₀/r in the ground; beyond τ = 1 it has hardened."""
    way = traction / G * log(FAR)
    if hardening and traction > 1:
        way += 3 / hardening * (traction * log(traction) - (traction - 1))
    return way


def shaft(program):
    """A rigid shaft that is pulled out of ground: concentric cylinders, τ = τ₀ r₀/r (Randolph & Wroth 1978), until it slips."""
    rows = [["ground", "shaft", *HEAD]]
    at = lambda run, way: np.interp(way, *run)
    run = rigid_shaft(program, elastic(G), {"law": "coulomb", "mu": 0.1}, 2 * way_of(1))
    rows.append(["elastic", "μ p = 1", *row("τ₀ at half of the way to slip", 0.5, at(run, 0.5 * way_of(1)), 5)])
    rows.append(["", "", *row("τ₀ at twice that way", 1, at(run, 2 * way_of(1)), 5)])
    run = rigid_shaft(program, yielding(0), {"law": "adhesion", "strength": 0.5}, 2 * way_of(1))
    rows.append(["s_u = 1", "adhesion s_u/2", *row("τ₀ while it slips", 0.5, at(run, 2 * way_of(1)), 5)])
    run = rigid_shaft(program, yielding(0), {"law": "coulomb", "mu": 0.2}, 2 * way_of(1))
    rows.append(["", "μ p = 2: the ground fails", *row("τ₀ at the end", 1, at(run, 2 * way_of(1)), 5)])
    hardening = 0.3 * G
    run = rigid_shaft(program, yielding(hardening), {"law": "coulomb", "mu": 0.15}, 1.2 * way_of(1.5, hardening))
    for traction in (0.9, 1.2, 1.4):
        name = ["hardens, H = 0.3 G", "μ p = 1.5"] if traction == 0.9 else ["", ""]
        rows.append([*name, *row("τ₀", traction, at(run, way_of(traction, hardening)), 5)])
    rows.append(["", "", *row("τ₀ while it slips", 1.5, run[1][-1], 5)])
    return rows


RIM, RATE = 2.0, 1.5


def compressible_shaft_case(friction, way, increments=100):
    """An elastic shaft of radius 1 and length LENGTH that is pulled at its head; its ground is held at r = RIM. A pressure of 10 acts between them.

    Its stiffness is such that RATE = μ L, μ² = 2G/(ln(RIM) E)."""
    young = 2 * G / log(RIM) * (LENGTH / RATE) ** 2
    mesh = [block("pile", [[0, 0], [1, 0], [1, LENGTH], [0, LENGTH]], [1, 40], [None, "side", "head", None], kind="Q8"),
            block("ground", [[1, 0], [RIM, 0], [RIM, LENGTH], [1, LENGTH]], [3, 40], ["bottom", "far", "top", "wall"], kind="Q8")]
    contact = {"slave": "wall", "master": "side", "friction": {**friction, "alpha_t": STIFF}, "sliding": "small",
               "initial": {"pressure": 10, "balanced": True}}
    held = [{"on": "bottom", "ux": 0}, {"on": "top", "ux": 0}, {"on": "far", "ux": 0, "uy": 0}, {"on": "head", "uy": way}]
    step = {"name": "pull", "duration": 1, "dt": {"initial": 1 / increments, "max": 1 / increments, "min": 1e-6}, "supports": held}
    return {"title": "a compressible shaft", "section": "axisymmetric", "mesh": {"blocks": mesh},
            "bodies": {"pile": {"material": {"model": "linear", "E": young, "nu": 0}}, "ground": {"material": elastic(G)}},
            "contacts": {"shaft": contact}, "steps": [step], "watch": ["head"], "output": {"fields": False}}


def compressible_shaft(program, *told):
    """The pull at the head of the shaft over its way."""
    run = Run(program, compressible_shaft_case(*told))
    return run.history["head.uy"], run.history["head.fy"]


def slipped(share):
    """Way and pull of the head of a shaft that has slipped over a share of its length, with the strength 1:
    k w'' … = k w below, = 1 above; k = G/ln(RIM), the strength over the way at which it slips."""
    above, below = RATE * share, RATE * (1 - share)
    way = log(RIM) / G * (1 + above * tanh(below) + 0.5 * above**2)
    return way, 2 * pi * LENGTH / RATE * (above + tanh(below))


def weakening(peak, rest, slip):
    """The greatest pull on a shaft whose friction falls linearly from `peak` to `rest` over a slip: E A w'' = 2π τ(w), integrated
    from the foot, where w' = 0, for all ways of the foot."""
    k, young = G / log(RIM), 2 * G / log(RIM) * (LENGTH / RATE) ** 2
    # τ over the way w = τ/k + slip.
    ways, tractions = [0, peak / k, rest / k + slip, 1.0], [0, peak, rest, rest]
    foot = np.linspace(0, rest / k + 2 * slip, 4001)
    w, strain, h = foot.copy(), 0 * foot, LENGTH / 1000
    tau = lambda w: np.interp(w, ways, tractions)
    for _ in range(1000):
        middle = w + 0.5 * h * strain
        strain = strain + h * 2 / young * tau(middle)
        w = middle + 0.5 * h * strain
    return (pi * young * strain).max()


def long_shaft(program):
    """A compressible shaft that slips from its head downwards, with constant and with falling strength."""
    rows = [["strength", *HEAD]]
    whole = 2 * pi * LENGTH
    run = compressible_shaft(program, {"law": "adhesion", "strength": 1}, 1.05 * slipped(1)[0])
    for share in (0, 0.25, 0.5, 0.75, 1):
        way, pull = slipped(share)
        name = "constant" if share == 0 else ""
        what = "pull over 2π r₀ L τ_f, " + ("when it begins to slip" if share == 0 else f"slipped over {share:g} L")
        rows.append([name, *row(what, pull / whole, np.interp(way, *run) / whole, 4)])
    for slip in (3e-4, 1e-4):
        exact = weakening(1, 0.4, slip)
        found = compressible_shaft(program, {"law": "slip_weakening", "mu_s": 0.1, "mu_d": 0.04, "D_c": slip}, 3e-4)[1].max()
        rows.append([f"falls to 0.4 over {slip * G:g} r₀ τ_f/G", *row("greatest pull over 2π r₀ L τ_f", exact / whole, found / whole, 4)])
    return rows


# Columns -------------------------------------------------------------------------------------------------------------------------

YOUNG, HARDENING = 1e5, 5e3


def tangent_modulus():
    """dσ/dε of a strip in plane strain while it yields, σ_y = 1, the stress along it twice that across the plane."""
    return 1 / ((1 - NU**2) / YOUNG + 3 / (4 * HARDENING))


def column_case(length, shortening, increments, aside=0.0):
    """A column of width 1 whose ends do not turn, one of them free to move aside, is shortened; or pushed aside by a force besides."""
    mesh = [block("column", [[0, 0], [length, 0], [length, 1], [0, 1]], [20, 2], [None, "head", None, "foot"], kind="Q8")]
    metal = {"model": "von_mises", "E": YOUNG, "nu": NU, "sigma_y": 1, "H": HARDENING}
    step = {"name": "press", "duration": 1, "dt": {"initial": 1 / increments, "max": 1 / increments, "min": 1e-6},
            "supports": [{"on": "foot", "ux": 0}, {"on": {"near": [0, 0.5]}, "uy": 0}, {"on": "head", "ux": -shortening}],
            "loads": [{"on": "head", "total_force": {"y": aside}}] if aside else []}
    return {"title": "a column", "mesh": {"blocks": mesh}, "bodies": {"column": {"material": metal, "element": "reduced"}},
            "steps": [step], "watch": ["head"], "output": {"fields": False}}


def column(program, *told):
    """The run of a column, and the force that shortens it."""
    run = Run(program, column_case(*told))
    return run, -run.history["head.fx"]


def plastic_buckling(program):
    """Columns that buckle after they have yielded (Engesser, Shanley): P = π² E_t I/L² of ends that do not turn."""
    rows = [["L/h", *HEAD]]
    modulus = tangent_modulus()
    for length, shortening in ((58, 0.008), (50, 0.013)):
        exact = pi**2 * modulus / (12 * length**2)
        run, force = column(program, length, shortening, 400)
        attempts = table(run.folder / "newton.csv")
        # Of the last iteration of each increment.
        negative = dict(zip(attempts["time"], attempts["negative_pivots"]))
        first = next(i for i, time in enumerate(run.history["time"]) if negative[time] >= 1)
        rows.append([f"{length}", *row("P/(σ_y h) at the first negative pivot", exact, force[first], 4)])
        greatest = column(program, length, 4 * shortening, 400, exact / 1000)[1].max()
        across = YOUNG / (1 - NU**2)
        most = 4 * across / (sqrt(across) + sqrt(modulus)) ** 2
        rows.append(["", "greatest P over that, pushed aside by P/1000", f"1 to {most:.3f}", f"{greatest / exact:.3f}", ""])
    return rows


SHAFTS = {"shaft": shaft, "long_shaft": long_shaft, "plastic_buckling": plastic_buckling}
