"""Runs from Python: the same bits as the command line, results as its users read them."""

from __future__ import annotations

import csv
import json
import pickle
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import DOCUMENT, REPOSITORY, command, inline, python

import fecontact as fc

# Files of a run whose content depends on nothing but the case.
TABLES = ["history.csv", "newton.csv", "probes.csv", "fronts.csv", "events.csv"]


def written(document: dict[str, Any], folder: Path) -> Path:
    path = folder / "case.json"
    path.write_text(json.dumps(document))
    return path


def same_files(one: Path, other: Path) -> None:
    for name in TABLES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    frames = sorted((one / "solid").glob("*.vtu"))
    assert len(frames) > 3
    for frame in [*frames, *sorted((one / "contact").glob("*.vtu"))]:
        assert frame.read_bytes() == (other / frame.relative_to(one)).read_bytes(), frame.name


def test_same_bits_as_the_command_line(program: Path, document: dict[str, Any], result: fc.Result, tmp_path: Path) -> None:
    path = written(document, tmp_path)
    told = command(program, "run", path, "--out", tmp_path / "line", "--quiet")
    assert told.returncode == 0, told.stderr
    same_files(result.folder, tmp_path / "line")
    # As a file, and on other numbers of threads, too.
    again = fc.Case(path).run(tmp_path / "python", threads=1, progress=False)
    same_files(again.folder, tmp_path / "line")
    ours, theirs = result.summary, json.loads((tmp_path / "line" / "summary.json").read_text())
    own = {"case", "wall_s", "peak_memory_mib", "files"}
    assert {key: ours[key] for key in ours if key not in own} == {key: theirs[key] for key in theirs if key not in own}
    # A page is written where it is asked for.
    assert set(theirs["files"]) - set(ours["files"]) == {"report.html"}


def test_check_says_what_the_command_line_says(program: Path, document: dict[str, Any], tmp_path: Path) -> None:
    told = command(program, "check", written(document, tmp_path))
    assert told.returncode == 0 and fc.Case(document).check() == told.stdout


def test_tables_have_units(result: fc.Result, document: dict[str, Any]) -> None:
    units = result.history.attrs["units"]
    assert list(units) == list(result.history)
    labelled = {"time": "s", "step": "", "strain": "N·mm", "base.normal_force": "N", "base.mean_slip": "mm", "base.slip_fraction": ""}
    assert {name: units[name] for name in labelled} == labelled
    # The points that slip are counted under the name of a length.
    assert result.newton.attrs["units"]["slip"] == "" and result.newton.attrs["units"]["time"] == "s"
    assert fc.Case({**document, "units": {}}).run(progress=False).history.attrs["units"]["strain"] == "F·L"


def test_tables_and_interface(result: fc.Result) -> None:
    assert result.status == "completed" and result.contacts == ["base"]
    history = result.history
    assert history["time"].iloc[-1] == 5.0 and len(history) == result.summary["increments"]
    # Numbers are read to the last digit.
    with open(result.folder / "history.csv", newline="") as text:
        rows = list(csv.DictReader(text))
    for name in set(history) - {"step"}:
        assert [float(row[name]) for row in rows] == history[name].tolist(), name
    assert result.newton["iteration"].min() == 1 and {"gauge.ux"} <= set(result.probes)
    assert len(result.events) >= 1 and set(result.events["contact"]) == {"base"} and len(result.fronts) >= 1
    base = result.interface["base"]
    assert base["slip"].dims == ("time", "point") and base["position"].dims == ("point",)
    assert base.sizes == {"time": len(history), "point": 6}
    np.testing.assert_array_equal(base["time"], history["time"])
    assert base["slip"].attrs["units"] == "mm"
    with pytest.raises(KeyError, match="there are base"):
        result.interface["bas"]


def test_stores_of_earlier_versions_are_read(result: fc.Result, tmp_path: Path) -> None:
    """They called pressure and traction ``p`` and ``q``."""
    now, old = result.interface["base"], tmp_path / "out"
    shutil.copytree(result.folder, old)
    metadata = old / "interface.zarr" / ".zmetadata"
    text = metadata.read_text()
    for former, name in (("p", "pressure"), ("q", "traction")):
        (metadata.parent / f"base.{name}").rename(metadata.parent / f"base.{former}")
        text = text.replace(f"base.{name}/", f"base.{former}/")
    metadata.write_text(text)
    then = fc.Result(old).interface["base"]
    assert set(then.variables) == set(now.variables)
    np.testing.assert_array_equal(then["pressure"], now["pressure"])


def test_results_are_listed(result: fc.Result) -> None:
    """Every column of the history, by what stands behind its dot."""
    listed = {entry["name"].rsplit(".", 1)[-1] for entry in fc.schema("results")["history.csv"]}
    assert {column.rsplit(".", 1)[-1] for column in result.history} <= listed


def test_a_row_that_is_being_written_is_none_yet(result: fc.Result, tmp_path: Path) -> None:
    """Cut anywhere, the last row would end in another number; the others are whole."""
    text, whole = (result.folder / "history.csv").read_text(), result.history
    for cut in (2, 20, len(text.splitlines()[-1])):
        (tmp_path / "history.csv").write_text(text[:-cut])
        assert fc.Result(tmp_path).history.equals(whole[:-1])
    (tmp_path / "history.csv").write_text(text)
    assert fc.Result(tmp_path).history.equals(whole)


def test_fields(result: fc.Result) -> None:
    pytest.importorskip("pyvista")
    fields = result.fields
    assert fields.times[-1] == 5.0 and len(fields) == len(fields.times)
    grid = fields[-1]
    assert grid.n_points == len(inline()["nodes"]) and grid.point_data["displacement"].shape[1] == 3
    assert fields.at(0.9).point_data["displacement"][:, 1].min() == pytest.approx(-0.02, rel=0.2)
    assert result.fields.contact[-1].n_points > 0 and result.fields.points[-1].n_points > 0
    of = grid.point_data
    xx, yy, zz, xy, yz, xz = of["stress"].T
    assert of["principal_stress"].shape == (grid.n_points, 3) and (np.diff(of["principal_stress"], axis=1) <= 0).all()
    assert of["principal_stress"].sum(axis=1) == pytest.approx(xx + yy + zz, rel=1e-5, abs=1e-5)
    tensors = np.array([[[x, s, 0], [s, y, 0], [0, 0, z]] for x, y, z, s in zip(xx, yy, zz, xy)])
    assert of["principal_stress"][:, ::-1] == pytest.approx(np.linalg.eigvalsh(tensors), rel=1e-5, abs=1e-5)
    assert of["principal_strain"].shape == (grid.n_points, 3) and of["stretch_zz"] == pytest.approx(1.0)


def test_open_and_report(result: fc.Result, tmp_path: Path) -> None:
    again = fc.Result.open(result.folder)
    assert again.history.equals(result.history) and "completed" in repr(again)
    page = again.report(tmp_path / "page.html")
    assert page.read_text().lstrip().lower().startswith("<!doctype html")
    shown = again._repr_html_()
    assert "<svg" in shown and "completed" in shown
    with pytest.raises(FileNotFoundError, match="no summary.json"):
        fc.Result.open(tmp_path)


def test_temporary_folder_lives_as_long_as_the_result(document: dict[str, Any]) -> None:
    result = fc.Case(document).run(progress=False)
    folder, base = result.folder, result.interface["base"]
    assert (folder / "history.csv").is_file()
    del result
    assert not folder.exists()
    assert np.isfinite(base["slip"].values).all()


def test_mesh_from_arrays(document: dict[str, Any], result: fc.Result, tmp_path: Path) -> None:
    given = document.pop("mesh")
    arrays = {kind: {name: np.array(list_) for name, list_ in given[kind].items()} for kind in ("elements", "edges")}
    mesh = fc.Mesh(given["nodes"], **arrays)
    # Edges are turned so that their body is on the left, and stand in its order.
    sides = lambda edges: {name: {frozenset(edge) for edge in own} for name, own in edges.items()}  # noqa: E731
    told = mesh.document()
    assert sides(told.pop("edges")) == sides(given["edges"])
    assert told == {"nodes": given["nodes"], "elements": given["elements"], "points": {}}
    assert mesh.groups["block_top"] == "edges"
    case = fc.Case(**document, mesh=mesh)
    same_files(result.folder, case.run(tmp_path / "out", progress=False).folder)
    assert pickle.loads(pickle.dumps(case)).document == case.document
    # The case goes to a file that the command line reads, whole.
    case.write(tmp_path / "whole.json")
    assert fc.Case(tmp_path / "whole.json").check() == case.check().replace("a mesh at hand", "given in the case file")
    assert case.digest == pickle.loads(pickle.dumps(case)).digest
    moved = fc.Mesh(np.array(given["nodes"]) * 2.0, **arrays)
    assert len({case.digest, case.replace({"mesh": moved}).digest, case.replace({"steps[1].duration": 3}).digest}) == 3


def test_mesh_from_gmsh(document: dict[str, Any]) -> None:
    gmsh = pytest.importorskip("gmsh", exc_type=ImportError)
    gmsh.initialize(["-v", "0"])
    try:
        surface = gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(2, [surface], name="block")
        gmsh.model.addPhysicalGroup(1, [1], name="block_bottom")
        gmsh.model.mesh.generate(2)
        mesh = fc.Mesh.from_gmsh()
    finally:
        gmsh.finalize()
    assert mesh.groups == {"block": "elements", "block_bottom": "edges"} and np.ptp(mesh.nodes, axis=0).tolist() == [2, 1]


BLOCKS: dict[str, Any] = {
    "parameters": {"h": 0.25},
    "blocks": [
        {
            "body": name,
            "corners": [[x, y], [f"{x} + {length}", y], [f"{x} + {length}", y + 0.5], [x, y + 0.5]],
            "elements": [f"round({length}/h)", 3],
            "sides": [f"{name}_{side}" for side in ("bottom", "right", "top", "left")],
        }
        for name, x, y, length in (("ground", 0.0, -0.5, 3.0), ("block", 0.4, 0.01, 1.0))
    ],
}


def test_mesh_of_blocks(document: dict[str, Any], program: Path, tmp_path: Path) -> None:
    document["mesh"] = BLOCKS
    case = fc.Case(document)
    result = case.run(progress=False)
    mesh = fc.Mesh.from_blocks(**BLOCKS)
    assert (len(mesh.nodes), len(mesh.elements)) == (13 * 4 + 5 * 4, 12 * 3 + 4 * 3)
    np.testing.assert_allclose(mesh.nodes[[0, 12, 52]], [[0, -0.5], [3, -0.5], [0.4, 0.01]])
    at_hand = fc.Case({**document, "mesh": pickle.loads(pickle.dumps(mesh))}).run(progress=False)
    command(program, "run", written(document, tmp_path), "--out", tmp_path / "line", "--quiet")
    case.write(tmp_path / "again.json")
    again = fc.Case(tmp_path / "again.json").run(progress=False)
    for other in (at_hand.folder, tmp_path / "line", again.folder):
        assert (other / "history.csv").read_bytes() == (result.folder / "history.csv").read_bytes()
    finer = case.replace({"mesh.parameters.h": 0.125})
    assert finer.digest != case.digest
    assert f"{(24 + 8) * 3} elements" in finer.check() and f"{(12 + 4) * 3} elements" in case.check()
    with pytest.raises(fc.CaseError, match=r"mesh.parameters.H: is not used in any expression of the mesh"):
        case.replace({"mesh.parameters.H": 2}).check()
    with pytest.raises(fc.CaseError, match=r"mesh: blocks\[1\].elements\[0\]: is 2.5: must be a whole number"):
        fc.Mesh.from_blocks([BLOCKS["blocks"][0], {**BLOCKS["blocks"][1], "elements": [2.5, 3]}], BLOCKS["parameters"])


def test_a_law_by_name_is_varied_where_it_is_used(document: dict[str, Any]) -> None:
    with pytest.raises(fc.CaseError, match="stand where they are used: name one use, as contacts.NAME.friction.mu"):
        fc.Case(document).replace({"frictions.dry.kappa": 1})


def test_replace(document: dict[str, Any]) -> None:
    case = fc.Case(document)
    other = case.replace({"contacts.base.friction.mu_s": np.float64(0.5), "steps[1].duration": 2})
    assert other.document["contacts"]["base"]["friction"]["mu_s"] == 0.5 and other.document["steps"][1]["duration"] == 2
    assert case.document == document
    with pytest.raises(fc.CaseError, match=r"there is no `friktion` in this case; did you mean `friction`\? There is slave, master, friction"):
        case.replace({"contacts.base.friktion.mu_s": 0.5})
    with pytest.raises(fc.CaseError, match=r"steps\[7\].duration.*0 to 1"):
        case.replace({"steps[7].duration": 2})
    with pytest.raises(fc.CaseError, match=r"steps\[²\].duration: is not a place"):
        case.replace({"steps[²].duration": 2})
    with pytest.raises(fc.CaseError, match="mu_S.*did you mean `mu_s`"):
        case.replace({"contacts.base.friction.mu_S": 0.5})


def test_resume_goes_on_to_the_same_bits(document: dict[str, Any], result: fc.Result, tmp_path: Path) -> None:
    from fecontact import _native

    case, out = fc.Case(document), tmp_path / "out"
    # A run that ends at its first look, which is early in it or at its end.
    status, _, raised = _native.run(case._native, str(out), None, False, False, refuse)
    assert status in ("interrupted", "completed") and isinstance(raised, RuntimeError)
    same_files(result.folder, case.run(out, resume=True, progress=False).folder)
    with pytest.raises(fc.CaseError, match="steps.0..duration` is now 2 and was 1"):
        case.replace({"steps[0].duration": 2}).run(out, resume=True, progress=False)


def refuse(told: list[str], place: object) -> None:
    raise RuntimeError("no more")


def test_committed_case() -> None:
    assert "gauss_to_segment" in fc.Case(REPOSITORY / "cases" / "block_on_ground.json").check()


def test_builder_makes_what_a_file_says(document: dict[str, Any]) -> None:
    from fecontact import model

    rubber = model.NeoHookean(E=100, nu=0.3, density=1e-4)
    friction = model.SuperSubloading(mu_s=0.4, mu_k=0.2, alpha_t=2e3, r=100, kappa=10, xi=0.002)
    top = "block_top"
    case = fc.Case(
        title="test",
        units=DOCUMENT["units"],
        mesh=document["mesh"],
        bodies={name: model.Body(material=rubber) for name in ("ground", "block")},
        contacts={"base": model.Contact(slave="block_bottom", master="ground_top", friction=friction)},
        steps=[
            model.Step(
                name="press",
                duration=1,
                dt=model.Increments(initial=0.5, min=1e-4),
                supports=[model.Support(on="ground_bottom", ux=0, uy=0), model.Support(on=top, ux=0, uy=-0.02)],
            ),
            model.Step(
                name="drag",
                duration=4,
                dt=model.Increments(initial=0.25, min=1e-4),
                supports=[model.Support(on=top, ux=model.Rate(0.1))],
            ),
        ],
        watch=[top],
        probes={"gauge": model.Probe(at=[0.9, 0.2])},
        output=model.Output(fronts=model.Fronts(slip_rate=0.01), points=True),
    )
    assert case.document == document


def test_builder_is_made_from_the_schema() -> None:
    import sys

    tools = REPOSITORY / "python" / "tools"
    sys.path.insert(0, str(tools))
    from model_from_schema import written as made

    committed = (REPOSITORY / "python" / "fecontact" / "model.py").read_text()
    assert committed == made(fc.schema("case")), "run python tools/model_from_schema.py"


def test_example(tmp_path: Path) -> None:
    from fecontact.examples import block_on_ground

    block_on_ground.main([str(tmp_path / "figure.png")])
    assert (tmp_path / "figure.png").stat().st_size > 20_000


def test_plot_of_bodies(result: fc.Result) -> None:
    from matplotlib import pyplot as plt

    grid = result.fields[-1]
    ax = fc.plot.body(result, "von_mises", deformed=10)
    [cells] = [drawn for drawn in ax.collections if drawn.get_array() is not None]
    np.testing.assert_allclose(cells.get_array(), grid["von_mises"])
    moved = (grid.points + 10 * grid["displacement"])[:, :2]
    low, high = ax.dataLim.get_points()
    # Frames have single precision.
    np.testing.assert_allclose([low, high], [moved.min(axis=0), moved.max(axis=0)], rtol=1e-6)
    assert ax.get_xlabel() == "x [mm]" and "displacement × 10" in ax.get_title()
    assert [other.get_ylabel() for other in ax.figure.axes if other is not ax] == ["von Mises stress [N/mm²]"]
    [cells] = [drawn for drawn in fc.plot.body(result, "stress", component="xy", time=0.0).collections if drawn.get_array() is not None]
    np.testing.assert_allclose(cells.get_array(), result.fields[0]["stress"][:, 3])
    assert fc.plot.body(result, "displacement", edges=True).has_data()
    with pytest.raises(ValueError, match="xx, yy, zz, xy"):
        fc.plot.body(result, "stress")
    with pytest.raises(KeyError, match="von_mises"):
        fc.plot.body(result, "mises")
    plt.close("all")


def test_plots(result: fc.Result) -> None:
    from matplotlib import pyplot as plt

    ax = plt.figure().add_subplot()
    assert fc.plot.friction(result, ax=ax) is ax
    [line] = ax.get_lines()
    expected = result.history["base.tangential_force"].abs() / result.history["base.normal_force"]
    np.testing.assert_array_equal(line.get_ydata(), expected)
    assert ax.get_xlabel() == "time [s]"
    for column, unit in (("base.mean_slip", "mm"), ("block_top.fx", "N"), ("base.max_penetration", "mm"), ("dt", "s")):
        assert fc.plot.friction(result, x=column).get_xlabel() == f"{column} [{unit}]"
    for draw in (fc.plot.slip_fraction, fc.plot.events, fc.plot.path, fc.plot.newton):
        assert draw(result).has_data()
    for field in ("slip", "slip_rate", "pressure", "mu"):
        assert fc.plot.interface(result, "base", field).has_data()
    with pytest.raises(KeyError, match="there are base"):
        fc.plot.friction(result, "bas")
    rows = fc.plot.interface(result, "base", "slip", x="x", y="row")
    # A cell a row and a point, over the coordinate of the points.
    data = result.interface["base"]
    [cells] = [drawn for drawn in rows.collections if hasattr(drawn, "get_coordinates")]
    assert cells.get_array().shape == (data.sizes["time"], data.sizes["point"])
    assert rows.get_ylim() == (-0.5, data.sizes["time"] - 0.5)
    assert rows.get_xlim()[0] < data["x"].values.min() < data["x"].values.max() < rows.get_xlim()[1]
    with pytest.raises(ValueError, match="x is position, x or y"):
        fc.plot.interface(result, "base", x="z")
    plt.close("all")


def test_plot_of_fronts(result: fc.Result) -> None:
    from matplotlib import pyplot as plt

    [event, *_] = result.events.sort_values("length", ascending=False)["event"]
    drawn = {line.get_label(): line for line in fc.plot.fronts(result, "base").get_lines()}
    own = result.fronts[result.fronts["event"] == event]
    onset = result.events.set_index("event")["onset"][event]
    np.testing.assert_allclose(drawn[f"event {event}"].get_ydata(), own["arrival"] - onset)
    # Slopes are those of the waves of the material: c_s = √(G/ρ), c_p = √((λ + 2G)/ρ).
    shear = np.sqrt(100 / 2.6 / 1e-4)
    for name, speed in (("c_s", shear), ("c_p", shear * np.sqrt(2 * 0.7 / 0.4))):
        x, t = drawn[name].get_data()
        np.testing.assert_allclose(np.abs(x - x[1]), speed * np.asarray(t), rtol=1e-12)
        assert np.max(t) > 0
    with pytest.raises(KeyError, match="base has no event 999"):
        fc.plot.fronts(result, "base", event=999)
    plt.close("all")


def test_a_log_has_no_bar(document: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "case.json").write_text(json.dumps(document))
    text = f"import fecontact as fc; fc.Case({str(tmp_path / 'case.json')!r}).run()"
    assert "iter" not in python("-c", text).stderr


def test_derivatives(document: dict[str, Any]) -> None:
    """Those of a run are central differences of runs; a case may name their places, or its run."""
    place = "contacts.base.friction.kappa"
    document["newton"] = {"tolerance": 1e-12, "max_iterations": 40}
    case = fc.Case(document)
    result = case.run(progress=False, gradients=[place])
    column = f"d(base.tangential_force)/d({place})"
    assert len(result.gradients) == len(result.history) and result.gradients["step"].iloc[-1] == "drag"
    low, high = (case.replace({place: 10 * (1 + end)}).run(progress=False).history for end in (-1e-4, 1e-4))
    assert list(low["time"]) == list(result.history["time"]) == list(high["time"])
    differences = (high["base.tangential_force"] - low["base.tangential_force"]) / (20 * 1e-4)
    assert abs(differences).max() > 0
    np.testing.assert_allclose(result.gradients[column], differences, rtol=0, atol=1e-5 * abs(differences).max())
    named = fc.Case({**document, "gradients": [place]}).run(progress=False)
    assert named.gradients.equals(result.gradients)
    whole = fc.Case({**document, "gradients": [place], "output": {"displacement_gradients": True}}).run(progress=False)
    along, moved = (whole.interface_gradients["base"].sel(by=place), whole.displacement_gradients.sel(by=place))
    ends = [fc.Case(document).replace({place: 10 * share, "newton": {"tolerance": 1e-12}, "output": {"exact": True}}).run(progress=False) for share in (0.999, 1.001)]
    for name in ("slip", "pressure", "traction"):
        below, above = (end.interface["base"][name].to_numpy() for end in ends)
        expected = (above - below) / (0.002 * 10)
        assert along[name].dims == ("time", "point")
        # The stores are rounded to 2⁻¹⁶ of their values.
        rounding = 2.0**-16 * abs(above).max() / (0.002 * 10)
        np.testing.assert_allclose(along[name], expected, rtol=0, atol=1e-4 * abs(expected).max() + 2 * rounding)
    below, above = (end.fields[-1]["displacement"] for end in ends)
    expected = (np.asarray(above) - np.asarray(below))[:, :2] / (0.002 * 10)
    np.testing.assert_allclose(moved[-1], expected, rtol=0, atol=1e-3 * abs(expected).max())
    assert moved.dims == ("time", "node", "component") and (moved.x.size, moved.sizes["time"]) == (len(expected), len(result.history))
    with pytest.raises(FileNotFoundError, match="displacement_gradients"):
        _ = named.displacement_gradients
    with pytest.raises(FileNotFoundError, match="gradients"):
        _ = case.run(progress=False).gradients
    with pytest.raises(fc.CaseError, match="kapa"):
        case.run(progress=False, gradients=["contacts.base.friction.kapa"])
