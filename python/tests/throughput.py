"""What a study costs beside its runs: 1000 spring–sliders on two workers, against the same runs called one after another by two
processes that do nothing else; not a test.

python python/tests/throughput.py [runs] [workers]
"""

from __future__ import annotations

import json
import multiprocessing
import sys
import tempfile
import time
from pathlib import Path

import fecontact as fc

CASE = Path(__file__).resolve().parents[2] / "cases" / "paper" / "spring_mass_3.json"
PLACE = "contacts.base.friction.xi"


def slider() -> fc.Case:
    """Some periods of stick and slip."""
    given = json.loads(CASE.read_text())
    given["steps"][0]["duration"] = 300.0
    return fc.Case(given)


def values(runs: int) -> list[float]:
    """A value a run."""
    return [0.002 * (1 + 0.1 * k / runs) for k in range(runs)]


def plain(own: list[float], folder: str, number: int) -> None:
    """Runs, one after another."""
    case = slider()
    for k, value in enumerate(own):
        case.replace({PLACE: value}).run(f"{folder}/{number}_{k}", threads=1, progress=False)


def main(runs: int, workers: int) -> None:
    """Both, in turn."""
    print(f"{runs} runs on {workers} workers")
    with tempfile.TemporaryDirectory() as folder:
        context = multiprocessing.get_context("spawn")
        given = values(runs)
        started = time.monotonic()
        processes = [context.Process(target=plain, args=(given[k::workers], folder, k)) for k in range(workers)]
        for process in processes:
            process.start()
        for process in processes:
            process.join()
        ideal = time.monotonic() - started
    with tempfile.TemporaryDirectory() as folder:
        started = time.monotonic()
        table = fc.study(slider(), {PLACE: given}, out=folder, workers=workers, progress=False)
        took = time.monotonic() - started
    assert (table["status"] == "completed").all()
    beyond = (took - ideal) * workers / runs
    print(f"plain {ideal:.2f} s, study {took:.2f} s: {ideal / took:.1%} of the throughput, {beyond * 1e3:.2f} ms a task beyond its run")


if __name__ == "__main__":
    main(int((sys.argv[1:] or ["1000"])[0]), int((sys.argv[2:] or ["2"])[0]))
