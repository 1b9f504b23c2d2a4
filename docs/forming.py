"""Tables of the quick tier: a footing under V and H on clay, a bar that necks, a sheet drawn through a wedge, against closed forms.

Every function runs cases and returns rows, the head first. Needs numpy.
"""

from math import acos, pi, radians, sin, sqrt, tan

import numpy as np

from closed_forms import block
from problems import HEAD, row
from results import Run

CLAY = {"model": "von_mises", "E": 1e4, "nu": 0.3, "sigma_y": sqrt(3)}


def green(h):
    """V/(B s_u) that goes with h = H/(B s_u) at the limit (Green 1954)."""
    return 1 + pi / 2 + acos(h) + sqrt(1 - h * h) if h < 1 else 1 + pi / 2


def green_h(v):
    low, high = 0.0, 1.0
    if v <= 1 + pi / 2:
        return 1.0
    for _ in range(60):
        low, high = (0.5 * (low + high), high) if green(0.5 * (low + high)) > v else (low, 0.5 * (low + high))
    return low


def along_the_ray(v, h):
    """How far (v, h) is from Green's curve along its ray: the factor over the one at the limit, less 1."""
    low, high = 0.1, 10.0
    outside = lambda s: s * h > 1 or s * v > green(min(1, s * h))
    for _ in range(60):
        mid = 0.5 * (low + high)
        low, high = (low, mid) if outside(mid) else (mid, high)
    return 1 / low - 1


def inclined_footing_case(vertical, mu, element="f_bar", kind="Q4", under=(40, 6), beside=(18, 40), rows=(22, 0.04), stiffer=1, boxed=False):
    """On a plane, or under a box with sides whose corners lie at nodes; with clay that is so many times stiffer, and driven by as much less."""
    blocks, free = [], "base" if boxed else None
    for x, (columns, grading), names in (((-2.5, -0.5), (beside[0], 1 / beside[1]), ["bottom", None, free, "side"]),
                                         ((-0.5, 0.5), (under[0], {"middle": under[1]}), ["bottom", None, "base", None]),
                                         ((0.5, 2.5), beside, ["bottom", "side", free, None])):
        blocks.append(block("ground", [[x[0], -2], [x[1], -2], [x[1], 0], [x[0], 0]], [columns, rows[0]], names, kind=kind, grading=[grading, rows[1]]))
    shape = {"polyline": {"points": [[0.5, 0.5], [0.5, 0], [-0.5, 0], [-0.5, 0.5]]}} if boxed else {"plane": {"point": [0, 0], "normal": [0, -1]}}
    contact = {"slave": "base", "master": shape, "rigid_body": "footing",
               "friction": {"law": "coulomb", "mu": mu}}
    steps = [{"name": "load", "duration": 1, "dt": {"initial": 0.05, "max": 0.1, "min": 1e-4},
              "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}, {"on": "footing", "ux": 0, "uy": -0.003 / stiffer, "angle": 0}],
              "until": {"on": "footing", "fy": -vertical}},
             {"name": "drive", "duration": 1, "dt": {"initial": 0.02, "max": 0.05, "min": 1e-5},
              "supports": [{"on": "footing", "uy": None, "ux": 0.004 / stiffer}], "loads": [{"on": "footing", "force": {"y": -vertical}}]}]
    return {"title": f"V = {vertical}, mu = {mu}", "mesh": {"blocks": blocks}, "bodies": {"ground": {"material": {**CLAY, "E": stiffer * CLAY["E"]}, "element": element}},
            "rigid_bodies": {"footing": {"reference": [0, 0]}}, "contacts": {"base": contact}, "steps": steps, "output": {"fields": False}}


# Elements under the footing and beside it, of which the smallest are at the corners, and rows.
MESHES = {"Q4 F-bar, B/100": {}, "Q4 F-bar, B/150": {"under": (56, 8), "beside": (20, 60), "rows": (26, 0.025)},
          "Q8 reduced, B/95": {"kind": "Q8", "element": "reduced", "under": (28, 8), "beside": (12, 60), "rows": (14, 0.02)}}
BOX = {"B/31": {"under": (14, 5), "beside": (8, 30), "rows": (8, 0.05)}, "B/95": {"under": (28, 8), "beside": (12, 60), "rows": (14, 0.02)},
       "B/300": {"under": (50, 20), "beside": (20, 200), "rows": (22, 0.006)}}


def footing_v_h(program):
    """A rigid footing on clay that is loaded by V and then driven along: H = min(h B s_u, μ V)."""
    rows = [["elements, corner", "V/(B s_u)", "μ", *HEAD, "along the ray"]]
    runs = [("Q8 reduced, B/95", v, mu) for v, mu in ((2, 1), (3, 1), (4, 1), (4.5, 1), (3, 0.2), (4.5, 0.1))]
    runs += [(name, 4.5, 1) for name in ("Q4 F-bar, B/100", "Q4 F-bar, B/150")]
    for name, vertical, mu in runs:
        run = Run(program, inclined_footing_case(vertical, mu, **MESHES[name]))
        exact, found = min(green_h(vertical), mu * vertical), abs(run.last("footing.fx"))
        ray = f"{100 * along_the_ray(vertical, found):+.2f} %" if mu == 1 else ""
        rows.append([name, f"{vertical:g}", f"{mu:g}", *row("H/(B s_u)", exact, found, 4), ray])
    return rows


def footing_in_a_box(program):
    """The same as a rigid box with corners and sides under V = 4 B s_u; the stiffer the clay, the less it sinks before it slides."""
    rows = [["Q8 reduced, corner", "E/s_u", *HEAD, "along the ray", "sunk by [B]"]]
    for name, stiffer in (("B/31", 1), ("B/95", 1), ("B/31", 10), ("B/95", 10), ("B/300", 10)):
        run = Run(program, inclined_footing_case(4, 1, "reduced", "Q8", stiffer=stiffer, boxed=True, **BOX[name]))
        found = abs(run.last("footing.fx"))
        rows.append([name, f"10{'⁵' if stiffer == 10 else '⁴'}", *row("H/(B s_u)", green_h(4), found, 4), f"{100 * along_the_ray(4, found):+.2f} %",
                     f"{-run.last('footing.uy'):.1e}"])
    return rows


HALF_LENGTH, HALF_WIDTH = 53.334 / 2, 12.826 / 2


def bar_case(imperfection, kind, element, elements, strain=0.16):
    half, width = HALF_LENGTH, HALF_WIDTH
    k, g = 164.206, 80.1938
    metal = {"model": "von_mises", "E": 9 * k * g / (3 * k + g), "nu": (3 * k - 2 * g) / (6 * k + 2 * g),
             "sigma_y": 0.45, "H": 0.12924, "Q": 0.265, "b": 16.93}
    mesh = [block("bar", [[0, 0], [width * (1 - imperfection), 0], [width, half], [0, half]], elements, ["middle", None, "end", "axis"], kind=kind)]
    step = {"name": "pull", "duration": 1, "dt": {"initial": 0.01, "max": 0.01},
            "supports": [{"on": "middle", "uy": 0}, {"on": "axis", "ux": 0}, {"on": "end", "uy": half * (np.exp(strain) - 1)}]}
    return {"title": f"bar {imperfection} {kind}", "mesh": {"blocks": mesh}, "bodies": {"bar": {"material": metal, "element": element}}, "steps": [step],
            "watch": ["end"], "output": {"fields": False}}


def considere(elastic):
    """Greatest load over the first area of an even bar in plane strain, and its logarithmic strain: without elastic strain (Considère), or with it."""
    k, g, strength = 164.206, 80.1938, lambda p: 0.45 + 0.12924 * p + 0.265 * (1 - np.exp(-16.93 * p))
    if not elastic:
        e = np.linspace(0, 0.4, 400001)
        force = 2 / sqrt(3) * strength(2 / sqrt(3) * e) * np.exp(-e)
        return force.max(), e[force.argmax()]
    # Along the strain in small increments: elastic trial, radial return, and the strain across that leaves no stress across.
    plastic, p, best, lateral = np.zeros(3), 0.0, (0.0, 0.0), 0.0

    def stress(across, along):
        e = np.array([across, along, 0.0]) - plastic
        s = 2 * g * (e - e.mean())
        q = sqrt(1.5) * np.linalg.norm(s)
        more = 0.0
        if q > strength(p):
            for _ in range(8):
                slope = 0.12924 + 0.265 * 16.93 * np.exp(-16.93 * (p + more))
                more += (q - 3 * g * more - strength(p + more)) / (3 * g + slope)
        return k * e.sum() + s * (1 - 3 * g * more / q if q else 1), more, (1.5 * more / q * s if q else s)

    for along in np.linspace(0, 0.16, 3201)[1:]:
        a, b = lateral - 1e-4, lateral
        fa, fb = stress(a, along)[0][0], stress(b, along)[0][0]
        for _ in range(30):
            if abs(fb) < 1e-12:
                break
            a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
            fb = stress(b, along)[0][0]
        lateral = b
        tau, more, flow = stress(b, along)
        plastic, p = plastic + flow, p + more
        best = max(best, (tau[1] * np.exp(-along), along))
    return best


def necking(program):
    """A bar in plane strain with the constants of Simo's benchmark, pulled: its greatest load."""
    rows = [["bar", *HEAD]]
    for name, imperfection, kind, element, elements, elastic in (
            ("even, Q4 F-bar 6 × 12", 0, "Q4", "f_bar", [6, 12], True),
            ("1.8 % narrower in the middle, Q4 F-bar 10 × 30", 0.018, "Q4", "f_bar", [10, 30], False),
            ("the same, Q8 reduced 5 × 15", 0.018, "Q8", "reduced", [5, 15], False)):
        exact, at = considere(False)
        run = Run(program, bar_case(imperfection, kind, element, elements))
        strains = np.log(1 + run.history["end.uy"] / HALF_LENGTH)
        # Over the narrowest section.
        force = run.history["end.fy"] / HALF_WIDTH / (1 - imperfection)
        top = force.argmax()
        rows.append([name, *row("greatest F/A₀", exact, force[top], 4)])
        if elastic:
            exact, at = considere(True)
            rows.append(["", *row("the same, with elastic strain in the reference", exact, force[top], 4)])
            rows.append(["", *row("strain there", at, strains[top], 4)])
    return rows


def sheet(program, degrees=15, n=8, entry=2.2, way=1.6, element="f_bar", kind="Q4", push=False, method="node_to_segment", dt=0.01):
    """Half of a sheet of half thickness 1, shaped to the die, drawn (or pushed) through a smooth wedge; it enters from the left."""
    a = radians(degrees)
    r = 2 * sin(a) / (1 + 2 * sin(a))
    out, length = 1 - r, r / tan(a)
    across = n
    mesh = [block("sheet", [[-entry, 0], [0, 0], [0, 1], [-entry, 1]], [round(entry * n), across], ["middle", None, "top", "back"], kind=kind),
            block("sheet", [[0, 0], [length, 0], [length, out], [0, 1]], [round(length * n), across], ["middle", None, "top", None], kind=kind),
            block("sheet", [[length, 0], [length + 0.6, 0], [length + 0.6, out], [length, out]], [max(2, round(0.6 * n / 1.5)), across], ["middle", "front", "top", None], kind=kind)]
    if push:
        mesh.pop()
        mesh[-1]["sides"][1] = None
    back = 1 + (entry + 1) * tan(a)
    # The solid on the right of the line in its order: from the exit to the entry it is above.
    points = [[length + 1, out + 1], [length, out], [-entry - 1, back]]
    contact = {"slave": "top", "master": {"polyline": {"points": points}}, "method": method, "friction": {"law": "frictionless"}}
    pulled = {"on": "back", "ux": way} if push else {"on": "front", "ux": way}
    step = {"name": "draw", "duration": way, "dt": {"initial": dt, "max": dt, "min": dt / 2000}, "supports": [{"on": "middle", "uy": 0}, pulled]}
    material = {"model": "von_mises", "E": 1e3 / sqrt(3), "nu": 0.3, "sigma_y": 1}
    run = Run(program, {"title": f"sheet {degrees} {n} {element} push {push}", "mesh": {"blocks": mesh}, "bodies": {"sheet": {"material": material, "element": element}},
                        "contacts": {"die": contact}, "steps": [step], "watch": ["back" if push else "front"], "output": {"fields": False, "report": False}})
    two_k = 2 / sqrt(3)
    exact = 2 * (1 + a) * sin(a) / (1 + 2 * sin(a))
    end = "back" if push else "front"
    force = abs(run.history[f"{end}.fx"]) / ((1 if push else out) * two_k)
    return run, run.history[f"{end}.ux"], force, exact, (1 + a), length, out


def drawing(program):
    """A sheet drawn, and pushed, through a smooth wedge die: mean stress over the second half of a way of 2 half thicknesses, over 2k."""
    rows = [["die; elements across half of the sheet; contact", *HEAD, "least and most"]]
    q8 = {"kind": "Q8", "element": "reduced", "method": "mortar"}
    for name, more in (("15°, drawn; 10 Q4 F-bar; nodes", {"n": 10}),
                       ("15°, drawn; 10 Q4 F-bar; mortar", {"n": 10, "method": "mortar"}),
                       ("15°, drawn; 8 Q8 reduced; mortar", {"n": 8, **q8}),
                       ("15°, pushed; 8 Q8 reduced; mortar", {"n": 8, "push": True, **q8})):
        _, way, stress, exact, *_ = sheet(program, way=2, entry=3.4 if "push" in more else 3.2, dt=0.02, **more)
        late = (way > 1) & (way < 1.95)
        mean = np.trapezoid(stress[late], way[late]) / np.ptp(way[late])
        rows.append([name, *row("σ/(2k)", exact, mean, 4), f"{stress[late].min():.3f}, {stress[late].max():.3f}"])
    return rows


FORMING = {"footing_v_h": footing_v_h, "footing_in_a_box": footing_in_a_box, "necking": necking, "drawing": drawing}
