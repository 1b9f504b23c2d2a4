"""Meshes from files, arrays, blocks, or the gmsh model in memory."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _foreign, _native
from ._paths import path as as_path
from ._plain import numbers, plain, refused, renamed

Lists = Union[ArrayLike, Sequence[ArrayLike]]
# What a mesh is made of again: arrays, the content of a gmsh file, blocks as JSON, or such of several meshes.
Source = Union[tuple[Any, ...], bytes, str, list[Any]]


class Mesh:
    """A mesh in memory, checked like one from a file.

    Args:
        nodes: positions, shape (nodes, 2) [L].
        elements: for each body its elements, as node numbers from 0: shape (elements, k) with k = 3 or 6
            (triangles), 4, 8 or 9 (quadrilaterals; corners in order, then mid-side nodes in the same order, then the centre),
            or a list of such arrays.
        edges: for each boundary curve its edges, shape (edges, 2), or (edges, 3) with the middle node last.
        points: for each set its nodes, shape (points,).

    Raises:
        CaseError: the mesh is invalid.
    """

    def __init__(
        self,
        nodes: ArrayLike,
        elements: Mapping[str, Lists],
        edges: Mapping[str, Lists] | None = None,
        points: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        given = numbers(nodes, "nodes", "mesh")
        if given.ndim != 2 or given.shape[1] != 2:
            raise refused("mesh", "nodes", f"has the shape {given.shape}: must be (nodes, 2)")
        for kind, parts in (("elements", elements), ("edges", edges or {}), ("points", points or {})):
            if not isinstance(parts, Mapping) or not all(isinstance(name, str) for name in parts):
                raise refused("mesh", kind, f"is a {type(parts).__name__}: must be a dict of arrays by name")
        one = {name: np.asarray(nodes).reshape(-1, 1) for name, nodes in (points or {}).items()}
        self._source: Source = (
            np.ascontiguousarray(given),
            {name: _lists("elements", name, lists, (3, 4, 6, 8, 9)) for name, lists in elements.items()},
            {name: _lists("edges", name, lists, (2, 3)) for name, lists in (edges or {}).items()},
            {name: _lists("points", name, nodes, (1,)) for name, nodes in one.items()},
        )
        self._native = _native.Mesh(*self._source)

    @classmethod
    def read(cls, path: str | os.PathLike[str], bodies: Sequence[str] | str | None = None) -> Mesh:
        """Read the mesh of a file: of gmsh (``.msh``, MSH 4.1 or 2.2), or of another program, with its groups.

        Bodies are the element sets of Abaqus and CalculiX (``.inp``), the blocks of Exodus (``.e``, ``.exo``), the groups of cells of
        MED (``.med``), and in other formats read by meshio, such as ``.vtu``, the values of a cell array (``NAME_1``, …). Element
        surfaces, side sets, and groups of lines become edge groups; node sets become node groups. In an assembly of several instances
        each instance is a body. Lines inside bodies become nodes, with a warning. Of decks, keywords that change the
        mesh and are not read (``*NGEN``, ``*ELCOPY``, …), and those that are not known, are refused.

        All but ``.msh`` and ``.inp`` need ``pip install 'fecontact[meshio]'``. A node set with the nodes of edges, or of a body,
        of the same name is merged with that group; with other nodes it is called ``NAME_nodes``.

        Args:
            path: the file; its extension determines the format.
            bodies: the element sets that are bodies, if sets overlap; or the name of the cell array.

        Raises:
            CaseError: the file cannot be read, or is not a plane mesh.
            ImportError: the format needs a package that is not installed.
        """
        path = as_path(path, "path")
        if Path(path).suffix.lower() == ".msh" or _is_gmsh(path):
            if bodies is not None:
                raise refused(os.fspath(path), "bodies", "is for other formats: the bodies of gmsh are its physical surfaces")
            return cls._of(Path(path).read_bytes(), _native.Mesh.read(os.fspath(path)))
        return cls(**_foreign.read(os.fspath(path), bodies))

    @classmethod
    def join(cls, meshes: Sequence[Mesh]) -> Mesh:
        """Combine meshes into one; they share no nodes, and each group is in one of them.

        Raises:
            CaseError: two of them have a group of the same name.
        """
        given = list(meshes)
        return cls._of([mesh._source for mesh in given], _native.Mesh.join([mesh._native for mesh in given]))

    @classmethod
    @renamed(apart="separated")
    def from_blocks(
        cls,
        blocks: Sequence[Mapping[str, Any]],
        parameters: Mapping[str, float | str] | None = None,
        separated: Sequence[str] = (),
        joined: Sequence[Sequence[str]] = (),
    ) -> Mesh:
        """Create a mesh of quadrilaterals divided into elements, joined where two of one body share a side.

        ``Case(mesh=model.Blocks(...))`` accepts the same without a mesh in memory, and keeps the parameters changeable:
        ``case.replace({"mesh.parameters.L": 3.0})``.

        Args:
            blocks: objects of :class:`fecontact.model.Block`, or dicts.
            parameters: numbers by name, for expressions in corners, numbers of elements and gradings.
            separated: names of sides that are not joined.
            joined: lists of bodies joined with each other, such as two bonded materials.

        Raises:
            CaseError: a block is invalid, with the reason.
        """
        more = {"parameters": dict(parameters or {}), "separated": list(separated), "joined": [list(bodies) for bodies in joined]}
        given = plain({"blocks": list(blocks), **more}, file="mesh")
        return _again(json.dumps(given, allow_nan=False))

    @classmethod
    def from_gmsh(cls) -> Mesh:
        """Take the mesh of the current model of the module ``gmsh``, which must be initialized and have generated it.

        Bodies are its physical surfaces, boundary curves its physical curves, sets of nodes its physical points.
        """
        import gmsh

        options = {"Mesh.MshFileVersion": 4.1, "Mesh.Binary": 1, "Mesh.SaveAll": 0, "Mesh.SaveParametric": 0}
        before = {name: gmsh.option.getNumber(name) for name in options}
        with tempfile.TemporaryDirectory(prefix="fecontact-") as folder:
            file = os.path.join(folder, "model.msh")
            try:
                for name, value in options.items():
                    gmsh.option.setNumber(name, value)
                gmsh.write(file)
            finally:
                for name, value in before.items():
                    gmsh.option.setNumber(name, value)
            content = Path(file).read_bytes()
        return cls._of(content, _native.Mesh.from_bytes(content))

    @classmethod
    def _of(cls, source: Source, native: _native.Mesh) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._source, mesh._native = source, native
        return mesh

    def __reduce__(self) -> tuple[Any, tuple[Any]]:
        return (_again, (self._source,))

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Reference positions, shape (nodes, 2) [L]; a copy."""
        return self._native.nodes()

    @property
    def elements(self) -> list[list[int]]:
        """The nodes of every element, counter-clockwise."""
        return self._native.elements()

    @property
    def groups(self) -> dict[str, str]:
        """Every group and its kind: elements, edges, points, or lines that are sides of no element (the outline of a rigid master)."""
        return {name: kind for name, (kind, _) in self._native.groups().items()}

    def document(self) -> dict[str, Any]:
        """The mesh in the form of a case file."""
        groups = self._native.groups()
        elements, nodes = self.elements, self.nodes.tolist()
        edges = {name: members for name, (kind, members) in groups.items() if kind == "edges"}
        for name, lines in self._native.lines().items():
            number: dict[tuple[float, float], int] = {}
            for x, y in (node for line in lines for node in line):
                if (x, y) not in number:
                    number[x, y] = len(nodes)
                    nodes.append([x, y])
            edges[name] = [[number[x, y] for x, y in line] for line in lines]
        return {
            "nodes": nodes,
            "elements": {k: [elements[e] for e in m[0]] for k, (kind, m) in groups.items() if kind == "elements"},
            "edges": edges,
            "points": {name: members[0] for name, (kind, members) in groups.items() if kind == "points"},
        }

    def __repr__(self) -> str:
        groups = ", ".join(self.groups)
        return f"<Mesh of {len(self.nodes)} nodes and {len(self.elements)} elements, with the groups {groups}>"


def _again(source: Source) -> Mesh:
    if isinstance(source, list):
        return Mesh.join([_again(part) for part in source])
    if isinstance(source, str):
        return Mesh._of(source, _native.Mesh.from_blocks(source))
    if isinstance(source, bytes):
        return Mesh._of(source, _native.Mesh.from_bytes(source))
    mesh = Mesh.__new__(Mesh)
    mesh._source, mesh._native = source, _native.Mesh(*source)
    return mesh


def _is_gmsh(path: str | os.PathLike[str]) -> bool:
    """Whether a file is a gmsh mesh, by its content."""
    if not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        return file.read(11) == b"$MeshFormat"


def _lists(kind: str, name: str, given: Any, widths: tuple[int, ...]) -> list[NDArray[np.int64]]:
    place = f"{kind}.{name}"
    try:
        several = isinstance(given, (list, tuple)) and bool(given) and np.ndim(given[0]) == 2
        arrays = [np.asarray(array) for array in (given if several else [given])]
    except ValueError:
        raise refused("mesh", place, "has rows of different lengths: give a list of arrays, one for each length") from None
    for array in arrays:
        if array.size == 0:
            continue
        if array.ndim != 2 or array.shape[1] not in widths:
            allowed = " or ".join(str(width) for width in widths)
            raise refused("mesh", place, f"has the shape {array.shape}: must be (number, {allowed})")
        if not np.issubdtype(array.dtype, np.integer):
            raise refused("mesh", place, f"has the type {array.dtype}: nodes are integers, counted from 0")
    return [np.ascontiguousarray(array, dtype=np.int64) for array in arrays if array.size]
