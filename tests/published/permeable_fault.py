"""A fault of constant friction that opens its own permeability, in one dimension: python3 permeable_fault.py CELLS STEPS

S dp/dt = d/dx((T0 + k1 |slip|)/eta dp/dx) by finite differences, the pressure held at x = 0; slip by displacement discontinuities in an unbounded plane,
where |tau| = f (sigma - p) or the fault sticks. Both are iterated to convergence in every step of time. Prints slip at x = 0 and at places, and p there.
Needs numpy and scipy.
"""

import sys

import numpy as np
from scipy.linalg import solve_banded

E, NU, F, SIGMA, P, S, ETA, T0, END = 2.5, 0.25, 0.6, 1e-3, 5e-4, 1.0, 1.0, 0.1, 2.0
RATIO = 0.5
TAU0 = F * (SIGMA - RATIO * P)
STIFF = E / (2 * (1 + NU)) / (1 - NU)  # G/(1 - nu)


def run(half, cells, steps, k1):
    h = 2 * half / cells
    x = (np.arange(cells + 1) - cells // 2) * h
    n, middle = len(x), cells // 2
    apart = x[:, None] - x[None, :]
    kernel = STIFF / (2 * np.pi) * (1 / (apart + h / 2) - 1 / (apart - h / 2))  # fall of the shear by slip
    p, slip, active = np.zeros(n), np.zeros(n), np.zeros(n, bool)
    times = END * (np.arange(steps + 1) / steps) ** 2
    for t0, t1 in zip(times, times[1:]):
        dt, guess = t1 - t0, slip
        for _ in range(200):
            transmissivity = (T0 + k1 * guess) / ETA
            joint = 0.5 * (transmissivity[1:] + transmissivity[:-1]) / h * dt
            bands = np.zeros((3, n))
            bands[1] = S * h
            bands[1, :-1] += joint
            bands[1, 1:] += joint
            bands[0, 1:] = bands[2, :-1] = -joint
            right = S * h * p
            bands[1, middle], bands[0, middle + 1], bands[2, middle - 1], right[middle] = 1, 0, 0, P
            new_p = solve_banded((1, 1), bands, right)
            # tau0 - K (slip - old) - K old = f (sigma - p) where it slips on; elsewhere it keeps its slip
            drive = TAU0 - F * (SIGMA - new_p)
            active = active | (drive - kernel @ slip > 0)
            for _ in range(100):
                new = slip.copy()
                rows = np.flatnonzero(active)
                new[rows] += np.linalg.solve(kernel[np.ix_(rows, rows)], (drive - kernel @ slip)[rows])
                over = drive - kernel @ new
                again = (active & (new >= slip)) | (~active & (over > 1e-15))
                if (again == active).all():
                    break
                active = again
            change = np.abs(new - guess).max()
            guess = new
            if change < 1e-12 * max(np.abs(new).max(), 1e-300):
                break
        p, slip = new_p, guess
    return x, p, slip


if __name__ == "__main__":
    cells, steps = int(sys.argv[1]), int(sys.argv[2])
    for k1 in [0.0, 2000.0]:
        x, p, slip = run(4.0, cells, steps, k1)
        size = F * P / STIFF
        edge = np.abs(x[slip > 0]).max() if (slip > 0).any() else 0.0
        values = {place: (np.interp(place, x, slip) / size, np.interp(place, x, p) / P) for place in (0.0, 0.2, 0.4, 0.6)}
        print(k1, "edge", edge, "slip/(f P (1-nu)/G) and p/P at", {a: tuple(round(float(v), 5) for v in b) for a, b in values.items()})
