"""Seepage around the wall of cases/excavation_below_water.json alone, without its ground: python3 seepage_below_wall.py

Bilinear finite elements for the head on squares, saturated up to the first water table at y = -1, which is held far away; -4 on the pit. Prints the flow
over k h, h = 3, and the water's force on the wall below the pit, which is 9.81 times an integral of head less y. Needs numpy and scipy.
"""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

TABLE, PIT, TIP, THICK = -1.0, -4.0, -9.0, 0.5
ELEMENT = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]]) / 6


def seepage(size):
    x, y = np.arange(-6, 20 + 0.5 * size, size), np.arange(-14, TABLE + 0.5 * size, size)
    number = np.arange(len(x) * len(y)).reshape(len(y), len(x))
    middle, height = np.meshgrid(0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1]))
    ground = np.where(middle < 0, height < PIT, (middle > THICK) | (height < TIP))
    cells = np.stack([corner[ground] for corner in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])], axis=1)
    rows, columns = np.repeat(cells, 4, axis=1).ravel(), np.tile(cells, 4).ravel()
    matrix = csr_matrix((np.tile(ELEMENT.ravel(), len(cells)), (rows, columns)), shape=(number.size, number.size))
    head, held = np.zeros(number.size), np.zeros(number.size, bool)
    pit = number[np.isclose(y, PIT)][0][x < 0.5 * size]
    for nodes, level in ((number[:, -1], TABLE), (pit, PIT)):
        head[nodes], held[nodes] = level, True
    free = np.isin(np.arange(number.size), cells) & ~held
    head[free] = spsolve(matrix[free][:, free].tocsc(), -matrix[free][:, held] @ head[held])
    flow = (matrix @ head)[number[:, -1]].sum() / (TABLE - PIT)
    face = number[:, np.isclose(x, 0)].ravel()[(y > TIP - 0.5 * size) & (y < PIT + 0.5 * size)]
    pressure = head[face] - y[(y > TIP - 0.5 * size) & (y < PIT + 0.5 * size)]
    return flow, 9.81 * size * (0.5 * (pressure[1:] + pressure[:-1])).sum()


for size in (0.5, 0.25, 0.125):
    print(f"squares of {size} m: q/(k h) {seepage(size)[0]:.4f}, water below the pit {seepage(size)[1]:.2f}")
