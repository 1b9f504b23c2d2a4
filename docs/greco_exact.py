"""The GRECO block once more, without the program: square linear elements of its own, and Signorini's and Coulomb's conditions met exactly at every node of the bottom.

    python3 docs/greco_exact.py        # u_x [µm], p and q [MPa] on 10 to 40 elements a side

The load grows in proportion from nothing, so that one increment has the states of all. On the bottom nodes are open up to one place, slide to the right up to another, and
stick beyond; the two places are moved until no open node is inside the plane, no closed one is pulled, none that sticks bears more than μ p and none slides against its friction.
Needs numpy.
"""

import numpy as np

YOUNG, POISSON, MU, SIDE, LEFT, TOP = 130e3, 0.2, 1.0, 40.0, 150.0, 50.0


def stiffness():
    """Of a square element in plane strain; nodes by rows."""
    lame, shear = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
    law = np.array([[lame + 2 * shear, lame, 0], [lame, lame + 2 * shear, 0], [0, 0, shear]])
    found = np.zeros((8, 8))
    for x, y in ((x, y) for x in (-1, 1) for y in (-1, 1)):
        along = lambda s: np.array([1 - s, 1 + s]) / 2
        a, b, slope = along(x / np.sqrt(3)), along(y / np.sqrt(3)), np.array([-1, 1])
        strain = np.zeros((3, 8))
        strain[0, 0::2] = strain[2, 1::2] = np.outer(b, slope).ravel()
        strain[1, 1::2] = strain[2, 0::2] = np.outer(slope, a).ravel()
        found += strain.T @ law @ strain / 4
    return found


def bottom(count):
    """x, u_x, p and q of the nodes of the bottom but for its supported corner, on so many elements a side."""
    row, edge = count + 1, SIDE / count
    whole, element, load = np.zeros((2 * row * row, 2 * row * row)), stiffness(), np.zeros(2 * row * row)
    for first in (i + row * j for j in range(count) for i in range(count)):
        dofs = np.array([[2 * node, 2 * node + 1] for node in (first, first + 1, first + row, first + row + 1)]).ravel()
        whole[np.ix_(dofs, dofs)] += element
    share = edge * np.r_[0.5, np.ones(count - 1), 0.5]
    load[2 * row * np.arange(row)] = LEFT * share
    load[2 * (row * count + np.arange(row)) + 1] = -TOP * share
    contact, right = np.arange(2 * count), 2 * (row * np.arange(row) + count)
    other = np.setdiff1d(np.arange(2 * row * row), np.r_[contact, right, right[0] + 1])
    through = np.linalg.solve(whole[np.ix_(other, other)], np.c_[whole[np.ix_(other, contact)], load[other]])
    condensed = whole[np.ix_(contact, contact)] - whole[np.ix_(contact, other)] @ through[:, :-1]
    load = load[contact] - whole[np.ix_(contact, other)] @ through[:, -1]
    opened, slid = round(0.08 * count), round(0.74 * count)
    for _ in range(count):
        moved, borne = states(condensed, load, opened, slid)
        if (moved[:opened, 1] < 0).any():
            opened -= 1
        elif (borne[opened:, 1] < 0).any():
            opened += 1
        elif (abs(borne[slid:, 0]) > MU * borne[slid:, 1]).any():
            slid += 1
        elif (moved[opened:slid, 0] < 0).any():
            slid -= 1
        else:
            return edge * np.arange(count), moved[:, 0], borne[:, 1] / share[:-1], -borne[:, 0] / share[:-1]
    raise ArithmeticError("no states agree with the conditions")


def states(condensed, load, opened, slid):
    """Displacements and forces of the nodes where the first ones are open, the next slide, and the others stick."""
    size, count = len(load), len(load) // 2
    system = np.block([[condensed, -np.eye(size)], [np.zeros((size, 2 * size))]])
    for node in range(count):
        x, y = 2 * node, 2 * node + 1
        system[size + x, size + x if node < slid else x] = 1
        system[size + y, size + y if node < opened else y] = 1
        if opened <= node < slid:
            system[size + x, size + y] = MU
    found = np.linalg.solve(system, np.r_[load, np.zeros(size)])
    return found[:size].reshape(-1, 2), found[size:].reshape(-1, 2)


if __name__ == "__main__":
    for count in (10, 20, 40):
        x, u, p, q = bottom(count)
        at = lambda values, places: " ".join(f"{value:.3f}" for value in np.interp(places, x, values))
        print(f"{count}: open to {x[p <= 0].max():g}, u_x", at(1e3 * u, [0, 1.25, 5, 7.5, 11.25]))
        print("  p", at(p, [5, 10, 15, 20, 25, 32, 36]), "q", at(q, [32, 36]))
