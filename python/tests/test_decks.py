"""Decks of Abaqus and CalculiX: what changes a mesh and is not read is refused, and a model written as a deck is the model that is read."""

import pathlib
import random
from typing import Any

import fecontact as fc
import pytest

NODES = "*NODE\n1, 0, 0\n2, 1, 0\n3, 2, 0\n4, 0, 1\n5, 1, 1\n6, 2, 1\n"
ELEMENTS = "*ELEMENT, TYPE=CPE4, ELSET=A\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n"
PART = f"*PART, NAME=P\n{NODES}{ELEMENTS}*ELSET, ELSET=S\n1\n*END PART\n*ASSEMBLY, NAME=all\n*INSTANCE, NAME=I, PART=P\n*END INSTANCE\n"


@pytest.mark.parametrize(
    ("deck", "words"),
    [
        (NODES + ELEMENTS + "*ELGEN, ELSET=A\n1, 2, 1, 1\n", ["line 11: *ELGEN", "changes the mesh", "write the deck flat"]),
        (NODES + "*NGEN, NSET=B\n1, 3, 1\n" + ELEMENTS, ["*NGEN", "changes the mesh"]),
        (NODES + ELEMENTS + "*ELCOPY, ELEMENT SHIFT=2, OLD SET=A, SHIFT NODES=6\n", ["*ELCOPY", "changes the mesh"]),
        (NODES + "*N COPY, OLD SET=ALL, CHANGE NUMBER=10, SHIFT\n5, 0, 0\n" + ELEMENTS, ["*N COPY", "changes the mesh"]),
        (NODES + "*NFILL\na, b, 3\n" + ELEMENTS, ["*NFILL", "changes the mesh"]),
        (NODES + "*NMAP, NSET=ALL\n" + ELEMENTS, ["*NMAP", "changes the mesh"]),
        (NODES + "*IMPERFECTION, FILE=modes\n" + ELEMENTS, ["*IMPERFECTION", "changes the mesh"]),
        (NODES + ELEMENTS + "*SYMMETRIC MODEL GENERATION, REVOLVE\n", ["*SYMMETRIC MODEL GENERATION", "changes the mesh"]),
        ("*SYSTEM\n5, 5, 0\n" + NODES + ELEMENTS, ["line 1: *SYSTEM", "changes the mesh"]),
        (NODES.replace("*NODE", "*NODE, SYSTEM=C") + ELEMENTS, ["*NODE, SYSTEM=C", "a cylinder or a sphere"]),
        (NODES + ELEMENTS + "*MESHING MAGIC\n", ["*MESHING MAGIC", "is not known here"]),
        (NODES.replace("*NODE", "*NODE, INPUT=nodes.txt") + ELEMENTS, ["*NODE", "the option `INPUT=nodes.txt` is not read"]),
        (NODES + ELEMENTS + "*NSET, NSET=B, ELSET=A\n", ["*NSET", "the option `ELSET=A` is not read"]),
        (NODES + ELEMENTS + "*NSET, NSET=B, NSET=C\n1\n", ["the option NSET is given twice"]),
        (NODES + ELEMENTS.replace("=A", "="), ["the option ELSET is given without a value"]),
        (NODES + "*NODE\n2, 1, 0.3\n" + ELEMENTS, ["line 8: *NODE", "node 2 appears in the file twice", "(1.0, 0.3, 0.0)"]),
        (NODES + ELEMENTS + ELEMENTS, ["element 1 appears in the file twice"]),
        (NODES.replace("2, 1, 0", "2, nan, 0") + ELEMENTS, ["`nan` is not a finite number"]),
        (NODES.replace("2, 1, 0", "2, -INF, 0") + ELEMENTS, ["`-INF` is not a finite number"]),
        (NODES.replace("2, 1, 0", "2, 1_0, 0") + ELEMENTS, ["`1_0` is not a finite number"]),
        (NODES.replace("2, 1, 0", "2, 1, 0, 0, 3, 2, 0") + ELEMENTS, ["is not the number of a node and one to three coordinates"]),
        (NODES + ELEMENTS.replace("1, 1, 2, 5, 4", "-1, 1, 2, 5, 4"), ["`-1` is not a whole number"]),
        (NODES + ELEMENTS.replace("CPE4", "S4") + "*SURFACE, NAME=B\nA, S3\n", ["*SURFACE B", "shell or membrane (S4)"]),
        (NODES + ELEMENTS + "*SURFACE, NAME=B\nA, S5\n", ["*SURFACE B", "`A, S5` names no side S1 to S4"]),
        (NODES + ELEMENTS + "*SURFACE, NAME=B\nA\n", ["*SURFACE B", "`A` names no side S1 to S4"]),
        (NODES + ELEMENTS + "*SURFACE, NAME=B\nA, S1\n*SURFACE, NAME=b\nA, S3\n", ["*SURFACE b", "appears in the file twice"]),
        (NODES + ELEMENTS + "*SURFACE, NAME=B, TYPE=SEGMENTS\nSTART, 0, 0\n", ["the type SEGMENTS is not read"]),
        (NODES + ELEMENTS + "*NSET, NSET=B\n1\n*SURFACE, NAME=B, TYPE=NODE\n2\n", ["has other nodes than the node set of this name"]),
        (NODES + ELEMENTS + "*NSET, NSET=B, GENERATE\n1, 3000000000\n", ["*NSET B", "has 7, which the file does not have"]),
        (NODES + ELEMENTS + "*ELSET, ELSET=B, GENERATE\n1, 10000000\n", ["*ELSET B", "has 3, which the file does not have"]),
        (NODES + ELEMENTS + "*NSET, NSET=B, GENERATE\n1, 3, 0\n", ["`0` is not a whole number of 1 or more"]),
        (NODES + ELEMENTS + "*NSET, NSET=B, GENERATE\n3, 1, -1\n", ["`-1` is not a whole number of 1 or more"]),
        (NODES + ELEMENTS + "*NSET, NSET=B, GENERATE\n3, 1\n", ["the range from 3 to 1 is empty"]),
        (NODES + ELEMENTS + f"*NSET, NSET=B, GENERATE\n1, {'9' * 5000}\n", ["is not a whole number"]),
        (NODES + ELEMENTS + "*INCLUDE, INPUT=nowhere.inp\n", ["nowhere.inp", "no such mesh file"]),
        (NODES + ELEMENTS + "*INCLUDE, INPUT=deck.inp\n", ["deck.inp", "includes itself"]),
        (NODES + ELEMENTS + "*INCLUDE, INPUT=circle.inp\n", ["includes itself"]),
        ("1, 0, 0\n" + NODES + ELEMENTS, ["line 1: `1, 0, 0` stands before the first keyword"]),
        (PART + "*END ASSEMBLY\n" + PART, ["appears in the file twice: give the parts different names"]),
        (PART.replace("PART=P", "PART=P\n5., 0., 0., 1."), ["its lines are no translation (x, y, z) and rotation"]),
        (PART + "*NODE\n1, 7, 7\n*END ASSEMBLY\n", ["node 1 appears in the file twice"]),
        (PART + "*ELSET, ELSET=S, INSTANCE=I\n2\n*END ASSEMBLY\n", ["is a set of the part and another one of the assembly"]),
        (PART + "*NSET, NSET=N, INSTANCE=J\n2\n*END ASSEMBLY\n", ["there is no instance `J`"]),
        (PART + "*ELSET, ELSET=T\nJ.A\n*END ASSEMBLY\n", ["there is no set `J.A`"]),
    ],
)
def test_what_is_not_read_and_could_change_the_mesh_is_refused(tmp_path: pathlib.Path, deck: str, words: list[str]) -> None:
    (tmp_path / "deck.inp").write_text(deck)
    (tmp_path / "circle.inp").write_text("*INCLUDE, INPUT=deck.inp\n")
    with pytest.raises(fc.CaseError) as error:
        fc.Mesh.read(tmp_path / "deck.inp", bodies=["A"])
    assert all(word in str(error.value) for word in words), error.value


def test_numbers_names_and_lines_are_read_as_the_programs_write_them(tmp_path: pathlib.Path) -> None:
    (tmp_path / "more.txt").write_text("5, 1.d+0, 10.D-1\n6, 2, 1\n")
    (tmp_path / "deck.inp").write_text(
        "*HEADING\n2, 5, 7\n*Node,\nNSET=all\n1, 0.\n2, 1.D0\n3, .2E+1, , \n4, , 1\n*INCLUDE, INPUT=more.txt\n"
        + ELEMENTS.replace("=A", '="left, or right"')
        + '*SURFACE, NAME="upper, middle"\n"left, or right", S3\n*NSET, NSET=a.b, UNSORTED\n6, 1\n*NSET, NSET=c\na.b, 2\n'
        "*EQUATION\n2\n1, 1, 1, 3, 1, -1\n*TRANSFORM, NSET=c\n0, 1, 0, 1, 0, 0\n*CONTACT PAIR, INTERACTION=i\na, b\n"
        '*NODE\n2, 1, 0\n*MATERIAL, NAME=5" pipe\n*STEP\n*STATIC\n1, 1\n*NODE PRINT, NSET=c\nU\n*ENDSTEP\n'
    )
    document = fc.Mesh.read(tmp_path / "deck.inp").document()
    assert document["nodes"] == [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
    assert document["elements"] == {"left, or right": [[0, 1, 4, 3], [1, 2, 5, 4]]}
    assert sorted(map(sorted, document["edges"]["upper, middle"])) == [[3, 4], [4, 5]]
    assert document["points"] == {"all": [0, 1, 2, 3, 4, 5], "a.b": [0, 5], "c": [0, 1, 5]}


def test_a_deck_of_abaqus_cae_is_read(tmp_path: pathlib.Path) -> None:
    """As it writes one part and one instance: internal sets of part and assembly have the same names, and mean others."""
    (tmp_path / "deck.inp").write_text(
        "*Heading\n** Job name: press Model name: Model-1\n*Preprint, echo=NO, model=NO, history=NO, contact=NO\n**\n** PARTS\n**\n"
        f"*Part, name=Part-1\n{NODES}*Element, type=CPS4R\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n"
        "*Nset, nset=_PickedSet2, internal, generate\n 1,  6,  1\n*Elset, elset=_PickedSet2, internal, generate\n 1,  2,  1\n"
        "*Elset, elset=Block, generate\n 1,  2,  1\n** Section: Section-1\n*Solid Section, elset=_PickedSet2, material=Steel\n,\n*End Part\n"
        "**\n*Assembly, name=Assembly\n**\n*Instance, name=Part-1-1, part=Part-1\n*End Instance\n**\n"
        "*Nset, nset=_PickedSet2, internal, instance=Part-1-1\n 3,\n*Nset, nset=Corner, instance=Part-1-1\n 6,\n*Nset, nset=both\n"
        "_PickedSet2, Corner\n*Elset, elset=_Top_S3, internal, instance=Part-1-1, generate\n 1,  2,  1\n"
        "*Surface, type=ELEMENT, name=Top\n_Top_S3, S3\n*Surface, type=NODE, name=all\nPart-1-1._PickedSet2\n"
        "*End Assembly\n*Material, name=Steel\n*Elastic\n210000., 0.3\n*Step, name=Step-1, nlgeom=YES\n*Static\n1., 1., 1e-05, 1.\n"
        "*Boundary\nCorner, ENCASTRE\n*Restart, write, frequency=0\n*Output, field, variable=PRESELECT\n*End Step\n"
    )
    document = fc.Mesh.read(tmp_path / "deck.inp").document()
    assert document["elements"] == {"Block": [[0, 1, 4, 3], [1, 2, 5, 4]]}
    assert sorted(map(sorted, document["edges"]["Top"])) == [[3, 4], [4, 5]]
    assert document["points"] == {"Corner": [5], "both": [2, 5], "all": [0, 1, 2, 3, 4, 5]}


def model(dice: random.Random) -> dict[str, Any]:
    """Two bodies of triangles and quadrilaterals of order 1 or 2, with edges and points by name."""
    order, columns, rows = dice.choice([1, 2]), dice.randint(1, 4), dice.randint(1, 3)
    nodes: list[list[float]] = []
    number: dict[tuple[str, int, int], int] = {}

    def node(body: str, i: int, j: int) -> int:
        """The node at a place of a body's grid, two steps an element."""
        if (body, i, j) not in number:
            shake = (dice.uniform(-0.1, 0.1), dice.uniform(-0.1, 0.1))
            number[body, i, j] = len(nodes)
            nodes.append([i / 2 + shake[0], j / 2 + shake[1] + (7 if body == "upper" else 0)])
        return number[body, i, j]

    bodies: dict[str, list[list[int]]] = {"lower": [], "upper": []}
    for body, cells in bodies.items():
        for i, j in ((i, j) for i in range(0, 2 * columns, 2) for j in range(0, 2 * rows, 2)):
            corners = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)]
            shapes = [corners] if dice.random() < 0.6 else [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
            for shape in shapes:
                middles = [((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in zip(shape, [*shape[1:], shape[0]], strict=True)]
                cells.append([node(body, *place) for place in shape + (middles if order == 2 else [])])
    edges = {}
    for name, cells in zip(("low", "high"), bodies.values(), strict=True):
        every = [(cell, k) for cell in cells for k in range(corners_of(cell))]
        shared = [end_nodes(*side) for side in every]
        edges[name] = dice.sample([side for side in every if shared.count(end_nodes(*side)) == 1], dice.randint(1, 3))
    points = {name: sorted(dice.sample(range(len(nodes)), dice.randint(1, 4))) for name in ("tip", "gauge")}
    return {"nodes": nodes, "elements": bodies, "edges": edges, "points": points}


def corners_of(cell: list[int]) -> int:
    return 3 if len(cell) in (3, 6) else 4


def end_nodes(cell: list[int], k: int) -> frozenset[int]:
    return frozenset((cell[k], cell[(k + 1) % corners_of(cell)]))


def sides(edges: dict[str, Any]) -> dict[str, list[list[int]]]:
    """Edges by their nodes: end, end, middle."""
    told: dict[str, list[list[int]]] = {}
    for name, members in edges.items():
        for cell, k in members:
            corners = corners_of(cell)
            middle = [cell[corners + k]] if len(cell) > corners else []
            told.setdefault(name, []).append([cell[k], cell[(k + 1) % corners], *middle])
    return told


def written(dice: random.Random, given: dict[str, Any], folder: pathlib.Path) -> None:
    """The model as a deck, with numbers of its own, in one of the ways to write it."""
    count = len(given["nodes"])
    tags = dice.sample(range(1, 3 * count), count)
    if dice.random() < 0.5:
        tags = list(range(1, count + 1))
    exponent = dice.choice(["e", "E", "D", "d"])
    spell = dice.choice([str.upper, str.lower, str.capitalize])

    def real(value: float) -> str:
        return f"{value:.17e}".replace("e", exponent)

    def rows(values: list[Any], width: int) -> list[str]:
        return [", ".join(map(str, values[k : k + width])) + dice.choice(["", ","]) for k in range(0, len(values), width)]

    lines = [f"{tags[k]}, {real(x)}, {real(y)}{dice.choice(['', ',', ', 0.'])}" for k, (x, y) in enumerate(given["nodes"])]
    nodes = [f"*{spell('node')}, {spell('nset')}=all", *lines]
    if dice.random() < 0.5:
        (folder / "nodes.inp").write_text("\n".join(nodes) + "\n")
        nodes = ["*INCLUDE, INPUT=nodes.inp"]
    elements, sets = [], []
    number: dict[tuple[int, ...], int] = {}
    for body, cells in given["elements"].items():
        own = dice.sample(cells, len(cells))
        for cell in own:
            number[tuple(cell)] = 5 * len(number) + 2
        named = dice.random() < 0.5
        for width in sorted({len(cell) for cell in own}):
            elements.append(f"*ELEMENT, TYPE={dice.choice(['CPE', 'CPS', 'CAX'])}{width}" + (f",\nELSET={body}" if named else ""))
            for cell in own:
                if len(cell) == width:
                    split = dice.randint(2, width)
                    listed = [number[tuple(cell)], *(tags[node] for node in cell)]
                    elements += [", ".join(map(str, listed[:split])) + ",", ", ".join(map(str, listed[split:]))]
        if not named:
            first, last = min(number[tuple(cell)] for cell in own), max(number[tuple(cell)] for cell in own)
            way = [f"*ELSET, ELSET={body}, GENERATE", f"{first}, {last}, 5"]
            sets += dice.choice([way, [f"*ELSET, ELSET={body}", *rows([number[tuple(cell)] for cell in own], 16)]])
    for name, members in given["points"].items():
        sets += [f"*NSET, NSET={name}, UNSORTED", *rows([tags[node] for node in dice.sample(members, len(members))], 3)]
    for name, members in given["edges"].items():
        sets.append(f"** edges\n*SURFACE, NAME={name}, TYPE=ELEMENT")
        for cell, k in members:
            if dice.random() < 0.5:
                sets.append(f"{number[tuple(cell)]}, S{k + 1}")
            else:
                own_set = f"_{name}_{number[tuple(cell)]}_{k}"
                sets.insert(0, f"*ELSET, ELSET={own_set}, INTERNAL\n{number[tuple(cell)]}")
                sets.append(f"{own_set.upper()}, s{k + 1}")
    mesh = [*nodes, *elements, *sets]
    if dice.random() < 0.3:
        assembly = ["*ASSEMBLY, NAME=b", "*INSTANCE, NAME=c, PART=a", "*END INSTANCE", "*END ASSEMBLY"]
        mesh = ["*PART, NAME=a", *nodes, *elements, *sets, "*END PART", *assembly]
    physics = ["*MATERIAL, NAME=steel", "*ELASTIC", "1000, 0.3", "*STEP", "*STATIC", "1, 1", "*END STEP"]
    (folder / "deck.inp").write_text("\n".join(["*HEADING", "a model", *mesh, *physics]) + "\n")


@pytest.mark.parametrize("seed", range(40))
def test_a_model_written_as_a_deck_is_the_model_that_is_read(tmp_path: pathlib.Path, seed: int) -> None:
    dice = random.Random(seed)
    given = model(dice)
    written(dice, given, tmp_path)
    read = fc.Mesh.read(tmp_path / "deck.inp")
    document = read.document()
    assert document["nodes"] == given["nodes"]
    assert {name: sorted(cells) for name, cells in document["elements"].items()} == {
        name: sorted(cells) for name, cells in given["elements"].items()
    }
    # An edge is given from either end, and where it is given twice it is there once.
    told = {name: {(frozenset(edge[:2]), *edge[2:]) for edge in edges} for name, edges in document["edges"].items()}
    assert told == {name: {(frozenset(edge[:2]), *edge[2:]) for edge in edges} for name, edges in sides(given["edges"]).items()}
    every = {"all": list(range(len(given["nodes"])))}
    assert document["points"] == {**given["points"], **every}
