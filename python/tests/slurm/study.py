"""A study on the workers of a Slurm cluster: ``python study.py [folder]``, where ``sbatch`` is at hand."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from pathlib import Path
from typing import Any

import fecontact as fc

CASES = Path(__file__).resolve().parents[3] / "cases"


def peak(result: fc.Result) -> float:
    """Largest friction force."""
    return float(result.history["base.tangential_force"].abs().max())


def kill_one(out: Path) -> None:
    """Kill the first worker that is seen in the middle of a run."""
    while True:
        for lock in (out / "runs").glob("*/fecontact.lock"):
            try:
                process = json.loads(lock.read_text())["process"]
            except (OSError, ValueError):
                continue
            if (lock.parent / "checkpoint.bin").is_file():
                print(f"killed: worker {process} in run {lock.parent.name}", flush=True)
                os.kill(process, signal.SIGKILL)
                return
        time.sleep(0.01)


def main(folder: str = "slurm_study") -> None:
    from dask_jobqueue import SLURMCluster
    from distributed import Client

    out = Path(folder).resolve()
    document: dict[str, Any] = json.loads((CASES / "paper" / "spring_mass_1.json").read_text())
    document["steps"][0]["duration"] = 20
    document["output"] = {"fields": False, "checkpoint": 0.002}
    cluster = SLURMCluster(
        cores=1,
        processes=1,
        memory="1GB",
        walltime="00:10:00",
        interface="lo",
        python=sys.executable,
        log_directory=str(out / "log"),
        local_directory=str(out / "dask"),
        worker_extra_args=["--resources", "memory=1e9"],
        scheduler_options={"dashboard_address": None},
    )
    with cluster, Client(cluster) as client:
        cluster.scale(jobs=2)
        client.wait_for_workers(2, timeout=60)
        os.system("squeue --format='%.6i %.12j %.2t %.8M'")
        threading.Thread(target=kill_one, args=(out,), daemon=True).start()
        values = {"steps[0].loads[1].spring.kx": [6, 7, 8, 9, 10, 11, 12, 13]}
        started = time.monotonic()
        table = fc.study(fc.Case(document), values, peak, out, memory=5e8, client=client, progress=False)
        print(f"{len(table)} runs in {time.monotonic() - started:.1f} s")
    print(table[["steps[0].loads[1].spring.kx", "run", "status", "peak"]].to_string())
    resumed = [run for run in table["run"] if json.loads((out / "runs" / f"{run}.json").read_text())["resumed"]]
    print("went on from a checkpoint:", *resumed)
    assert set(table["status"]) == {"completed"} and resumed


if __name__ == "__main__":
    main(*sys.argv[1:])
