"""The notebooks run from nothing to their end, and the reference says what the docstrings say."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import nbformat
import pytest

from conftest import REPOSITORY

sys.path.insert(0, str(REPOSITORY / "python" / "tools"))

NOTEBOOKS = sorted((REPOSITORY / "python" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path: Path) -> None:
    """A notebook is stored with its outputs, and a run from nothing prints the same and draws as many pictures."""
    from notebooks import MOST, run, texts

    stored = nbformat.read(path, as_version=4)
    assert path.stat().st_size <= MOST
    code = [cell for cell in stored.cells if cell.cell_type == "code"]
    assert all(cell.execution_count == k for k, cell in enumerate(code, 1)), "renew it: python python/tools/notebooks.py"
    fresh = run(path)
    outputs = [output for cell in fresh.cells if cell.cell_type == "code" for output in cell.outputs]
    told = [output.text for output in outputs if output.output_type == "stream" and output.name == "stderr"]
    assert not any("Warning" in text or "Error" in text for text in told), told
    pictures = [[sum("image/png" in output.get("data", {}) for output in cell.outputs) for cell in of.cells if cell.cell_type == "code"] for of in (stored, fresh)]
    assert sum(pictures[0]) >= 2 and pictures[0] == pictures[1]
    for number, (before, now) in enumerate(zip(texts(stored), texts(fresh), strict=True), 1):
        assert len(before) == len(now), f"cell {number}: renew it: python python/tools/notebooks.py"
        assert all(same(*pair) for pair in zip(before, now)), f"cell {number} printed\n{now}\nand not\n{before}\nrenew it: python python/tools/notebooks.py"


NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


def same(before: str, now: str) -> bool:
    """Whether two texts agree: words to the letter, numbers within a thousandth, as they are on other computers."""
    words = [NUMBER.sub("#", text).split() for text in (before, now)]
    numbers = [[float(number) for number in NUMBER.findall(text)] for text in (before, now)]
    return words[0] == words[1] and numbers[0] == pytest.approx(numbers[1], rel=1e-3, abs=1e-9)


def test_reference() -> None:
    from api_reference import PAGE, written

    assert PAGE.read_text() == written(), "run python python/tools/api_reference.py"
