"""Studies: one table, nothing lost and nothing twice when workers, or the study itself, are killed."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY

import fecontact as fc
from fecontact import _study_run, studies
from fecontact._study_run import Task, perform

MU_S = "contacts.base.friction.mu_s"
HERE = Path(__file__).parent


def peak(result: fc.Result) -> dict[str, float]:
    """Measures a run, and leaves a line that it did."""
    if folder := os.environ.get("MEASURED"):
        with open(folder, "a") as lines:
            lines.write(f"{result.folder.name}\n")
    return {"peak": result.history["base.tangential_force"].abs().max(), "rows": len(result.history)}


def fails(result: fc.Result) -> float:
    raise ArithmeticError("no number")


def slider(duration: float = 500.0) -> fc.Case:
    """A block of one node on a spring: seconds of work, with a checkpoint every 0.1 s, so that there is time to kill it in mid run."""
    document = json.loads((REPOSITORY / "cases" / "paper" / "spring_mass_1.json").read_text())
    document["steps"][0]["duration"] = duration
    document["output"] = {"fields": False, "checkpoint": 0.002}
    return fc.Case(document)


def records(out: Path) -> dict[str, Any]:
    return {file.stem: json.loads(file.read_text()) for file in (out / "runs").glob("*.json")}


def wait_for(what: Any, seconds: float = 300.0) -> Any:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if found := what():
            return found
        time.sleep(0.01)
    raise AssertionError("it did not come")


def in_mid_run(out: Path) -> list[int]:
    """Processes that solve, and have left a checkpoint."""
    found = []
    for lock in (out / "runs").glob("*/fecontact.lock"):
        with contextlib.suppress(OSError, ValueError):
            if (lock.parent / "checkpoint.bin").is_file():
                found.append(int(json.loads(lock.read_text())["process"]))
    return found


def lives(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def below(process: int) -> list[int]:
    """Processes that it has begun, and those that they have."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            if int(stat.read_text().rpartition(")")[2].split()[1]) == process:
                found += [int(stat.parent.name), *below(int(stat.parent.name))]
    return found


def same_as_alone(out: Path, case: fc.Case, table: pd.DataFrame, row: int, folder: Path) -> None:
    """A run of a study, to the bit what the case gives by itself."""
    alone = case.replace({MU_S: float(table[MU_S][row])}).run(folder, threads=1, progress=False)
    for name in ("history.csv", "newton.csv"):
        assert (out / "runs" / table["run"][row] / name).read_bytes() == (alone.folder / name).read_bytes()


def test_samplers() -> None:
    table = studies.latin_hypercube({"a": (1.0, 2.0), "b": (1e-3, 10.0)}, 8, log=["b"])
    # One point in every eighth of every range, the second in decades.
    assert sorted((8 * (table["a"] - 1)).astype(int)) == list(range(8))
    assert sorted((8 * np.log10(table["b"] / 1e-3) / 4).astype(int)) == list(range(8))
    assert studies.latin_hypercube({"a": (1.0, 2.0)}, 8, seed=1)["a"].tolist() != table["a"].tolist()
    halves = studies.sobol({"a": (0.0, 1.0), "b": (0.0, 1.0)}, 16)
    assert ((halves < 0.5).sum() == 8).all() and len(studies.sobol({"a": (0, 1)}, 8)) == 8
    assert len(studies.grid({"a": [1, 2, 3], "b": ["x", [1]]})) == 6
    with pytest.raises(ValueError, match="b: the range .* must be positive"):
        studies.sobol({"b": (0.0, 1.0)}, 4, log=["b"])


def test_a_study_is_a_table_and_does_only_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case, out, told = slider(1.0), tmp_path / "study", tmp_path / "measured"
    monkeypatch.setenv("MEASURED", str(told))
    rows = pd.DataFrame({MU_S: [0.4, 0.5, 0.4, 0.1, -1.0], "steps[0].dt.max": [0.0157, 0.0157, 0.0157, 0.0157, "long"]})
    with pytest.warns(fc.RunWarning, match=r"of 5 rows 2 refused; row 3 refused: case: contacts\.base\.friction: .*mu_k"):
        table = studies.study(case, rows, peak, out, progress=False)
    assert table["status"].tolist() == ["completed"] * 3 + ["refused"] * 2
    assert "mu_k" in table["reason"][3] and "dt.max" in table["reason"][4] and table["run"][4] == ""
    # Equal cases are one run.
    assert table["run"][0] == table["run"][2] and len(told.read_text().split()) == 2 and len(records(out)) == 3
    same_as_alone(out, case, table, 1, tmp_path / "alone")
    expected = fc.Result.open(tmp_path / "alone").history["base.tangential_force"].abs().max()
    assert table["peak"][1] == expected and np.isnan(table["peak"][3])
    written = fc.Result(out)._table("table.csv")
    assert written["peak"].tolist()[:3] == table["peak"].tolist()[:3] and written["status"].tolist() == table["status"].tolist()
    with contextlib.suppress(ImportError):
        import pyarrow  # noqa: F401

        assert pd.read_parquet(out / "table.parquet")["peak"][1] == expected
    # Started again with one more: the others are not run again, and measured anew.
    stamps = {file: file.stat().st_mtime_ns for file in (out / "runs").glob("*/history.csv")}
    with pytest.warns(fc.RunWarning, match="of 3 rows 3 unmeasured; row 0 unmeasured: measure: ArithmeticError"):
        more = studies.study(case, {MU_S: [0.4, 0.5, 0.6]}, fails, out, progress=False)
    assert more["status"].tolist() == ["unmeasured"] * 3 and "ArithmeticError: no number" in more["reason"][2]
    assert {file: file.stat().st_mtime_ns for file in stamps} == stamps and len(records(out)) == 4


def test_runs_that_have_ended_are_not_begun_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "runs").mkdir()
    case = slider(0.2)
    for variant, status in ((case, "completed"), (case.replace({MU_S: 0.01}), "refused")):
        task = Task(variant, variant.digest, str(tmp_path / "runs"), 1, "first")
        first, written = perform(task, None), task.file.read_text()
        assert first["status"] == status, first
        # Nothing is written either: the seconds are those of the run.
        with monkeypatch.context() as still:
            still.setattr(_study_run.Task, "write", lambda *_: pytest.fail("it wrote"))
            assert perform(task, None) == first == json.loads(written)


def test_what_no_study_can_be(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="status is not a place"):
        studies.study(slider(), {"status": [1]}, out=tmp_path)
    with pytest.warns(fc.RunWarning, match="1 unmeasured"):
        table = studies.study(slider(0.1), {MU_S: [0.4]}, named_as_parameter, tmp_path, workers=1, progress=False)
    assert table["status"].tolist() == ["unmeasured"] and "the name of another column" in table["reason"][0]


@pytest.mark.parametrize("place", ["contacts.bse.friction.mu_s", "contacts.base.friction.mu_ss"])
def test_a_place_that_no_case_has_is_refused_at_once(tmp_path: Path, place: str) -> None:
    with pytest.raises(fc.CaseError, match=f"^case: contacts.*did you mean `{'base' if 'bse' in place else 'mu_s'}`"):
        studies.study(slider(0.1), {place: [0.4, 0.5]}, None, tmp_path, workers=1, progress=False)
    # Wrong in all rows, found when they run.
    with pytest.raises(fc.CaseError, match="^case: contacts.base.friction: .*mu_k") as refused:
        studies.study(slider(0.1), {MU_S: [0.01, 0.02]}, None, tmp_path, workers=1, progress=False)
    assert refused.value.file == "case" and refused.value.place == "contacts.base.friction"


def several(result: fc.Result) -> dict[str, Any]:
    return {"a": 1.0, "b": None}


def nothing(result: fc.Result) -> None:
    pass


def column(result: fc.Result) -> dict[str, Any]:
    return {"force": result.history["base.normal_force"]}


def test_measures_that_are_none(tmp_path: Path) -> None:
    def measured(measure: Any) -> pd.Series:
        return studies.study(slider(0.1), {MU_S: [0.4]}, measure, tmp_path, workers=1, progress=False).iloc[0]

    kept = measured(several)
    assert kept["status"] == "completed" and kept["a"] == 1.0 and np.isnan(kept["b"])
    for measure, words in ((nothing, "it returned nothing"), (column, r"force is a Series of shape \(\d+,\): a measure is")):
        with pytest.warns(fc.RunWarning, match=words):
            assert len(measured(measure)["reason"]) < 200
    with pytest.warns(fc.RunWarning, match="no number"):
        line = next(k for k, text in enumerate(Path(__file__).read_text().splitlines(), 1) if '("no number")' in text)
        assert measured(fails)["reason"] == f"measure: ArithmeticError: no number ({__file__}:{line})"


@pytest.mark.parametrize("value", [0.4, "text", {"initial": 1}])
def test_a_value_that_is_no_list(tmp_path: Path, value: Any) -> None:
    with pytest.raises(TypeError, match=r"contacts\.base\.friction\.mu_s: is .*: give a list of values, such as \["):
        studies.study(slider(0.1), {MU_S: value}, None, tmp_path, progress=False)


def named_as_parameter(result: fc.Result) -> dict[str, float]:
    return {"seconds": 1.0}


def test_a_run_that_kills_its_workers_is_lost(tmp_path: Path) -> None:
    case = slider(0.5)
    task = Task(case, case.digest, str(tmp_path), 1, "token")
    begun = {"status": "begun", "study": "token", "deaths": 2, "checkpoint": None}
    task.write(begun)
    assert perform(task, None)["status"] == "lost" and not task.folder.exists()
    # Not those of another start of the study, and not where a checkpoint shows that it came further.
    for other in ({"study": "before"}, {"checkpoint": 1}):
        task.write({**begun, **other})
        assert perform(task, None)["status"] == "completed"


def test_the_lock_of_a_worker_killed_on_another_computer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_study_run, "DEAD", 1.5)
    case = slider(0.1)
    task = Task(case, case.digest, str(tmp_path), 1, "token")
    task.folder.mkdir()
    lock = task.folder / "fecontact.lock"
    lock.write_text(json.dumps({"process": 1, "computer": "elsewhere", "since": 0}))
    started = time.monotonic()
    assert perform(task, None)["status"] == "completed" and not lock.exists()
    assert time.monotonic() - started > 1.5
    # While the study ends, nobody waits.
    task.file.unlink()
    (task.folder / "summary.json").unlink()
    lock.write_text(json.dumps({"process": 1, "computer": "elsewhere", "since": 0}))
    assert perform(task, None, lambda: True)["status"] == "interrupted" and lock.exists()


def test_workers_killed_in_mid_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    case, out, told = slider(), tmp_path / "study", tmp_path / "measured"
    monkeypatch.setenv("MEASURED", str(told))
    killed: list[int] = []

    def kill() -> None:
        for _ in range(2):
            process = wait_for(lambda: [one for one in in_mid_run(out) if one not in killed])[0]
            os.kill(process, signal.SIGKILL)
            killed.append(process)

    killer = threading.Thread(target=kill)
    killer.start()
    table = studies.study(case, {MU_S: [0.4, 0.5, 0.6]}, peak, out, workers=2, progress=False)
    killer.join()
    check_after_kills(case, out, table, told, killed, tmp_path)


def check_after_kills(case: fc.Case, out: Path, table: pd.DataFrame, told: Path, killed: list[int], folder: Path) -> None:
    assert table["status"].tolist() == ["completed"] * len(table), table["reason"].tolist()
    assert len(killed) == 2 and not any(map(lives, killed)) and not in_mid_run(out)
    # Nothing twice, and what was cut off went on from its checkpoint, to the bits of a run in one go.
    assert sorted(told.read_text().split()) == sorted(table["run"])
    resumed = [k for k in range(len(table)) if records(out)[table["run"][k]]["resumed"]]
    assert resumed
    same_as_alone(out, case, table, resumed[0], folder / "alone")


def script(out: Path, **options: Any) -> subprocess.Popen[str]:
    """A study in a process of its own."""
    text = (
        f"import sys; sys.path.insert(0, {str(HERE)!r})\nfrom test_studies import *\n"
        f"if __name__ == '__main__':\n    studies.study(slider(), {{MU_S: [0.4, 0.5]}}, peak, {str(out)!r}, workers=2, progress=False)\n"
    )
    file = out.parent / "script.py"
    file.write_text(text)
    return subprocess.Popen([sys.executable, str(file)], stderr=subprocess.PIPE, text=True, **options)


@pytest.mark.parametrize("by", [signal.SIGKILL, signal.SIGINT])
def test_a_study_that_ends_leaves_no_solver_and_goes_on(tmp_path: Path, by: signal.Signals) -> None:
    out = tmp_path / "study"
    started = script(out)
    solving = wait_for(lambda: in_mid_run(out))
    begun = below(started.pid)
    assert set(solving) <= set(begun) and len(begun) >= 2
    os.kill(started.pid, by)
    errors = started.communicate(timeout=300)[1]
    assert ("KeyboardInterrupt" in errors) == (by == signal.SIGINT)
    wait_for(lambda: not any(map(lives, begun)))
    if by == signal.SIGINT:
        written = pd.read_csv(out / "table.csv")["status"]
        assert set(written) <= {"pending", "completed"} and "pending" in set(written)
    table = studies.study(slider(), {MU_S: [0.4, 0.5]}, peak, out, workers=2, progress=False)
    assert set(table["status"]) == {"completed"} and any(record["resumed"] for record in records(out).values())
    same_as_alone(out, slider(), table, 1, tmp_path / "alone")


def test_runs_write_fields_only_where_the_case_asks_for_them(tmp_path: Path) -> None:
    for output, written in [({}, False), ({"fields": True}, True), ({"every": 10}, True)]:
        case, out = slider(1.0).replace({"output": output}), tmp_path / f"{len(output)}{written}{'every' in output}"
        table = studies.study(case, {MU_S: [0.5]}, peak, out, progress=False)
        assert (out / "runs" / table["run"][0] / "contact.pvd").is_file() == written
        same_as_alone(out, case, table, 0, out / "alone")
        assert (out / "alone" / "contact.pvd").is_file()


def test_workers_that_cannot_begin(tmp_path: Path) -> None:
    file = tmp_path / "script.py"
    file.write_text(
        f"import sys; sys.path.insert(0, {str(HERE)!r})\nfrom test_studies import *\n"
        f"studies.study(slider(), {{MU_S: [0.4]}}, None, {str(tmp_path / 'study')!r}, workers=1, progress=False)\n"
    )
    told = subprocess.run([sys.executable, str(file)], capture_output=True, text=True, timeout=300)
    assert told.returncode == 1 and "if __name__ == '__main__'" in told.stderr


@contextlib.contextmanager
def cluster(folder: Path, *arguments: str, measured: Path | None = None) -> Iterator[str]:
    """A scheduler and two workers of Dask, processes of this computer."""
    file, processes = folder / "scheduler.json", []
    path = os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, "PYTHONPATH": path, **({"MEASURED": str(measured)} if measured else {})}

    def start(name: str, *options: str) -> None:
        command = [sys.executable, "-m", f"distributed.cli.{name}", "--scheduler-file", str(file), "--no-dashboard"]
        command += ["--host", "127.0.0.1", *options]
        processes.append(subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    try:
        start("dask_scheduler", "--port", "0")
        for _ in range(2):
            start("dask_worker", "--nthreads", "1", "--nanny", "--local-directory", str(folder), "--death-timeout", "300", *arguments)
        wait_for(file.is_file)
        yield str(file)
    finally:
        for process in reversed(processes):
            process.terminate()
        for process in processes:
            # A worker whose scheduler went first waits for it.
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(20)
            process.kill()
            process.wait()


def test_dask_workers_killed_in_mid_run(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    case, out, told = slider(), tmp_path / "study", tmp_path / "measured"
    killed: list[int] = []

    def kill() -> None:
        for _ in range(2):
            process = wait_for(lambda: [one for one in in_mid_run(out) if one not in killed])[0]
            os.kill(process, signal.SIGKILL)
            killed.append(process)

    resources = ("--resources", "threads=2,memory=1e9")
    with cluster(tmp_path, *resources, measured=told) as file, distributed.Client(scheduler_file=file) as client:
        client.wait_for_workers(2, timeout=300)
        with pytest.raises(ValueError, match='no worker declares .* --resources "threads=3"'):
            studies.study(case, {MU_S: [0.4]}, peak, out, threads=3, client=client, progress=False)
        killer = threading.Thread(target=kill)
        killer.start()
        table = studies.study(case, {MU_S: [0.4, 0.45, 0.5, 0.6]}, peak, out, memory=6e8, client=client, progress=False)
        killer.join()
    check_after_kills(case, out, table, told, killed, tmp_path)


def test_seeds_of_a_random_interface_are_an_ensemble(document: dict[str, Any], tmp_path: Path) -> None:
    field = {"seed": 0, "mean": 0.4, "deviation": 0.04, "correlation": 0.3}
    document["contacts"]["base"]["along"] = {"mu_s": {"random": field}}
    place = "contacts.base.along.mu_s.random.seed"
    table = fc.study(fc.Case(document), {place: [1, 2, 3]}, peak, tmp_path, progress=False)
    assert list(table["status"]) == ["completed"] * 3 and table["peak"].nunique() == 3
    again = fc.Case(document).replace({place: 2}).run(progress=False)
    assert peak(again)["peak"] == table["peak"][1]
