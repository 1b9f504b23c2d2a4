"""Tables of the quick tier: plates, rings and interfaces that move against closed forms, on meshes of blocks that stand here.

Every function runs cases and returns rows, the head first. Needs numpy.
"""

from math import pi, sqrt, tanh

import numpy as np

from problems import HEAD, digits, row
from results import Run, committed, law, table

E, NU = 200.0, 0.3
LINEAR = {"material": {"model": "linear", "E": E, "nu": NU}}


def block(body, corners, elements, sides, **more):
    return {"body": body, "corners": corners, "elements": elements, "sides": sides, **more}


def solid(section, blocks, supports, loads, **more):
    """A body of linear elasticity in one static increment."""
    step = {"name": "load", "duration": 1, "dt": {"initial": 1}, "supports": supports, "loads": loads}
    return {"section": section, "mesh": {"blocks": blocks}, "bodies": {"body": LINEAR}, "steps": [step], **more}


def moved(run, x, y):
    """Displacement of the node at a place."""
    frame = run.frame("solid")
    return frame["displacement"][np.hypot(frame["Points"][:, 0] - x, frame["Points"][:, 1] - y).argmin()]


def quarter(a, b, elements, grading=1.0):
    """A quarter of a ring, or of a sphere, of quadratic elements: from the x axis to the y axis."""
    corners, arcs = [[a, 0], [b, 0], [0, b], [0, a]], [None, [0, 0], None, [0, 0]]
    return [block("body", corners, elements, ["bottom", "outside", "axis", "inside"], arcs=arcs, grading=[grading, 1], kind="Q8")]


def tube(program):
    """A thick tube under a pressure inside: its run, Lamé's u_r, and its radii."""
    a, b, p = 1.0, 2.0, 0.7
    mesh = [block("body", [[a, 0], [b, 0], [b, 0.5], [a, 0.5]], [16, 2], ["bottom", None, "top", "inside"], kind="Q8")]
    held = [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}]
    run = Run(program, solid("axisymmetric", mesh, held, [{"on": "inside", "traction": {"x": p}}], watch=["top"]))
    return run, lambda r: (1 + NU) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * NU) * r + b**2 / r), (a, b)


def lame(program):
    """A thick tube and a hollow sphere under a pressure inside."""
    run, exact, (a, b) = tube(program)
    rows = [["problem", *HEAD]]
    rows += [["tube", *row(f"10³ u_r at r = {r:g}", 1e3 * exact(r), 1e3 * moved(run, r, 0.25)[0])] for r in (a, 1.5, b)]
    rows.append(["tube", *row("force that holds it", 2 * NU * 0.7 * pi * a**2, abs(run.last("top.fy")))])
    p = 1e-5
    run = Run(program, solid("axisymmetric", quarter(a, b, [10, 16]), [{"on": "bottom", "uy": 0}], [{"on": "inside", "pressure": p}]))
    exact = lambda r: p * a**3 / (E * (b**3 - a**3)) * ((1 - 2 * NU) * r + (1 + NU) * b**3 / (2 * r**2))
    rows += [["sphere", *row(f"10⁹ u_r at r = {r:g}", 1e9 * exact(r), 1e9 * moved(run, r, 0)[0])] for r in (a, 1.5, b)]
    return rows


def kirsch(program):
    """A plate with a hole, pulled along x; it ends at 200 radii."""
    a, b, s = 1.0, 200.0, 0.5
    held = [{"on": "bottom", "uy": 0}, {"on": "axis", "ux": 0}]
    case = solid({"plane_stress": {"thickness": 0.1}}, quarter(a, b, [80, 24], (b / a) ** (79 / 80)), held,
                 [{"on": "outside", "traction": {"x": f"{s} * x / {b}"}}],
                 probes={"side": {"at": [0, a]}, "front": {"at": [a, 0]}})
    run = Run(program, case)
    stress = table(run.folder / "probes.csv")
    return [[*HEAD],
            row("E u_x/(S a), front of the hole", 3, moved(run, a, 0)[0] * E / (s * a)),
            row("E u_y/(S a), side of the hole", -1, moved(run, 0, a)[1] * E / (s * a)),
            row("σ_xx/S at its side", 3, stress["side.stress_xx"][-1] / s),
            row("σ_yy/S at its front", -1, stress["front.stress_yy"][-1] / s)]


def sphere(program):
    """A rigid sphere on an elastic half-space, which ends at 500 a: a = √(Rδ), p₀ = 2 E* a/(πR), P = 4/3 E* a δ."""
    radius, delta, even, far = 50.0, 0.02, 1.5, 500.0
    a, star = sqrt(radius * delta), E / (1 - NU**2)
    x, n, m = [0.0, even, far], 60, 40
    ratio = (far / even) ** ((m - 1) / m)
    mesh = []
    for i in range(2):
        for j in range(2):
            corners = [[x[i], -x[j + 1]], [x[i + 1], -x[j + 1]], [x[i + 1], -x[j]], [x[i], -x[j]]]
            names = ["bottom" if j else None, "right" if i else None, None if j else "top", None]
            mesh.append(block("body", corners, [m if i else n, m if j else n], names,
                              grading=[ratio if i else 1, 1 / ratio if j else 1]))
    rows = [["method", *HEAD]]
    for method in ("gauss_to_segment", "mortar", "node_to_segment"):
        contact = {"slave": "top", "master": {"circle": {"centre": [0, radius], "radius": radius}}, "method": method,
                   "friction": {"law": "frictionless"}, "normal": {"alpha_n": 1e5 * E}}
        step = {"name": "press", "duration": 1, "dt": {"initial": 0.25, "max": 0.25},
                "supports": [{"on": "bottom", "ux": 0, "uy": delta}, {"on": "right", "ux": 0, "uy": delta}]}
        run = Run(program, {"section": "axisymmetric", "mesh": {"blocks": mesh}, "bodies": {"body": LINEAR},
                            "contacts": {"base": contact}, "steps": [step]})
        rows.append([method, *row("P", 4 / 3 * star * a * delta, run.last("base.normal_force"), 5)])
        rows.append(["", *row("a", a, sqrt(run.last("base.contact_length") / pi), 5)])
        rows.append(["", *row("p₀", 2 * star * a / (pi * radius), run.frame()["pressure"].max(), 5)])
    return rows


def press_fit_case(a, length, delta, beta, mu, alpha_n):
    """A rod in a rigid sleeve that is fitted, pulled while it sticks, and on while it slides."""
    mesh = [block("rod", [[0, 0], [a, 0], [a, length], [0, length]], [4, 60], [None, "side", "top", None])]
    contact = {"slave": "side", "master": {"plane": {"point": [a - delta, 0], "normal": [-1, 0]}}, "method": "mortar",
               "shrink_fit": True, "normal": {"alpha_n": alpha_n},
               "friction": {"law": "coulomb", "mu": mu, "alpha_t": 0.5 * beta**2 * E * a}}
    steps = [{"name": name, "duration": 1, "dt": {"initial": dt}, "supports": [{"on": "top", "uy": way}]}
             for name, dt, way in (("fit", 0.5, 0), ("pull", 0.5, 0.05), ("slide", 0.1, 1))]
    return {"section": "axisymmetric", "mesh": {"blocks": mesh}, "contacts": {"fit": contact}, "watch": ["top"],
            "bodies": {"rod": {"material": {"model": "linear", "E": E, "nu": 0}}}, "newton": {"tolerance": 1e-10}, "steps": steps}


# Radius and length of the rod, overlap, β, μ and α_n of its fit.
FIT = (1.0, 10.0, 1e-3, 0.1, 0.5, 1e4)


def press_fit(program):
    """A rod in a rigid sleeve: its pressure, the pull while it sticks (shear lag), and the pull while it slides."""
    a, length, delta, beta, mu, alpha_n = FIT
    run, p = Run(program, press_fit_case(*FIT)), 0.0
    for _ in range(60):
        p = E * (delta - p / alpha_n) / (a - delta + p / alpha_n)
    stuck = pi * a**2 * E * beta * 0.05 * tanh(beta * length)
    return [[*HEAD], row("p after the fit", p, run.frame(time=1.0)["pressure"].mean()),
            row("F while it sticks", stuck, abs(run.at("top.fy", 2.0))),
            row("F while it slides", mu * p * 2 * pi * a * length, abs(run.last("top.fy")))]


def pile(program):
    """The pile: its peak over the normal force, with friction that weakens slowly, and as it is."""
    rows = [["friction of the shaft", "largest q/p of the law alone", "largest F/N of the pile", "difference"]]
    case = committed("cases/pile.json")
    for name, kappa in (("weakens over 0.2 m", 5.0), ("over 2 mm, as in the case", 500.0)):
        friction = case["contacts"]["shaft"]["friction"] = {**case["contacts"]["shaft"]["friction"], "kappa": kappa}
        run = Run(program, case)
        peak = run.history["pile_head.fy"].argmax()
        alone = law(program, {"friction": friction, "initial": {"pressure": 45}, "dt": 1e-3, "path": [{"duration": 4, "slip": {"rate": 2e-3}}]})
        found = run.history["pile_head.fy"][peak] / run.history["shaft.normal_force"][peak]
        rows.append([name, *row("", alone["traction"].max() / 45, found, 4)[1:]])
    return rows


def shear_box(program):
    """The shear box, when friction has come down to μ_k: N₀ + d/(1/K + 2 H (1 − ν²)/(E A)), and μ_k."""
    run = Run(program, committed("cases/shear_box.json"))
    dilation = run.last("joint.mean_dilation")
    expected = run.at("joint.normal_force", 10.0) + dilation / (1 / 800 + 80 * (1 - 0.2**2) / (2000 * 100))
    normal = run.last("joint.normal_force")
    return [[*HEAD], row("normal force [N/mm]", expected, normal, 5),
            row("friction over normal force", 0.5, abs(run.last("joint.tangential_force")) / normal, 4)]


def injection(program):
    """A fluid injected into a fault near its strength: when slip begins, and the length at which it runs away."""
    steepest, pressure, tau, columns = 1.158 / 0.7, 0.01, 0.98, 256
    ratio = 1.18**17
    mesh = [block("lower", [[-4, -5], [4, -5], [4, 0], [-4, 0]], [columns, 18], ["fixed", "fixed", "below", "fixed"], grading=[1, 1 / ratio]),
            block("upper", [[-4, 0], [4, 0], [4, 5], [-4, 5]], [columns, 18], ["above", "fixed", "fixed", "fixed"], grading=[1, ratio])]
    body = {"material": {"model": "linear", "E": 2.6, "nu": 0.3}}
    rows = [["width of the patch", *HEAD]]
    for width in (0.3, 1.0):
        fault = {"slave": "above", "master": "below", "method": "node_to_segment", "sliding": "small", "normal": {"alpha_n": 1000 * steepest},
                 "fluid_pressure": f"t*{(1 - tau) * pressure}*exp(-(x/{width})^2)",
                 "friction": {"law": "slip_weakening", "mu_s": 0.5, "mu_d": 0.1, "D_c": 0.4 * pressure / steepest, "alpha_t": 50 * steepest},
                 "initial": {"pressure": pressure, "traction": 0.5 * pressure * tau, "balanced": True}}
        step = {"name": "inject", "duration": 10, "dt": {"initial": 0.02, "max": 0.02, "min": 1e-5}, "supports": [{"on": "fixed", "ux": 0, "uy": 0}]}
        run = Run(program, {"mesh": {"blocks": mesh}, "bodies": {"lower": body, "upper": body}, "contacts": {"fault": fault}, "steps": [step]}, may_stop=True)
        slips = run.history["fault.mean_slip"] != 0
        length = (run.frame()["slip"] != 0).sum() * 8 / columns
        rows.append([digits(width, 2), *row("slip begins at t =", 1, run.history["time"][slips][0], 3)])
        rows.append(["", *row("length at which it runs away", 1, length, 3)])
    return rows


CLOSED = {
    "lame": lame,
    "kirsch": kirsch,
    "sphere": sphere,
    "press_fit": press_fit,
    "pile": pile,
    "shear_box": shear_box,
    "injection": injection,
}
