"""Radial consolidation around a driven pile, elastic or with yielding: finite differences of one dimension. Needs numpy and scipy.

Water and skeleton move against each other, so that r times both flows adds up to none: du/dt = (k/gamma_w) dp/dr, where equilibrium gives
dp/dr = d(sigma_r)/dr + (sigma_r - sigma_theta)/r of the effective stress, tension positive. One equation for the displacement u(r, t), u = 0 at the pile
and far away, backward Euler in time; the stress by radial return to the cylinder of von Mises in small strains, from the state in which the cavity leaves
the ground: s_r - s_theta = -2 s_u out to R, falling by 1/r^2 beyond.

    python3 tests/published/driven_pile.py            T50 and T90 for G/s_u = 50, 100, 200, 500
"""

import sys

import numpy as np
from scipy.linalg import solve_banded

NU, FAR = 0.3, 400.0


def falls(ratio, yields, nodes, growth):
    """Times at which the pressure at the pile is half, and a tenth, of what it began with; c = 1, s_u = 1, r0 = 1."""
    plastic, shear = np.sqrt(ratio), ratio
    bulk = 2 * shear * (1 + NU) / (3 * (1 - 2 * NU))
    mobility = 1 / (bulk + 4 * shear / 3)
    r = np.exp(np.linspace(0, np.log(FAR), nodes + 1))
    middle, width = 0.5 * (r[1:] + r[:-1]), np.diff(r)
    tau = np.minimum(1.0, (plastic / middle) ** 2)
    stress = np.array([-tau, tau, 0 * tau])
    start, limit = 2 * np.log(plastic), np.sqrt(2)
    u = np.zeros(nodes + 1)
    # Strains in the middles: rows of du/dr and u/r.
    pick = lambda v: np.array([np.diff(v) / width, 0.5 * (v[1:] + v[:-1]) / middle])

    def respond(change):
        """Stress, and its derivatives by both strains, at an increment of displacement."""
        radial, hoop = pick(change)
        trial = stress + 2 * shear * np.array([radial, hoop, 0 * radial]) + (bulk - 2 * shear / 3) * (radial + hoop)
        stiff = np.full((3, 2, middle.size), bulk - 2 * shear / 3)
        stiff[0, 0] += 2 * shear
        stiff[1, 1] += 2 * shear
        if not yields:
            return trial, stiff
        mean = trial.mean(axis=0)
        s = trial - mean
        size = np.sqrt((s**2).sum(axis=0))
        over = size > limit
        share = np.where(over, limit / size, 1.0)
        n = s / size
        deviator = stiff - stiff.mean(axis=0)
        turned = share * (deviator - over * n[:, None] * (n[:, None] * deviator).sum(axis=0))
        return mean + share * s, stiff.mean(axis=0) + turned

    gap = 0.5 * (width[1:] + width[:-1])
    weight = lambda v: 0.5 * (v[1:] + v[:-1])
    time, step, found, before = 0.0, 1e-5, [], start
    while len(found) < 2:
        change = np.zeros_like(u)
        for _ in range(30):
            new, stiff = respond(change)
            inner = change[1:-1] / step - mobility * (np.diff(new[0]) / gap + weight(new[0] - new[1]) / r[1:-1])
            if np.abs(inner).max() * step < 1e-13:
                break
            bands = np.zeros((3, nodes + 1))
            bands[1] = 1.0
            bands[1, 1:-1] = 1 / step
            # A middle acts on its two nodes: by -1/width and 1/width, and by a half over r.
            own = [[stiff[i, 0] * side / width + stiff[i, 1] * 0.5 / middle for side in (-1, 1)] for i in range(2)]
            for cell, sign in ((slice(1, None), 1), (slice(None, -1), -1)):
                for side in (0, 1):
                    entry = -mobility * (sign * own[0][side][cell] / gap + 0.5 * (own[0][side] - own[1][side])[cell] / r[1:-1])
                    offset = (0 if sign == 1 else -1) + side
                    rows = np.arange(1, nodes)
                    bands[1 - offset, rows + offset] += entry
            full = np.zeros_like(u)
            full[1:-1] = inner
            bands[0, 1] = bands[2, -2] = 0.0
            change -= solve_banded((1, 1), bands, full)
        slopes = np.zeros_like(u)
        slopes[1:-1] = change[1:-1] / step / mobility
        pressure = -(0.5 * (slopes[1:] + slopes[:-1]) * width).sum()
        for level in (0.5, 0.1)[len(found):]:
            if pressure <= level * start:
                found.append(time + step * (before - level * start) / (before - pressure))
        stress, u, time, before = new, u + change, time + step, pressure
        step = max(step, growth * time)
    return found


if __name__ == "__main__":
    for ratio in (50, 100, 200, 500):
        for yields in (False, True):
            coarse, fine = (np.array(falls(ratio, yields, nodes, growth)) for nodes, growth in ((400, 0.02), (800, 0.01)))
            print(ratio, "yields" if yields else "elastic", coarse, fine, 2 * fine - coarse)
