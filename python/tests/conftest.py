"""What the tests share: a small case, and the program to compare with."""

from __future__ import annotations

import copy
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest

import fecontact as fc

matplotlib.use("Agg")
REPOSITORY = Path(__file__).resolve().parents[2]


def rectangle(low: tuple[float, float], high: tuple[float, float], divisions: tuple[int, int], first: int) -> Any:
    """Nodes, quadrilaterals and sides of a rectangle; nodes are numbered from ``first`` on."""
    n, m = divisions
    x, y = np.meshgrid(np.linspace(low[0], high[0], n + 1), np.linspace(low[1], high[1], m + 1))
    number = first + np.arange((n + 1) * (m + 1)).reshape(m + 1, n + 1)
    corners = (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1])
    elements = np.stack([corner.ravel() for corner in corners], axis=1)
    lines = {"bottom": number[0], "right": number[:, -1], "top": number[-1], "left": number[:, 0]}
    sides = {name: np.stack([line[:-1], line[1:]], axis=1) for name, line in lines.items()}
    return np.stack([x.ravel(), y.ravel()], axis=1), elements, sides


def squares(prefix: str, low: tuple[float, float], high: tuple[float, float], divisions: tuple[int, int], first: int) -> Any:
    nodes, elements, sides = rectangle(low, high, divisions, first)
    return nodes, {prefix: elements}, {f"{prefix}_{side}": lines for side, lines in sides.items()}


def inline() -> dict[str, Any]:
    """A block of 5 × 3 on ground of 12 × 3 elements, as a case file has it."""
    ground = squares("ground", (0.0, -0.5), (3.0, 0.0), (12, 3), 0)
    block = squares("block", (0.4, 0.01), (1.4, 0.51), (5, 3), len(ground[0]))
    lists = lambda part: {name: array.tolist() for name, array in part.items()}  # noqa: E731
    return {
        "nodes": np.concatenate([ground[0], block[0]]).tolist(),
        "elements": lists({**ground[1], **block[1]}),
        "edges": lists({**ground[2], **block[2]}),
    }


DOCUMENT: dict[str, Any] = {
    "title": "test",
    "units": {"length": "mm", "time": "s", "force": "N"},
    "mesh": inline(),
    "bodies": {name: {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1e-4}} for name in ("ground", "block")},
    "contacts": {
        "base": {
            "slave": "block_bottom",
            "master": "ground_top",
            "friction": {
                "law": "super_subloading",
                "mu_s": 0.4,
                "mu_k": 0.2,
                "alpha_t": 2e3,
                "r": 100,
                "kappa": 10,
                "xi": 0.002,
            },
        }
    },
    "steps": [
        {
            "name": "press",
            "duration": 1,
            "dt": {"initial": 0.5, "min": 1e-4},
            "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}],
        },
        {
            "name": "drag",
            "duration": 4,
            "dt": {"initial": 0.25, "min": 1e-4},
            "supports": [{"on": "block_top", "ux": {"rate": 0.1}}],
        },
    ],
    "watch": ["block_top"],
    "probes": {"gauge": {"at": [0.9, 0.2]}},
    "output": {"fronts": {"slip_rate": 0.01}, "points": True},
}


@pytest.fixture
def document() -> dict[str, Any]:
    return copy.deepcopy(DOCUMENT)


@pytest.fixture(scope="session")
def result(tmp_path_factory: pytest.TempPathFactory) -> fc.Result:
    """Results of the small case, in a folder."""
    return fc.Case(DOCUMENT).run(tmp_path_factory.mktemp("run") / "out", progress=False)


@pytest.fixture(scope="session")
def program() -> Path:
    """The command line: $FECONTACT, or what ``cargo build --release`` has made."""
    given = os.environ.get("FECONTACT")
    path = Path(given) if given else REPOSITORY / "target" / "release" / "fecontact"
    if not path.is_file():
        pytest.fail(f"{path}: there is no program to compare with; cargo build --release, or set FECONTACT")
    return path


def command(program: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True, timeout=300)


def python(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=300, **options)
