"""Static friction of interfaces of random strength: python3 docs/random_interfaces.py target/release/fecontact.

A block on a rigid plane, periodic along x, is sheared until its equilibrium is lost: 20 fields of each correlation length. Prints the table
of docs/validation/random_interfaces.md. Needs numpy.
"""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from results import Run

SEEDS = range(1, 21)
LENGTH, HEIGHT, SHEAR, NU = 16.0, 2.0, 1000.0, 0.3
MEAN, DEVIATION, RESIDUAL = 0.6, 0.06, 0.3
# 1.158 G*/W, with G* = 2 G/(1 − ν) of a body on a rigid one, is the length of the largest stable patch (Uenishi and Rice).
NUCLEATION = 2.0
WEAKENING = 1.158 * 2 * SHEAR / (1 - NU) / NUCLEATION


def case(correlation, seed, deviation=DEVIATION, elements=320):
    """Coefficients that rise from 0.4 on by 0.004 in an increment, and by a sixteenth of it where it is cut."""
    corners = [[0, 0], [LENGTH, 0], [LENGTH, HEIGHT], [0, HEIGHT]]
    block = {"body": "block", "corners": corners, "elements": [elements, 8], "grading": [1, 6], "sides": ["bottom", "right", "top", "left"]}
    random = {"seed": seed, "mean": MEAN, "deviation": deviation, "correlation": correlation}
    held = {"on": "top", "uy": 0}
    moved = lambda stress: {**held, "ux": stress * HEIGHT / SHEAR}
    return {
        "mesh": {"blocks": [block]},
        "bodies": {"block": {"material": {"model": "linear", "E": 2 * (1 + NU) * SHEAR, "nu": NU}}},
        "periodic": [["left", "right"]],
        "contacts": {"base": {
            "slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small", "method": "node_to_segment",
            "friction": {"law": "slip_weakening", "mu_s": MEAN, "mu_d": RESIDUAL, "D_c": (MEAN - RESIDUAL) / WEAKENING},
            "along": {"mu_s": {"random": random}}, "initial": {"pressure": 1, "balanced": True},
        }},
        "steps": [
            {"name": "load", "duration": 1, "dt": {"initial": 1}, "supports": [moved(0.35)]},
            {"name": "shear", "duration": 100, "dt": {"initial": 1, "min": 1 / 16, "max": 1}, "supports": [moved(0.75)]},
        ],
        "output": {"fields": False, "report": False},
    }


def static_friction(program, correlation, seed, **options):
    """Largest tangential force over the normal force."""
    history = Run(program, case(correlation, seed, **options), may_stop=True).history
    return (history["base.tangential_force"] / history["base.normal_force"]).max()


def main(program):
    print("| correlation length / nucleation length | mean of F_t/F_n | deviation | least | largest |\n|---|---|---|---|---|")
    with ThreadPoolExecutor(2) as pool:
        for correlation in (0.1, 0.3, 1.0):
            found = np.array(list(pool.map(lambda seed: static_friction(program, correlation * NUCLEATION, seed), SEEDS)))
            numbers = " | ".join(f"{number:.3f}" for number in (found.mean(), found.std(ddof=1), found.min(), found.max()))
            print(f"| {correlation:g} | {numbers} |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "target/release/fecontact")
