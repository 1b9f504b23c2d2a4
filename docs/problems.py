"""Tables of the quick tier: problems of seconds, each against its reference. Every function runs cases and returns rows, the head first.

`docs/tables.py` puts them into the pages in docs/validation, where each problem is told, and compares them. Needs numpy.
"""

import json
import re
from math import exp, pi, sqrt

import numpy as np

import greco_exact
from results import ROOT, Run, committed, law, table

HEAD = ["quantity", "reference", "ours", "difference"]
COST = ["Newton iterations (most)", "cut-backs"]


def digits(value, count=6):
    """A number with so many digits."""
    return f"{value:.{max(0, count - 1 - int(np.floor(np.log10(abs(value)))))}f}"


def row(quantity, reference, ours, count=6):
    difference = f"{100 * (ours / reference - 1):+.2f} %"
    return [quantity, digits(reference, count), digits(ours, count), difference.replace("-0.00", "0.00").replace("+0.00", "0.00")]


def first_case(program):
    """The block on ground: friction of the whole block."""
    run = Run(program, committed("cases/block_on_ground.json"))
    friction = run.history["base.tangential_force"] / run.history["base.normal_force"]
    slides = run.history["base.slip_fraction"]
    way = run.history["block_top.ux"]
    peak = friction.argmax()
    found = [f"{friction[peak]:.3f} at {way[peak]:.4f} mm", f"{way[slides > 0.02][0]:.4f} mm", f"{way[slides > 0.98][0]:.4f} mm", f"{friction[-1]:.3f}"]
    names = ["largest F_t/F_n", "2 % of the contact slips from", "98 % from", "F_t/F_n at the end"]
    return [["block on ground", "at the top"], *map(list, zip(names, found))]


def li(x):
    """The logarithmic integral by Ramanujan's series."""
    log = np.log(x)
    total, harmonic, factor = 0.0 * log, 0.0, 1.0
    for n in range(1, 60):
        harmonic += 1 / n if n % 2 else 0.0
        factor *= 1.0 / n if n > 1 else 1.0
        total = total + (-1) ** (n - 1) * log**n * factor / 2 ** (n - 1) * harmonic
    return np.euler_gamma + np.log(np.abs(log)) + np.sqrt(x) * total


def law_alone(program):
    """The super/subloading law alone, against closed forms (the page of the law has their equations)."""
    case = committed("cases/law/monotone.json")
    told = case["friction"]
    mu_s, mu_k, r, kappa, p = told["mu_s"], told["mu_k"], told["r"], told["kappa"], case["initial"]["pressure"]
    ratio = np.linspace(0.5, 0.999, 20001)
    slip = -li(ratio) / r
    friction = ratio * (mu_k + (mu_s - mu_k) * np.exp(-kappa * slip / mu_k))
    best = friction.argmax()
    case["friction"] = {**told, "xi": 0.0}
    case["dt"] = 1e-4
    found = law(program, case)
    at = found["traction"].argmax()
    rows = [[*HEAD], row("peak of q/p, no recovery", friction[best], found["traction"][at] / p, 5),
            row("its slip [m]", friction[best] * p / told["alpha_t"] + slip[best], found["slip"][at], 3)]
    case = committed("cases/law/velocity_steps.json")
    told, found = case["friction"], law(program, case)
    end = 0.0
    for leg, name in zip(case["path"][:3], ("0.01", "0.001", "0.0001")):
        end += leg["duration"]
        rate = leg["slip"]["rate"]
        steady = (told["kappa"] * rate + told["xi"]) / (told["kappa"] * rate / told["mu_k"] + told["xi"] / told["mu_s"])
        at = np.abs(found["time"] - end).argmin()
        rows.append(row(f"steady q/p at {name} mm/s", steady, found["traction"][at] / found["pressure"][at], 5))
    case = committed("cases/law/hold_slide_hold.json")
    told, found = case["friction"], law(program, case)
    at = lambda time: np.abs(found["time"] - time).argmin()
    before, after = found["mu"][at(91.0)], found["mu"][at(91.0 + 64.0)]
    rows.append(row("μ after a hold of 64 s", told["mu_s"] - (told["mu_s"] - before) * exp(-told["xi"] * 64 / told["mu_s"]), after, 5))
    return rows


def cylinder_on_block(program):
    """NAFEMS's cylinder with large displacements, and the pressure of Hertz with small ones."""
    rows = [["problem", *HEAD, *COST]]
    for name, case, published in (
        ("Q4", "hertz_q4", -1.30690), ("Q8", "hertz_q8", -1.30802), ("Q8, μ = 0.1", "hertz_q8_friction", -1.30264),
    ):
        run = Run(program, committed(f"cases/validation/{case}.json"))
        rows.append([name, *row("u_y(0, 0) [mm]", published, run.last("touch.uy")), *run.cost()])
    run = Run(program, committed("cases/validation/hertz_q8_small_strain.json"))
    x, p = along(run)
    at_0 = p[0] - (p[1] - p[0]) * x[0] / (x[1] - x[0])
    rows.append(["Q8, small strain", *row("p(0) [MPa]", 3585.4, at_0), *run.cost()])
    return rows


def along(run, time=None, what="pressure"):
    """x and a field of the closed points of a contact, by x of the deformed slave."""
    frame = run.frame("contact", time)
    closed = frame["pressure"] > 0
    x, values = frame["places"][closed, 0], frame[what][closed]
    order = np.argsort(x)
    return x[order], values[order]


def partial_slip_of(run):
    """What Cattaneo and Mindlin say of a run: half-widths a and c, p₀, and the tractions at x from the centre."""
    x, p = along(run)
    _, q = along(run, what="traction")
    force, load = abs(run.last("cylinder_top.fx")), abs(run.last("cylinder_top.fy"))
    a = sqrt(4 * load * 50 / (pi * 210000 / (2 * (1 - 0.3**2))))
    x = x - 0.5 * (x[0] + x[-1])
    return {"x": x, "p": p, "q": q, "a": a, "c": a * sqrt(1 - force / (0.3 * load)), "p0": 2 * load / (pi * a)}


def ellipse(x, half):
    return np.sqrt(np.maximum(0.0, 1 - (x / half) ** 2))


def partial_slip(program):
    """Cattaneo–Mindlin for the forces that the prescribed displacements bring about."""
    run = Run(program, committed("cases/validation/mindlin.json"))
    of = partial_slip_of(run)
    x, p, q, a, c, p0 = (of[name] for name in ("x", "p", "q", "a", "c", "p0"))
    element = (x[-1] - x[0]) / (len(x) - 1)
    inside = np.abs(x) < 0.97 * a
    smooth = inside & (np.abs(np.abs(x) - c) > 4 * element)
    p_error = np.abs(p - p0 * ellipse(x, a))[inside].max() / p0
    shear = 0.3 * p0 * (ellipse(x, a) - c / a * ellipse(x, c))
    q_error = np.abs(q - shear)[smooth].max() / (0.3 * p0)
    stuck = x[q < 0.999 * 0.3 * p]
    rows = [[*HEAD, *COST], [*row("p(0) [MPa]", p0, p[np.abs(x).argmin()]), *run.cost()]]
    rows.append([*row("c [mm]", c, 0.5 * (stuck[-1] - stuck[0] + element)), "", ""])
    rows.append(["largest error of p/p₀", "0", f"{p_error:.4f}", f"{100 * p_error:+.2f} %", "", ""])
    rows.append(["largest error of q/(μ p₀)", "0", f"{q_error:.4f}", f"{100 * q_error:+.2f} %", "", ""])
    return rows


def partial_slip_heals(program):
    """The super/subloading law: what sticks lies between c for μ_s and for μ_k; μ heals by its closed form in a hold."""
    run = Run(program, committed("cases/validation/mindlin_healing.json"))
    load, force = abs(run.at("cylinder_top.fy", 2.1)), abs(run.at("cylinder_top.fx", 2.1))
    a = sqrt(4 * abs(run.at("cylinder_top.fy", 1.1)) * 50 / (pi * 210000 / (2 * 0.91)))
    x, p = along(run, 2.1)
    _, ratio = along(run, 2.1, "R")
    stuck = x[ratio < 0.9]
    element = (x[-1] - x[0]) / (len(x) - 1)
    least, most = (a * sqrt(max(0.0, 1 - force / (mu * load))) for mu in (0.2, 0.3))
    weakest = along(run, 2.1, "mu")[1].min()
    healed = along(run, 12.1, "mu")[1].min()
    return [[*HEAD],
            ["c at the end of the shift [mm]", f"{least:.3f} (μ_k) to {most:.3f} (μ_s)", f"{0.5 * (stuck[-1] - stuck[0] + element):.3f}", "between"],
            row("lowest μ after a hold of 10 s", 0.3 - (0.3 - weakest) * exp(-0.03 * 10 / 0.3), healed)]


def greco(program):
    """u_x along the bottom, against the mean of several codes."""
    run, x, u = greco_bottom(program)
    published = ((0, 28.65), (1.25, 27.27), (5, 22.90), (7.5, 19.84), (11.25, 15.0))
    rows = [row(f"u_x({place:g}) [µm]", value, np.interp(place, x, u)) for place, value in published]
    return [[*HEAD, *COST], [*rows[0], *run.cost()], *([*other, "", ""] for other in rows[1:])]


def greco_profile(program):
    """p and q along the bottom by three methods, against states of nodes that meet the conditions exactly."""
    methods = (("at nodes", "node_to_segment"), ("at Gauss points (default)", None), ("mortar", "mortar"))
    x, _, p, q = greco_exact.bottom(40)
    found = [("states met exactly", x, p, q)]
    for name, method in methods:
        case = committed("cases/validation/greco.json")
        case["contacts"]["base"]["method"] = method
        frame = Run(program, case).frame("contact")
        order = np.argsort(frame["Points"][:, 0])
        found.append((name, *(values[order] for values in (frame["Points"][:, 0], frame["pressure"], frame["traction"]))))
    head = [["", *(f"{name}({place:g})" for name, places in (("p", GRECO_PLACES), ("q", GRECO_PLACES[-2:])) for place in places)]]
    return head + [[name, *(f"{np.interp(place, x, p):.2f}" for place in GRECO_PLACES), *(f"{np.interp(place, x, q):.2f}" for place in GRECO_PLACES[-2:])]
                   for name, x, p, q in found]


GRECO_PLACES = (5, 10, 15, 20, 25, 32, 36)


def greco_bottom(program):
    run = Run(program, committed("cases/validation/greco.json"))
    frame = run.frame("contact")
    order = np.argsort(frame["Points"][:, 0])
    return run, frame["Points"][order, 0], 1e3 * frame["displacement"][order, 0]


def wedge(program):
    """F/G = (tan a + μ)/(1 − μ tan a)."""
    run = Run(program, committed("cases/validation/wedge.json"))
    return [[*HEAD, *COST], [*row("F/G", 0.4 / 0.97, run.last("block_left.fx") / 25), *run.cost()]]


def spring_mass(program):
    """The point mass whose ringing is damped away: when it slips, against the quasi-static onset; and the block on the slope."""
    rows = [["case", *HEAD]]
    for number, reference in ((3, 3088.7), (4, 4682.5), (5, 2299.7)):
        run = Run(program, committed(f"cases/paper/spring_mass_{number}_damped.json"))
        rate = np.sqrt(2 * run.history["kinetic"] / 10)
        fast = np.flatnonzero((rate[1:-1] > 0.05) & (rate[1:-1] >= np.maximum(rate[:-2], rate[2:])))[0] + 1
        rows.append([f"`spring_mass_{number}_damped`", *row("first slip", reference, run.history["time"][fast], 5)])
    return rows


def coulomb_drag(program):
    """The block dragged with Coulomb friction, against GetFEM and CalculiX."""
    rows = [["mesh", *HEAD, *COST]]
    for name, *published in (("5k", 990413, 288252, 961231), ("20k", 987735, 287585, 959026)):
        run = Run(program, committed(f"cases/coulomb_drag_{name}.json"))
        found = (run.history["block_top.fy"][4], run.last("block_top.fx"), run.last("block_top.fy"))
        names = ("F_n after the press", "F_t at the end", "F_n at the end")
        three = [row(*each) for each in zip(names, published, map(abs, found))]
        rows += [[f"{name} dofs", *three[0], *run.cost()], *(["", *other, "", ""] for other in three[1:])]
    return rows

def cut_back(program):
    """The attempts at an increment of the tutorial's blocks that is asked for too much; what docs/guide/statics.md tells."""
    text = (ROOT / "docs/tutorial.md").read_text()
    case = next(json.loads(block) for block in re.findall(r"```json\n(.*?)```", text, re.S) if '"blocks"' in block)
    case["contacts"]["base"].update(friction={"law": "coulomb", "mu": 0.8}, normal={"alpha_n": 1.5e7}, method="gauss_to_segment")
    case["steps"] = case["steps"][:2]
    case["steps"][1].update(dt={"initial": 5}, supports=[{"on": "block_top", "ux": {"rate": 0.6}}])
    run = Run(program, case)
    solves = table(run.folder / "newton.csv")
    rows = [["attempt", "to time", "linear solves", "last residuals", "open, stick, slip; flips", "verdict", "reason"]]
    for attempt in sorted(set(solves["attempt"][solves["increment"] == 6])):
        of = np.flatnonzero((solves["increment"] == 6) & (solves["attempt"] == attempt))
        # Where an iterate could not be evaluated its points have no state: that of the one before.
        seen = of[-1] if np.isfinite(solves["residual"][of[-1]]) else of[-2]
        states = ", ".join(f"{solves[name][seen]:.0f}" for name in ("open", "stick", "slip"))
        residuals = ", ".join("NaN" if np.isnan(residual) else f"{residual:.2g}" for residual in solves["residual"][of[-3:]])
        rows.append([f"{attempt:.0f}", f"{solves['time'][of[0]]:g}", str(len(of)), residuals,
                     f"{states}; {solves['flips'][seen]:.0f}", solves["verdict"][of[-1]], solves["reason"][of[-1]]])
    return rows


QUICK = {
    "first_case": first_case,
    "law_alone": law_alone,
    "cylinder_on_block": cylinder_on_block,
    "partial_slip": partial_slip,
    "partial_slip_heals": partial_slip_heals,
    "greco": greco,
    "greco_profile": greco_profile,
    "wedge": wedge,
    "spring_mass": spring_mass,
    "coulomb_drag": coulomb_drag,
    "cut_back": cut_back,
}
