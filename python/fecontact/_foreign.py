"""Meshes in the formats of other programs: groups of cells, sides and nodes by name, whatever the format.

Abaqus and CalculiX decks are read here (all of a deck that is mesh, surfaces included), Exodus by ``netCDF4`` (side sets included),
everything else by ``meshio``.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._plain import refused
from .errors import CaseError

#: Nodes of plane cells and of lines.
PLANE, LINE = (3, 4, 6, 8, 9), (2, 3)

#: Sizes beyond which nodes do not lie in one plane, as a share of the mesh.
FLAT = 1e-9


@dataclass
class Found:
    """What a file says, nodes counted from 0: cells of any kind, by their numbers in the sets."""

    file: str
    nodes: NDArray[np.float64]
    cells: list[tuple[int, ...]] = field(default_factory=list)
    dimensions: list[int] = field(default_factory=list)
    #: sets of cells, by name
    sets: dict[str, list[int]] = field(default_factory=dict)
    #: sides of cells, given by the nodes at their ends
    sides: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    points: dict[str, list[int]] = field(default_factory=dict)

    def add(self, nodes: Sequence[int], dimension: int) -> int:
        """A cell, whose number it returns."""
        self.cells.append(tuple(int(node) for node in nodes))
        self.dimensions.append(dimension)
        return len(self.cells) - 1


def read(path: str, bodies: Sequence[str] | str | None) -> dict[str, Any]:
    """What :class:`fecontact.Mesh` is made of.

    Raises:
        CaseError: what cannot be read, or is no plane mesh.
    """
    end = Path(path).suffix.lower()
    if end == ".inp":
        return _parts(_abaqus(path), bodies)
    if end in (".e", ".exo", ".ex2", ".exii"):
        return _parts(_exodus(path), bodies)
    found, array = _other(path, bodies if isinstance(bodies, str) else None)
    return _parts(found, None if array else bodies)


def _parts(found: Found, bodies: Sequence[str] | str | None) -> dict[str, Any]:
    """Bodies, edges and points."""
    nodes = _plane(found)
    edges = _edges(found)
    members = _bodies(found, [bodies] if isinstance(bodies, str) else bodies)
    lines: dict[str, list[tuple[int, ...]]] = {}
    for name, cells in found.sets.items():
        own = [found.cells[cell] for cell in cells if found.dimensions[cell] == 1]
        if own and name not in members:
            lines[name] = [edges.get(frozenset(line), line) for line in own]
        alone = [found.cells[cell][0] for cell in cells if found.dimensions[cell] == 0]
        if alone:
            found.points.setdefault(name, []).extend(alone)
    ends = {frozenset(edge[:2]): edge for edge in edges.values()}
    for name, sides in found.sides.items():
        lines.setdefault(name, []).extend(ends.get(frozenset(side), side) for side in sides)
    groups = {name: {node for cell in cells for node in cell} for name, cells in lines.items()}
    groups |= {name: {node for cell in cells for node in found.cells[cell]} for name, cells in members.items()}
    points = {}
    for name, list_ in found.points.items():
        if groups.get(name) != set(list_):
            points[f"{name}_nodes" if name in groups else name] = np.array(sorted(set(list_)), dtype=np.int64)
    return {
        "nodes": nodes,
        "elements": {name: _by_width(found.cells[cell] for cell in cells) for name, cells in members.items()},
        "edges": {name: _by_width(dict.fromkeys(cells)) for name, cells in lines.items()},
        "points": points,
    }


def _plane(found: Found) -> NDArray[np.float64]:
    """x and y of the nodes, which have one z."""
    nodes = np.asarray(found.nodes, dtype=float)
    if nodes.ndim != 2 or not len(nodes):
        raise refused(found.file, "", "has no nodes")
    for cell, dimension in zip(found.cells, found.dimensions, strict=True):
        if dimension == 3:
            text = f"has a solid cell of {len(cell)} nodes: only plane meshes are read (triangles with 3 or 6 nodes, quadrilaterals with"
            raise refused(found.file, "", f"{text} 4, 8 or 9, and lines)")
        if dimension == 2 and len(cell) not in PLANE or dimension == 1 and len(cell) not in LINE:
            text = f"has a cell of {len(cell)} nodes: triangles have 3 or 6, quadrilaterals 4, 8 or 9, lines 2 or 3"
            raise refused(found.file, "", text)
    used = np.unique([node for cell in found.cells for node in cell]).astype(int)
    if nodes.shape[1] > 2 and len(used):
        heights, extent = nodes[used, 2], np.ptp(nodes[used, :2], axis=0).max()
        away = np.flatnonzero(np.abs(heights - heights[0]) > FLAT * extent)
        if len(away):
            where = tuple(nodes[used[away[0]]].tolist())
            raise refused(found.file, "", f"has a node at {where}: all must share one z, as the model lies in x and y")
    return np.ascontiguousarray(nodes[:, :2])


def _edges(found: Found) -> dict[frozenset[int], tuple[int, ...]]:
    """All edges of plane cells, by their nodes: end, end, middle."""
    edges = {}
    for cell, dimension in zip(found.cells, found.dimensions, strict=True):
        if dimension == 2:
            corners = 3 if len(cell) in (3, 6) else 4
            for k in range(corners):
                middle = cell[corners + k : corners + k + 1] if len(cell) >= 2 * corners else ()
                edge = (cell[k], cell[(k + 1) % corners], *middle)
                edges[frozenset(edge)] = edge
    return edges


def _bodies(found: Found, wanted: Sequence[str] | None) -> dict[str, list[int]]:
    """The sets of plane cells that are bodies: every cell is in one."""
    plane = {cell for cell, dimension in enumerate(found.dimensions) if dimension == 2}
    there = {name: [cell for cell in dict.fromkeys(cells) if cell in plane] for name, cells in found.sets.items()}
    there = {name: cells for name, cells in there.items() if cells}
    names = ", ".join(f"`{name}`" for name in there) or "none"
    if wanted is None and not there:
        return {"body": sorted(plane)} if plane else {}
    for name in wanted or ():
        if name not in there:
            raise refused(found.file, "bodies", f"there is no set `{name}` of plane cells; the sets are {names}")
    chosen = {name: there[name] for name in (wanted if wanted is not None else there)}
    owner: dict[int, str] = {}
    for name, cells in chosen.items():
        for cell in cells:
            if owner.setdefault(cell, name) != name:
                both = f"a cell is in the sets `{owner[cell]}` and `{name}`, and has one body"
                raise refused(found.file, "bodies", f"{both}: name the sets that are bodies; the sets are {names}")
    left = len(plane - owner.keys())
    if left:
        which = "the sets that are named" if wanted is not None else "the sets of the file"
        raise refused(found.file, "bodies", f"{left} plane cells are in none of {which}: each needs a body; the sets are {names}")
    return chosen


def _by_width(cells: Iterable[tuple[int, ...]]) -> list[NDArray[np.int64]]:
    """The cells, those of as many nodes in one array."""
    by: dict[int, list[tuple[int, ...]]] = {}
    for cell in cells:
        by.setdefault(len(cell), []).append(cell)
    return [np.array(rows, dtype=np.int64) for rows in by.values()]


# ---- Abaqus, CalculiX ----

#: Elements of the plane and of lines; the number of their nodes comes last.
ELEMENTS = re.compile(r"(?:CPE|CPS|CPEG|CAX|M3D|S|STRI)(3|4|6|8|9)|(?:T2D|T3D|R2D|RAX)(2|3)|B[23]([123])")

#: Letters behind the number, for reduced integration, hybrid, incompatible, modified, thermal and porous elements.
VARIANT = re.compile(r"[RHIMTPS5]*$")


def _abaqus(path: str) -> Found:
    """Nodes, elements, sets and surfaces of a deck; names as they are first written, whatever the case of their letters."""
    deck = _Deck(path)
    deck.read(Path(path))
    number = {tag: k for k, tag in enumerate(deck.nodes)}
    positions = [(*at, 0.0, 0.0)[:3] for at in deck.nodes.values()]
    found = Found(path, np.array(positions, dtype=float).reshape(-1, 3))
    cells: dict[int, int] = {}
    for tag, (kind, nodes) in deck.elements.items():
        missing = [node for node in nodes if node not in number]
        if missing:
            raise refused(path, "", f"element {tag} has node {missing[0]}, which the file does not have")
        dimension, _ = _element(path, kind)
        cells[tag] = found.add([number[node] for node in nodes], dimension)
    found.sets = {name: [cells[tag] for tag in deck.known(tags, cells, name)] for name, tags in deck.named("ELSET").items()}
    found.points = {name: [number[tag] for tag in deck.known(tags, number, name)] for name, tags in deck.named("NSET").items()}
    for name, faces in deck.surfaces.items():
        for of, side in faces:
            if side is None:
                tags = deck.members("NSET", of)
                found.points.setdefault(name, []).extend(number[tag] for tag in deck.known(tags, number, name))
                continue
            for tag in deck.known(deck.members("ELSET", of), cells, name):
                cell = found.cells[cells[tag]]
                corners = 3 if len(cell) in (3, 6) else 4
                if found.dimensions[cells[tag]] != 2 or not 1 <= side <= corners:
                    raise refused(path, f"*SURFACE {name}", f"element {tag} has no side S{side} in the plane")
                found.sides.setdefault(name, []).append((cell[side - 1], cell[side % corners]))
    return found


def _element(path: str, kind: str) -> tuple[int, int]:
    """Dimension and number of nodes of an element type."""
    match = ELEMENTS.match(kind)
    if not match or not VARIANT.match(kind, match.end()):
        raise refused(path, f"*ELEMENT, TYPE={kind}", "is no plane element, nor a line: CPE, CPS and CAX with 3, 4, 6 or 8 nodes are read")
    plane, line, beam = match.groups()
    if plane:
        return 2, int(plane)
    return 1, int(line) if line else {1: 2, 2: 3, 3: 2}[int(beam)]


class _Deck:
    """The keywords of a deck that are mesh."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.nodes: dict[int, list[float]] = {}
        self.elements: dict[int, tuple[str, list[int]]] = {}
        self.sets: dict[str, dict[str, list[int]]] = {"NSET": {}, "ELSET": {}}
        self.surfaces: dict[str, list[tuple[str, int | None]]] = {}
        self.parts = 0
        #: sets that Abaqus/CAE makes for its own use
        self.internal: set[str] = set()

    def read(self, path: Path) -> None:
        """A file, with those that it includes."""
        options: dict[str, str] = {}
        rows: list[list[str]] = []
        keyword = ""
        for line in [*Path(_there(os.fspath(path))).read_text(errors="replace").splitlines(), "*END"]:
            text = line.strip()
            if not text or text.startswith("**"):
                continue
            if not text.startswith("*"):
                rows.append([cell.strip() for cell in text.rstrip(",").split(",")])
                continue
            self.take(path, keyword, options, rows)
            keyword, *given = [cell.strip() for cell in text[1:].split(",")]
            pairs = [cell.partition("=") for cell in given]
            options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
            keyword, rows = " ".join(keyword.upper().split()), []

    def take(self, path: Path, keyword: str, options: dict[str, str], rows: list[list[str]]) -> None:
        """One keyword with its lines."""
        try:
            if keyword == "INCLUDE":
                self.read(path.parent / options["INPUT"])
            elif keyword == "NODE":
                for tag, *at in rows:
                    self.nodes[int(tag)] = [float(x or 0) for x in at]
                self.put("NSET", options.get("NSET"), [int(row[0]) for row in rows])
            elif keyword == "ELEMENT":
                self.put("ELSET", options.get("ELSET"), self.take_elements(options["TYPE"].upper(), rows))
            elif keyword in ("NSET", "ELSET"):
                self.put(keyword, options[keyword], self.listed(keyword, "GENERATE" in options, rows))
                if "INTERNAL" in options:
                    self.internal.add(options[keyword].upper())
            elif keyword == "SURFACE":
                self.take_surface(options, rows)
            elif keyword == "PART":
                self.parts += 1
            if self.parts > 1 or keyword == "INSTANCE" and rows:
                text = "has several parts, or moves one: write it without parts and assemblies (a flat deck)"
                raise refused(self.path, "", text)
        except CaseError:
            raise
        except (KeyError, ValueError, IndexError) as error:
            raise refused(self.path, f"*{keyword}", f"cannot be understood: {error!s}") from None

    def take_elements(self, kind: str, rows: list[list[str]]) -> list[int]:
        """Elements of a type, one or more lines each."""
        _, count = _element(self.path, kind)
        numbers = [int(cell) for row in rows for cell in row]
        if len(numbers) % (count + 1):
            raise refused(self.path, f"*ELEMENT, TYPE={kind}", f"has lines that are not a number and {count} nodes")
        tags = []
        for k in range(0, len(numbers), count + 1):
            tag, *nodes = numbers[k : k + count + 1]
            if tag in self.elements:
                raise refused(self.path, f"*ELEMENT, TYPE={kind}", f"element {tag} stands in the file twice")
            self.elements[tag] = (kind, nodes)
            tags.append(tag)
        return tags

    def listed(self, kind: str, generate: bool, rows: list[list[str]]) -> list[int]:
        """The members that the lines of a set list: numbers, ranges, or names of other sets."""
        if generate:
            ranges = [[*map(int, row), 1][:3] for row in rows]
            return [tag for first, last, step in ranges for tag in range(first, last + 1, step)]
        return [tag for row in rows for cell in row for tag in self.members(kind, cell)]

    def take_surface(self, options: dict[str, str], rows: list[list[str]]) -> None:
        """Sides of elements (S1 … S4), or nodes."""
        by_nodes = options.get("TYPE", "ELEMENT").upper() == "NODE"
        faces = self.surfaces.setdefault(options["NAME"], [])
        for row in rows:
            label = "" if by_nodes else (row[1:] or [""])[0].upper()
            if not by_nodes and not re.fullmatch(r"S[1-4]", label):
                place = f"*SURFACE {options['NAME']}"
                raise refused(self.path, place, f"`{', '.join(row)}` names no side S1 to S4 of its elements")
            faces.append((row[0], None if by_nodes else int(label[1:])))

    def put(self, kind: str, name: str | None, tags: list[int]) -> None:
        """Put members into a set, if it has a name."""
        if name:
            known = self.name(kind, name) or name
            self.sets[kind].setdefault(known, []).extend(tags)

    def name(self, kind: str, name: str) -> str | None:
        """A set as it is written first."""
        return next((known for known in self.sets[kind] if known.upper() == name.upper()), None)

    def members(self, kind: str, cell: str) -> list[int]:
        """A number, or the members of a set; of an instance, behind its name and a dot."""
        cell = cell.strip('"')
        if cell.isdigit():
            return [int(cell)]
        known = self.name(kind, cell) or self.name(kind, cell.rpartition(".")[2])
        if known is None:
            raise refused(self.path, f"*{kind}", f"there is no set `{cell}` before it is used")
        return list(self.sets[kind][known])

    def named(self, kind: str) -> dict[str, list[int]]:
        """The sets that a user has named."""
        return {name: tags for name, tags in self.sets[kind].items() if name.upper() not in self.internal}

    def known(self, tags: list[int], numbers: dict[int, int], name: str) -> list[int]:
        """The members, which must be there."""
        missing = [tag for tag in tags if tag not in numbers]
        if missing:
            raise refused(self.path, name, f"has {missing[0]}, which the file does not have")
        return tags


# ---- Exodus ----


def _exodus(path: str) -> Found:
    """Blocks, side sets and node sets, by their names or as ``block_1``, ``sideset_1``, ``nodeset_1`` with their numbers."""
    with _needs("netCDF4").Dataset(_there(path)) as data:
        data.set_auto_mask(False)
        variables = data.variables
        axes = [variables[f"coord{axis}"][:] for axis in "xyz" if f"coord{axis}" in variables]
        nodes = np.stack(axes, axis=1) if axes else np.array(variables["coord"][:]).T
        found = Found(path, nodes)
        shells: dict[int, bool] = {}

        def labels(kind: str, key: str, what: str, count: str) -> list[str]:
            number = len(data.dimensions[count]) if count in data.dimensions else 0
            ids = variables[f"{key}_prop1"][:] if f"{key}_prop1" in variables else range(1, number + 1)
            given = variables[f"{kind}_names"][:] if f"{kind}_names" in variables else [b""] * number
            texts = [b"".join(np.atleast_1d(row)).decode(errors="replace").split("\0")[0].strip() for row in given]
            return [text or f"{what}_{tag}" for text, tag in zip(texts, ids, strict=True)]

        for k, name in enumerate(labels("eb", "eb", "block", "num_el_blk"), 1):
            if f"connect{k}" not in variables:
                continue
            block = variables[f"connect{k}"]
            kind = str(block.elem_type).upper()
            dimension = next((d for d, word in _EXODUS if word.match(kind)), None)
            if dimension is None:
                raise refused(path, name, f"has elements of the type {kind}, which are not read")
            own = [found.add(cell - 1, dimension) for cell in block[:]]
            shells |= dict.fromkeys(own, kind.startswith("SHELL") or kind.startswith("TRI") and nodes.shape[1] == 3)
            found.sets[name] = own
        for k, name in enumerate(labels("ns", "ns", "nodeset", "num_node_sets"), 1):
            if f"node_ns{k}" in variables:
                found.points[name] = (variables[f"node_ns{k}"][:] - 1).tolist()
        for k, name in enumerate(labels("ss", "ss", "sideset", "num_side_sets"), 1):
            if f"elem_ss{k}" not in variables:
                continue
            for cell, side in zip(variables[f"elem_ss{k}"][:] - 1, variables[f"side_ss{k}"][:], strict=True):
                nodes_of = found.cells[cell]
                corners = 3 if len(nodes_of) in (3, 6) else 4
                # The first two sides of a shell are its faces.
                edge = int(side) - (2 if shells[int(cell)] else 0)
                if found.dimensions[cell] != 2 or not 1 <= edge <= corners:
                    raise refused(path, name, f"side {side} of element {cell + 1} is no edge in the plane")
                found.sides.setdefault(name, []).append((nodes_of[edge - 1], nodes_of[edge % corners]))
    return found


_EXODUS = [(2, re.compile("QUAD|SHELL|TRI")), (1, re.compile("BAR|BEAM|TRUSS|EDGE")), (3, re.compile("HEX|TET|WEDGE|PYR"))]


# ---- by meshio ----


def _other(path: str, array: str | None) -> tuple[Found, bool]:
    """What ``meshio`` reads, and whether bodies are the values of an array of the cells."""
    meshio = _needs("meshio")
    _there(path)
    try:
        mesh = meshio.read(path)
    except (Exception, SystemExit) as error:  # noqa: BLE001
        raise refused(path, "", f"cannot be read by meshio: {type(error).__name__}: {error}") from None
    found = Found(path, np.asarray(mesh.points))
    blocks = []
    for block in mesh.cells:
        blocks.append([found.add(cell, block.dim) for cell in block.data])
    for name, sets in (mesh.cell_sets or {}).items():
        found.sets[name] = [blocks[k][cell] for k, own in enumerate(sets) if own is not None for cell in np.asarray(own, dtype=int)]
    found.points = {name: [int(node) for node in own] for name, own in (mesh.point_sets or {}).items()}
    # MED: the groups of each family of cells and of nodes.
    families = getattr(mesh, "cell_tags", {})
    for own, tags in zip(blocks, mesh.cell_data.get("cell_tags", []), strict=False):
        for cell, tag in zip(own, tags, strict=True):
            for name in families.get(tag, ()):
                found.sets.setdefault(name, []).append(cell)
    families = getattr(mesh, "point_tags", {})
    for node, tag in enumerate(mesh.point_data.get("point_tags", [])):
        for name in families.get(tag, ()):
            found.points.setdefault(name, []).append(node)
    arrays = {name: data for name, data in mesh.cell_data.items() if all(_is_whole(values) for values in data)}
    arrays.pop("cell_tags", None)
    return found, _by_array(found, arrays, blocks, array)


def _is_whole(values: Any) -> bool:
    return np.issubdtype(np.asarray(values).dtype, np.integer) and np.ndim(values) == 1


def _by_array(found: Found, arrays: dict[str, Any], blocks: list[list[int]], wanted: str | None) -> bool:
    """Sets by the values of an array, where the file has no sets, or the array is asked for."""
    if wanted not in arrays and (found.sets or not arrays):
        return False
    if wanted is None and len(arrays) > 1 or wanted is not None and wanted not in arrays:
        names = ", ".join(f"`{name}`" for name in arrays)
        raise refused(found.file, "bodies", f"name the array of the cells whose values are the bodies; there are {names}")
    name = wanted if wanted is not None else next(iter(arrays))
    found.sets = {}
    for own, values in zip(blocks, arrays[name], strict=True):
        for cell, value in zip(own, values, strict=True):
            found.sets.setdefault(f"{name}_{value}", []).append(cell)
    return True


def _needs(module: str) -> ModuleType:
    """A package that is needed for some formats alone."""
    try:
        return __import__(module)
    except ImportError as error:
        raise ImportError(f"this format needs {module}: pip install 'fecontact[meshio]'") from error


def _there(path: str) -> str:
    if not os.path.isfile(path):
        raise refused(path, "", "there is no such mesh file; check the path")
    return path
