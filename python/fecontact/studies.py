"""Studies: many variants of a case, run in processes of this computer or on a cluster, with one table of results."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import time
import uuid
import warnings
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from . import _study_workers
from ._progress import is_seen
from ._study_run import Measure, Record, Task, refusal, replace_file
from .case import Case
from .errors import CaseError, RunWarning
from .mesh import Mesh

# Columns of the table besides parameters and measures.
OWN = ("run", "status", "reason", "seconds", "warnings")
# The table is written anew while runs end, at most so often [s].
EVERY = 5.0


def grid(values: Mapping[str, Iterable[Any]]) -> pd.DataFrame:
    """Every combination: ``grid({"contacts.base.friction.mu_s": [0.3, 0.4], "steps[1].duration": [1, 2]})`` has 4 rows."""
    for name, given in values.items():
        if isinstance(given, (str, Mapping)) or not isinstance(given, Iterable):
            raise TypeError(f"{name}: is {given!r}: give a list of values, such as [{given!r}]")
    rows = list(itertools.product(*(list(given) for given in values.values())))
    columns = {name: pd.Series([row[k] for row in rows]) for k, name in enumerate(values)}
    return pd.DataFrame(columns)


def latin_hypercube(ranges: Mapping[str, tuple[float, float]], n: int, *, log: Sequence[str] = (), seed: int = 0) -> pd.DataFrame:
    """``n`` points of a Latin hypercube (``scipy.stats.qmc``).

    Args:
        ranges: lowest and highest value by place.
        n: number of points.
        log: places whose logarithm is distributed uniformly.
        seed: the same seed gives the same points.
    """
    from scipy.stats import qmc

    return _scaled(qmc.LatinHypercube(len(ranges), rng=seed).random(n), ranges, log)


def sobol(ranges: Mapping[str, tuple[float, float]], n: int, *, log: Sequence[str] = (), seed: int = 0) -> pd.DataFrame:
    """``n`` points of a scrambled Sobol sequence; balanced if ``n`` is a power of 2. The arguments are those of :func:`latin_hypercube`."""
    from scipy.stats import qmc

    sampler = qmc.Sobol(len(ranges), rng=seed)
    points = sampler.random_base2(n.bit_length() - 1) if n & (n - 1) == 0 else sampler.random(n)
    return _scaled(points, ranges, log)


def _scaled(points: Any, ranges: Mapping[str, tuple[float, float]], log: Sequence[str]) -> pd.DataFrame:
    if unknown := set(log) - set(ranges):
        raise ValueError(f"log: there is no range of {', '.join(sorted(unknown))}")
    columns = {}
    for share, (name, (low, high)) in zip(points.T, ranges.items()):
        if not (np.isfinite([low, high]).all() and low <= high):
            raise ValueError(f"{name}: the range ({low}, {high}) must be finite and ascending")
        if name in log and low <= 0:
            raise ValueError(f"{name}: the range ({low}, {high}) must be positive for its logarithm")
        columns[name] = low * (high / low) ** share if name in log else low + (high - low) * share
    return pd.DataFrame(columns)


def study(
    case: Case,
    parameters: Mapping[str, Iterable[Any]] | pd.DataFrame,
    measure: Measure | None = None,
    out: str | os.PathLike[str] = "study",
    *,
    workers: int | None = None,
    threads: int = 1,
    memory: float | None = None,
    client: Any = None,
    retry: bool = False,
    progress: bool = True,
) -> pd.DataFrame:
    """Run variants of a case, and collect the results in one table.

    A run has the folder ``out/runs/<digest>``, named by the hash of its case; equal cases are run once. A restarted study
    only completes missing runs, from the checkpoints of interrupted ones, and evaluates all measures again. A run whose
    worker dies is restarted from its checkpoint (``output.checkpoint`` of the case: minutes between two); one whose worker
    dies three times without progress is ``lost``. Ctrl-C ends the study with a checkpoint of every run.

    Runs write no fields unless the case requests them: ``output.fields``, ``every``, ``times`` or ``points``.

    Args:
        case: the common part of all runs.
        parameters: values by place, such as ``{"contacts.base.friction.mu_s": [0.3, 0.4]}``: all combinations (:func:`grid`); or
            a table with one column per place and one row per run, such as that of :func:`latin_hypercube` or :func:`sobol`.
        measure: function from the :class:`~fecontact.Result` of a completed run to a number, or to numbers or texts by name; None
            is an empty cell (NaN).
        out: folder of the study; workers on other computers must see it under the same path.
        workers: number of simultaneous processes; default: as many as cores and memory permit. Not with ``client``.
        threads: number of threads of one run, without effect on the results.
        memory: memory required by one run [bytes]; limits the number of runs per computer or worker.
        client: a ``distributed.Client`` (dask-jobqueue for Slurm, PBS, LSF; Kubernetes). A task requests the resources
            ``threads`` (if more than 1) and ``memory`` (if given) from its worker: ``dask worker --resources "threads=4,memory=16e9"``.
        retry: whether stopped runs are tried again, from where they stopped.
        progress: whether a progress bar is shown, on a terminal or in a notebook.

    Returns:
        One row per row of parameters, also in ``out/table.csv`` and, with pyarrow, ``out/table.parquet``: the parameters,
        ``run`` (the digest), ``status``, ``reason``, ``seconds`` of its last start, ``warnings``, and the measures. The status is
        ``completed``; ``stopped`` (the solver gave up), ``refused`` (bad input), ``unmeasured`` (``measure`` raised), ``lost``, ``failed`` (the
        computer: a full disk), ``defect``; ``pending`` in the files of an interrupted study. Only completed runs have measures.
        A :class:`~fecontact.errors.RunWarning` reports the number of rows not completed, and the reason of the first one.

    Raises:
        CaseError: all rows are refused because of the same place, such as one that the case does not have.
        TypeError: the values of a place are not a list.
    """
    rows = parameters.reset_index(drop=True) if isinstance(parameters, pd.DataFrame) else grid(parameters)
    if taken := [name for name in rows if name in OWN]:
        raise ValueError(f"parameters: {taken[0]} is not a place in a case")
    if client is not None and workers is not None:
        raise ValueError("workers: the cluster of the client has its own")
    runs = Path(out).resolve() / "runs"
    runs.mkdir(parents=True, exist_ok=True)
    table = _Table(rows, runs.parent)
    tasks = table.tasks(case, runs, threads, retry)
    table.refuse()
    if client is None:
        done = _study_workers.local(tasks, measure, workers or _room(threads, memory))
    else:
        wanted = {**({"threads": float(threads)} if threads > 1 else {}), **({"memory": float(memory)} if memory else {})}
        done = _study_workers.dask(tasks, measure, client, wanted)
    try:
        with contextlib.closing(done):
            _follow(done, table, len(tasks), progress)
    finally:
        table.write()
    table.refuse()
    frame = table.frame()
    _warn(frame)
    return frame


def _warn(frame: pd.DataFrame) -> None:
    """Warn about rows without results."""
    without = frame[frame["status"] != "completed"]
    if without.empty:
        return
    counts = ", ".join(f"{count} {status}" for status, count in without["status"].value_counts(sort=False).items())
    first = without.iloc[0]
    text = f"study: of {len(frame)} rows {counts}; row {without.index[0]} {first['status']}: {first['reason']}"
    warnings.warn(text, RunWarning, stacklevel=3)


def _follow(done: Generator[tuple[Task, Record], None, None], table: _Table, runs: int, progress: bool) -> None:
    """Add records as they arrive."""
    from tqdm.auto import tqdm

    written = time.monotonic()
    with tqdm(total=runs, unit=" runs", disable=not (progress and runs and is_seen())) as bar:
        for task, record in done:
            table.take(task, record)
            bar.update()
            if time.monotonic() - written > EVERY:
                table.write()
                written = time.monotonic()


class _Table:
    """Parameters of all rows, with the run of each and its record."""

    def __init__(self, rows: pd.DataFrame, folder: Path) -> None:
        self._rows, self._folder = rows, folder
        self._names: list[str] = []
        self._refused: dict[int, Record] = {}
        self.records: dict[str, Record] = {}

    def tasks(self, case: Case, runs: Path, threads: int, retry: bool) -> list[Task]:
        """The runs of all rows, each once."""
        token = uuid.uuid4().hex[:12]
        found: dict[str, Task] = {}
        base = case.replace({})
        base._path = os.path.abspath(base._path)
        for k, row in enumerate(self._rows.to_dict("records")):
            try:
                variant = base.replace({str(place): value for place, value in row.items()})
                digest = variant.digest
            except CaseError as error:
                self._names.append("")
                self._refused[k] = {"status": "refused", "reason": refusal(error), "place": error.place}
                continue
            self._names.append(digest)
            found.setdefault(digest, Task(variant, digest, os.fspath(runs), threads, token, retry))
        return list(found.values())

    def refuse(self) -> None:
        """Raise if all rows are refused because of the same place."""
        records = [self.records.get(digest, {}) if digest else self._refused[k] for k, digest in enumerate(self._names)]
        places = {(record.get("status"), record.get("place")) for record in records}
        if len(places) == 1 and (place := places.pop())[0] == "refused" and place[1]:
            file, _, message = records[0]["reason"].partition(f": {place[1]}: ")
            raise CaseError(records[0]["reason"], file, place[1], message)

    def frame(self) -> pd.DataFrame:
        """The table with the known results."""
        pending: Record = {"status": "pending", "reason": "", "seconds": np.nan, "warnings": ""}
        rows = []
        for k, digest in enumerate(self._names):
            record: Record = self.records.get(digest, pending) if digest else self._refused[k]
            own = {"run": digest, **{name: record.get(name, pending[name]) for name in OWN[1:]}}
            rows.append({**own, **record.get("measures", {})})
        known = pd.DataFrame(rows, columns=None if rows else list(OWN))
        return pd.concat([self._rows.map(_shown), known], axis=1)

    def take(self, task: Task, record: Record) -> None:
        """Add the record of a run that has ended."""
        measures = record.get("measures", {}) if record["status"] == "completed" else {}
        if taken := [name for name in measures if name in OWN or name in self._rows]:
            reason = f"measure: {taken[0]} is the name of another column of the table: choose another"
            record = {**record, "status": "unmeasured", "reason": reason, "measures": {}}
        self.records[task.digest] = record

    def write(self) -> None:
        """Write ``table.csv``, and ``table.parquet`` if pyarrow is installed."""
        frame = self.frame()
        replace_file(self._folder / "table.csv", frame.to_csv(index=False))
        try:
            import pyarrow  # noqa: F401
        except ImportError:
            return
        part = self._folder / f"table.parquet.{os.getpid()}.part"
        # A column of one kind: parquet has no others.
        mixed = {name for name in frame if len({type(value) for value in frame[name]}) > 1 and frame[name].dtype == object}
        frame.astype(dict.fromkeys(mixed, str)).to_parquet(part, index=False)
        os.replace(part, self._folder / "table.parquet")


def _shown(value: Any) -> Any:
    """A parameter as a cell: a number or text, else its text form."""
    if isinstance(value, Mesh):
        return "a mesh at hand"
    if isinstance(value, (Mapping, list, tuple, np.ndarray)):
        return json.dumps(value, default=lambda array: np.asarray(array).tolist())
    return os.fspath(value) if isinstance(value, os.PathLike) else value


def _room(threads: int, memory: float | None) -> int:
    """Number of runs that this computer can do simultaneously."""
    affinity: Callable[[int], set[int]] | None = getattr(os, "sched_getaffinity", None)
    cores = len(affinity(0)) if affinity else os.cpu_count() or 1
    room = cores // threads
    if memory:
        room = min(room, int(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / memory))
    return max(room, 1)
