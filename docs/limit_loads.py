"""Tables of the quick tier: bodies that yield, against closed forms of small strains, on meshes of blocks that stand here.

Every function runs cases and returns rows, the head first. Stiffnesses are so high that the shape does not change. Needs numpy.
"""

from math import exp, log, pi, radians, tan

import numpy as np

from closed_forms import block, quarter
from problems import HEAD, digits, row
from results import Run

E, NU = 1e5, 0.3


def von_mises(strength):
    return {"model": "von_mises", "E": E, "nu": NU, "sigma_y": strength}


def hills_tube_case(kind, element, columns):
    """A tube, b = 2 a, held along its axis and widened from inside."""
    mesh = [block("tube", [[1, 0], [2, 0], [2, 0.1], [1, 0.1]], [columns, 1], ["bottom", None, "top", "bore"], kind=kind)]
    step = {"name": "widen", "duration": 4, "dt": {"initial": 0.05, "max": 0.05},
            "supports": [{"on": "bottom", "uy": 0}, {"on": "top", "uy": 0}, {"on": "bore", "ux": 4 / E}]}
    return {"section": "axisymmetric", "mesh": {"blocks": mesh}, "bodies": {"tube": {"material": von_mises(1), "element": element}},
            "steps": [step], "watch": ["bore"], "output": {"fields": False}}


def hills_tube(program):
    """The pressure in the tube over the displacement of its bore (Hill 1950)."""
    rows = [["elements", *HEAD]]
    for name, kind, element, columns in (("Q4 F-bar, 24", "Q4", "f_bar", 24), ("Q8 reduced, 10", "Q8", "reduced", 10)):
        run = Run(program, hills_tube_case(kind, element, columns))
        pressure = lambda time: run.at("bore.fx", time) / (2 * pi * 0.1)
        for time, exact in ((1, 0.5109), (1.5, 0.6474), (2, 0.7216), (3, 0.7871), (4, 0.7980)):
            rows.append([name if time == 1 else "", *row(f"p/σ_y at E u/(σ_y a) = {time:g}", exact, pressure(time), 4)])
    return rows


def thick_sphere_case(front):
    """A sphere, b = 2 a, under the pressure inside that makes it yield up to the radius of a front (Hill 1950)."""
    pressure = 2 * log(front) + 2 / 3 * (1 - front**3 / 8)
    step = {"name": "press", "duration": 1, "dt": {"initial": 0.05, "max": 0.05},
            "supports": [{"on": "bottom", "uy": 0}], "loads": [{"on": "inside", "pressure": pressure}]}
    return {"section": "axisymmetric", "mesh": {"blocks": quarter(1, 2, [10, 16])}, "bodies": {"body": {"material": von_mises(1), "element": "reduced"}},
            "steps": [step], "watch": ["outside", {"near": [2, 0]}], "output": {"fields": False}}


def thick_sphere(program):
    """How far the outside of the sphere moves while the front of yielding is at c."""
    rows = [["front", *HEAD]]
    for front in (1.25, 1.5, 1.75):
        run = Run(program, thick_sphere_case(front))
        rows.append([f"c = {front:g} a", *row("E u(b)/(σ_y a)", front**3 * (1 - NU) / 4, run.last("near_2_0.ux") * E, 4)])
    return rows


def footing_case(body, kind, columns, rows, width, settlement, surcharge=0, **step):
    """Half of a rigid rough footing of width 1 that is bonded to the ground and settles."""
    half, beside, depth = 0.5, width, 2
    near, far = columns
    mesh = [block("ground", [[0, -depth], [half, -depth], [half, 0], [0, 0]], [near[0], rows[0]], ["bottom", None, "footing", "middle"],
                  kind=kind, grading=[near[1], rows[1]]),
            block("ground", [[half, -depth], [beside, -depth], [beside, 0], [half, 0]], [far[0], rows[0]], ["bottom", "side", "surface", None],
                  kind=kind, grading=[far[1], rows[1]])]
    step = {"name": "settle", "duration": 1, "dt": {"initial": 0.02, "max": 0.05, "min": 1e-5}, **step, "loads": [{"on": "surface", "pressure": str(surcharge)}],
            "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}, {"on": "middle", "ux": 0},
                         {"on": "footing", "ux": 0, "uy": -settlement}]}
    return {"mesh": {"blocks": mesh}, "bodies": {"ground": body}, "steps": [step], "watch": ["footing"], "output": {"fields": False}}


# Elements beside the middle and beside the corner, and the ratio of the last size to the first.
FINE = {"Q4": ([[20, 0.2], [30, 30]], [32, 0.05]), "Q8": ([[12, 0.1], [18, 40]], [18, 0.02]), "T6": ([[10, 0.1], [15, 40]], [16, 0.02])}


def strip_footing(program):
    """Clay that is sheared undrained, s_u = 1, under a rough strip footing: 2 + π (Prandtl 1920)."""
    rows = [["elements, corner", *HEAD]]
    clay = {**von_mises(3**0.5), "E": 1e4}
    for name, kind, element in (("Q4 F-bar, B/100", "Q4", "f_bar"), ("Q8 reduced, B/100", "Q8", "reduced"), ("T6, B/80", "T6", "displacement"),
                                ("Q4 in full, B/100", "Q4", "displacement")):
        run = Run(program, footing_case({"material": clay, "element": element}, kind, *FINE[kind], 2.5, 0.004))
        rows.append([name, *row("N_c", 2 + pi, -run.last("footing.fy") / 0.5, 4)])
    return rows


def cam_clay(stiffer, overconsolidation=1):
    """Undrained Cam-clay under an isotropic effective stress of 100, with slopes and compliance that are divided: the body, and its s_u."""
    pressure, critical, slopes, shear = 100, 1.2, [0.1 / stiffer, 0.02 / stiffer], 3000 * stiffer
    lam, kappa = (slope / (1 + slope) for slope in slopes)
    fluid = 50 * (pressure / slopes[1] + 4 / 3 * shear)
    body = {"material": {"model": "cam_clay", "lambda": lam, "kappa": kappa, "M": critical, "G": shear, "OCR": overconsolidation, "p_min": 1},
            "initial_stress": {"components": {"xx": -pressure, "yy": -pressure, "zz": -pressure}},
            "pore_fluid": {"bulk_modulus": fluid, "porosity": 0.5}}
    return body, critical * pressure * (overconsolidation / 2) ** 0.8 / 3**0.5


def footing_on_cam_clay(program):
    """The same of Cam-clay, whose s_u = M p_f/√3 comes of its stress: stiff, and soft with a settlement of a tenth of the width, beside von Mises."""
    rows = [["clay", "elements", "settlement", *HEAD]]
    kinds = {"Q8 reduced": ("Q8", "reduced", [[10, 0.15], [14, 30]], [14, 0.04]), "Q4 F-bar": ("Q4", "f_bar", [[14, 0.15], [20, 40]], [22, 0.04]),
             "Q8 reduced, B/100": ("Q8", "reduced", *FINE["Q8"])}
    fine = {"initial": 0.01, "max": 0.01, "min": 1e-6}

    def add(name, elements, body, strength, settlement, surcharge):
        kind, element, columns, across = kinds[elements]
        run = Run(program, footing_case({**body, "element": element}, kind, columns, across, 2.5, settlement, surcharge, dt=fine))
        bearing = (-run.last("footing.fy") / 0.5 - surcharge) / strength
        rows.append([name, elements, f"{settlement:g} B", *row("N_c", 2 + pi, bearing, 4)])

    for name, elements, stiffer, over, settlement in (
        ("OCR 1, G/s_u = 7500", "Q8 reduced", 100, 1, 0.001), ("the same", "Q4 F-bar", 100, 1, 0.001), ("the same, OCR 2, G/s_u = 4300", "Q8 reduced", 100, 2, 0.001),
        ("OCR 1, G/s_u = 75", "Q8 reduced", 1, 1, 0.1),
    ):
        body, strength = cam_clay(stiffer, over)
        add(name, elements, body, strength, settlement, 100)
    for name, elements, ratio, settlement in (("von Mises, G/s_u = 7500", "Q8 reduced", 7500, 0.001), ("von Mises, G/s_u = 75", "Q8 reduced", 75, 0.1),
                                              ("the same", "Q8 reduced, B/100", 75, 0.1), ("the same", "Q4 F-bar", 75, 0.1)):
        add(name, elements, {"material": {"model": "von_mises", "E": 2 * 1.49 * ratio, "nu": 0.49, "sigma_y": 3**0.5}}, 1, settlement, 0)
    return rows


def footing_on_soil(program):
    """Soil of c = 1, φ = 20° without weight under a rough footing: N_c = (N_q − 1) cot φ (Prandtl) where ψ = φ; with ψ = 5° about that."""
    phi = radians(20)
    exact = (exp(pi * tan(phi)) * tan(pi / 4 + phi / 2) ** 2 - 1) / tan(phi)
    rows = [["flow", *HEAD]]
    for psi, viscosity, kind, element in ((20, 0, "Q8", "reduced"), (20, 0, "Q4", "f_bar"), (5, 1e-4, "Q8", "reduced"), (5, 1e-4, "Q4", "f_bar")):
        soil = {"model": "mohr_coulomb", "E": 1e4, "nu": NU, "c": 1, "phi": 20, "psi": psi, "viscosity": viscosity}
        run = Run(program, footing_case({"material": soil, "element": element}, kind, *FINE[kind], 4, 0.01))
        name = f"ψ = {psi}°, {kind} {element.replace('f_bar', 'F-bar')}" + (f", viscosity {viscosity:g} of the duration" if viscosity else "")
        rows.append([name, *row("N_c", exact, -run.last("footing.fy") / 0.5, 4)])
    return rows


LIMIT = {
    "hills_tube": hills_tube,
    "thick_sphere": thick_sphere,
    "strip_footing": strip_footing,
    "footing_on_cam_clay": footing_on_cam_clay,
    "footing_on_soil": footing_on_soil,
}
