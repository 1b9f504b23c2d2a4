"""Decks of Abaqus and CalculiX: their nodes, elements, sets and surfaces.

What a deck says in another way (nodes that are generated, parts that are placed) is refused, and so is a keyword that is not known.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ._deck_keywords import CHANGING, FLAGS, PHYSICS, PHYSICS_OF, READ
from ._found import Found, there
from ._plain import refused
from .errors import CaseError

#: Elements of the plane, shells and membranes, and lines; the number of their nodes comes last.
ELEMENTS = re.compile(r"(?:CPE|CPS|CPEG|CAX)(3|4|6|8|9)|(?:M3D|S|STRI)(3|4|6|8|9)|(?:T2D|T3D|R2D|RAX)(2|3)|B[23]([123])")

#: Letters behind the number, for reduced integration, hybrid, incompatible, modified, thermal and porous elements.
VARIANT = re.compile(r"[RHIMTPS5]*$")

#: A comma outside quotes.
COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')

FLAT = "write the deck flat: all nodes under *NODE in x and y, all elements under *ELEMENT, all sets under *NSET and *ELSET"


@dataclass
class Block:
    """A keyword in capitals, with what stands behind it and below it."""

    file: str
    line: int
    title: str
    words: list[str]
    rows: list[str] = field(default_factory=list)
    #: whether it stands in a part, whose sets are others than those of the assembly
    in_part: bool = False

    @property
    def keyword(self) -> str:
        """The keyword without blanks, which do not count."""
        return self.title.replace(" ", "")

    def refused(self, message: str, name: str = "") -> CaseError:
        """An error at the keyword, perhaps with a name or an option behind it."""
        return refused(self.file, f"line {self.line}: *{self.title}{name}", message)

    def options(self) -> dict[str, str]:
        """The options, which are all understood, and given once."""
        options: dict[str, str] = {}
        for word in self.words:
            key, _, value = word.partition("=")
            key, value = "".join(key.upper().split()), value.strip().strip('"')
            if key not in READ[self.keyword]:
                known = ", ".join(sorted(READ[self.keyword])) or "none"
                raise self.refused(f"the option `{word}` is not read, only {known}: {FLAT}")
            if key in options or (key not in FLAGS and not value):
                raise self.refused(f"the option {key} is given {'twice' if key in options else 'without a value'}")
            options[key] = value
        return options

    def named(self, options: dict[str, str], key: str) -> str:
        """An option that must be there."""
        if key not in options:
            raise self.refused(f"has no option {key}")
        return options[key]

    def cells(self) -> Iterator[list[str]]:
        """The lines below, cut at their commas."""
        for row in self.rows:
            cut = COMMA.split(row.rstrip(",")) if '"' in row else row.rstrip(",").split(",")
            yield [cell.strip() for cell in cut]

    def whole(self, cell: str) -> int:
        """A number of a node or an element."""
        if not re.fullmatch("0*[1-9][0-9]{0,17}", cell):
            raise self.refused(f"cannot be understood: `{cell}` is no whole number from 1 on")
        return int(cell)

    def real(self, cell: str) -> float:
        """A number as Fortran writes it, 1.D0 included; nothing is 0."""
        try:
            value = float(cell.upper().replace("D", "E") or 0)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or "_" in cell:
            raise self.refused(f"cannot be understood: `{cell}` is no finite number")
        return value


def read(path: str) -> Found:
    """Nodes, elements, sets and surfaces of a deck; names as they are first written, whatever the case of their letters.

    Raises:
        CaseError: what is not understood.
    """
    return _Deck(path).found()


def _blocks(path: str, above: list[str], blocks: list[Block]) -> None:
    """Append the keywords of a file, and of those that it includes, where it includes them."""
    here = os.path.realpath(there(path))
    if here in above:
        raise refused(path, "", "the deck includes itself: remove this *INCLUDE")
    for number, text in _lines(Path(path).read_text(errors="replace")):
        if not text.startswith("*"):
            if not blocks:
                raise refused(path, f"line {number}", f"`{text[:40]}` stands before the first keyword: this is no deck")
            blocks[-1].rows.append(text)
            continue
        keyword, comma, behind = text[1:].partition(",")
        block = Block(path, number, " ".join(keyword.upper().split()), [word.strip() for word in COMMA.split(behind)] if comma else [])
        if block.keyword in CHANGING:
            raise block.refused(f"changes the mesh, and is not read: {FLAT} (Abaqus/CAE does so when it has imported the deck)")
        if block.keyword == "INCLUDE":
            _blocks(str(Path(path).parent / block.named(block.options(), "INPUT")), [*above, here], blocks)
        elif block.keyword in READ:
            blocks.append(block)
        elif block.keyword in PHYSICS or block.keyword.startswith(PHYSICS_OF):
            blocks.append(Block(path, number, "", []))
        else:
            text = "is not known here, and could change the mesh: remove it if it does not (nodes, elements, sets and surfaces are read)"
            raise block.refused(text)


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """The lines with their numbers, without comments; a line of a keyword that ends with a comma goes on in the next."""
    number, begun = 0, ""
    for k, line in enumerate(text.splitlines(), 1):
        line = line.strip()
        if not line or line.startswith("**"):
            continue
        if begun and line.startswith("*"):
            yield number, begun
            begun = ""
        number, begun = (number, begun + line) if begun else (k, line)
        if not (begun.startswith("*") and begun.endswith(",")):
            yield number, begun
            begun = ""
    if begun:
        yield number, begun


class _Deck:
    """The parts of a deck that are mesh."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.nodes: dict[int, list[float]] = {}
        #: type, nodes
        self.elements: dict[int, tuple[str, list[int]]] = {}
        #: by kind, and whether they are those of the part
        self.sets: dict[tuple[str, bool], dict[str, list[int]]] = {(kind, part): {} for kind in ("NSET", "ELSET") for part in (True, False)}
        #: sets that Abaqus/CAE makes for its own use
        self.internal: set[tuple[str, bool, str]] = set()
        #: the one part and the one instance
        self.names: dict[str, str] = {}
        blocks: list[Block] = []
        _blocks(path, [], blocks)
        in_part = False
        for block in blocks:
            in_part = block.in_part = self.enters(block, in_part)
        # The numbers of nodes and elements first, as sets may stand before what they list.
        listed = [self.numbered(block) for block in blocks]
        self.surfaces: dict[str, Block] = {}
        for block, tags in zip(blocks, listed, strict=True):
            if block.keyword in ("NODE", "ELEMENT"):
                kind = "NSET" if block.keyword == "NODE" else "ELSET"
                self.put(block, kind, block.options().get(kind), tags)
            elif block.keyword in ("NSET", "ELSET"):
                self.put_set(block)
            elif block.keyword == "SURFACE":
                name = block.named(block.options(), "NAME")
                if name.upper() in (known.upper() for known in self.surfaces):
                    raise block.refused("stands in the file twice: give the surfaces different names", f" {name}")
                self.surfaces[name] = block

    def enters(self, block: Block, in_part: bool) -> bool:
        """Whether a block and those behind it stand in the part, or its instance."""
        keyword = block.keyword
        if keyword in ("PART", "INSTANCE"):
            if keyword in self.names or any(cell for row in block.cells() for cell in row):
                raise block.refused("the deck has several parts, or moves one: write it without parts and assemblies (a flat deck)")
            self.names[keyword] = block.named(block.options(), "NAME")
            return True
        return in_part and keyword not in ("ENDPART", "ENDINSTANCE")

    def numbered(self, block: Block) -> list[int]:
        """The numbers of the nodes or elements of a block, which are kept."""
        if block.keyword == "NODE":
            return self.take_nodes(block)
        if block.keyword == "ELEMENT":
            return self.take_elements(block)
        return []

    def take_nodes(self, block: Block) -> list[int]:
        """Nodes, one a line: number, x, y, z."""
        system = block.options().get("SYSTEM", "R").upper()
        if system != "R":
            raise block.refused(f"gives coordinates of a cylinder or a sphere: {FLAT}", f", SYSTEM={system}")
        tags = []
        for row in block.cells():
            if not 2 <= len(row) <= 4:
                raise block.refused(f"cannot be understood: `{', '.join(row)}` is not the number of a node and one to three coordinates")
            tag, at = block.whole(row[0]), [*(block.real(cell) for cell in row[1:]), 0.0, 0.0][:3]
            if self.nodes.setdefault(tag, at) != at:
                places = f"at {tuple(self.nodes[tag])} and {tuple(at)}"
                raise block.refused(f"node {tag} stands in the file twice, {places}: give each node, also of an assembly, its own number")
            tags.append(tag)
        return tags

    def take_elements(self, block: Block) -> list[int]:
        """Elements of a type, one or more lines each."""
        kind = block.named(block.options(), "TYPE").upper()
        name = f", TYPE={kind}"
        match = ELEMENTS.match(kind)
        if not match or not VARIANT.match(kind, match.end()):
            raise block.refused("is no plane element, nor a line: CPE, CPS and CAX with 3, 4, 6 or 8 nodes are read", name)
        count = _count(match)
        numbers = [block.whole(cell) for row in block.cells() for cell in row]
        if len(numbers) % (count + 1):
            raise block.refused(f"has lines that are not a number and {count} nodes", name)
        tags = []
        for k in range(0, len(numbers), count + 1):
            tag, *nodes = numbers[k : k + count + 1]
            if tag in self.elements:
                raise block.refused(f"element {tag} stands in the file twice", name)
            self.elements[tag] = (kind, nodes)
            tags.append(tag)
        return tags

    def put_set(self, block: Block) -> None:
        """A set, whose members are numbers, ranges, or names of other sets."""
        kind, options = block.keyword, block.options()
        name = block.named(options, kind)
        if options.get("INSTANCE", "").upper() not in ("", self.names.get("INSTANCE", "").upper()):
            raise block.refused(f"there is no instance `{options['INSTANCE']}` before it is used", f" {name}")
        if "INTERNAL" in options:
            self.internal.add((kind, block.in_part, name.upper()))
        if "GENERATE" in options:
            tags = [tag for row in block.cells() for tag in self.range(block, row, f" {name}")]
        else:
            tags = [tag for row in block.cells() for cell in row for tag in self.members(block, kind, cell, f" {name}")]
        self.put(block, kind, name, tags)

    def range(self, block: Block, row: list[str], name: str) -> Sequence[int]:
        """The numbers from the first to the last by the step, which are all there."""
        if not 2 <= len(row) <= 3:
            raise block.refused(f"`{', '.join(row)}` is no range: first, last, step", name)
        first, last, step = [*map(block.whole, row), 1][:3]
        tags = range(first, last + 1, step)
        if not tags:
            raise block.refused(f"the range from {first} to {last} is empty", name)
        return self.known(block, tags, name, block.keyword)

    def members(self, block: Block, kind: str, cell: str, name: str) -> list[int]:
        """A number, or the members of a set; of an instance, behind its name and a dot."""
        if cell.isascii() and cell.isdigit():
            return list(self.known(block, [block.whole(cell)], name, kind))
        cell = cell.strip('"')
        instance, _, own = cell.rpartition(".")
        of_part = [(own, True)] if instance and instance.upper() == self.names.get("INSTANCE", "").upper() else []
        for name_there, part in [(cell, block.in_part), *of_part, (cell, not block.in_part)]:
            known = _spelled(self.sets[kind, part], name_there)
            if known in self.sets[kind, part]:
                return self.sets[kind, part][known]
        raise block.refused(f"there is no set `{cell}` before it is used", name)

    def known(self, block: Block, tags: Sequence[int], name: str, kind: str) -> Sequence[int]:
        """The members, which must be there."""
        given = self.nodes if kind == "NSET" else self.elements
        # Of more numbers than there are, one of the first so many is missing.
        missing = next((tag for tag in tags[: len(given) + 1] if tag not in given), None)
        if missing is not None:
            raise block.refused(f"has {missing}, which the file does not have", name)
        return tags

    def put(self, block: Block, kind: str, name: str | None, tags: Sequence[int]) -> None:
        """Put members into a set, if it has a name."""
        if name is not None:
            sets = self.sets[kind, block.in_part]
            sets.setdefault(_spelled(sets, name), []).extend(tags)

    def named(self, kind: str) -> dict[str, list[int]]:
        """The sets that a user has named, of the part and of the assembly."""
        named: dict[str, list[int]] = {}
        for part in (True, False):
            for name, tags in self.sets[kind, part].items():
                if (kind, part, name.upper()) not in self.internal and set(named.setdefault(_spelled(named, name), tags)) != set(tags):
                    text = "is a set of the part and another one of the assembly: give them different names"
                    raise refused(self.path, f"*{kind} {name}", text)
        return named

    def found(self) -> Found:
        """All of it, counted from 0."""
        number = {tag: k for k, tag in enumerate(self.nodes)}
        found = Found(self.path, np.array(list(self.nodes.values()), dtype=float).reshape(-1, 3))
        cells: dict[int, int] = {}
        for tag, (kind, nodes) in self.elements.items():
            missing = [node for node in nodes if node not in number]
            if missing:
                raise refused(self.path, "", f"element {tag} has node {missing[0]}, which the file does not have")
            cells[tag] = found.add([number[node] for node in nodes], 1 if _is_line(kind) else 2)
        found.sets = {name: [cells[tag] for tag in tags] for name, tags in self.named("ELSET").items()}
        found.points = {name: [number[tag] for tag in tags] for name, tags in self.named("NSET").items()}
        for name, block in self.surfaces.items():
            kind = block.options().get("TYPE", "ELEMENT").upper()
            if kind == "ELEMENT":
                sides = self.sides(block, f" {name}")
                found.sides[name] = [(number[end], number[other]) for end, other in sides]
            elif kind == "NODE":
                points = [number[tag] for row in block.cells() for tag in self.members(block, "NSET", row[0], f" {name}")]
                if set(found.points.setdefault(name, points)) != set(points):
                    raise block.refused("has other nodes than the node set of this name: give them different names", f" {name}")
            else:
                raise block.refused(f"the type {kind} is not read: give the sides of elements (TYPE=ELEMENT) or nodes (TYPE=NODE)", f" {name}")
        return found

    def sides(self, block: Block, name: str) -> Iterator[tuple[int, int]]:
        """The nodes at the ends of the sides of a surface."""
        for row in block.cells():
            label = row[1].upper() if len(row) == 2 else ""
            if not re.fullmatch("S[1-4]", label):
                raise block.refused(f"`{', '.join(row)}` names no side S1 to S4 of its elements", name)
            for tag in self.members(block, "ELSET", row[0], name):
                kind, nodes = self.elements[tag]
                side, corners = int(label[1:]), 3 if len(nodes) in (3, 6) else 4
                match = ELEMENTS.match(kind)
                if match and match[2]:
                    text = f"element {tag} is a shell or membrane ({kind}), whose sides programs number differently"
                    raise block.refused(f"{text}: write CPE, CPS or CAX, or give the nodes of the surface (TYPE=NODE)", name)
                if _is_line(kind) or side > corners:
                    raise block.refused(f"element {tag} has no side {label} in the plane", name)
                yield nodes[side - 1], nodes[side % corners]


def _spelled(sets: Mapping[str, list[int]], name: str) -> str:
    """The name of a set as it is written first, whatever the case of its letters."""
    return name if name in sets else next((known for known in sets if known.upper() == name.upper()), name)


def _count(match: re.Match[str]) -> int:
    """Number of nodes of an element type."""
    plane, shell, line, beam = match.groups()
    return {"1": 2, "2": 3, "3": 2}[beam] if beam else int(plane or shell or line)


def _is_line(kind: str) -> bool:
    match = ELEMENTS.match(kind)
    return match is not None and bool(match[3] or match[4])
