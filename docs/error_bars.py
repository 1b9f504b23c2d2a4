"""Error bars of numbers that stand in the documentation and come from one mesh, by `fecontact converge`: tables of both tiers.

    python3 docs/error_bars.py PROGRAM NAME …      prints tables by their names

A case on a mesh of blocks begins with a quarter of its elements along every side, so that the last of its three meshes is the one of the number itself, or
where its elements cannot be halved twice has nearly as many. A case on another mesh begins with its own. Needs numpy.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
from math import cos, pi, radians

from cavities_and_walls import cylinder_case, pipe_case, wall_case
from closed_forms import FIT, press_fit_case
from forming import HALF_WIDTH, MESHES, bar_case, inclined_footing_case
from limit_loads import E, FINE, cam_clay, footing_case, hills_tube_case, thick_sphere_case, von_mises
from problems import digits
from results import ROOT, committed, text_of
from shafts_and_columns import G, column_case, compressible_shaft_case, rigid_shaft_case, tangent_modulus, way_of, yielding

HEAD = ["problem", "number", "h", "h/2", "h/4", "error bar", "order"]


def converged(program, case, measures):
    """What `fecontact converge` says of measures of a case: the numbers of three meshes, the error bar of the last, and the order, or in words what it is."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "case.json"
        path.write_text(json.dumps(case))
        asked = [part for measure in measures for part in ("--measure", measure)]
        said = subprocess.run([program, "converge", path, *asked, "--out", folder], capture_output=True, text=True)
    for measure in measures:
        found = re.search(rf"^{re.escape(measure)}: (.*)\n  (.*)(?:\n  extrapolated \S+, error bar of the last (\S+))?", said.stdout, re.M)
        if not found:
            raise SystemExit(f"{case.get('title', measure)}: {said.stderr}")
        order = re.search(r"with the order (\S+)", found[2])
        words = next((short for words, short in (("alternating", "alternates"), ("accidental", "by chance"), ("no order", "within 0.1 %"), ("does not converge", "does not converge"))
                      if words in found[2]), "does not change")
        yield [float(value) for value in found[1].split(", ")], float(found[3]) if found[3] else None, order[1] if order else words


def rows(program, problem, case, numbers, count=4):
    """Rows of a problem: of each number its name, its measure, and what it is divided by."""
    found = converged(program, case, [measure for _, measure, _ in numbers])
    for (name, _, unit), (values, bar, order) in zip(numbers, found):
        told = [digits(value / unit, count) for value in values]
        yield [problem, name, *told, "–" if bar is None else f"{bar / abs(unit):.2g}", order]
        problem = ""


def coarse(case):
    """A case on blocks with a quarter of the elements along every side and increments that are four times as long, as far as a step allows."""
    blocks = [{**block, **quartered(block)} for block in case["mesh"]["blocks"]]
    return {**case, "mesh": {**case["mesh"], "blocks": blocks}, "steps": [lengthened(step) for step in case["steps"]]}


def quartered(block):
    counts, gradings = zip(*(quarter(*side) for side in zip(block["elements"], block.get("grading", [1, 1]))))
    return {"elements": list(counts), "grading": list(gradings)}


def quarter(count, grading):
    """A quarter of the elements along a side, and the grading that two halvings make the one that is given (docs/guide/convergence.md)."""
    least = max(1, round(count / 4))
    middle = isinstance(grading, dict)
    ratio = grading["middle"] if middle else grading
    for n in (2 * least, least):
        ratio **= 2 * max(1, (n - 1) // 2) / max(1, n - 1) if middle else 2 * max(1, n - 1) / (2 * n - 1)
    return least, {"middle": ratio} if middle else ratio


def lengthened(step):
    """A step with increments that are four times as long, but not longer than it is."""
    longer = lambda key, value: 16 * value if key == "error" else min(4 * value, step["duration"]) if key != "min" else value
    return {**step, "dt": {key: longer(key, value) for key, value in step["dt"].items()}} if "dt" in step else step


# Quick ---------------------------------------------------------------------------------------------------------------------------

def bars_sections(program):
    """The rod in its sleeve."""
    numbers = [("p after the fit", "fit.normal_force/fit.contact_length:end@fit", 1), ("F while it sticks", "top.fy:end@pull", 1),
               ("F while it slides", "top.fy:end@slide", 1)]
    return [HEAD, *rows(program, "press fit", coarse(press_fit_case(*FIT)), numbers, 6)]


def bars_of_yielding(program):
    """Tubes, cavities, shafts, bars and columns: what is nearly one-dimensional, in seconds."""
    found = [HEAD]
    for name, kind, element, columns in (("Hill's tube, Q4 F-bar, 24", "Q4", "f_bar", 24), ("Q8 reduced, 8", "Q8", "reduced", 8)):
        found += rows(program, name, coarse(hills_tube_case(kind, element, columns)), [("p/σ_y at E u/(σ_y a) = 4", "bore.fx:end", 2 * pi * 0.1)])
    found += rows(program, "thick sphere, c = 1.5 a", coarse(thick_sphere_case(1.5)), [("E u(b)/(σ_y a)", "near_2_0.ux:end", 1 / E)])
    clay = {"model": "von_mises", "E": 200 * 1.4999, "nu": 0.4999, "sigma_y": 3**0.5}
    found += rows(program, "cavity in clay, Q8 reduced, 40", coarse(cylinder_case(clay, "reduced", "Q8", 40, 1000)), at_widths("p/s_u"))
    sand = {"model": "mohr_coulomb", "E": 50e3, "nu": 0.3, "c": 0.001, "phi": 30, "psi": 10}
    found += rows(program, "cavity in sand, ψ = 10°, Q8 reduced, 60", coarse(cylinder_case(sand, "reduced", "Q8", 60, 4000, 100.0)), at_widths("p"), 5)
    failing = rigid_shaft_case(yielding(0), {"law": "coulomb", "mu": 0.2}, 2 * way_of(1))
    found += rows(program, "rigid shaft, the ground fails", coarse(failing), [("τ₀ at the end", "shaft.fy:end", 2 * pi)], 5)
    hardening = rigid_shaft_case(yielding(0.3 * G), {"law": "coulomb", "mu": 0.15}, way_of(1.4, 0.3 * G))
    found += rows(program, "the ground hardens", coarse(hardening), [("τ₀ when it should be 1.4", "shaft.fy:end", 2 * pi)], 5)
    for slip in (3e-4, 1e-4):
        weakening = compressible_shaft_case({"law": "slip_weakening", "mu_s": 0.1, "mu_d": 0.04, "D_c": slip}, 3e-4)
        found += rows(program, f"long shaft, falls over {slip * G:g} r₀ τ_f/G", coarse(weakening), [("greatest pull over 2π r₀ L τ_f", "head.fy:max", 40 * pi)])
    for name, narrower, kind, element, elements in (("bar, even, Q4 F-bar", 0, "Q4", "f_bar", [6, 12]), ("1.8 % narrower, Q4 F-bar", 0.018, "Q4", "f_bar", [10, 30]),
                                                    ("1.8 % narrower, Q8 reduced", 0.018, "Q8", "reduced", [5, 15])):
        case = bar_case(narrower, kind, element, elements)
        found += rows(program, name, coarse(case), [("greatest F/A₀", "end.fy:max", HALF_WIDTH * (1 - narrower))])
    force = pi**2 * tangent_modulus() / (12 * 58**2)
    aside = column_case(58, 0.032, 400, force / 1000)
    return [*found, *rows(program, "column, L/h = 58, pushed aside", coarse(aside), [("greatest P over P_t", "head.fx:min", -force)])]


def at_widths(name):
    """The pressure in a cavity when it is half as wide again, twice and four times as wide; the force on it is that on a row of elements 0.1 high."""
    return [(f"{name} at a/a₀ = {width:g}", f"bore.fx:end@to {width:g} a", 2 * pi * width * 0.1) for width in (1.5, 2, 4)]


# Slow ----------------------------------------------------------------------------------------------------------------------------

def bars_of_mechanisms(program):
    """Footings, pipes and walls."""
    found, clay = [HEAD], {**von_mises(3**0.5), "E": 1e4}
    for name, kind, element in (("footing on clay, Q4 F-bar", "Q4", "f_bar"), ("Q8 reduced", "Q8", "reduced"), ("T6", "T6", "displacement")):
        case = footing_case({"material": clay, "element": element}, kind, *FINE[kind], 2.5, 0.004)
        found += rows(program, name, coarse(case), [("N_c", "footing.fy:end", -0.5)])
    body, strength = cam_clay(100)
    case = footing_case({**body, "element": "reduced"}, "Q8", [[10, 0.15], [14, 30]], [14, 0.04], 2.5, 0.001, 100, dt={"initial": 0.01, "max": 0.01, "min": 1e-6})
    found += rows(program, "on Cam-clay, OCR 1, G/s_u = 7500, Q8 reduced", coarse(case), [(f"N_c + {100 / strength:.4g}, with the surcharge", "footing.fy:end", -0.5 * strength)])
    for psi, viscosity in ((20, 0), (5, 1e-4)):
        soil = {"model": "mohr_coulomb", "E": 1e4, "nu": 0.3, "c": 1, "phi": 20, "psi": psi, "viscosity": viscosity}
        case = footing_case({"material": soil, "element": "reduced"}, "Q8", *FINE["Q8"], 4, 0.01)
        found += rows(program, f"on soil, ψ = {psi}°, Q8 reduced", coarse(case), [("N_c", "footing.fy:end", -0.5)])
    for vertical, name in ((3, "Q8 reduced, B/95"), (4.5, "Q8 reduced, B/95"), (4.5, "Q4 F-bar, B/100")):
        case = inclined_footing_case(vertical, 1, **MESHES[name])
        found += rows(program, f"V = {vertical:g} B s_u, {name}", coarse(case), [("H/(B s_u)", "footing.fx:end", 1)])
    for name, alpha, bonded in (("pipe, bonded", 1, True), ("contact, α = 1", 1, False), ("contact, frictionless", 0, False)):
        for elements, kind, element, around, rings in ((", Q8 reduced", "Q8", "reduced", 16, 20), (", Q4 F-bar", "Q4", "f_bar", 32, 32)):
            case = pipe_case(alpha, kind, element, around, rings, bonded)
            found += rows(program, name + elements, coarse(case), [("N", "pipe.fx:end" if bonded else "tool.fx:end", 0.5)])
    for phi, delta, weight in ((30, 0, 0), (30, 20, 0), (30, 20, 1), (35, 0, 0)):
        case = wall_case(phi, delta, weight)
        name = f"wall, φ = {phi}°, " + ("δ = 2φ/3" if delta else "smooth")
        found += rows(program, name, coarse(case), [("K_pγ" if weight else "K_pq", "wall.fx:end", (0.5 if weight else 1) * cos(radians(delta)))])
    return found


def bars_block(program):
    """The block on ground."""
    ratio = "base.tangential_force/base.normal_force"
    return [HEAD, *rows(program, "block on ground", committed("cases/block_on_ground.json"), [("largest F_t/F_n", ratio + ":max", 1), ("F_t/F_n at the end", ratio + ":end", 1)], 5)]


def bars_tutorial(program):
    """The blocks of the tutorial, whose case stands there."""
    text = (ROOT / "docs/tutorial.md").read_text()
    case = next(json.loads(block) for block in re.findall(r"```json\n(.*?)```", text, re.S) if '"blocks"' in block)
    ratio = "base.tangential_force/base.normal_force"
    numbers = [("peak of F_t/F_n", ratio + ":max@drag", 1), ("at the end of `drag`", ratio + ":end@drag", 1), ("peak after the hold", ratio + ":max@again", 1)]
    return [HEAD, *rows(program, "blocks", case, numbers)]


def bars_cylinder(program):
    """NAFEMS's cylinder."""
    found = [HEAD]
    for name, case in (("Q4", "hertz_q4"), ("Q8", "hertz_q8")):
        found += rows(program, name, committed(f"cases/validation/{case}.json"), [("u_y(0, 0) [mm]", "touch.uy:end", 1)], 6)
    return found


def bars_greco(program):
    """Places along the bottom of the GRECO block."""
    places = (0, 1.25, 5, 7.5, 11.25)
    case = {**committed("cases/validation/greco.json"), "watch": [{"near": [place, 0]} for place in places]}
    return [HEAD, *rows(program, "GRECO", case, [(f"u_x({place:g}) [µm]", f"near_{place:g}_0.ux:end", 1e-3) for place in places], 6)]


def bars_wedge(program):
    return [HEAD, *rows(program, "wedge", committed("cases/validation/wedge.json"), [("F/G", "block_left.fx:end", 25)], 6)]


def bars_pile(program):
    """The pile over the first three tenths of its way, in which it bears most, at first in increments of four times the length of its own."""
    case = committed("cases/pile.json")
    case["steps"][0].update(duration=0.3, dt={"initial": 0.01, "max": 0.01})
    case["steps"][0]["supports"][2]["uy"] = 0.3 * case["steps"][0]["supports"][2]["uy"]
    return [HEAD, *rows(program, "pile", case, [("largest F/N", "pile_head.fy/shaft.normal_force:max", 1)])]


def bars_shear_box(program):
    """The shear box, at first with elements and increments of twice the size of its own."""
    case = committed("cases/shear_box.json")
    case["mesh"]["parameters"]["h"] *= 2
    case["steps"][1]["dt"] = {"initial": 1, "max": 1}
    numbers = [("normal force [N/mm]", "joint.normal_force:end", 1), ("friction over normal force", "joint.tangential_force/joint.normal_force:end", 1)]
    return [HEAD, *rows(program, "shear box", case, numbers, 5)]


BARS = {"bars_sections": bars_sections, "bars_of_yielding": bars_of_yielding, "bars_wedge": bars_wedge}
SLOW_BARS = {
    "bars_of_mechanisms": bars_of_mechanisms,
    "bars_block": bars_block,
    "bars_tutorial": bars_tutorial,
    "bars_cylinder": bars_cylinder,
    "bars_greco": bars_greco,
    "bars_pile": bars_pile,
    "bars_shear_box": bars_shear_box,
}


if __name__ == "__main__":
    for asked in sys.argv[2:]:
        print(text_of({**BARS, **SLOW_BARS}[asked](str(pathlib.Path(sys.argv[1]).resolve()))), flush=True)
