"""Who does the runs of a study: processes of this computer, or the workers of a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from ._study_run import Measure, Record, Task, perform

# Times that workers may die on a run that does not even begin, or on its measures, before it is lost.
GIVEN_UP = 10
LOST: Record = {"status": "lost", "reason": f"its worker died {GIVEN_UP} times"}
# Times that a worker may die before it begins a first run.
UNBORN = 3

# Of a worker process: what to measure, and whether the study was interrupted.
_measure: Measure | None = None
_halt = threading.Event()


def _initialize(measure: bytes, parent: Any) -> None:
    """Begin as a worker: it ends with its parent, also where that is killed in the middle of a run."""
    global _measure
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        try:
            parent.recv()
            _halt.set()
            parent.recv()
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
    _measure = pickle.loads(measure)


def _perform(task: Task) -> Record:
    return perform(task, _measure, _halt.is_set)


def _pickled(measure: Measure | None) -> bytes:
    """The measure for other processes; by value where cloudpickle is there, so that those of a notebook do as well."""
    try:
        import cloudpickle
    except ImportError:
        try:
            return pickle.dumps(measure)
        except Exception as error:
            raise TypeError(f"measure: {error}: give a function of a module, or pip install cloudpickle") from None
    return bytes(cloudpickle.dumps(measure))


class _Slot:
    """One worker process, begun anew when it dies."""

    def __init__(self, measure: bytes) -> None:
        self._measure = measure
        # Times that it died before it began a first run.
        self.unborn = 0
        self._begin()

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.is_new = True
        reader, self._writer = context.Pipe(duplex=False)
        self._pool = ProcessPoolExecutor(1, context, _initialize, (self._measure, reader))

    def submit(self, task: Task) -> Future[Record]:
        return self._pool.submit(_perform, task)

    def renew(self) -> None:
        self.end()
        self._begin()

    def halt(self) -> None:
        try:
            self._writer.send(None)
        except OSError:
            pass  # It has died already.

    def end(self) -> None:
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._writer.close()


def local(tasks: list[Task], measure: Measure | None, workers: int) -> Generator[tuple[Task, Record], None, None]:
    """Do tasks in processes of this computer; tells each as it ends."""
    # As Python does; libraries such as gmsh undo it, and a worker that is killed would take this process along by its pipe.
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    sent = _pickled(measure)
    left = list(reversed(tasks))
    slots = [_Slot(sent) for _ in range(min(workers, len(tasks)))]
    at_work: dict[Future[Record], tuple[_Slot, Task]] = {}
    deaths: dict[str, int] = {}
    try:
        for slot in slots:
            task = left.pop()
            at_work[slot.submit(task)] = (slot, task)
        while at_work:
            for future in wait(at_work, return_when=FIRST_COMPLETED).done:
                slot, task = at_work.pop(future)
                try:
                    record: Record | None = future.result()
                    slot.is_new = False
                except BrokenProcessPool:
                    deaths[task.digest] = deaths.get(task.digest, 0) + 1
                    record = LOST if deaths[task.digest] == GIVEN_UP else None
                    _look(slot, task)
                    slot.renew()
                following = task if record is None else left.pop() if left else None
                if following is not None:
                    at_work[slot.submit(following)] = (slot, following)
                if record is not None:
                    yield task, record
    except BaseException:
        for slot in slots:
            slot.halt()
        raise
    finally:
        for slot in slots:
            slot.end()


def _look(slot: _Slot, task: Task) -> None:
    """A worker that dies before it begins a first run, again and again, will not do better."""
    slot.unborn = slot.unborn + 1 if slot.is_new and task.record().get("study") != task.study else 0
    if slot.unborn == UNBORN:
        raise RuntimeError(
            "a worker of the study cannot begin (what it says stands above): a script calls study() under "
            "`if __name__ == '__main__':`, and the measure must be importable"
        )


def dask(
    tasks: list[Task], measure: Measure | None, client: Any, resources: Mapping[str, float]
) -> Generator[tuple[Task, Record], None, None]:
    """Do tasks on the cluster of a client; tells each as it ends."""
    import distributed

    _check_resources(client.scheduler_info(n_workers=-1)["workers"].values(), resources)
    of, given_up = {}, dict.fromkeys((task.digest for task in tasks), 0)

    def submit(task: Task) -> Any:
        key = f"fecontact-{task.digest}-{task.study}-{given_up[task.digest]}"
        future = client.submit(perform, task, measure, key=key, pure=False, resources=dict(resources) or None)
        of[future] = task
        return future

    completed: Any = distributed.as_completed
    under_way = completed(submit(task) for task in tasks)
    try:
        for future in under_way:
            task = of.pop(future)
            error = future.exception()
            if error is None:
                yield task, future.result()
            elif isinstance(error, distributed.KilledWorker) and given_up[task.digest] < GIVEN_UP:
                # The scheduler blames all runs of a worker that dies; their records tell which of them it was.
                given_up[task.digest] += 1
                under_way.add(submit(task))
            else:
                yield task, {"status": "failed", "reason": f"{type(error).__name__}: {error}"}
    except BaseException:
        Path(tasks[0].runs, f"halt-{tasks[0].study}").touch()
        client.cancel(list(of), force=True)
        raise


def _check_resources(workers: Iterable[Mapping[str, Any]], wanted: Mapping[str, float]) -> None:
    """Refuse what no worker will ever do; those of a cluster that is empty yet are not known."""
    declared = [worker.get("resources", {}) for worker in workers]
    able: Callable[[Mapping[str, float]], bool] = lambda has: all(has.get(name, 0.0) >= much for name, much in wanted.items())  # noqa: E731
    if declared and not any(able(has) for has in declared):
        asked = ",".join(f"{name}={much:g}" for name, much in wanted.items())
        raise ValueError(f"no worker declares what a run needs: start them with --resources \"{asked}\", or more of each")
