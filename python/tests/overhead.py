"""What Python costs: processor time of a case on the command line, from Python, and iterated; not a test.

python python/tests/overhead.py [case] [rounds]
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
RUN = "import sys, fecontact as fc; fc.Case(sys.argv[1]).run(sys.argv[2], progress=False, report=True)"
ITERATE = (
    "import sys, fecontact as fc\n"
    "for increment in fc.Simulation(fc.Case(sys.argv[1])): increment.displacement.max(); increment.velocity.max()"
)


def seconds(*command: str) -> float:
    """Processor time of a child."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(case: str, rounds: int) -> None:
    """The least of some rounds, back to back."""
    program = os.environ.get("FECONTACT", str(REPOSITORY / "target" / "release" / "fecontact"))
    imports = [sys.executable, "-c", "import fecontact"]
    kinds: dict[str, list[float]] = {"command line": [], "import": [], "Case.run": [], "Simulation": []}
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            kinds["command line"].append(seconds(program, "run", case, "--out", f"{folder}/a", "--quiet"))
            kinds["import"].append(seconds(*imports))
            kinds["Case.run"].append(seconds(sys.executable, "-c", RUN, case, f"{folder}/b"))
            kinds["Simulation"].append(seconds(sys.executable, "-c", ITERATE, case))
    line, start = min(kinds["command line"]), min(kinds["import"])
    for kind, times in kinds.items():
        own = min(times) - (start if kind in ("Case.run", "Simulation") else 0.0)
        print(f"{kind:14} {min(times):8.2f} s   without import {own:8.2f} s   to the command line {own / line:.3f}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else str(REPOSITORY / "cases" / "coulomb_drag_20k.json"), int((sys.argv[2:] or ["3"])[0]))
