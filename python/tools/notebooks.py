"""Run the notebooks and store them with their outputs, so that they can be read where they lie: python python/tools/notebooks.py [NAME...]

Pictures are stored as PNG at the resolution of the screen; a notebook has at most 300 kB. Times of runs are left as they were;
:func:`texts` leaves them out, where notebooks are compared.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"

#: The most that a notebook may have [bytes].
MOST = 300_000

#: What differs from run to run: durations, temporary folders, addresses of objects.
VARYING = [
    (re.compile(r"\d+(\.\d+)?(e-?\d+)? ?(s|ms|min)\b"), "… s"),
    (re.compile(r"(/[\w.-]+)+/"), "…/"),
    (re.compile(r"0x[0-9a-f]+"), "0x…"),
    (re.compile(r"\d+%\|[^\n]*"), "…"),
]

#: Temporary folders.
TEMPORARY = re.compile(re.escape(tempfile.gettempdir()) + r"/[\w.-]+")

#: Pictures beside which the texts of a figure are not stored.
PICTURE = "image/png"


def run(path: Path) -> Any:
    """The notebook with the outputs of a fresh run, without what differs in each or repeats its pictures."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=900, resources={"metadata": {"path": folder}}).execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            output.get("metadata", {}).clear()
            # Widgets cannot be read without a kernel, and their texts are of the moment.
            for kind in [kind for kind in data if kind.startswith("application/vnd.jupyter.widget")]:
                del data[kind]
            if PICTURE in data:
                data.pop("image/svg+xml", None)
    notebook.metadata.pop("widgets", None)
    return notebook


def texts(notebook: Any) -> list[list[str]]:
    """What the cells have printed and returned as text, without what differs from run to run."""
    return [[_text(output) for output in cell.outputs if _text(output)] for cell in notebook.cells if cell.cell_type == "code"]


def _text(output: Any) -> str:
    if output.output_type == "stream":
        text = output.text if output.name == "stdout" else ""
    else:
        text = "" if PICTURE in output.get("data", {}) else output.get("data", {}).get("text/plain", "")
    for pattern, instead in [(TEMPORARY, "results"), *VARYING]:
        text = pattern.sub(instead, text)
    return str(text).strip()


def main(names: list[str]) -> None:
    """Renew some notebooks, or all."""
    for path in sorted(FOLDER.glob("*.ipynb")):
        if names and path.stem not in names:
            continue
        # Folders of the computer that ran it say nothing to a reader.
        text = TEMPORARY.sub("results", nbformat.writes(run(path))) + "\n"
        size = len(text.encode())
        if size > MOST:
            raise SystemExit(f"{path.name}: has {size} bytes, more than {MOST}: draw smaller or fewer pictures")
        path.write_text(text)
        print(f"{path.name}: {size / 1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
