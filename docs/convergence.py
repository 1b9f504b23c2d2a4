"""Error bars of `fecontact converge` against closed forms: python3 docs/convergence.py target/release/fecontact.

Every problem starts on a coarse mesh and is refined twice. Prints the tables of docs/validation/convergence.md, or with the names of
problems behind the program these alone.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from math import exp, log, pi, sin, sqrt
from statistics import median

from closed_forms import E, LINEAR, NU, block, quarter

QUIET = {"fields": False, "report": False}


def step(supports, loads=(), dt=1.0, **more):
    return {"name": "load", "duration": 1, "dt": {"initial": dt, "max": dt, "min": dt / 1000}, "supports": supports, "loads": list(loads), **more}


def of_kind(blocks, kind):
    return {"blocks": [{**one, "kind": kind} for one in blocks]}


def tube(kind):
    """A thick tube under a pressure inside (Lamé)."""
    a, b, h, p = 1.0, 2.0, 0.5, 0.7
    mesh = of_kind([block("body", [[a, 0], [b, 0], [b, h], [a, h]], [3, 1], ["bottom", "outside", "top", "inside"])], kind)
    held = [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}]
    case = {"section": "axisymmetric", "mesh": mesh, "bodies": {"body": LINEAR}, "watch": ["inside", "outside"],
            "steps": [step(held, [{"on": "inside", "traction": {"x": p}}])]}
    u = lambda r: (1 + NU) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * NU) * r + b**2 / r)
    return case, {"inside.ux:end": u(a), "outside.ux:end": u(b), "strain:end": 0.5 * p * 2 * pi * a * h * u(a)}


def shell(kind):
    """A thick sphere under a pressure inside (Lamé)."""
    a, b, p = 1.0, 2.0, 1e-5
    mesh = of_kind(quarter(a, b, [3, 4]), kind)
    case = {"section": "axisymmetric", "mesh": mesh, "bodies": {"body": LINEAR}, "watch": [{"near": [a, 0]}, {"near": [b, 0]}],
            "steps": [step([{"on": "bottom", "uy": 0}], [{"on": "inside", "pressure": p}])]}
    u = lambda r: p * a**3 / (E * (b**3 - a**3)) * ((1 - 2 * NU) * r + (1 + NU) * b**3 / (2 * r**2))
    return case, {"near_1_0.ux:end": u(a), "near_2_0.ux:end": u(b), "strain:end": 0.5 * p * 2 * pi * a**2 * u(a)}


def hole(kind):
    """A plate with a hole, pulled along x (Kirsch); it ends at 1000 radii."""
    a, b, s, n = 1.0, 1000.0, 0.5, 24
    mesh = of_kind(quarter(a, b, [n, 6], (b / a) ** ((n - 1) / n)), kind)
    held = [{"on": "bottom", "uy": 0}, {"on": "axis", "ux": 0}]
    case = {"section": {"plane_stress": {"thickness": 0.1}}, "mesh": mesh, "bodies": {"body": LINEAR},
            "watch": [{"near": [a, 0]}, {"near": [0, a]}], "steps": [step(held, [{"on": "outside", "traction": {"x": f"{s} * x / {b}"}}])]}
    return case, {"near_1_0.ux:end": 3 * s * a / E, "near_0_1.uy:end": -s * a / E}


def rigid_sphere(method):
    """A rigid sphere on an elastic half-space, which ends at 5000 a (Hertz, who neglects a/R)."""
    radius, delta, even, far, n, m = 5000.0, 2e-4, 1.6, 5000.0, 12, 14
    a, star = sqrt(radius * delta), E / (1 - NU**2)
    x, ratio, mesh = [0.0, even, far], (far / even) ** ((m - 1) / m), []
    for i in range(2):
        for j in range(2):
            corners = [[x[i], -x[j + 1]], [x[i + 1], -x[j + 1]], [x[i + 1], -x[j]], [x[i], -x[j]]]
            sides = ["bottom" if j else None, "right" if i else None, None if j else "top", None]
            mesh.append(block("body", corners, [m if i else n, m if j else n], sides, grading=[ratio if i else 1, 1 / ratio if j else 1]))
    contact = {"slave": "top", "master": {"circle": {"centre": [0, radius], "radius": radius}}, "method": method,
               "friction": {"law": "frictionless"}}
    held = [{"on": "bottom", "ux": 0, "uy": delta}, {"on": "right", "ux": 0, "uy": delta}]
    case = {"section": "axisymmetric", "mesh": {"blocks": mesh}, "bodies": {"body": LINEAR}, "contacts": {"base": contact}, "steps": [step(held, dt=0.25)]}
    force = 4 / 3 * star * a * delta
    return case, {"base.normal_force:end": force, "base.contact_length:end": pi * a**2, "strain:end": 0.4 * force * delta}


def half_planes(method):
    """Two bodies of one material, one of them round, pressed by P and sheared by Q (Hertz; Cattaneo and Mindlin). They end at 20 a."""
    a, radius, size, mu, near, n, m = 1.0, 1000.0, 20.0, 0.5, 1.3, 10, 9
    star = E / (2 * (1 - NU**2))
    load = pi * star * a**2 / (4 * radius)
    push = 0.75 * mu * load
    rise = lambda x: radius - sqrt(radius**2 - x**2)
    x, ratio, mesh = [-size, -near, near, size], (size / near) ** ((m - 1) / m), []
    for i in range(3):
        left, right = x[i], x[i + 1]
        columns, grading = (n, 1) if i == 1 else (m, ratio if i == 2 else 1 / ratio)
        mesh.append(block("lower", [[left, -size], [right, -size], [right, 0], [left, 0]], [columns, m + 3], ["fixed", None, "below", None],
                          grading=[grading, 0.02]))
        arc = [[0, radius], None, None, None]
        mesh.append(block("upper", [[left, rise(left)], [right, rise(right)], [right, size], [left, size]], [columns, m + 3],
                          ["above", None, "plate", None], grading=[grading, 50], arcs=arc))
    contact = {"slave": "above", "master": "below", "method": method, "friction": {"law": "coulomb", "mu": mu}}
    press = {**step([{"on": "fixed", "ux": 0, "uy": 0}, {"on": "plate", "ux": 0}], [{"on": "plate", "total_force": {"y": -load}}], dt=0.25), "stabilize": 1e-3}
    shear = {"name": "shear", "duration": 1, "dt": {"initial": 0.1, "max": 0.1, "min": 1e-4}, "supports": [{"on": "plate", "ux": None}],
             "loads": [{"on": "plate", "total_force": {"x": push, "y": -load}}]}
    case = {"mesh": {"blocks": mesh}, "bodies": {"lower": LINEAR, "upper": LINEAR}, "plates": ["plate"], "contacts": {"base": contact},
            "steps": [press, shear]}
    return case, {"base.contact_length:end": 2 * a, "base.slip_fraction:end": 1 - sqrt(1 - push / (mu * load))}


def yielding_sphere(kind, element):
    """A thick sphere that yields up to the radius c under a pressure inside (Hill)."""
    front = 1.5
    pressure = 2 * log(front) + 2 / 3 * (1 - front**3 / 8)
    case = {"section": "axisymmetric", "mesh": of_kind(quarter(1, 2, [3, 4]), kind), "bodies": {"body": {"material": {"model": "von_mises", "E": 1e5, "nu": 0.3, "sigma_y": 1}, "element": element}},
            "watch": [{"near": [2, 0]}], "steps": [step([{"on": "bottom", "uy": 0}], [{"on": "inside", "pressure": pressure}], dt=0.1)]}
    return case, {"near_2_0.ux:end": front**3 * (1 - 0.3) / 4 / 1e5}


def footing(kind, element, near, far, rows):
    """Clay sheared undrained under half of a rigid rough strip footing of width 1, bonded to it (Prandtl)."""
    half, beside, depth, settlement = 0.5, 2.5, 2, 0.004
    mesh = of_kind([
        block("ground", [[0, -depth], [half, -depth], [half, 0], [0, 0]], [near, rows], ["bottom", None, "footing", "middle"], grading=[0.3, 0.1]),
        block("ground", [[half, -depth], [beside, -depth], [beside, 0], [half, 0]], [far, rows], ["bottom", "side", None, None], grading=[15, 0.1])], kind)
    held = [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}, {"on": "middle", "ux": 0}, {"on": "footing", "ux": 0, "uy": -settlement}]
    clay = {"material": {"model": "von_mises", "E": 1e4, "nu": 0.3, "sigma_y": 3**0.5}, "element": element}
    case = {"mesh": mesh, "bodies": {"ground": clay}, "watch": ["footing"], "steps": [step(held, dt=0.1)]}
    return case, {"footing.fy:end": -(2 + pi) * half}


def triangles(a, b, h, n, quadratic):
    """The cross-section of a ring by triangles, node by node, their diagonals to and fro; one element high."""
    at, elements, edges = {}, [], {"bottom": [], "top": [], "inside": [], "outside": []}
    node = lambda i, j: at.setdefault((i, j), len(at))
    joined = lambda p, q: [node(*p), node(*q)] + ([node((p[0] + q[0]) // 2, (p[1] + q[1]) // 2)] if quadratic else [])
    for k in range(n):
        sw, se, ne, nw = (2 * k, 0), (2 * k + 2, 0), (2 * k + 2, 2), (2 * k, 2)
        for corners in ([sw, se, ne], [sw, ne, nw]) if k % 2 else ([sw, se, nw], [se, ne, nw]):
            middles = [joined(corners[i], corners[(i + 1) % 3])[2] for i in range(3)] if quadratic else []
            elements.append([node(*corner) for corner in corners] + middles)
        edges["bottom"].append(joined(sw, se))
        edges["top"].append(joined(ne, nw))
    edges["inside"], edges["outside"] = [joined((0, 2), (0, 0))], [joined((2 * n, 0), (2 * n, 2))]
    nodes = [[a + (b - a) * i / (2 * n), h * j / 2] for i, j in at]
    return {"nodes": nodes, "elements": {"body": elements}, "edges": edges}


def triangular_tube(quadratic):
    """The thick tube under a pressure inside, by triangles (Lamé)."""
    case, truths = tube("Q4")
    return {**case, "mesh": triangles(1.0, 2.0, 0.5, 3, quadratic)}, truths


def hot_tube(quadratic):
    """A thick tube in plane strain, hot inside: T = ln(b/r)/ln(b/a); u = 2 (1 + ν) α r/(b² − a²) ∫ T r dr at both surfaces (Timoshenko)."""
    a, b, alpha = 1.0, 3.0, 1e-4
    body = {**LINEAR, "thermal": {"expansion": alpha}}
    load = step([{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}], temperature={"body": f"log({b}/x)/log({b / a})"})
    case = {"section": "axisymmetric", "mesh": triangles(a, b, 0.5, 4, quadratic), "bodies": {"body": body}, "watch": ["inside", "outside"],
            "steps": [load]}
    integral = ((b**2 - a**2) / 4 - a**2 / 2 * log(b / a)) / log(b / a)
    u = lambda r: 2 * (1 + NU) * alpha * r / (b**2 - a**2) * integral
    return case, {"inside.ux:end": u(a), "outside.ux:end": u(b)}


def swinging(scheme):
    """A stiff block on a spring, in motion: u = v/ω sin ωt. The increments matter, and the mesh does not."""
    k, density, v, end = 40.0, 2.5, 0.1, 2.0
    omega = sqrt(k / density)
    stiff = {"material": {"model": "linear", "E": 1e8, "nu": 0, "density": density}}
    mesh = {"blocks": [block("body", [[0, 0], [1, 0], [1, 1], [0, 1]], [1, 1], [None, "right", None, "left"])]}
    swing = {"name": "swing", "duration": end, "dt": {"initial": 0.05, "max": 0.05}, "scheme": scheme, "supports": [{"on": "body", "uy": 0}],
             "loads": [{"on": {"near": [0, 0]}, "spring": {"kx": k}}]}
    case = {"mesh": mesh, "bodies": {"body": stiff}, "plates": ["left"], "watch": ["right"], "initial_velocity": {"body": [v, 0]}, "steps": [swing]}
    return case, {"right.ux:end": v / omega * sin(omega * end)}


def loaded_by_friction(integration):
    """A stiff block dragged on a plane by a prescribed motion u, friction that weakens: dR = −r ln R du_p, hence u_p = −li(R)/r;
    μ = μ_k + (μ_s − μ_k) exp(−κ u_p/μ_k); q = μ p R, u = q/α_t + u_p."""
    mu_s, mu_k, p, alpha_t, r, kappa, slip = 0.5, 0.3, 2.0, 500.0, 400.0, 60.0, 0.006
    friction = {"law": "super_subloading", "mu_s": mu_s, "mu_k": mu_k, "alpha_t": alpha_t, "r": r, "kappa": kappa, "integration": integration}
    mesh = {"blocks": [block("body", [[0, 0], [1, 0], [1, 1], [0, 1]], [1, 1], ["bottom", None, "top", None])]}
    stiff = {"material": {"model": "linear", "E": 1e8, "nu": 0}}
    contact = {"slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "friction": friction, "normal": {"alpha_n": 1e8}}
    held, loads = [{"on": "body", "ux": 0}], [{"on": "top", "traction": {"y": -p}}]
    drag = {"name": "drag", "duration": 1, "dt": {"initial": 0.05, "max": 0.05}, "supports": [{"on": "body", "ux": slip}]}
    case = {"mesh": mesh, "bodies": {"body": stiff}, "contacts": {"base": contact}, "steps": [step(held, loads), drag]}

    def logarithmic_integral(x):
        power, total = 1.0, 0.5772156649015329 + log(-log(x))
        for k in range(1, 200):
            power *= log(x) / k
            total += power / k
        return total

    def traction_and_plastic_slip(ratio):
        plastic = -logarithmic_integral(ratio) / r
        return (mu_k + (mu_s - mu_k) * exp(-kappa * plastic / mu_k)) * p * ratio, plastic

    low, high = 1e-9, 1 - 1e-12
    for _ in range(100):
        middle = (low + high) / 2
        traction, plastic = traction_and_plastic_slip(middle)
        low, high = (middle, high) if traction / alpha_t + plastic < slip else (low, middle)
    return case, {"base.tangential_force:end": traction_and_plastic_slip(low)[0]}


# The safety factors of the bar were chosen on these.
PROBLEMS = {
    "tube, Q4": lambda: tube("Q4"),
    "tube, Q8": lambda: tube("Q8"),
    "sphere, Q4": lambda: shell("Q4"),
    "sphere, Q8": lambda: shell("Q8"),
    "hole, Q4": lambda: hole("Q4"),
    "hole, T6": lambda: hole("T6"),
    "rigid sphere, Gauss points": lambda: rigid_sphere("gauss_to_segment"),
    "rigid sphere, mortar": lambda: rigid_sphere("mortar"),
    "partial slip, Gauss points": lambda: half_planes("gauss_to_segment"),
    "partial slip, mortar": lambda: half_planes("mortar"),
    "yielding sphere, Q8": lambda: yielding_sphere("Q8", "reduced"),
    "yielding sphere, Q4": lambda: yielding_sphere("Q4", "f_bar"),
    "footing, Q4": lambda: footing("Q4", "f_bar", 5, 8, 8),
    "footing, T6": lambda: footing("T6", "displacement", 3, 4, 4),
}


# They had no part in that.
HELD_OUT = {
    "tube, T3": lambda: triangular_tube(False),
    "tube, T6": lambda: triangular_tube(True),
    "hot tube, T3": lambda: hot_tube(False),
    "hot tube, T6": lambda: hot_tube(True),
    "swinging, Newmark": lambda: swinging({"newmark": {}}),
    "swinging, HHT": lambda: swinging({"hht": {"alpha": -0.1}}),
    "friction, backward Euler": lambda: loaded_by_friction("backward_euler"),
}


def judged(program, name):
    """Rows of a problem: measure, truth, finest value, verdict, bar."""
    case, truths = {**PROBLEMS, **HELD_OUT}[name]()
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "case.json"
        path.write_text(json.dumps({**case, "output": QUIET}))
        asked = [part for measure in truths for part in ("--measure", measure)]
        said = subprocess.run([program, "converge", path, *asked, "--out", folder], capture_output=True, text=True)
    rows = []
    for measure, truth in truths.items():
        found = re.search(rf"^{re.escape(measure)}: (.*)\n  (.*)(?:\n  extrapolated (\S+), error bar of the last (\S+))?", said.stdout, re.M)
        if not found:
            raise SystemExit(f"{name}: {said.stderr}")
        values = [float(value) for value in found[1].split(", ")]
        # The side that is held decides the sign of a reaction.
        truth = abs(truth) if values[-1] > 0 else -abs(truth)
        rows.append((name, measure, truth, values, found[2], float(found[4]) if found[4] else None))
    return rows


def compare(program, names):
    print("| problem | number | closed form | finest | error | bar | bar/error | verdict |\n|---|---|---|---|---|---|---|---|")
    with ThreadPoolExecutor(2) as pool:
        rows = [row for rows in pool.map(lambda name: judged(program, name), names) for row in rows]
    ratios = []
    for name, measure, truth, values, verdict, bar in rows:
        error = abs(values[-1] - truth)
        if bar is not None:
            ratios.append(bar / error)
        told = ["–", "–"] if bar is None else [f"{100 * bar / abs(truth):.2g} %", f"{bar / error:.2g}"]
        words = verdict.split(":")[0]
        print(f"| {name} | `{measure}` | {truth:.6g} | {values[-1]:.6g} | {100 * error / abs(truth):.2g} % | {told[0]} | {told[1]} | {words} |")
    covered = sum(ratio >= 1 for ratio in ratios)
    print(f"\n{len(ratios)} pairs with a bar, {len(rows) - len(ratios)} without; the bar covers the closed form in {covered}; median bar/error {median(ratios):.2g}")


if __name__ == "__main__":
    given = sys.argv[1] if len(sys.argv) > 1 else "target/release/fecontact"
    for group in [sys.argv[2:]] if sys.argv[2:] else [PROBLEMS, HELD_OUT]:
        compare(given, list(group))
