"""Tables of the quick tier: bodies that yield, at finite strain and in contact, against closed forms, on meshes of blocks that stand here.

Every function runs cases and returns rows, the head first. Needs numpy.
"""

from math import asin, cos, exp, factorial, log, pi, radians, sin, sqrt, tan

import numpy as np

from closed_forms import block
from limit_loads import von_mises
from problems import HEAD, row
from results import Run

NU = 0.3
WIDTHS = (1.5, 2, 4)


# Cavities ------------------------------------------------------------------------------------------------------------------------

def outwards(far, columns):
    """Last size over first that makes elements about as thick as their distance from the axis says, out to `far`."""
    return 1.5 * far ** (1 - 1 / columns)


def widening(dt):
    """Steps in which a cavity becomes WIDTHS times as wide, as exp(t): every increment is of the same strain at the bore."""
    ends = [log(width) for width in WIDTHS]
    return [{"name": f"to {width:g} a", "duration": end - start, "dt": {"initial": dt if start else dt / 20, "max": dt, "min": 1e-6}}
            for width, start, end in zip(WIDTHS, [0, *ends], ends)]


def ground(material, element, p0):
    """A body that starts under the isotropic pressure p₀, and the load outside that holds it there."""
    stress = {"initial_stress": {"components": {"xx": -p0, "yy": -p0, "zz": -p0}}} if p0 else {}
    return {"material": material, "element": element, **stress}, [{"on": "outside", "pressure": f"{p0}"}] if p0 else []


HEIGHT = 0.1


def cylinder_case(material, element, kind, columns, far, p0=0.0, dt=0.02):
    """A long cylindrical cavity of radius 1 that becomes wider: rings of one row of elements."""
    mesh = [block("ground", [[1, 0], [far, 0], [far, HEIGHT], [1, HEIGHT]], [columns, 1], ["bottom", "outside", "top", "bore"],
                  kind=kind, grading=[outwards(far, columns), 1])]
    body, loads = ground(material, element, p0)
    held = [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}, {"on": "bore", "ux": "exp(t) - 1"}]
    return {"section": "axisymmetric", "mesh": {"blocks": mesh}, "bodies": {"ground": body}, "watch": ["bore"],
            "steps": [{**step, "supports": held, "loads": loads} for step in widening(dt)], "output": {"fields": False}}


def cylinder(program, *told):
    """The pressure in the cavity when it has a width."""
    run = Run(program, cylinder_case(*told))
    return lambda width: run.at("bore.fx", log(width)) / (2 * pi * width * HEIGHT)


def sphere(program, material, element, kind, columns, sectors, far, p0, dt=0.02):
    """The pressure in a spherical cavity of radius 1 when it has a width: half the section of half a sphere.

    Forces along the radius at the nodes of the bore, over the area 2π a² (supports at its two ends act across the radius)."""
    angles = [0.25 * pi * k / sectors for k in range(2 * sectors + 1)]
    places = [[round(cos(angle), 9), round(sin(angle), 9)] for angle in angles]
    mesh = [block("ground", [[1, 0], [far, 0], [0, far], [0, 1]], [columns, sectors], ["bottom", "outside", None, "bore"],
                  arcs=[None, [0, 0], None, [0, 0]], grading=[outwards(far, columns), 1], kind=kind)]
    body, loads = ground(material, element, p0)
    moves = {"ux": "x*(exp(t) - 1)"}, {"uy": "y*(exp(t) - 1)"}
    # One by one: `ux` is refused on a group that reaches the axis, also where it is zero there.
    held = [{"on": "bottom", "uy": 0}, {"on": {"near": places[0]}, **moves[0]}, {"on": {"near": places[-1]}, **moves[1]}]
    held += [{"on": {"near": place}, **moves[0], **moves[1]} for place in places[1:-1]]
    run = Run(program, {"section": "axisymmetric", "mesh": {"blocks": mesh}, "bodies": {"ground": body}, "watch": [{"near": place} for place in places],
                        "steps": [{**step, "supports": held, "loads": loads} for step in widening(dt)], "output": {"fields": False}})
    names = [name[:-3] for name in run.history if name.startswith("near_") and name.endswith(".fx")]
    radial = lambda t: sum(run.at(f"{name}.fx", t) * x + run.at(f"{name}.fy", t) * y for name, (x, y) in zip(names, places))
    return lambda width: radial(log(width)) / (2 * pi * width**2)


def cavity_in_clay(program):
    """A cylindrical cavity in clay that is sheared undrained, G/s_u = 100: p = s_u [1 + ln((G/s_u)(1 − (a₀/a)²))] (Gibson & Anderson 1961)."""
    rows = [["elements", *HEAD]]
    for name, kind, element, columns, nu in (("Q4 F-bar, 80", "Q4", "f_bar", 80, 0.4999), ("Q8 reduced, 40", "Q8", "reduced", 40, 0.4999),
                                             ("Q4 F-bar, 80, ν = 0.49", "Q4", "f_bar", 80, 0.49)):
        clay = {"model": "von_mises", "E": 200 * (1 + nu), "nu": nu, "sigma_y": sqrt(3)}
        pressure = cylinder(program, clay, element, kind, columns, 1000)
        for width in WIDTHS:
            rows.append([name if width == WIDTHS[0] else "", *row(f"p/s_u at a/a₀ = {width:g}", 1 + log(100 * (1 - width**-2)), pressure(width), 4)])
    return rows


def yu_houlsby(width, m, E, nu, c, phi, psi, p0):
    """The pressure in a cavity, m = 1 a cylinder, 2 a sphere, when it is `width` times as wide as under p₀ (Yu & Houlsby 1991)."""
    f, s = sin(radians(phi)), sin(radians(psi))
    a, b, Y, G = (1 + f) / (1 - f), (1 + s) / (1 - s), 2 * c * cos(radians(phi)) / (1 - f), E / (2 * (1 + nu))
    over = Y + (a - 1) * p0
    g, d = a * (b + m) / (m * (a - 1) * b), over / (2 * (m + a) * G)
    eta = exp((b + m) * (1 - 2 * nu) * (1 + (2 - m) * nu) * over / (E * (a - 1) * b))
    xi = (1 - nu**2 * (2 - m)) * (1 + m) * d / ((1 + nu) * (a - 1) * b) * (a * b + m * (1 - 2 * nu) + 2 * nu - m * nu * (a + b) / (1 - nu * (2 - m)))

    def of(p):
        R = (m + a) * (Y + (a - 1) * p) / (a * (1 + m) * over)
        series = sum(xi**n / factorial(n) * (log(R) if abs(n - g) < 1e-12 else (R ** (n - g) - 1) / (n - g)) for n in range(60))
        rest = (1 - d) ** ((b + m) / b) - g / eta * series
        return (R**-g / rest) ** (b / (b + m)) if rest > 0 else float("inf")

    low, high = (a * (1 + m) * over / (m + a) - Y) / (a - 1), 1e4 * p0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if of(middle) < width else (low, middle)
    return low


def cavity_in_sand(program):
    """Cavities in sand, E = 50 MPa, ν = 0.3, φ = 30°, at first under 100 kPa, that dilates or does not (Yu & Houlsby 1991)."""
    rows = [["cavity, elements", *HEAD]]
    for name, m, kind, element, psi in (("cylinder, ψ = 10°, Q8 reduced, 60", 1, "Q8", "reduced", 10), ("the same, T6", 1, "T6", "displacement", 10),
                                        ("cylinder, ψ = 0, Q8 reduced, 60", 1, "Q8", "reduced", 0), ("sphere, ψ = 10°, Q8 reduced, 24 × 8", 2, "Q8", "reduced", 10)):
        told = {"E": 50e3, "nu": NU, "c": 0.001, "phi": 30, "psi": psi}
        sand = {"model": "mohr_coulomb", **told}
        pressure = cylinder(program, sand, element, kind, 60, 4000, 100.0) if m == 1 else sphere(program, sand, element, kind, 24, 8, 1000, 100.0)
        for width in WIDTHS:
            rows.append([name if width == WIDTHS[0] else "",
                         *row(f"p at a/a₀ = {width:g} [kPa]", yu_houlsby(width, m, p0=100.0, **told), pressure(width), 5)])
    return rows


# A pipe --------------------------------------------------------------------------------------------------------------------------

def half_ring(kind, radius, far, around, rings, ratio):
    """Half a ring above y = 0, in two quarters; its last element is `ratio` times as thick as its first."""
    sector = lambda corners, names: block("soil", corners, [rings, around], names, arcs=[None, [0, 0], None, [0, 0]], grading=[ratio, 1], kind=kind)
    return [sector([[radius, 0], [far, 0], [0, far], [0, radius]], ["level", "far", None, "pipe"]),
            sector([[0, radius], [0, far], [-far, 0], [-radius, 0]], [None, "far", "level", "pipe"])]


def pipe_factor(alpha):
    """N of a pipe whose wall bears α s_u (Randolph & Houlsby 1984)."""
    delta = asin(alpha)
    return pi + 2 * delta + 4 * cos(pi / 4 - delta / 2) * (sqrt(2) + sin(pi / 4 - delta / 2))


def pipe_case(alpha, kind, element, around, rings, bonded):
    """A pipe, D = 1, that moves sideways through clay, s_u = 1: the soil held by it, or in contact with a rigid circle."""
    body = {"material": {**von_mises(sqrt(3)), "E": 1e4, "nu": 0.49}, "element": element}
    case = {"mesh": {"blocks": half_ring(kind, 0.5, 8, around, rings, 200)}, "bodies": {"soil": body}, "output": {"fields": False}}
    held = [{"on": "far", "ux": 0, "uy": 0}, {"on": "level", "uy": 0}]
    if bonded:
        case["watch"] = ["pipe"]
        held.append({"on": "pipe", "ux": 0.002, "uy": 0})
    else:
        # It stays closed all round under 20 s_u.
        body["initial_stress"] = {"components": {"xx": -20, "yy": -20, "zz": -20}}
        friction = {"law": "adhesion", "strength": alpha} if alpha else {"law": "frictionless"}
        case["rigid_bodies"] = {"tool": {"reference": [0, 0]}}
        case["contacts"] = {"wall": {"slave": "pipe", "master": {"circle": {"centre": [0, 0], "radius": 0.5}}, "rigid_body": "tool",
                                     "friction": friction, "initial": {"of_bodies": True}}}
        held.append({"on": "tool", "ux": 0.002, "uy": 0, "angle": 0})
    case["steps"] = [{"name": "push", "duration": 1, "dt": {"initial": 0.01, "max": 0.05, "min": 1e-5}, "supports": held}]
    return case


def pipe(program, *told):
    """N = P/(s_u D) of the pipe."""
    run = Run(program, pipe_case(*told))
    return 2 * run.last("pipe.fx" if "pipe.fx" in run.history else "tool.fx")


def pipe_in_clay(program):
    """A pipe sideways in undrained clay (Randolph & Houlsby 1984): bonded, and in contact with adhesion α s_u."""
    rows = [["wall", "elements", *HEAD]]
    for wall, alpha, bonded in (("bonded", 1, True), ("contact, α = 1", 1, False), ("contact, α = ½", 0.5, False), ("contact, frictionless", 0, False)):
        for name, kind, element, around, rings in (("Q8 reduced, 16 × 20", "Q8", "reduced", 16, 20), ("Q4 F-bar, 32 × 32", "Q4", "f_bar", 32, 32)):
            rows.append([wall, name, *row("N", pipe_factor(alpha), pipe(program, alpha, kind, element, around, rings, bonded), 4)])
            wall = ""
    return rows


# A wall --------------------------------------------------------------------------------------------------------------------------

def wall_case(phi, delta, weight, kind="Q8", element="reduced", columns=(20, 30), rows=(18, 10), below=(8, 26), way=None):
    """A rigid wall, H = 1, that is pushed into soil under a surcharge or its own weight.

    The wall is a moving rigid plane; below its toe the soil leans on the same plane at rest, without friction. Elements and the ratio
    of the last size to the first: along x from the wall, along y from the toe up, and from the toe down."""
    far, depth = 6, 2
    mesh = [block("soil", [[0, -1], [far, -1], [far, y], [0, y]], [columns[0], of[0]], [None, "far", top, side], kind=kind, grading=[columns[1], of[1]])
            for y, of, top, side in ((0, rows, "top", "face"), (-depth, below, "bottom", "below"))]
    soil = {"model": "mohr_coulomb", "E": 1e4, "nu": NU, "c": 0, "phi": phi, "psi": phi, "density": weight}
    stress = {"geostatic": {"surface": 0, "weight": 1, "K0": 1}} if weight else {"components": {"xx": -1, "yy": -1, "zz": -1}}
    load = {"on": "soil", "gravity": {"y": "-1"}} if weight else {"on": "top", "pressure": "1"}
    plane = {"master": {"plane": {"point": [0, -1], "normal": [1, 0]}}, "initial": {"of_bodies": True}}
    smooth = {"law": "frictionless"}
    case = {"mesh": {"blocks": mesh}, "bodies": {"soil": {"material": soil, "element": element, "initial_stress": stress}},
            "rigid_bodies": {"wall": {"reference": [0, -1]}}, "output": {"fields": False},
            "contacts": {"face": {"slave": "face", **plane, "rigid_body": "wall", "friction": {"law": "coulomb", "mu": tan(radians(delta))} if delta else smooth},
                         "below": {"slave": "below", **plane, "friction": smooth}},
            "steps": [{"name": "push", "duration": 1, "dt": {"initial": 0.002, "max": 0.05, "min": 1e-5}, "loads": [load],
                       "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "far", "ux": 0}, {"on": "wall", "ux": way or (0.004 if phi < 33 else 0.008), "uy": 0, "angle": 0}]}]}
    return case


def wall(program, phi, delta, weight, *elements):
    """K_p of the wall, its resultant over q H or γH²/2."""
    run = Run(program, wall_case(phi, delta, weight, *elements))
    return np.hypot(run.last("wall.fx"), run.last("wall.fy")) * (2 if weight else 1)


def under_surcharge(phi, delta):
    """K_pq of soil without weight, exact (Rankine where the wall is smooth, else with a fan)."""
    f, d = radians(phi), radians(delta)
    turned = asin(sin(d) / sin(f)) + d
    return (1 + sin(f) * cos(turned)) / (1 - sin(f)) * exp(turned * tan(f)) / cos(d)


# Own characteristics, 60 points.
UNDER_WEIGHT = {(30, 0): 3.000, (30, 20): 5.256, (35, 0): 3.690, (35, 70 / 3): 7.773}


def passive_wall(program):
    """Passive pressure of soil without cohesion, ψ = φ, on a wall in contact, smooth and with δ = 2φ/3."""
    rows = [["soil", "elements", *HEAD]]
    for phi in (30, 35):
        for delta in (0, 2 * phi / 3):
            name = f"φ = {phi}°, " + ("δ = 2φ/3" if delta else "smooth")
            rows.append([name, "Q8 reduced", *row("K_pq", under_surcharge(phi, delta), wall(program, phi, delta, 0), 4)])
            if phi == 30:
                found = wall(program, phi, delta, 0, "T6", "displacement", (16, 20), (14, 10), (7, 20))
                rows.append(["", "T6", *row("K_pq", under_surcharge(phi, delta), found, 4)])
            rows.append(["", "Q8 reduced", *row("K_pγ", UNDER_WEIGHT[phi, delta], wall(program, phi, delta, 1), 4)])
    return rows


WALLS = {
    "cavity_in_clay": cavity_in_clay,
    "cavity_in_sand": cavity_in_sand,
    "pipe_in_clay": pipe_in_clay,
    "passive_wall": passive_wall,
}
