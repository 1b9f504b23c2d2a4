"""One run of a study, as a worker does it: where it was left, into its own folder, with a record beside it.

``runs/<digest>/`` is the folder of results, ``runs/<digest>.json`` the record: begun, or how it ended. The record is touched while
the run is under way, which is its sign of life.
"""

from __future__ import annotations

import json
import os
import time
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import _native
from .case import Case
from .errors import CaseError
from .result import Result

# Statuses that a run started again keeps.
DONE = ("completed", "refused", "stopped")
# Starts of a run that die without having come to a new checkpoint, until it is given up.
DEATHS = 3
# Between two signs of life, and without one until a run of another computer counts as dead [s].
SIGN, DEAD = 5.0, 60.0
# What the solver leaves in a folder that it writes into.
LOCK = "fecontact.lock"
CHECKPOINTS = ("checkpoint.bin", "checkpoint_prev.bin")

Record = dict[str, Any]
Measure = Callable[[Result], "float | Mapping[str, float | str | None]"]


class Halted(Exception):
    """The study was interrupted."""


@dataclass(frozen=True)
class Task:
    """A run: its case, its folder, and what to measure."""

    case: Case
    digest: str
    runs: str
    threads: int
    # A name of this start of the study.
    study: str
    retry: bool = False

    @property
    def folder(self) -> Path:
        """Folder of its results."""
        return Path(self.runs, self.digest)

    @property
    def file(self) -> Path:
        """Its record."""
        return Path(self.runs, f"{self.digest}.json")

    def record(self) -> Record:
        """What is known of it; nothing where nothing is, or where a crash left half a file."""
        try:
            known = json.loads(self.file.read_text())
        except (FileNotFoundError, json.JSONDecodeError):
            return {}
        return known if isinstance(known, dict) else {}

    def write(self, record: Record) -> Record:
        """Keep a record: whole, or not at all."""
        replace_file(self.file, json.dumps(record))
        return record

    def is_done(self, record: Record) -> bool:
        """Whether nothing is left to run."""
        kept = record.get("status") in DONE and not (self.retry and record["status"] == "stopped")
        return kept and (record["status"] == "refused" or (self.folder / "summary.json").is_file())


def replace_file(path: Path, text: str) -> None:
    """Write a file: whole, or not at all."""
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.write_text(text)
    os.replace(part, path)


def perform(task: Task, measure: Measure | None, halted: Callable[[], bool] | None = None) -> Record:
    """Run what is left of a task, and measure it. Never raises: what went wrong is in the record."""
    try:
        record = _ended(task, halted or _halt_file(task))
        if record["status"] != "completed" or measure is None:
            return record
        try:
            return {**record, "measures": _measures(measure, Result(task.folder))}
        except Exception as error:
            return {**record, "status": "unmeasured", "reason": f"measure: {_told(error)}{_where(measure, error)}"}
    except Halted:
        return {"status": "interrupted", "reason": "the study was interrupted"}
    except Exception as error:
        return {"status": "failed", "reason": _told(error)}


def _ended(task: Task, halted: Callable[[], bool]) -> Record:
    """The record of a run that has ended, now or before."""
    resume = True
    while True:
        record = task.record()
        if task.is_done(record):
            return record
        if (task.folder / "summary.json").is_file() and Result(task.folder).status == "completed":
            # Its worker died between the end of the run and its record.
            return task.write({**_record("completed", task), "resumed": True})
        begun = _begun(task, record)
        if begun["deaths"] >= DEATHS:
            reason = f"its worker died {DEATHS} times during the run: out of memory? (memory=, fewer workers)"
            return task.write(_record("lost", None, reason))
        task.write(begun)
        started = time.monotonic()
        try:
            goes_on = resume and any((task.folder / name).is_file() for name in CHECKPOINTS)
            status, why, raised = _run(task, halted, goes_on)
        except CaseError as error:
            if error.file:
                refused = _record("refused", None, refusal(error), time.monotonic() - started)
                return task.write({**refused, "place": error.place})
            if (task.folder / LOCK).is_file():
                _wait(task, halted)
            elif resume:
                # A checkpoint that nothing can go on from.
                resume = False
            else:
                raise RuntimeError(str(error)) from error
            continue
        if isinstance(raised, Halted):
            raise raised
        if status not in ("stopped", "defect") and raised is not None:
            status, why = "failed", _told(raised)
        return task.write({**_record(status, task, why or "", time.monotonic() - started), "resumed": goes_on})


def _begun(task: Task, record: Record) -> Record:
    """The record of a run that begins, counting the starts of this study that died without progress."""
    checkpoint = _stamp(task.folder / "checkpoint.bin")
    again = record.get("status") == "begun" and record.get("study") == task.study
    deaths = record["deaths"] + 1 if again and record["checkpoint"] == checkpoint else 0
    return {**_record("begun", None), "study": task.study, "deaths": deaths, "checkpoint": checkpoint}


def _stamp(path: Path) -> int | None:
    try:
        return path.stat().st_mtime_ns
    except FileNotFoundError:
        return None


def _record(status: str, task: Task | None, reason: str = "", seconds: float = 0.0) -> Record:
    """A record, with the warnings that the run of a task has left."""
    warnings = Result(task.folder).warnings if task and (task.folder / "summary.json").is_file() else []
    return {"status": status, "reason": reason, "seconds": seconds, "warnings": "; ".join(warnings), "measures": {}}


def _run(task: Task, halted: Callable[[], bool], resume: bool) -> tuple[str, str | None, BaseException | None]:
    last = [time.monotonic()]

    def poll(messages: list[str], place: _native.Place | None) -> None:
        if time.monotonic() - last[0] > SIGN:
            last[0] = time.monotonic()
            os.utime(task.file)
        if halted():
            raise Halted

    return _native.run(lean(task.case)._native, os.fspath(task.folder), task.threads, resume, False, poll)


def lean(case: Case) -> Case:
    """The case as a study runs it: without fields, unless it asks for some."""
    output = case._document.get("output") or {}
    asked = any(key in output for key in ("fields", "every", "times", "points"))
    return case if asked else case.replace({"output": {**output, "fields": False}})


def _wait(task: Task, halted: Callable[[], bool]) -> None:
    """Wait for whoever writes into the folder of a run, such as a worker that the scheduler has lost sight of."""
    since, seen, lock = time.monotonic(), _stamp(task.file), task.folder / LOCK
    while lock.is_file():
        if halted():
            raise Halted
        time.sleep(1.0)
        if _stamp(task.file) != seen:
            since, seen = time.monotonic(), _stamp(task.file)
        elif _of_another_computer(lock):
            # One that was killed leaves a lock of which only the study can know that it is nobody's.
            if time.monotonic() - since > DEAD:
                lock.unlink(missing_ok=True)
        elif not _is_held(lock):
            return


def _is_held(lock: Path) -> bool:
    """Whether the process of this computer that wrote a lock lives."""
    try:
        os.kill(int(json.loads(lock.read_text())["process"]), 0)
    except (OSError, ValueError, KeyError):
        return False
    return True


def _of_another_computer(lock: Path) -> bool:
    import platform

    try:
        return bool(json.loads(lock.read_text())["computer"] != platform.node())
    except (OSError, ValueError, KeyError):
        return False


def _halt_file(task: Task) -> Callable[[], bool]:
    """Whether the study has ended without its workers, which look into its folder now and then."""
    last = [0.0, False]
    file = Path(task.runs, f"halt-{task.study}")

    def halted() -> bool:
        if time.monotonic() - last[0] > SIGN:
            last[:] = time.monotonic(), file.exists()
        return bool(last[1])

    return halted


def _measures(measure: Measure, result: Result) -> dict[str, float | str]:
    found = measure(result)
    if found is None:
        raise TypeError("it returned nothing: a measure is a number, or numbers and texts by name")
    named = dict(found) if isinstance(found, Mapping) else {getattr(measure, "__name__", "measure"): found}
    return {str(name): _cell(str(name), value) for name, value in named.items()}


def _cell(name: str, value: Any) -> float | str:
    if isinstance(value, str):
        return value
    if value is None:
        return float("nan")
    number = np.asarray(value)
    if number.shape != () or number.dtype.kind not in "fiub":
        of = f" of shape {number.shape}" if number.shape else ""
        raise TypeError(f"{name} is a {type(value).__name__}{of}: a measure is a number or a text")
    return number.item()  # type: ignore[no-any-return]


def refusal(error: CaseError) -> str:
    """What is wrong with a case; the path of one that is no file would name nothing."""
    text = str(error)
    return text if os.path.isfile(error.file) else text.replace(f"{error.file}: ", "case: ", 1)


def _where(measure: Measure, error: Exception) -> str:
    """The line of a measure that raised: the last in its own file, not in what it called."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != __file__]
    file = getattr(getattr(measure, "__code__", None), "co_filename", None)
    own = [frame for frame in frames if frame.filename == file] or frames
    return f" ({own[-1].filename}:{own[-1].lineno})" if own else ""


def _told(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"
