"""Decks of Abaqus and CalculiX: their nodes, elements, sets and surfaces, also in parts that instances place.

What a deck says in another way (nodes that are generated) is refused, and so is a keyword that is not known.
"""

from __future__ import annotations

import math
import os
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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
    #: number of the instance that it belongs to, whose sets are others than those of the assembly; 0 is the assembly, or a flat deck
    scope: int = 0

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
        if not re.fullmatch("0*[1-9][0-9]{0,11}", cell):
            raise self.refused(f"cannot be understood: `{cell}` is not a whole number of 1 or more")
        return int(cell)

    def place(self) -> Place:
        """Where an instance places its part: a translation, and a rotation about an axis through two points, by degrees."""
        rows = [[self.real(cell) for cell in row] for row in self.cells() if any(row)]
        if len(rows) > 2 or any(len(row) > 3 for row in rows[:1]) or any(len(row) != 7 for row in rows[1:]):
            raise self.refused("its lines are no translation (x, y, z) and rotation (two points of the axis, degrees)")
        moved = np.array([*rows[0], 0.0, 0.0, 0.0][:3]) if rows else np.zeros(3)
        if len(rows) < 2:
            return Place(moved)
        start, end, angle = np.array(rows[1][:3]), np.array(rows[1][3:6]), math.radians(rows[1][6])
        size = float(np.linalg.norm(end - start))
        if not size > 0.0:
            raise self.refused("its axis of rotation has no direction: its two points coincide")
        return Place(moved, start, (end - start) / size, angle)

    def real(self, cell: str) -> float:
        """A number as Fortran writes it, 1.D0 included; nothing is 0."""
        try:
            value = float(cell.upper().replace("D", "E") or 0)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or "_" in cell:
            raise self.refused(f"cannot be understood: `{cell}` is not a finite number")
        return value


@dataclass
class Place:
    """Where an instance is: its part is moved, and then turned about an axis."""

    moved: NDArray[np.float64]
    start: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    axis: NDArray[np.float64] = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    angle: float = 0.0

    def of(self, at: list[float]) -> list[float]:
        """A point of the part in the assembly."""
        arm = np.array(at) + self.moved
        if self.angle:
            arm = arm - self.start
            turned = math.cos(self.angle) * arm + math.sin(self.angle) * np.cross(self.axis, arm)
            arm = self.start + turned + (1.0 - math.cos(self.angle)) * float(self.axis @ arm) * self.axis
        return [float(x) for x in arm]


#: Numbers of nodes and elements of an instance begin here, times its number, where a deck has several instances.
APART = 10**12


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
                raise refused(path, f"line {number}", f"`{text[:40]}` stands before the first keyword: this is not a deck")
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
        #: nodes of the assembly itself
        self.of_assembly: set[int] = set()
        #: instances by their numbers, from 1: name, and where it is
        self.instances: dict[int, tuple[str, Place]] = {}
        written: list[Block] = []
        _blocks(path, [], written)
        blocks = self.placed(written)
        scopes = [*self.instances, 0]
        #: by kind, and the instance whose they are
        self.sets: dict[tuple[str, int], dict[str, list[int]]] = {(kind, scope): {} for kind in ("NSET", "ELSET") for scope in scopes}
        #: sets that Abaqus/CAE makes for its own use
        self.internal: set[tuple[str, int, str]] = set()
        # The numbers of nodes and elements first, as sets may stand before what they list.
        listed = [self.numbered(block) for block in blocks]
        self.surfaces: dict[tuple[int, str], Block] = {}
        for block, tags in zip(blocks, listed, strict=True):
            if block.keyword in ("NODE", "ELEMENT"):
                kind = "NSET" if block.keyword == "NODE" else "ELSET"
                self.put(block, kind, block.options().get(kind), tags)
            elif block.keyword in ("NSET", "ELSET"):
                self.put_set(block)
            elif block.keyword == "SURFACE":
                name = block.named(block.options(), "NAME")
                if (block.scope, name.upper()) in ((scope, known.upper()) for scope, known in self.surfaces):
                    raise block.refused("appears in the file twice: give the surfaces different names", f" {name}")
                self.surfaces[block.scope, name] = block

    def placed(self, written: list[Block]) -> list[Block]:
        """The blocks of the assembly, and those of each part as often as an instance places it."""
        parts: dict[str, tuple[Block, list[Block]]] = {}
        placed: list[Block] = []
        within: Block | None = None
        own: list[Block] = []
        for block in written:
            keyword = block.keyword
            if keyword in ("PART", "INSTANCE"):
                if within is not None:
                    raise block.refused(f"stands within *{within.title}, which does not end before it (*END {within.keyword})")
                within, own = block, []
                name = block.named(block.options(), "NAME").upper()
                if keyword == "PART" and name in parts:
                    raise block.refused("appears in the file twice: give the parts different names", f" {block.options()['NAME']}")
                if keyword == "INSTANCE" and any(name == known.upper() for known, _ in self.instances.values()):
                    raise block.refused("appears in the file twice: give the instances different names", f" {block.options()['NAME']}")
            elif keyword == "ENDPART" and within is not None and within.keyword == "PART":
                parts[within.options()["NAME"].upper()] = (within, own)
                within = None
            elif keyword == "ENDINSTANCE" and within is not None and within.keyword == "INSTANCE":
                self.place(within, [*self.part_of(within, parts), *own], placed)
                within = None
            elif within is not None:
                own.append(block)
            else:
                placed.append(block)
        if within is not None:
            raise within.refused(f"does not end (*END {within.keyword})")
        if parts and not self.instances:
            # Parts that no assembly places are where they are written.
            for part, blocks in parts.values():
                self.place(part, blocks, placed)
        return placed

    def part_of(self, instance: Block, parts: Mapping[str, tuple[Block, list[Block]]]) -> list[Block]:
        """The blocks of the part that an instance places."""
        name = instance.options().get("PART")
        if name is None:
            return []
        if name.upper() not in parts:
            known = ", ".join(f"`{part.options()['NAME']}`" for part, _ in parts.values()) or "none"
            raise instance.refused(f"there is no part `{name}` before it is used; the parts are {known}")
        return parts[name.upper()][1]

    def place(self, instance: Block, blocks: list[Block], placed: list[Block]) -> None:
        """Add an instance, or a part that none places, with what belongs to it."""
        scope = len(self.instances) + 1
        place = instance.place() if instance.keyword == "INSTANCE" else Place(np.zeros(3))
        self.instances[scope] = (instance.options()["NAME"], place)
        placed.extend(replace(block, scope=scope) for block in blocks)

    def first(self, scope: int) -> int:
        """What is added to the numbers of nodes and elements of an instance; of a single one they are those of the assembly, too."""
        return scope * APART if len(self.instances) > 1 else 0

    def scope_of(self, name: str) -> int | None:
        """The number of an instance by its name."""
        return next((scope for scope, (known, _) in self.instances.items() if known.upper() == name.upper()), None)

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
            tag, at = self.first(block.scope) + block.whole(row[0]), [*(block.real(cell) for cell in row[1:]), 0.0, 0.0][:3]
            at = self.instances[block.scope][1].of(at) if block.scope else at
            if not block.scope:
                self.of_assembly.add(tag)
            if self.nodes.setdefault(tag, at) != at:
                places = f"at {tuple(self.nodes[tag])} and {tuple(at)}"
                raise block.refused(f"node {tag % APART} appears in the file twice, {places}: give each node, also of an assembly, its own number")
            tags.append(tag)
        return tags

    def take_elements(self, block: Block) -> list[int]:
        """Elements of a type, one or more lines each."""
        kind = block.named(block.options(), "TYPE").upper()
        name = f", TYPE={kind}"
        match = ELEMENTS.match(kind)
        if not match or not VARIANT.match(kind, match.end()):
            raise block.refused("is neither a plane element nor a line: CPE, CPS and CAX with 3, 4, 6 or 8 nodes are read", name)
        count = _count(match)
        numbers = [block.whole(cell) for row in block.cells() for cell in row]
        if len(numbers) % (count + 1):
            raise block.refused(f"has lines that are not a number and {count} nodes", name)
        tags = []
        for k in range(0, len(numbers), count + 1):
            tag, *nodes = (self.first(block.scope) + number for number in numbers[k : k + count + 1])
            if tag in self.elements:
                raise block.refused(f"element {tag % APART} appears in the file twice", name)
            self.elements[tag] = (kind, nodes)
            tags.append(tag)
        return tags

    def put_set(self, block: Block) -> None:
        """A set, whose members are numbers, ranges, or names of other sets."""
        kind, options = block.keyword, block.options()
        name = block.named(options, kind)
        of = self.scope_of(options["INSTANCE"]) if options.get("INSTANCE") else block.scope
        if of is None:
            raise block.refused(f"there is no instance `{options['INSTANCE']}` before it is used", f" {name}")
        if "INTERNAL" in options:
            self.internal.add((kind, block.scope, name.upper()))
        if "GENERATE" in options:
            tags = [tag for row in block.cells() for tag in self.range(block, row, f" {name}", of)]
        else:
            tags = [tag for row in block.cells() for cell in row for tag in self.members(block, kind, cell, f" {name}", of)]
        self.put(block, kind, name, tags)

    def range(self, block: Block, row: list[str], name: str, of: int) -> Sequence[int]:
        """The numbers from the first to the last by the step, which are all there."""
        if not 2 <= len(row) <= 3:
            raise block.refused(f"`{', '.join(row)}` is not a range: first, last, step", name)
        first, last, step = [*map(block.whole, row), 1][:3]
        begin = self.first(of)
        tags = range(begin + first, begin + last + 1, step)
        if not tags:
            raise block.refused(f"the range from {first} to {last} is empty", name)
        return self.known(block, tags, name, block.keyword)

    def members(self, block: Block, kind: str, cell: str, name: str, of: int | None = None) -> list[int]:
        """A number, or the members of a set; of an instance, behind its name and a dot, or by the option."""
        of = block.scope if of is None else of
        if cell.isascii() and cell.isdigit():
            return list(self.known(block, [self.first(of) + block.whole(cell)], name, kind))
        cell = cell.strip('"')
        instance, _, own = cell.rpartition(".")
        named = self.scope_of(instance) if instance else None
        if named is not None and own.isascii() and own.isdigit():
            return list(self.known(block, [self.first(named) + block.whole(own)], name, kind))
        # A single instance shares its sets with the assembly.
        shared = [0, *self.instances] if len(self.instances) == 1 else []
        for name_there, scope in [(cell, of), (cell, block.scope), *([(own, named)] if named is not None else []), *((cell, other) for other in shared)]:
            known = _spelled(self.sets[kind, scope], name_there)
            if known in self.sets[kind, scope]:
                return self.sets[kind, scope][known]
        raise block.refused(f"there is no set `{cell}` before it is used", name)

    def known(self, block: Block, tags: Sequence[int], name: str, kind: str) -> Sequence[int]:
        """The members, which must be there."""
        given = self.nodes if kind == "NSET" else self.elements
        # Of more numbers than there are, one of the first so many is missing.
        missing = next((tag for tag in tags[: len(given) + 1] if tag not in given), None)
        if missing is not None:
            raise block.refused(f"has {missing % APART}, which the file does not have", name)
        return tags

    def put(self, block: Block, kind: str, name: str | None, tags: Sequence[int]) -> None:
        """Put members into a set, if it has a name."""
        if name is not None:
            sets = self.sets[kind, block.scope]
            sets.setdefault(_spelled(sets, name), []).extend(tags)

    def named(self, kind: str) -> dict[str, list[int]]:
        """The sets that a user has named, of the instances and of the assembly. Where several have one of a name, those of instances are
        named ``INSTANCE_NAME``."""
        named: dict[str, list[int]] = {}
        all_ = [(scope, name, tags) for (of, scope), sets in self.sets.items() if of == kind for name, tags in sets.items()]
        users = [(scope, name, tags) for scope, name, tags in all_ if (kind, scope, name.upper()) not in self.internal]
        for scope, name, tags in users:
            own = self.unique(scope, name, [other for _, other, _ in users])
            if set(named.setdefault(_spelled(named, own), tags)) != set(tags):
                text = "is a set of the part and another one of the assembly: give them different names"
                raise refused(self.path, f"*{kind} {name}", text)
        return named

    def unique(self, scope: int, name: str, names: list[str]) -> str:
        """The name of a set or surface; of an instance among several, with that of the instance, if there is another of this name."""
        others = sum(other.upper() == name.upper() for other in names) > 1
        return f"{self.instances[scope][0]}_{name}" if scope and len(self.instances) > 1 and others else name

    def found(self) -> Found:
        """All of it, counted from 0."""
        number = {tag: k for k, tag in enumerate(self.nodes)}
        found = Found(self.path, np.array(list(self.nodes.values()), dtype=float).reshape(-1, 3))
        cells: dict[int, int] = {}
        for tag, (kind, nodes) in self.elements.items():
            missing = [node for node in nodes if node not in number]
            if missing:
                raise refused(self.path, "", f"element {tag % APART} has node {missing[0] % APART}, which the file does not have")
            cells[tag] = found.add([number[node] for node in nodes], 1 if _is_line(kind) else 2)
        found.sets = {name: [cells[tag] for tag in tags] for name, tags in self.named("ELSET").items()}
        used = {node for _, nodes in self.elements.values() for node in nodes}
        for name, tags in self.named("NSET").items():
            # Reference points of an assembly belong to no element, and could not be held.
            held = [number[tag] for tag in tags if not (self.instances and tag in self.of_assembly and tag not in used)]
            if held or not tags:
                found.points[name] = held
            else:
                warnings.warn(f"{self.path}: *NSET {name}: is left out: its nodes belong to no element (reference points)", stacklevel=6)
        if len(self.instances) > 1:
            self.put_instances(found, cells)
        for (scope, own), block in self.surfaces.items():
            name = self.unique(scope, own, [other for _, other in self.surfaces])
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

    def put_instances(self, found: Found, cells: Mapping[int, int]) -> None:
        """Instances with plane cells are the bodies of an assembly of several."""
        for scope, (name, _) in self.instances.items():
            own = [cell for tag, cell in cells.items() if tag // APART == scope and found.dimensions[cell] == 2]
            if not own:
                continue
            if set(found.sets.setdefault(_spelled(found.sets, name), own)) != set(own):
                raise refused(self.path, f"*INSTANCE {name}", "has the name of a set with other elements: rename one")
            found.bodies.append(_spelled(found.sets, name))

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
                    text = f"element {tag % APART} is a shell or membrane ({kind}), whose sides programs number differently"
                    raise block.refused(f"{text}: write CPE, CPS or CAX, or give the nodes of the surface (TYPE=NODE)", name)
                if _is_line(kind) or side > corners:
                    raise block.refused(f"element {tag % APART} has no side {label} in the plane", name)
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
