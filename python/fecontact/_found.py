"""What a mesh file of another program says."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ._plain import refused


@dataclass
class Found:
    """Nodes, counted from 0, and cells of any kind, by their numbers in the sets."""

    file: str
    nodes: NDArray[np.float64]
    cells: list[tuple[int, ...]] = field(default_factory=list)
    dimensions: list[int] = field(default_factory=list)
    #: sets of cells, by name
    sets: dict[str, list[int]] = field(default_factory=dict)
    #: sides of cells, given by the nodes at their ends
    sides: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    points: dict[str, list[int]] = field(default_factory=dict)
    #: sets that are bodies unless others are asked for; all sets of plane cells if none is named
    bodies: list[str] = field(default_factory=list)

    def add(self, nodes: Sequence[int], dimension: int) -> int:
        """A cell, whose number it returns."""
        self.cells.append(tuple(int(node) for node in nodes))
        self.dimensions.append(dimension)
        return len(self.cells) - 1


def there(path: str) -> str:
    """The path of a file that exists.

    Raises:
        CaseError: there is no such file.
    """
    if not os.path.isfile(path):
        raise refused(path, "", "there is no such mesh file; check the path")
    return path
