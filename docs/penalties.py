"""What a stiff and a soft α_t cost: the table of docs/validation/numerical_choices.md. Needs numpy."""

import json
import subprocess
import tempfile
from math import exp, pi
from pathlib import Path

from results import Run, committed

# α_t over (λ + 2G)/h, the default among them.
STIFFNESSES = (5, 15, 30, 300)


def block(layers):
    """A square block of two bodies that stick, on meshes that do not match, pressed and pushed at its top."""
    side = {"kind": "Q4", "sides": ["low", None, "high", None]}
    return {
        "mesh": {"blocks": [
            {**side, "body": "lower", "corners": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]], "elements": [3 * layers, layers], "sides": ["held", None, "face", None]},
            {**side, "body": "upper", "corners": [[0, 0.5], [1, 0.5], [1, 1], [0, 1]], "elements": [2 * layers, layers], "sides": ["foot", None, "top", None]},
        ]},
        "bodies": {name: {"material": {"model": "linear", "E": 100, "nu": 0.3}} for name in ("lower", "upper")},
        "contacts": {"joint": {"slave": "foot", "master": "face", "sliding": "small", "friction": {"law": "coulomb", "mu": 10}}},
        "steps": [
            {"name": "press", "duration": 1, "supports": [{"on": "held", "ux": 0, "uy": 0}, {"on": "top", "ux": 0, "uy": -0.001}]},
            {"name": "push", "duration": 1, "supports": [{"on": "top", "ux": 1e-5}]},
        ],
    }


def belt(thickness):
    """A belt over a fixed drum of radius 10, held by a force at one end and pulled at the other until it slides everywhere."""
    inner, outer = 10, 10 * (1 + thickness)

    def part(corners, elements, arcs, sides):
        return {"body": "belt", "kind": "Q8", "corners": corners, "elements": elements, "arcs": arcs, "sides": sides}

    arc, straight = [[0, 0], None, [0, 0], None], [None] * 4
    blocks = [
        part([[-inner, -10], [-inner, 0], [-outer, 0], [-outer, -10]], [20, 1], straight, [None, None, None, "left"]),
        part([[-inner, 0], [0, inner], [0, outer], [-outer, 0]], [32, 1], arc, ["inner", None, None, None]),
        part([[0, inner], [inner, 0], [outer, 0], [0, outer]], [32, 1], arc, ["inner", None, None, None]),
        part([[inner, 0], [inner, -10], [outer, -10], [outer, 0]], [20, 1], straight, [None, "right", None, None]),
    ]
    return {
        "mesh": {"blocks": blocks},
        "bodies": {"belt": {"material": {"model": "neo_hookean", "E": 1e4, "nu": 0.3}}},
        "contacts": {"drum": {"slave": "inner", "master": {"circle": {"centre": [0, 0], "radius": 10}}, "friction": {"law": "coulomb", "mu": 0.3}}},
        "steps": [
            {"name": "tension", "duration": 1, "loads": [{"on": "left", "total_force": {"y": -pull(thickness)}}],
             "supports": [{"on": "right", "ux": 0, "uy": 0}, {"on": "left", "ux": 0}]},
            {"name": "pull", "duration": 1, "dt": {"initial": 0.02}, "supports": [{"on": "right", "uy": -2}]},
        ],
        "watch": ["left", "right"],
    }


def pull(thickness):
    """The force at its end, large beside its bending stiffness."""
    return 1e4 * thickness**2


def resolved(program, case):
    """The case with its defaults filled in."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.json"
        path.write_text(json.dumps(case))
        said = subprocess.run([program, "check", path, "--resolved"], check=True, capture_output=True, text=True)
    return json.loads(said.stdout)


def runs(program, case):
    """The case with each of the stiffnesses; one that stops gives none."""
    name, given = next(iter(resolved(program, case)["contacts"].items()))
    for over in STIFFNESSES:
        changed = json.loads(json.dumps(case))
        changed["contacts"][name]["friction"]["alpha_t"] = given["friction"]["alpha_t"] * over / 15
        run = Run(program, changed, may_stop=True)
        yield run if run.summary["status"] == "completed" else None


def told(found, run):
    return "stops" if run is None else f"{found(run)}; {run.summary['newton_iterations']}"


def penalties(program):
    """Give, ratio of forces or scatter of shear, and linear solves, by α_t."""
    rows = [["problem", "what", *map(str, STIFFNESSES)]]
    for layers in (2, 4, 8):
        case = block(layers)
        hard = json.loads(json.dumps(case))
        hard["contacts"]["joint"]["stick"] = 1e-12
        expected = Run(program, hard).last("joint.force_x")
        give = lambda run: f"{100 * (run.last('joint.force_x') / expected - 1):+.2f} %"
        rows.append([f"blocks that stick, {layers} layers each", "force that pushes", *(told(give, run) for run in runs(program, case))])
    for thickness in (0.005, 0.01, 0.05):
        ratio = exp(0.3 * pi / (1 + thickness / 2))
        off = lambda run: f"{100 * (-run.last('right.fy') / pull(thickness) / ratio - 1):+.2f} %"
        rows.append([f"belt on a drum, t/R = {thickness}", "ratio of its forces", *(told(off, run) for run in runs(program, belt(thickness)))])
    case = committed("cases/validation/hertz_q8_friction.json")
    next(iter(case["contacts"].values()))["friction"]["mu"] = 0.5
    name = next(iter(case["contacts"]))
    scatter = lambda run: f"{100 * run.last(name + '.scatter'):.2f} %"
    rows.append(["Hertz with μ = 0.5, Q8", "scatter", *(told(scatter, run) for run in runs(program, case))])
    case = committed("cases/validation/mindlin.json")
    name = next(iter(case["contacts"]))
    force = lambda run: f"{run.last(name + '.tangential_force'):.2f}"
    rows.append(["Mindlin, Q4", "Q [N/mm]", *(told(force, run) for run in runs(program, case))])
    return rows


PENALTIES = {"penalties": penalties}
