"""Meshes of other programs: each file is the same two squares, written here by hand or by meshio, and gives the same mesh."""

import pathlib
import pickle
from typing import Any

import fecontact as fc
import numpy as np
import pytest

#: The squares [0, 1]² and [1, 2] × [0, 1], which share no nodes; the right one of two triangles.
NODES = [[0, 0], [1, 0], [1, 1], [0, 1], [1, 0], [2, 0], [2, 1], [1, 1]]
SQUARES: dict[str, Any] = {
    "elements": {"left": [[0, 1, 2, 3]], "right": [[4, 5, 6], [4, 6, 7]]},
    "edges": {"joint": [[1, 2]], "top": [[2, 3], [6, 7]]},
    "points": {"corners": [0, 5]},
}


def expected(**change: Any) -> dict[str, Any]:
    return fc.Mesh(NODES, **{**SQUARES, **change}).document()


DECK = """** two squares
*HEADING
Squares, CPE4
*NODE, NSET=Nall
1, 0., 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1., 0.
11, 1., 0.
12, 2., 0.
13, 2., 1.
14, 1., 1.
*Element, type=CPE4R, elset=left
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPE3, ELSET=Right
2, 11, 12,
13
3, 11, 13, 14
*NSET, NSET=corners
1, 12
*ELSET, ELSET=_top_S3, INTERNAL
1
*SURFACE, NAME=joint
LEFT, S2
*SURFACE, NAME=top, TYPE=ELEMENT
_top_S3, S3
3, S2
*MATERIAL, NAME=steel
*ELASTIC
1000, 0.3
"""


def test_a_deck_of_abaqus_or_calculix_keeps_its_sets(tmp_path: pathlib.Path) -> None:
    (tmp_path / "squares.inp").write_text(DECK)
    mesh = fc.Mesh.read(tmp_path / "squares.inp")
    document = mesh.document()
    assert document["points"].pop("Nall") == list(range(8))
    document["elements"]["right"] = document["elements"].pop("Right")
    assert document == expected()
    assert pickle.loads(pickle.dumps(mesh)).document() == mesh.document()
    with pytest.raises(fc.CaseError, match="no set `middle` of plane cells; the sets are `left`"):
        fc.Mesh.read(tmp_path / "squares.inp", bodies=["middle"])
    # Parts of the deck in files of their own, ranges, quadratic elements, sets of sets, and sets of lines.
    (tmp_path / "nodes.inp").write_text("*NODE\n" + "\n".join(f"{k + 1}, {x}, {y}" for k, (x, y) in enumerate(QUADRATIC)))
    (tmp_path / "other.inp").write_text(
        "*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=CPS8R, ELSET=A\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
        "*ELEMENT, TYPE=T3D3, ELSET=side\n7, 1, 5, 2\n*ELSET, ELSET=all, GENERATE\n1, 1\n"
        "*NSET, NSET=low, GENERATE\n1, 5, 4\n*NSET, NSET=lower\nlow, 2\n*NSET, NSET=side\n1, 2, 5\n*NSET, NSET=A\n1, 2\n"
    )
    other = fc.Mesh.read(tmp_path / "other.inp", bodies=["A"])
    assert other.elements == [[0, 1, 2, 3, 4, 5, 6, 7]]
    # The set of nodes is that of the edges of the same name; that of the body has other nodes.
    assert other.document()["edges"] == {"side": [[0, 1, 4]]}
    assert other.document()["points"] == {"low": [0, 4], "lower": [0, 1, 4], "A_nodes": [0, 1]}


QUADRATIC = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]]


@pytest.mark.parametrize(
    ("piece", "replacement", "words"),
    [
        ("type=CPE4R", "type=C3D8R", ["TYPE=C3D8R", "neither a plane element"]),
        ("type=CPE4R", "type=CPE8R", ["a number and 8 nodes"]),
        ("1, 1, 2, 3, 4\n", "1, 1, 2, 3, 40\n", ["element 1 has node 40"]),
        ("2, 1., 0.\n", "2, one, 0.\n", ["*NODE", "cannot be understood"]),
        ("2, 1., 0.\n", "2, 1., 0., 0.5\n", ["must share one z"]),
        ("LEFT, S2", "LEFT, SPOS", ["*SURFACE joint", "`LEFT, SPOS` names no side S1 to S4"]),
        ("3, S2", "3, S4", ["element 3 has no side S4"]),
        ("LEFT, S2", "middle, S2", ["there is no set `middle`"]),
        ("*NSET, NSET=corners\n1, 12", "*NSET, NSET=corners\n1, 99", ["corners", "has 99"]),
        ("*ELEMENT, TYPE=CPE3, ELSET=Right", "*ELEMENT, TYPE=CPE3", ["2 plane cells are in none", "`left`"]),
        ("*MATERIAL", "*ELSET, ELSET=all\n1, 2, 3\n*MATERIAL", ["in the sets `left` and `all`", "name the sets that are bodies"]),
        ("*MATERIAL", "*PART, NAME=A\n*PART, NAME=B\n*MATERIAL", ["stands within *PART, which does not end before it"]),
        ("*MATERIAL", "*INCLUDE, INPUT=nowhere.inp\n*MATERIAL", ["nowhere.inp", "no such mesh file"]),
        ("3, 11, 13, 14", "1, 11, 13, 14", ["element 1 appears in the file twice"]),
    ],
)
def test_what_a_deck_cannot_mean_is_told(tmp_path: pathlib.Path, piece: str, replacement: str, words: list[str]) -> None:
    assert piece in DECK
    (tmp_path / "bad.inp").write_text(DECK.replace(piece, replacement))
    with pytest.raises(fc.CaseError) as error:
        fc.Mesh.read(tmp_path / "bad.inp")
    assert all(word in str(error.value) for word in ["bad.inp" if "nowhere" not in words[0] else "", *words]), error.value


def test_an_exodus_file_keeps_blocks_side_sets_and_node_sets(tmp_path: pathlib.Path) -> None:
    netcdf = pytest.importorskip("netCDF4")
    file = tmp_path / "squares.e"
    for shell in (False, True):
        with netcdf.Dataset(file, "w", format="NETCDF3_CLASSIC") as data:
            sizes = {"num_dim": 3 if shell else 2, "num_nodes": 8, "num_el_blk": 2, "num_side_sets": 2, "num_node_sets": 1, "len": 33}
            sizes |= {"b1": 1, "b2": 2, "n4": 4, "n3": 3, "s1": 1, "s2": 2, "m": 2}
            for name, size in sizes.items():
                data.createDimension(name, size)
            for k, axis in enumerate("xyz"[: sizes["num_dim"]]):
                data.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = (np.array(NODES)[:, k] if k < 2 else np.full(8, 0.25))
            names = {"eb_names": ["left", ""], "ns_names": ["corners"], "ss_names": ["joint", "top"]}
            counts = {"eb_names": "num_el_blk", "ns_names": "num_node_sets", "ss_names": "num_side_sets"}
            for name, texts in names.items():
                stored = data.createVariable(name, "S1", (counts[name], "len"))
                stored[:] = np.array([list(text.ljust(33, "\0")) for text in texts], dtype="S1")
            data.createVariable("eb_prop1", "i4", ("num_el_blk",))[:] = [10, 20]
            for k, (of, size, kind) in enumerate([("left", "n4", "QUAD4"), ("right", "n3", "TRI3")], 1):
                cells = data.createVariable(f"connect{k}", "i4", (f"b{k}", size))
                cells.elem_type = ("SHELL4" if k == 1 else kind) if shell else kind
                cells[:] = np.array(SQUARES["elements"][of]) + 1
            data.createVariable("node_ns1", "i4", ("m",))[:] = [1, 6]
            # The edges of shells and of triangles in space come behind their two faces.
            faces = 2 if shell else 0
            for k, (elements, sides) in enumerate([([1], [2]), ([1, 3], [3, 2])], 1):
                data.createVariable(f"elem_ss{k}", "i4", (f"s{k}",))[:] = elements
                data.createVariable(f"side_ss{k}", "i4", (f"s{k}",))[:] = np.array(sides) + faces
        document = fc.Mesh.read(file).document()
        document["elements"]["right"] = document["elements"].pop("block_20")
        assert document == expected(), shell
    with netcdf.Dataset(file, "a") as data:
        data["side_ss1"][:] = 1
    with pytest.raises(fc.CaseError, match="joint: side 1 of element 1 is not an edge in the plane"):
        fc.Mesh.read(file)
    # An element that is not there, and no file of this kind.
    with netcdf.Dataset(file, "a") as data:
        data["elem_ss1"][:] = 0
    with pytest.raises(fc.CaseError, match="joint: has the element 0, which the file does not have"):
        fc.Mesh.read(file)
    file.write_text("no mesh")
    with pytest.raises(fc.CaseError, match="is not a complete Exodus file"):
        fc.Mesh.read(file)


def meshio_squares(meshio: Any, **more: Any) -> Any:
    cells = [("quad", [[0, 1, 2, 3]]), ("triangle", [[4, 5, 6], [4, 6, 7]]), ("line", [[2, 1], [2, 3], [6, 7]])]
    return meshio.Mesh(np.array(NODES, dtype=float), cells, **more)


def test_a_med_file_keeps_its_groups(tmp_path: pathlib.Path) -> None:
    meshio = pytest.importorskip("meshio")
    pytest.importorskip("h5py")
    mesh = meshio_squares(meshio)
    mesh.cells.append(meshio.CellBlock("vertex", [[3], [6]]))
    mesh.cell_data["cell_tags"] = [np.array([-1]), np.array([-2, -2]), np.array([-3, -4, -4]), np.array([-5, -5])]
    mesh.cell_tags = {-1: ["left"], -2: ["right"], -3: ["joint"], -4: ["top"], -5: ["vertices"]}
    mesh.point_data["point_tags"] = np.array([1, 0, 0, 0, 0, 1, 0, 0])
    mesh.point_tags = {1: ["corners"]}
    meshio.write(tmp_path / "squares.med", mesh)
    points = {**SQUARES["points"], "vertices": [3, 6]}
    assert fc.Mesh.read(tmp_path / "squares.med").document() == expected(points=points)


def test_bodies_are_the_values_of_an_array_of_the_cells(tmp_path: pathlib.Path) -> None:
    meshio = pytest.importorskip("meshio")
    materials = [np.array([1]), np.array([2, 2]), np.array([3, 4, 4])]
    three = meshio_squares(meshio, cell_data={"material": materials})
    three.points = np.column_stack([three.points, np.full(8, 2.0)])
    file = tmp_path / "squares.vtu"
    meshio.write(file, three)
    renamed = {"material_1": "left", "material_2": "right", "material_3": "joint", "material_4": "top"}
    document = fc.Mesh.read(file).document()
    for kind in ("elements", "edges"):
        document[kind] = {renamed[name]: members for name, members in document[kind].items()}
    assert document == expected(points={})
    one = [np.zeros(len(values), dtype=int) for values in materials]
    meshio.write(file, meshio_squares(meshio, cell_data={"material": materials, "part": one, "heat": [values * 0.5 for values in materials]}))
    with pytest.raises(fc.CaseError, match="name the array of the cells whose values are the bodies; there are `material`, `part`"):
        fc.Mesh.read(file)
    assert set(fc.Mesh.read(file, bodies="material").groups) == set(renamed)
    with pytest.raises(fc.CaseError, match="name the array"):
        fc.Mesh.read(file, bodies="heat")
    bare = meshio_squares(meshio)
    meshio.write(file, bare)
    assert fc.Mesh.read(file).groups == {"body": "elements"}


def vtu(cells: dict[str, str], kind: str = "Int32", material: str = "1 2 2") -> str:
    """A file of text: a quadrilateral and two triangles, with an array of the cells."""
    given = {"connectivity": "0 1 2 3 4 5 6 4 6 7", "offsets": "4 7 10", "types": "9 5 5", **cells}
    points = " ".join(f"{x} {y} 0" for x, y in NODES)
    kinds = {name: "Float64" if "." in values else "Int32" for name, values in given.items()}
    arrays = "".join(f'<DataArray type="{kinds[name]}" Name="{name}" format="ascii">{values}</DataArray>' for name, values in given.items())
    return (
        '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="3"><Points>'
        f'<DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points><Cells>{arrays}</Cells><CellData>'
        f'<DataArray type="{kind}" Name="material" format="ascii">{material}</DataArray></CellData></Piece></UnstructuredGrid></VTKFile>'
    )


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (vtu({"connectivity": "0 1 2 3.5 4 5 6 4 6 7"}), "cells of the type `quad` whose nodes are not whole numbers"),
        (vtu({"connectivity": "0 1 2 3 4 5 6 4 6 70"}), "a cell has the node 71, and the file has 8 nodes"),
        (vtu({"connectivity": "0 1 2 -1 4 5 6 4 6 7"}), "a cell has the node 0, and the file has 8 nodes"),
        (vtu({"types": "6 5 5"}), "has 3 cells, of which 2 can be read"),
        (vtu({"types": "7 5 5", "connectivity": "0 1 4 2 3 4 5 6 4 6 7", "offsets": "5 8 11"}), "cells of the type `polygon`, which are not read"),
        (vtu({}, material="1 2 2 7"), "the array `material` of the cells has 4 values for 3 cells"),
        (vtu({}, material="1 2"), "cannot be read by meshio"),
    ],
)
def test_cells_and_arrays_that_do_not_fit_are_refused(tmp_path: pathlib.Path, content: str, words: str) -> None:
    pytest.importorskip("meshio")
    (tmp_path / "bad.vtu").write_text(content)
    with pytest.raises(fc.CaseError) as error:
        fc.Mesh.read(tmp_path / "bad.vtu")
    assert words in str(error.value), error.value


def test_bodies_are_whole_numbers_in_whatever_type_they_are_stored(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("meshio")
    file = tmp_path / "squares.vtu"
    file.write_text(vtu({}, "Float64", "1.0 2.0 2.0"))
    assert set(fc.Mesh.read(file).groups) == {"material_1", "material_2"} == set(fc.Mesh.read(file, bodies="material").groups)
    # A constant tells no bodies, unless it is asked for.
    file.write_text(vtu({}, "Float64", "20.0 20.0 20.0"))
    assert set(fc.Mesh.read(file).groups) == {"body"}
    assert set(fc.Mesh.read(file, bodies="material").groups) == {"material_20"}
    for values in ("1.5 2.0 2.0", "1.0 nan 2.0"):
        file.write_text(vtu({}, "Float64", values))
        assert set(fc.Mesh.read(file).groups) == {"body"}
        with pytest.raises(fc.CaseError, match="the array `material` does not have one whole number per cell"):
            fc.Mesh.read(file, bodies="material")
    # Sets that are named are those that are bodies.
    file.write_text(vtu({}))
    with pytest.raises(fc.CaseError, match="1 plane cells are in none of the sets that are named"):
        fc.Mesh.read(file, bodies=["material_2"])


def test_meshes_that_are_not_plane_are_refused(tmp_path: pathlib.Path) -> None:
    meshio = pytest.importorskip("meshio")
    file = tmp_path / "bad.vtu"
    tetra = meshio.Mesh(np.vstack([np.zeros(3), np.eye(3)]), [("tetra", [[0, 1, 2, 3]])])
    meshio.write(file, tetra)
    with pytest.raises(fc.CaseError, match="solid cell of 4 nodes: only plane meshes are read"):
        fc.Mesh.read(file)
    meshio.write(file, meshio.Mesh(tetra.points, [("triangle", [[1, 2, 3]])]))
    with pytest.raises(fc.CaseError, match="must share one z"):
        fc.Mesh.read(file)
    file.write_text("no mesh")
    with pytest.raises(fc.CaseError, match="cannot be read by meshio"):
        fc.Mesh.read(file)
    with pytest.raises(fc.CaseError, match="no such mesh file"):
        fc.Mesh.read(tmp_path / "nowhere.med")


#: As Abaqus/CAE writes an assembly of two parts, one of which is placed twice; CPE4R and CPE8R, sets of the parts and of the assembly.
ASSEMBLY = """*Heading
** Job name: Press Model name: Model-1
** Generated by: Abaqus/CAE 2023
*Preprint, echo=NO, model=NO, history=NO, contact=NO
**
** PARTS
**
*Part, name=Block
*Node
      1,           0.,           0.
      2,           1.,           0.
      3,           1.,           1.
      4,           0.,           1.
*Element, type=CPE4R
1, 1, 2, 3, 4
*Nset, nset=Set-1, generate
 1,  4,  1
*Elset, elset=Set-1
 1,
** Section: rubber
*Solid Section, elset=Set-1, material=Rubber
,
*End Part
**
*Part, name=Plate
*Node
      1,           0.,           0.
      2,           4.,           0.
      3,           4.,           2.
      4,           0.,           2.
      5,           2.,           0.
      6,           4.,           1.
      7,           2.,           2.
      8,           0.,           1.
*Element, type=CPE8R
1, 1, 2, 3, 4, 5, 6, 7, 8
*Elset, elset=Set-1
 1,
*Solid Section, elset=Set-1, material=Steel
,
*End Part
**
** ASSEMBLY
**
*Assembly, name=Assembly
**
*Instance, name=Block-1, part=Block
          1.,           2.,           0.
*End Instance
**
*Instance, name=Block-2, part=Block
          4.,           2.,           0.
          4.,           2.,           0.,           4.,           2.,           1.,          90.
*End Instance
**
*Instance, name=Plate-1, part=Plate
*End Instance
**
*Node
      1,          1.5,           4.,           0.
*Nset, nset=Reference
 1,
*Nset, nset=Fixed, instance=Plate-1
 1, 2, 5
*Nset, nset=Corners, instance=Block-1
 3,
*Nset, nset=Corners, instance=Block-2
 3,
*Elset, elset=_Under_S1, internal, instance=Block-1
 1,
*Surface, type=ELEMENT, name=Under
_Under_S1, S1
*Elset, elset=_Table_S3, internal, instance=Plate-1
 1,
*Surface, type=ELEMENT, name=Table
_Table_S3, S3
*End Assembly
**
*Material, name=Rubber
*Elastic
10., 0.3
*Step, name=Press, nlgeom=YES
*Static
0.1, 1.
*Boundary
Fixed, 1, 2
*End Step
"""


def test_the_instances_of_an_assembly_are_bodies_where_they_are_placed(tmp_path: pathlib.Path) -> None:
    (tmp_path / "press.inp").write_text(ASSEMBLY)
    with pytest.warns(UserWarning, match="Reference: is left out: its nodes belong to no element"):
        mesh = fc.Mesh.read(tmp_path / "press.inp")
    assert {name: kind for name, kind in mesh.groups.items() if kind == "elements"} == {"Block-1": "elements", "Block-2": "elements", "Plate-1": "elements"}
    document = mesh.document()
    at = lambda nodes: [tuple(float(x) for x in np.round(document["nodes"][node], 12)) for node in nodes]
    [cell] = document["elements"]["Block-1"]
    assert at(cell) == [(1, 2), (2, 2), (2, 3), (1, 3)]
    # Moved, then turned by 90 degrees about (4, 2): the edge that was below is at the right.
    [cell] = document["elements"]["Block-2"]
    assert sorted(at(cell)) == [(3, 2), (3, 3), (4, 2), (4, 3)]
    [cell] = document["elements"]["Plate-1"]
    assert len(cell) == 8 and at(cell)[:3] == [(0, 0), (4, 0), (4, 2)]
    assert [at(edge) for edge in document["edges"]["Under"]] == [[(1, 2), (2, 2)]]
    assert [at(edge) for edge in document["edges"]["Table"]] == [[(4, 2), (0, 2), (2, 2)]]
    assert sorted(at(document["points"]["Fixed"])) == [(0, 0), (2, 0), (4, 0)]
    assert sorted(at(document["points"]["Corners"])) == [(2, 3), (3, 3)]
    # A case runs on it.
    rubber = {"material": {"model": "linear", "E": 10.0, "nu": 0.3}}
    case = fc.Case(
        mesh=mesh,
        bodies={"Block-1": rubber, "Block-2": rubber, "Plate-1": rubber},
        contacts={"base": {"slave": "Under", "master": "Table", "friction": {"law": "coulomb", "mu": 0.3}}},
        steps=[{"name": "hold", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": name, "ux": 0, "uy": 0} for name in ("Block-1", "Block-2", "Fixed")]}],
    )
    assert "Plate-1" in case.check()
    for piece, replacement, words in [
        ("*End Part\n**\n*Part, name=Plate", "*Part, name=Plate", "*PART: stands within *PART, which does not end before it"),
        ("part=Plate", "part=Plates", "there is no part `Plates` before it is used; the parts are `Block`, `Plate`"),
        ("instance=Plate-1\n 1, 2, 5", "instance=Plate-2\n 1, 2, 5", "there is no instance `Plate-2`"),
        ("instance=Plate-1\n 1, 2, 5", "instance=Plate-1\n 1, 2, 9", "has 9, which the file does not have"),
        ("name=Block-2", "name=Block-1", "*INSTANCE Block-1: appears in the file twice"),
        ("           2.,           1.,          90.", "           2.,           0.,          90.", "its axis of rotation has no direction"),
    ]:
        assert piece in ASSEMBLY, piece
        (tmp_path / "bad.inp").write_text(ASSEMBLY.replace(piece, replacement))
        with pytest.raises(fc.CaseError) as error:
            fc.Mesh.read(tmp_path / "bad.inp")
        assert words in str(error.value), error.value


@pytest.mark.parametrize("kind", ["T3D2", "T3D3", "B31"])
def test_lines_of_quadratic_decks_are_their_sides(tmp_path: pathlib.Path, kind: str) -> None:
    """As gmsh and Salome write decks: line elements beside CPS8 and CPE6, with the middle node behind the ends or between them, or without it."""
    lines = {"T3D2": "1, 2\n11, 2, 3", "T3D3": "1, 2, 5\n11, 2, 6, 3", "B31": "1, 2\n11, 2, 3"}[kind]
    nodes = "\n".join(f"{k + 1}, {x}, {y}, 0" for k, (x, y) in enumerate([*QUADRATIC, [4, 0], [3, 0], [3, 1]]))
    (tmp_path / "q8.inp").write_text(
        f"*Heading\n q8.inp\n*NODE\n{nodes}\n*ELEMENT, type={kind}, ELSET=Line1\n10, {lines}\n"
        "*ELEMENT, type=CPS8, ELSET=Surface1\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, type=CPS6, ELSET=Surface2\n2, 2, 9, 3, 10, 11, 6\n"
        "*ELSET,ELSET=low\n10\n*ELSET,ELSET=body\n1, 2\n"
    )
    with pytest.warns(UserWarning, match="Line1: 1 of its 2 lines lie inside a body"):
        mesh = fc.Mesh.read(tmp_path / "q8.inp", bodies=["body"])
    edges = mesh.document()["edges"]
    assert edges == {"Line1": [[0, 1, 4]], "low": [[0, 1, 4]]}


def test_lines_inside_the_bodies_of_a_med_file_are_nodes(tmp_path: pathlib.Path) -> None:
    """As Salome exports a partition: groups of edges between and inside bodies that share nodes."""
    meshio = pytest.importorskip("meshio")
    pytest.importorskip("h5py")
    nodes = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]], dtype=float)
    cells = [("quad", [[0, 1, 4, 3], [1, 2, 5, 4]]), ("line", [[1, 4], [0, 1], [1, 2]])]
    mesh = meshio.Mesh(nodes, cells)
    mesh.cell_data["cell_tags"] = [np.array([-1, -2]), np.array([-3, -4, -4])]
    mesh.cell_tags = {-1: ["soil"], -2: ["soil"], -3: ["crack"], -4: ["bottom"]}
    meshio.write(tmp_path / "soil.med", mesh)
    with pytest.warns(UserWarning, match="crack: its 1 lines lie inside a body.*it is a group of nodes"):
        document = fc.Mesh.read(tmp_path / "soil.med").document()
    assert document["points"] == {"crack": [1, 4]} and document["edges"] == {"bottom": [[0, 1], [1, 2]]}


@pytest.mark.parametrize("form", ["XML", "HDF"])
def test_an_xdmf_file_has_bodies_by_an_array(tmp_path: pathlib.Path, form: str) -> None:
    """As meshes for FEniCS are written: triangles with the number of their body."""
    meshio = pytest.importorskip("meshio")
    pytest.importorskip("h5py")
    mesh = meshio.Mesh(np.array(NODES, dtype=float), [("triangle", [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])], cell_data={"name_to_read": [np.array([1, 1, 2, 2])]})
    meshio.write(tmp_path / "mesh.xdmf", mesh, data_format=form)
    document = fc.Mesh.read(tmp_path / "mesh.xdmf").document()
    assert document["elements"] == {"name_to_read_1": [[0, 1, 2], [0, 2, 3]], "name_to_read_2": [[4, 5, 6], [4, 6, 7]]}


def test_what_a_format_needs_is_named(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("meshio")
    monkeypatch.setitem(__import__("sys").modules, "h5py", None)
    (tmp_path / "a.med").touch()
    with pytest.raises(ImportError, match=r"a.med: reading it needs h5py: pip install 'fecontact\[meshio\]', or pip install h5py"):
        fc.Mesh.read(tmp_path / "a.med")


def test_a_missing_package_is_named(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "meshio", None)
    (tmp_path / "a.med").touch()
    with pytest.raises(ImportError, match=r"needs meshio: pip install 'fecontact\[meshio\]'"):
        fc.Mesh.read(tmp_path / "a.med")


def test_joined_meshes_are_one() -> None:
    left, right = [fc.Mesh(NODES, {name: SQUARES["elements"][name]}) for name in ("left", "right")]
    both = fc.Mesh.join([left, right])
    assert both.groups == {"left": "elements", "right": "elements"}
    assert both.elements == [[0, 1, 2, 3], [4, 5, 6], [4, 6, 7]]
    assert pickle.loads(pickle.dumps(both)).document() == both.document()
    with pytest.raises(fc.CaseError, match="the group `left` is in mesh 1 and in mesh 2"):
        fc.Mesh.join([left, left])


def test_blocks_of_two_bodies_share_nodes_where_they_are_joined() -> None:
    square = {"elements": [2, 2], "body": "a", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "points": {"tip": [1, 1]}}
    blocks = [square, {**square, "body": "b", "corners": [[1, 0], [2, 0], [2, 1], [1, 1]], "points": {"tip": [2, 1]}}]
    assert len(fc.Mesh.from_blocks(blocks).nodes) == 18
    with pytest.raises(TypeError, match="no argument `apart`: it is called `separated`"):
        fc.Mesh.from_blocks(blocks, apart=["a_right"])  # type: ignore[call-arg]
    mesh = fc.Mesh.from_blocks(blocks, joined=[["a", "b"]])
    assert len(mesh.nodes) == 15
    assert mesh.nodes[mesh.document()["points"]["tip"]].tolist() == [[1, 1], [2, 1]]


def test_a_case_of_several_files_is_written_beside_another(tmp_path: pathlib.Path) -> None:
    square = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"{0}\"\n1 2 \"{0}_low\"\n$EndPhysicalNames\n$Nodes\n4\n"
    square += "1 {1} 0 0\n2 {2} 0 0\n3 {2} 1 0\n4 {1} 1 0\n$EndNodes\n$Elements\n2\n1 3 2 1 1 1 2 3 4\n2 1 2 2 1 1 2\n$EndElements\n"
    for name, x in (("a", 0), ("b", 1)):
        (tmp_path / f"{name}.msh").write_text(square.format(name, x, x + 1))
    body = {"material": {"model": "linear", "E": 1.0, "nu": 0.0}}
    supports = [{"on": f"{name}_low", "ux": 0, "uy": 0} for name in "ab"]
    document = {
        "mesh": ["a.msh", "b.msh"],
        "bodies": {"a": body, "b": body},
        "steps": [{"name": "hold", "duration": 1, "dt": {"initial": 1}, "supports": supports}],
    }
    case = fc.Case(document, folder=tmp_path)
    assert "8 nodes, 2 elements" in case.check()
    (tmp_path / "below").mkdir()
    case.write(tmp_path / "below" / "case.json")
    again = fc.Case(tmp_path / "below" / "case.json")
    assert again.document["mesh"] == ["../a.msh", "../b.msh"]
    assert "8 nodes, 2 elements" in again.check()
    before = case.digest
    (tmp_path / "b.msh").write_text(square.format("b", 1, 3))
    assert case.digest != before
    (tmp_path / "a.msh").rename(tmp_path / "a.mesh")
    assert fc.Mesh.join([fc.Mesh.read(tmp_path / name) for name in ("a.mesh", "b.msh")]).groups["b_low"] == "edges"
