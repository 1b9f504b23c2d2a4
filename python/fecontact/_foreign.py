"""Meshes in the formats of other programs: groups of cells, sides and nodes by name, whatever the format.

Abaqus and CalculiX decks are read here (all of a deck that is mesh, surfaces included), Exodus by ``netCDF4`` (side sets included),
everything else by ``meshio``.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from . import _deck
from ._found import Found, there
from ._plain import refused

#: Nodes of plane cells and of lines.
PLANE, LINE = (3, 4, 6, 8, 9), (2, 3)

#: Sizes beyond which nodes do not lie in one plane, as a share of the mesh.
FLAT = 1e-9


def read(path: str, bodies: Sequence[str] | str | None) -> dict[str, Any]:
    """What :class:`fecontact.Mesh` is made of.

    Raises:
        CaseError: what cannot be read, or is no plane mesh.
    """
    end = Path(path).suffix.lower()
    if end == ".inp":
        return _parts(_deck.read(path), bodies)
    if end in (".e", ".exo", ".ex2", ".exii"):
        return _parts(_exodus(path), bodies)
    return _parts(*_other(path, bodies))


def _parts(found: Found, bodies: Sequence[str] | str | None) -> dict[str, Any]:
    """Bodies, edges and points."""
    _numbers(found)
    nodes = _plane(found)
    edges = _edges(found)
    members = _bodies(found, [bodies] if isinstance(bodies, str) else bodies or found.bodies or None)
    ends = {frozenset(edge[:2]): edge for edge in edges.values()}
    lines: dict[str, list[tuple[int, ...]]] = {}
    for name, cells in found.sets.items():
        own = [found.cells[cell] for cell in cells if found.dimensions[cell] == 1]
        if own and name not in members:
            # A line of two nodes stands for a quadratic side as well.
            lines[name] = [edges.get(frozenset(line)) or (ends.get(frozenset(line)) if len(line) == 2 else None) or line for line in own]
        alone = [found.cells[cell][0] for cell in cells if found.dimensions[cell] == 0]
        if alone:
            found.points.setdefault(name, []).extend(alone)
    _leave_out_inner(found, lines, members)
    for name, sides in found.sides.items():
        own_sides = [ends.get(frozenset(side), side) for side in sides]
        if {frozenset(side) for side in lines.setdefault(name, own_sides)} != {frozenset(side) for side in own_sides}:
            raise refused(found.file, name, "is a set of lines, and a surface of other edges: give them different names")
    groups = {name: {node for cell in cells for node in cell} for name, cells in lines.items()}
    groups |= {name: {node for cell in cells for node in found.cells[cell]} for name, cells in members.items()}
    points = {}
    for name, list_ in found.points.items():
        if groups.get(name) != set(list_):
            own_name = f"{name}_nodes" if name in groups else name
            if own_name in groups or own_name != name and own_name in found.points:
                raise refused(found.file, name, f"is a set of other nodes than the group `{name}`, and `{own_name}` is there: rename one")
            points[own_name] = np.array(sorted(set(list_)), dtype=np.int64)
    return {
        "nodes": nodes,
        "elements": {name: _by_width(found.cells[cell] for cell in cells) for name, cells in members.items()},
        "edges": {name: _by_width(dict.fromkeys(cells)) for name, cells in lines.items()},
        "points": points,
    }


def _leave_out_inner(found: Found, lines: dict[str, list[tuple[int, ...]]], members: dict[str, list[int]]) -> None:
    """Lines inside a body, or between two that share nodes, are no sides: a group of them becomes a group of nodes, with a warning."""
    sides: dict[frozenset[int], int] = {}
    for cells in members.values():
        for cell in cells:
            nodes = found.cells[cell]
            corners = 3 if len(nodes) in (3, 6) else 4
            for k in range(corners):
                side = frozenset((nodes[k], nodes[(k + 1) % corners]))
                sides[side] = sides.get(side, 0) + 1
    for name, own in list(lines.items()):
        inner = [line for line in own if sides.get(frozenset(line[:2]), 0) > 1]
        if not inner:
            continue
        if len(inner) == len(own):
            del lines[name]
            found.points.setdefault(name, []).extend(dict.fromkeys(node for line in own for node in line))
            message = f"its {len(inner)} lines lie inside a body, or between bodies that share nodes, and are not sides: it is a group of nodes"
        else:
            lines[name] = [line for line in own if line not in inner]
            message = f"{len(inner)} of its {len(own)} lines lie inside a body, or between bodies that share nodes, and are not sides: they are left out"
        warnings.warn(f"{found.file}: {name}: {message}", stacklevel=5)


def _numbers(found: Found) -> None:
    """Cells and sets name nodes that are there."""
    for what, lists in (("a cell", found.cells), ("a set", found.points.values())):
        for nodes in lists:
            beyond = next((node for node in nodes if not 0 <= node < len(found.nodes)), None)
            if beyond is not None:
                raise refused(found.file, "", f"{what} has the node {beyond + 1}, and the file has {len(found.nodes)} nodes")


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


# ---- Exodus ----


def _exodus(path: str) -> Found:
    """Blocks, side sets and node sets, by their names or as ``block_1``, ``sideset_1``, ``nodeset_1`` with their numbers."""
    netcdf = _needs("netCDF4")
    there(path)
    try:
        return _exodus_found(path, netcdf)
    except (AttributeError, IndexError, KeyError, OSError, ValueError) as error:
        raise refused(path, "", f"is not a complete Exodus file: {type(error).__name__}: {error}") from None


def _exodus_found(path: str, netcdf: ModuleType) -> Found:
    """What the variables of the file say."""
    with netcdf.Dataset(path) as data:
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
                if not 0 <= cell < len(found.cells):
                    raise refused(path, name, f"has the element {cell + 1}, which the file does not have")
                nodes_of = found.cells[cell]
                corners = 3 if len(nodes_of) in (3, 6) else 4
                # The first two sides of a shell are its faces.
                edge = int(side) - (2 if shells[int(cell)] else 0)
                if found.dimensions[cell] != 2 or not 1 <= edge <= corners:
                    raise refused(path, name, f"side {side} of element {cell + 1} is not an edge in the plane")
                found.sides.setdefault(name, []).append((nodes_of[edge - 1], nodes_of[edge % corners]))
    return found


_EXODUS = [(2, re.compile("QUAD|SHELL|TRI")), (1, re.compile("BAR|BEAM|TRUSS|EDGE")), (3, re.compile("HEX|TET|WEDGE|PYR"))]


# ---- by meshio ----


#: Cells that are read, by their names in meshio, with their dimensions.
_MESHIO = {"vertex": 0, "line": 1, "line3": 1, "triangle": 2, "triangle6": 2, "quad": 2, "quad8": 2, "quad9": 2}


def _other(path: str, bodies: Sequence[str] | str | None) -> tuple[Found, Sequence[str] | str | None]:
    """What ``meshio`` reads, and the sets that are bodies; those named after the values of an array of the cells included."""
    meshio = _needs("meshio")
    there(path)
    try:
        mesh = meshio.read(path)
    except ImportError as error:
        # Meshio loads what a format needs when it reads one.
        missing = (error.name or str(error)).partition(".")[0]
        raise ImportError(f"{path}: reading it needs {missing}: pip install 'fecontact[meshio]', or pip install {missing}") from error
    except (Exception, SystemExit) as error:  # noqa: BLE001
        raise refused(path, "", f"cannot be read by meshio: {type(error).__name__}: {error}") from None
    found = Found(path, np.asarray(mesh.points))
    blocks = []
    for block in mesh.cells:
        simple = block.type == "polygon" and np.shape(block.data)[1] in (3, 4)
        if block.dim < 3 and block.type not in _MESHIO and not simple:
            raise refused(path, "", f"has cells of the type `{block.type}`, which are not read, only {', '.join(_MESHIO)}")
        if not _is_whole(np.ravel(block.data)):
            raise refused(path, "", f"has cells of the type `{block.type}` whose nodes are not whole numbers")
        blocks.append([found.add(cell, block.dim) for cell in block.data])
    if Path(path).suffix.lower() == ".vtu":
        _complete(found)
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
    arrays = {name: data for name, data in mesh.cell_data.items() if name != "cell_tags"}
    return found, _by_array(found, arrays, blocks, bodies)


def _complete(found: Found) -> None:
    """Meshio leaves out cells of a VTU file that it does not know, and values beyond the last cell."""
    content = Path(found.file).read_bytes()
    number = sum(int(count) for count in re.findall(rb'NumberOfCells\s*=\s*"\s*(\d+)', content))
    if number != len(found.cells):
        raise refused(found.file, "", f"has {number} cells, of which {len(found.cells)} can be read: triangles, quadrilaterals and lines")
    try:
        pieces = ElementTree.fromstring(content).iter("Piece")
    except ElementTree.ParseError:
        # With binary data behind the text; what a program has written has one length.
        return
    for piece in pieces:
        for array in piece.iterfind("CellData/DataArray[@format='ascii']"):
            values = len((array.text or "").split()) / int(array.get("NumberOfComponents", "1") or 1)
            if values != int(piece.get("NumberOfCells", "0")):
                name = f"the array `{array.get('Name')}` of the cells"
                raise refused(found.file, "", f"{name} has {values:g} values for {piece.get('NumberOfCells')} cells")


def _is_whole(values: Any) -> bool:
    """Whether an array has one whole number a cell, in whatever type they are stored."""
    array = np.asarray(values)
    return array.ndim == 1 and (np.issubdtype(array.dtype, np.integer) or array.dtype.kind == "f" and bool(np.all(array % 1 == 0)))


def _is_bodies(values: Sequence[Any]) -> bool:
    """Whether an array that nobody has named tells bodies: whole numbers, and where they are stored as decimals, several of them."""
    whole = all(_is_whole(block) for block in values)
    return whole and (all(np.asarray(block).dtype.kind in "iu" for block in values) or len(np.unique(np.concatenate(values))) > 1)


def _by_array(
    found: Found, arrays: dict[str, Any], blocks: list[list[int]], bodies: Sequence[str] | str | None
) -> Sequence[str] | str | None:
    """Sets by the values of an array, where the file has no sets, or the array is asked for; the sets that are bodies then."""
    asked = bodies if isinstance(bodies, str) else None
    possible = {name: values for name, values in arrays.items() if _is_bodies(values)}
    names = ", ".join(f"`{name}`" for name in possible) or "none"
    if asked in arrays and asked is not None:
        if not all(_is_whole(values) for values in arrays[asked]):
            text = f"the array `{asked}` does not have one whole number per cell: name the array of the bodies; there are {names}"
            raise refused(found.file, "bodies", text)
        name = asked
    elif found.sets or not possible:
        return bodies
    elif len(possible) > 1 or asked is not None:
        raise refused(found.file, "bodies", f"name the array of the cells whose values are the bodies; there are {names}")
    else:
        name = next(iter(possible))
    found.sets = {}
    for own, values in zip(blocks, arrays[name], strict=True):
        for cell, value in zip(own, values, strict=True):
            found.sets.setdefault(f"{name}_{int(value)}", []).append(cell)
    return None if asked is not None else bodies


def _needs(module: str) -> ModuleType:
    """A package that is needed for some formats alone."""
    try:
        return __import__(module)
    except ImportError as error:
        raise ImportError(f"this format needs {module}: pip install 'fecontact[meshio]'") from error
