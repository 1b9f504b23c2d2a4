"""Tables of the slow tier: a pile in clay, its base on finer meshes, and its shaft, with the opening of its bond halved and doubled; the same
of a wall that holds a dig; and clay that is undrained, by water that is trapped or by water that flows and has no time to.

    python3 docs/piles_in_clay.py target/release/fecontact pile_bases
    python3 docs/piles_in_clay.py target/release/fecontact pile_openings
    python3 docs/piles_in_clay.py target/release/fecontact wall_openings
    python3 docs/piles_in_clay.py target/release/fecontact trapped_and_flowing

Every function runs cases and returns rows, the head first. Needs numpy.
"""

import sys
from math import pi

import numpy as np

from limit_loads import FINE, cam_clay, footing_case
from results import Run, table, text_of

LONG, RADIUS, STRENGTH, ADHESION, WEIGHT = 8, 0.5, 40, 0.8, 18
GROUND = {"geostatic": {"surface": 0, "weight": WEIGHT, "K0": 1}}
GRADINGS = ([1, 0.2], [30, 0.2], [30, 0.05], [1, 0.05])


def pile(kind, element, nu, finer, opening=0.005, down=0.05):
    """A pile that is pushed into clay: `finer` times as many elements along every side as the coarsest mesh with this number of nodes."""
    half = 1 if kind == "Q4" else 2

    def block(body, low, high, elements, sides, grading):
        count = [max(1, round(n * finer / half)) for n in elements]
        corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
        return {"body": body, "corners": corners, "elements": count, "sides": sides, "grading": grading, "kind": kind}

    def contact(slave, master):
        return {"slave": slave, "master": master, "interface": {"reduction": ADHESION}, "bond": {"opening": opening}, "initial": {"of_bodies": True}}

    blocks = [
        block("pile", (0, -LONG), (RADIUS, 0), (6, 16), ["pile_base", "pile_side", "head", None], GRADINGS[0]),
        block("soil", (RADIUS, -LONG), (10, 0), (14, 16), [None, "outer", None, "soil_side"], GRADINGS[1]),
        block("soil", (RADIUS, -2 * LONG), (10, -LONG), (14, 18), ["bottom", "outer", None, None], GRADINGS[2]),
        block("soil", (0, -2 * LONG), (RADIUS, -LONG), (6, 18), ["bottom", None, "soil_base", None], GRADINGS[3]),
    ]
    clay = {"model": "mohr_coulomb", "E": 20000, "nu": nu, "c": STRENGTH, "phi": 0, "psi": 0, "density": WEIGHT / 10}
    own = {"element": "reduced"} if kind == "Q8" else {}
    gravity = [{"on": body, "gravity": {"y": "-10"}} for body in ("soil", "pile")]
    return {
        "section": "axisymmetric", "mesh": {"blocks": blocks},
        "bodies": {"pile": {"material": {"model": "linear", "E": 3e7, "nu": 0.2, "density": WEIGHT / 10}, "initial_stress": GROUND, **own},
                   "soil": {"material": clay, "element": element, "initial_stress": GROUND}},
        "contacts": {"base": contact("soil_base", "pile_base"), "shaft": contact("soil_side", "pile_side")},
        "steps": [
            {"name": "rest", "duration": 1, "dt": {"initial": 1}, "loads": gravity,
             "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "outer", "ux": 0}]},
            {"name": "push", "duration": 1, "dt": {"initial": 0.05}, "supports": [{"on": "head", "uy": -down}]},
        ],
        "watch": ["head"], "output": {"fields": False, "report": False},
    }


def borne(run, share):
    """Shaft and base, without the weight that the base bore before, at a share of the way."""
    k = int(np.abs(run.history["time"] - 1 - share).argmin())
    shaft, base = abs(run.history["shaft.tangential_force"][k]), abs(run.history["base.normal_force"][k])
    return shaft, base - WEIGHT * LONG * pi * RADIUS**2


def pile_bases(program):
    rows = [["elements", "across the radius", "ν", "base at 5 % of D", "N_c", "base at 10 % of D", "N_c", "shaft"]]
    for kind, element, nu, finer in (("Q4", "f_bar", 0.49, 1), ("Q4", "f_bar", 0.49, 2), ("Q4", "f_bar", 0.49, 3), ("Q4", "f_bar", 0.45, 1), ("Q4", "f_bar", 0.45, 2),
                                     ("Q8", "reduced", 0.49, 1), ("Q8", "reduced", 0.49, 2), ("Q8", "reduced", 0.45, 2)):
        run = Run(program, pile(kind, element, nu, finer, down=0.1))
        [_, first], [shaft, last] = borne(run, 0.5), borne(run, 1)
        by = STRENGTH * pi * RADIUS**2
        across = 6 * finer if kind == "Q4" else 3 * finer
        name = "Q4, F-bar" if kind == "Q4" else "Q8, reduced"
        rows.append([name, f"{across}", f"{nu}", f"{first:.0f}", f"{first / by:.2f}", f"{last:.0f}", f"{last / by:.2f}", f"{shaft:.1f}"])
    return rows


def pile_openings(program):
    rows = [["δ [mm]", "δ E/(c h)", "shaft", "of α s_u π D L", "base"]]
    whole = ADHESION * STRENGTH * pi * 2 * RADIUS * LONG
    for opening in (0.00125, 0.0025, 0.005, 0.01, 0.02):
        run = Run(program, pile("Q4", "f_bar", 0.49, 1, opening))
        shaft, base = borne(run, 1)
        shrink = 0.2 ** (1 / 15)
        edge = LONG * (1 - shrink) / (1 - shrink**16)
        rows.append([f"{1e3 * opening:g}", f"{opening * 20000 / (ADHESION * STRENGTH * edge):.2g}", f"{shaft:.1f}", f"{100 * shaft / whole:.1f} %", f"{base:.0f}"])
    return rows


DEEP, THICK, HALF_PIT, FAR, FLOOR, STAGES = 8, 0.4, 6, 20, 14, 4


def wall(opening):
    """A wall in clay, wished in place, that holds a dig of a metre a stage."""
    ground = {"geostatic": {"surface": 0, "weight": WEIGHT, "K0": 0.9}}
    clay = {"model": "mohr_coulomb", "E": 12000, "nu": 0.495, "c": 30, "phi": 0, "psi": 0, "density": WEIGHT / 10}
    cuts = [f"cut_{k + 1}" for k in range(STAGES)]

    def block(body, left, low, right, high, elements, grading, sides):
        corners = [[left, low], [right, low], [right, high], [left, high]]
        return {"body": body, "corners": corners, "elements": elements, "grading": grading, "sides": sides, "kind": "Q8"}

    def contact(slave, master):
        return {"slave": slave, "master": master, "interface": {"reduction": 0.5}, "bond": {"opening": opening}, "initial": {"of_bodies": True}}

    blocks = [
        block("wall", 0, -DEEP, THICK, 0, [1, 16], [1, 1], ["tip", "wall_out", None, "wall_in"]),
        block("soil", -HALF_PIT, -FLOOR, 0, -DEEP, [12, 5], [0.15, 0.5], ["floor", None, None, "axis"]),
        block("soil", 0, -FLOOR, THICK, -DEEP, [1, 5], [1, 0.5], ["floor", None, "below", None]),
        block("soil", THICK, -FLOOR, FAR, -DEEP, [18, 5], [10, 0.5], ["floor", "far", None, None]),
        block("soil", THICK, -DEEP, FAR, 0, [18, 16], [10, 1], [None, "far", None, "soil_out"]),
        block("soil", -HALF_PIT, -DEEP, 0, -STAGES, [12, 8], [0.15, 1], [None, "soil_in", None, "axis"]),
        *(block(cut, -HALF_PIT, -k - 1, 0, -k, [12, 2], [0.15, 1], [None, f"face_{k + 1}", None, "axis"]) for k, cut in enumerate(cuts)),
    ]
    blocks[0]["points"] = {"head": [THICK / 2, 0]}
    soils = {name: {"material": clay, "element": "reduced", "initial_stress": ground} for name in ("soil", *cuts)}
    stiff = {"model": "linear", "E": 2e7, "nu": 0.2, "density": WEIGHT / 10}
    sides = [("soil_out", "wall_out"), ("below", "tip"), ("soil_in", "wall_in"), *((f"face_{k + 1}", "wall_in") for k in range(STAGES))]
    supports = [{"on": "floor", "ux": 0, "uy": 0}, {"on": "axis", "ux": 0}, {"on": "far", "ux": 0}]
    gravity = [{"on": body, "gravity": {"y": "-10"}} for body in ("wall", *soils)]
    dig = [{"name": f"{k + 1} m", "duration": 1, "dt": {"initial": 0.05, "max": 0.1}, "remove": [cut]} for k, cut in enumerate(cuts)]
    return {
        "mesh": {"joined": [["soil", *cuts]], "blocks": blocks},
        "bodies": {"wall": {"material": stiff, "element": "reduced", "initial_stress": ground}, **soils},
        "contacts": {slave: contact(slave, master) for slave, master in sides},
        "steps": [{"name": "rest", "duration": 1, "dt": {"initial": 1}, "supports": supports, "loads": gravity}, *dig],
        "sections": {"wall": {"body": "wall", "from": [THICK / 2, 0], "to": [THICK / 2, -DEEP]}},
        "watch": ["head"], "output": {"fields": False, "report": False},
    }


def wall_openings(program):
    rows = [["δ [mm]", "δ E/(c h)", "head [mm]", "largest M [kN m/m]", "shear behind the wall [kN/m]"]]
    for opening in (0.00125, 0.0025, 0.005, 0.01):
        run = Run(program, wall(opening))
        sections = table(run.folder / "sections.csv")
        moment = max(abs(values[-1]) for name, values in sections.items() if name.endswith("moment"))
        behind = abs(run.last("soil_out.tangential_force"))
        over = opening * 12000 / (15 * DEEP / 16)
        rows.append([f"{1e3 * opening:g}", f"{over:.2g}", f"{-1e3 * run.last('head.ux'):.2f}", f"{moment:.2f}", f"{behind:.1f}"])
    return rows


def both_ways(program, case, body, elements):
    """Runs of a case in which the water of a body is trapped, and in which it flows with hardly any permeability."""
    trapped, flows = ({**case, "bodies": {**case["bodies"], body: {**case["bodies"][body], "element": kind}}} for kind in elements)
    fluid = flows["bodies"][body]["pore_fluid"]
    flows["bodies"][body] = {**flows["bodies"][body], "pore_fluid": {**fluid, "permeability": 1e-15, "unit_weight": 10, "weighs": "pressure" in fluid}}
    return Run(program, trapped), Run(program, flows)


def trapped_and_flowing(program):
    rows = [["problem", "elements", "quantity", "trapped", "flowing", "difference"]]
    kinds = {"Q8 reduced": ("Q8", "reduced", ["reduced", "reduced"]), "T6": ("T6", "displacement", ["displacement", "displacement"]),
             "Q4 F-bar, Q4": ("Q4", "f_bar", ["f_bar", "displacement"])}

    def add(problem, elements, quantity, values):
        one, other = values
        rows.append([problem, elements, quantity, f"{one:.4g}", f"{other:.4g}", f"{100 * (other / one - 1):+.1f} %"])

    for name, (kind, element, elements) in kinds.items():
        for half, told in ((2, "half as many"), (1, "")):
            body, strength = cam_clay(100)
            near, far, deep = FINE[kind][0][0], FINE[kind][0][1], FINE[kind][1]
            columns, across = [[n // half, grading] for n, grading in (near, far)], [deep[0] // half, deep[1]]
            case = footing_case({**body, "element": element}, kind, columns, across, 2.5, 0.001, 100, dt={"initial": 0.02, "max": 0.02, "min": 1e-6})
            runs = both_ways(program, case, "ground", elements)
            add("footing on Cam-clay", f"{name} {told}".strip(), "N_c", [(-run.last("footing.fy") / 0.5 - 100) / strength for run in runs])
    for name, (kind, element, elements) in kinds.items():
        for finer in (1, 2):
            case = pile(kind, element, 0.3, finer, down=0.1)
            soil = case["bodies"]["soil"]
            soil["initial_stress"] = {"geostatic": {"surface": 0, "weight": WEIGHT - 10, "K0": 1}}
            soil["pore_fluid"] = {"bulk_modulus": 2.2e6, "porosity": 0.4, "pressure": "-10*y"}
            # Means of mortar leave a point at the ground surface less than its water.
            case["contacts"] = {name: {**one, "method": "gauss_to_segment"} for name, one in case["contacts"].items()}
            ends = []
            for run in both_ways(program, case, "soil", elements):
                water = run.history.get("base.fluid_force")
                ends.append([abs(run.last("shaft.tangential_force")), abs(run.last("base.normal_force")) + (0 if water is None else water[-1]) - WEIGHT * LONG * pi * RADIUS**2])
            across = (6 if kind == "Q4" else 3) * finer
            add(f"pile, {across} across the radius", name, "shaft", [shaft for shaft, _ in ends])
            add("", name, "base at 10 % of D", [base for _, base in ends])
    return rows


SLOW_PILES = {"pile_bases": pile_bases, "pile_openings": pile_openings, "wall_openings": wall_openings, "trapped_and_flowing": trapped_and_flowing}

if __name__ == "__main__":
    print(text_of(SLOW_PILES[sys.argv[2]](sys.argv[1])))
