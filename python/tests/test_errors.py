"""What goes wrong: an exception with the field's name and the text of the command line; nothing hangs, nothing is lost."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import command, python

import fecontact as fc
from fecontact.case import _raise


def broken(document: dict[str, Any], *places: Any, value: Any) -> dict[str, Any]:
    at: Any = document
    for place in places[:-1]:
        at = at[place]
    at[places[-1]] = value
    return document


@pytest.mark.parametrize(
    ("places", "value", "place"),
    [
        (("contacts", "base", "friktion"), 1, "contacts.base"),
        (("contacts", "base", "friction", "mu_s"), -0.4, "contacts.base.friction"),
        (("contacts", "base", "slave"), "block_botom", "contacts.base.slave"),
        (("steps", 1, "duration"), "long", "steps[1].duration"),
        (("steps", 1, "supports", 0, "on"), "roof", "steps[1].supports[0].on"),
        (("mesh", "elements", "block"), [[0, 1, 2, 99999]], "mesh"),
    ],
)
def test_bad_cases_are_told_as_by_the_command_line(
    program: Path, document: dict[str, Any], tmp_path: Path, places: tuple[Any, ...], value: Any, place: str
) -> None:
    given = broken(document, *places, value=value)
    (tmp_path / "case").write_text(json.dumps(given))
    told = command(program, "check", tmp_path / "case")
    assert told.returncode == 2
    with pytest.raises(fc.CaseError) as caught:
        fc.Case(given, folder=tmp_path).check()
    assert f"error: {caught.value}\n" == told.stderr
    assert caught.value.place.startswith(place) and caught.value.file == str(tmp_path / "case")


@pytest.mark.parametrize("value", [math.nan, np.float64(np.inf), np.array([[0.0, np.nan]])])
def test_numbers_that_are_none(document: dict[str, Any], value: Any) -> None:
    with pytest.raises(fc.CaseError, match=r"case: steps\[1\].duration.*is (nan|inf): must be a finite number"):
        fc.Case(broken(document, "steps", 1, "duration", value=value))


def test_things_that_a_case_cannot_hold(document: dict[str, Any]) -> None:
    with pytest.raises(fc.CaseError, match="contacts.base.area: is a object, which a case cannot hold"):
        fc.Case(broken(document, "contacts", "base", "area", value=object()))
    with pytest.raises(fc.CaseError, match="no such file"):
        fc.Case("nowhere.json")
    with pytest.raises(fc.CaseError, match="key `mesh` is missing"):
        fc.Case({"steps": []})
    with pytest.raises(TypeError, match="slav"):
        fc.model.Contact(slav="a", master="b", friction=fc.model.Frictionless())  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"nodes": np.zeros((4, 3))}, r"mesh: nodes: has the shape \(4, 3\): must be \(nodes, 2\)"),
        ({"nodes": [[0, 0], [1, 0], [np.nan, 1], [0, 1]]}, "node 2"),
        ({"elements": {"a": [[0, 1]]}}, r"mesh: elements.a: has the shape \(1, 2\)"),
        ({"elements": {"a": [[0.0, 1.0, 2.0, 3.0]]}}, "mesh: elements.a: has the type float64"),
        ({"elements": {"a": [[0, 1, 2, -1]]}}, "mesh: elements.a: the node -1 is negative"),
        ({"elements": {"a": [[0, 1, 2, 9]]}}, "node 9"),
        ({"edges": {"s": [[0, 1], [0, 2]]}}, "line 1 of `s` is not an edge of any element"),
    ],
)
def test_bad_meshes(change: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"nodes": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": {"a": [[0, 1, 2, 3]]}}
    assert len(fc.Mesh(**good).nodes) == 4
    with pytest.raises(fc.CaseError, match=message):
        fc.Mesh(**{**good, **change})


COULOMB = fc.law("coulomb", mu=0.4, alpha_t=1e3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fc.law(3), "law: is a int: give the name of a law, or its parameters"),
        (lambda: fc.law("coulomb", mu=[0.3, [0.4]], alpha_t=1.0), r"law: mu: is \[0.3, \[0.4\]\]: must be values in rows of one length"),
        (lambda: COULOMB.drive("x", [0, 1], 1.0), "law: time: is 'x': must be a number, or numbers in rows of one length"),
        (lambda: COULOMB.drive([0, 1], {}, 1.0), "law: slip: is {}: must be a number"),
        (lambda: COULOMB.drive([0, 1], [0, 1], 1.0, traction=[1, 2]), r"law: traction: is \[1, 2\]: must be a finite number"),
        (lambda: COULOMB.drive([0, 1], [0, 1], 1.0, by=3), "law: by: is 3: must be a list of names"),
        (lambda: COULOMB.drive([0, 1], [0, 1], 1.0, threads=2.5), "threads: is 2.5: must be a whole number"),
        (lambda: COULOMB.slider([0, 1], [0, 1], 1.0, stiffness=1.0, mass=None), "law: mass: is nan"),
        (lambda: fc.Case(3), "case: is a int: give the path of a case file, or a case as a dict"),
        (lambda: fc.Case({}, folder=3), "folder: is 3: must be a path"),
        (lambda: fc.Mesh(None, {}), "mesh: nodes: has the shape"),
        (lambda: fc.Mesh("x", {}), "mesh: nodes: is 'x': must be a number"),
        (lambda: fc.Mesh([[0, 0]], []), "mesh: elements: is a list: must be a dict of arrays by name"),
        (lambda: fc.Mesh([[0, 0]], {"a": [[0, 1, 2], [0, 1]]}), "mesh: elements.a: has rows of different lengths"),
        (lambda: fc.schema(3), "schema: schema: is 3: must be a name"),
        (lambda: fc.report("out", "page.html"), "folders: is 'out': give a list of folders"),
        (lambda: fc.friction_law("mine", 3), "law `mine`: variables: is a int: give values at first touch by name"),
        (lambda: fc.calibration.Interface("x", [0], 1.0, [0]), "time: is a str: must be numbers"),
    ],
)
def test_arguments_that_are_of_another_kind_are_named(call: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()


def test_arguments_of_a_simulation_are_named(document: dict[str, Any]) -> None:
    simulation = fc.Simulation(document)
    for call, message in (
        (lambda: simulation.prescribe("block_top", ux="x", by=1.0), "prescribe: ux: is 'x': must be a number"),
        (lambda: simulation.prescribe(3, ux=0.0, by=1.0), "prescribe: group: is 3: must be a name"),
        (lambda: simulation.load("block_top", pressure=1.0, by=[1, 2]), r"load: by: is \[1, 2\]: must be a finite number"),
        (lambda: simulation.increments(max="x"), "increments: max: is 'x': must be a number"),
        (lambda: simulation.reaction(3), "reaction: group: is 3: must be a name"),
        (lambda: simulation.write(3), "folder: is 3: must be a path"),
        (lambda: fc.Simulation.resume(document, 3), "saved: is a int: give what save"),
        (lambda: simulation.case.run(out=3, progress=False), "out: is 3: must be a path"),
        (lambda: simulation.case.replace(3), "replace: is a int: give values by place"),
    ):
        with pytest.raises(ValueError, match=message):
            call()


def test_notes_of_what_was_raised_are_kept(tmp_path: Path) -> None:
    """What was raised while a run went on has the folder as its last note."""
    error = RuntimeError("not this one")
    error.__notes__ = ["a note of its own"]
    with pytest.raises(RuntimeError, match="not this one") as caught:
        _raise("interrupted", None, error, fc.Result(tmp_path))
    assert caught.value.__notes__ == ["a note of its own", f"the results so far are in {tmp_path}"]


@pytest.mark.parametrize("text", ["{\"status\": \"comp", "[1]", "\xff"])
def test_a_damaged_summary_is_told(tmp_path: Path, text: str) -> None:
    (tmp_path / "summary.json").write_text(text, encoding="latin-1")
    with pytest.raises(ValueError, match=r"summary.json: is damaged"):
        _ = fc.Result.open(tmp_path).status


def test_folders_in_use_are_told(document: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "history.csv").write_text("mine")
    with pytest.raises(fc.CaseError, match="history.csv.*is in the way"):
        fc.Case(document).run(tmp_path, progress=False)
    assert (tmp_path / "history.csv").read_text() == "mine"
    for threads in (0, -1):
        with pytest.raises(ValueError, match=f"threads {threads}: give 1 to 1024"):
            fc.Case(document).run(threads=threads)
    with pytest.raises(fc.CaseError, match="--resume: there is no checkpoint"):
        fc.Case(document).run(tmp_path, resume=True, progress=False)


def test_a_run_that_has_left_nothing_to_resume_begins_anew(document: dict[str, Any], tmp_path: Path) -> None:
    with pytest.warns(fc.RunWarning, match="no checkpoint yet, the run begins anew"):
        result = fc.Case(document).run(tmp_path / "new", resume=True, progress=False)
    assert result.status == "completed"


def test_a_run_that_stops_holds_its_results(document: dict[str, Any]) -> None:
    # Pushed through the ground by far, in increments that may not be cut.
    document["steps"][1]["supports"] = [{"on": "block_top", "uy": -5.0}]
    document["steps"][1]["dt"] = {"initial": 4.0, "min": 3.0}
    with pytest.raises(fc.Stopped, match="step `drag` stopped at time 1") as caught:
        fc.Case(document).run(progress=False)
    result = caught.value.result
    assert result is not None and result.status == "stopped" and result.history["time"].iloc[-1] == 1.0
    assert result.summary["reason"] == str(caught.value)
    simulation = fc.Simulation(document)
    with pytest.raises(fc.Stopped, match="step `drag` stopped at time 1"):
        list(simulation)
    assert simulation.time == 1.0


def test_warnings_are_warnings(document: dict[str, Any]) -> None:
    document["contacts"]["base"]["normal"] = {"alpha_n": 50.0}
    with pytest.warns(fc.RunWarning, match="penetrat"):
        result = fc.Case(document).run(progress=False)
    assert any("penetrat" in text for text in result.warnings)


LONG = """
import json, sys, fecontact as fc
document = json.loads(sys.argv[1])
document["steps"][1].update(duration=4000.0, supports=[{"on": "block_top", "ux": "0.05*sin(t)"}])
print("begins", flush=True)
try:
    fc.Case(document).run(sys.argv[2], progress=False)
except fc.Interrupted as interrupted:
    result = interrupted.result
    print(result.status, len(result.history), flush=True)
    raise
"""


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_ends_a_run_at_the_next_increment(document: dict[str, Any], tmp_path: Path) -> None:
    document["output"] = {"fields": False}
    out = tmp_path / "out"
    run = subprocess.Popen(
        [sys.executable, "-c", LONG, json.dumps(document), str(out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 300
    while not (out / "history.csv").is_file() or (out / "history.csv").read_text().count("\n") < 5:
        assert time.monotonic() < deadline and run.poll() is None, run.communicate()
        time.sleep(0.05)
    run.send_signal(signal.SIGINT)
    told, errors = run.communicate(timeout=300)
    status, rows = told.split()[1:]
    assert status == "interrupted" and int(rows) >= 4 and run.returncode != 0
    assert "fecontact.errors.Interrupted" in errors and str(out) in errors
    assert json.loads((out / "summary.json").read_text())["status"] == "interrupted"
    assert (out / "checkpoint.bin").is_file() and not (out / "fecontact.lock").exists()


LAWS = """
import sys, time
import numpy as np
import fecontact as fc
parameters = {"mu_s": np.linspace(0.5, 0.6, 4000), "mu_k": 0.4, "r": 400.0, "kappa": 40.0, "xi": 0.05, "alpha_t": 2e3}
law, t = fc.law("super_subloading", **parameters), np.linspace(0.0, 200.0, 20000)
path = 0.01 * t + 0.005 * np.sin(20.0 * t)
print("begins", flush=True)
try:
    law.drive(t, path, 1.0, by=["mu_s", "kappa"]) if sys.argv[1] == "drive" else law.slider(t, path, 1.0, stiffness=10.0, mass=0.1)
    print("done", flush=True)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    law = fc.law("coulomb", mu=0.5, alpha_t=1e3)
    print(law.drive([0.0, 1.0], [0.0, 1.0], 2.0).traction[-1], flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("what", ["drive", "slider"])
def test_ctrl_c_ends_many_laws_at_their_next_step(what: str) -> None:
    """Sets of parameters that take minutes; the next drive of the process is answered as ever."""
    led = subprocess.Popen([sys.executable, "-c", LAWS, what], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert led.stdout is not None and led.stdout.readline() == "begins\n"
        time.sleep(1.0)
        assert led.poll() is None
        led.send_signal(signal.SIGINT)
        told, errors = led.communicate(timeout=300)
    finally:
        led.kill()
    assert told.split() == ["interrupted", "1.0"] and led.returncode == 0, errors


def test_python_goes_on_while_a_run_solves(document: dict[str, Any]) -> None:
    ticks, done = [], threading.Event()

    def tick() -> None:
        while not done.wait(0.005):
            ticks.append(time.monotonic())

    clock = threading.Thread(target=tick)
    clock.start()
    begun = time.monotonic()
    fc.Case(document).replace({"steps[1].dt.initial": 0.02}).run(progress=False)
    ended = time.monotonic()
    done.set()
    clock.join()
    during = [t for t in ticks if begun < t < ended]
    # A run that kept the interpreter would let none, or one, through.
    assert len(during) >= 5, (ended - begun, len(during))


def test_runs_after_a_fork() -> None:
    if not hasattr(os, "fork"):
        pytest.skip("no fork")
    script = (
        "import os, sys; from fecontact.examples.block_on_ground import case\n"
        "import fecontact as fc\n"
        "case = case(divisions=4); case.run(progress=False); simulation = fc.Simulation(case)\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        "    case.run(progress=False)\n"
        "    try: next(simulation)\n"
        "    except RuntimeError as error: os._exit(7 if 'process that made it' in str(error) else 1)\n"
        "    os._exit(2)\n"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))\n"
    )
    assert python("-c", script).returncode == 7
