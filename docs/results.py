"""Cases run by the program, and what they wrote, for the tables and figures of the documentation. Needs numpy."""

import base64
import csv
import json
import pathlib
import re
import subprocess
import tempfile
import zlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
TYPES = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4", "UInt64": "<u8", "UInt8": "u1"}


def committed(path):
    """A case of the repository, its mesh by its whole path, so that it may be changed and run from anywhere."""
    case = json.loads((ROOT / path).read_text())
    if isinstance(case.get("mesh"), str):
        case["mesh"] = str((ROOT / path).parent / case["mesh"])
    return case


def law(program, case):
    """The rows of a law driven alone: an array for every column."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "law.json"
        path.write_text(json.dumps(case))
        subprocess.run([program, "law", path, "--out", folder], check=True, capture_output=True)
        return table(next(file for file in pathlib.Path(folder).glob("*.csv")))


def table(path):
    """A CSV file of numbers: an array for every column; texts stay lists."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    columns = {}
    for name in rows[0]:
        try:
            columns[name] = np.array([float(row[name]) for row in rows])
        except ValueError:
            columns[name] = [row[name] for row in rows]
    return columns


def text_of(rows):
    """A table of Markdown; the first row is its head."""
    rows = [rows[0], ["---"] * len(rows[0]), *rows[1:]]
    return "\n".join("|" + "|".join(f" {cell} " if cell != "---" else cell for cell in row) + "|" for row in rows)


class Run:
    """A case run to its end, or to where it stops if it `may_stop`."""

    def __init__(self, program, case, may_stop=False):
        self.holder = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.holder.name) / "out"
        path = pathlib.Path(self.holder.name) / "case.json"
        # Frames of what is compared: of every increment, with all digits.
        path.write_text(json.dumps({**case, "output": {"exact": True, "every": 1, **case.get("output", {})}}))
        said = subprocess.run([program, "run", path, "--out", self.folder, "--quiet"], capture_output=True, text=True)
        if said.returncode and not may_stop:
            raise SystemExit(f"{case.get('title', 'a case')}: {said.stderr}")
        self.history = table(self.folder / "history.csv")
        self.summary = json.loads((self.folder / "summary.json").read_text())

    def last(self, column):
        """What a column of the history ends with."""
        return self.history[column][-1]

    def at(self, column, time):
        """A column of the history at the increment that ends at a time."""
        return self.history[column][np.abs(self.history["time"] - time).argmin()]

    def interface(self, name):
        """An array of interface.zarr: a row for every row of the history, a column for every point of the contact."""
        folder = self.folder / "interface.zarr" / name
        told = json.loads((folder / ".zarray").read_text())
        found = np.empty(told["shape"])
        counts = [-(-size // chunk) for size, chunk in zip(told["shape"], told["chunks"])]
        for number in np.ndindex(*counts):
            data = zlib.decompress((folder / ".".join(map(str, number))).read_bytes())
            for _ in filter(lambda kind: kind["id"] == "shuffle", told["filters"] or []):
                size = np.dtype(told["dtype"]).itemsize
                data = np.frombuffer(data, "u1").reshape(size, -1).T.tobytes()
            chunk = np.frombuffer(data, told["dtype"]).reshape(told["chunks"])
            place = tuple(slice(k * step, min((k + 1) * step, size)) for k, step, size in zip(number, told["chunks"], told["shape"]))
            found[place] = chunk[tuple(slice(0, part.stop - part.start) for part in place)]
        return found

    def cost(self):
        """Newton iterations of an increment in the mean and at most, and cut-backs."""
        iterations = self.history["iterations"]
        mean = self.summary["newton_iterations"] / len(iterations)
        return [f"{mean:.1f} ({iterations.max():.0f})", str(self.summary["cutbacks"])]

    def frame(self, name="contact", time=None):
        """The arrays of the frame nearest to a time, or of the last one; `places` are those of deformed bodies."""
        frames = re.findall(r'timestep="([^"]*)".*?file="([^"]*)"', (self.folder / f"{name}.pvd").read_text())
        file = frames[-1][1] if time is None else min(frames, key=lambda frame: abs(float(frame[0]) - time))[1]
        text = (self.folder / file).read_text()
        arrays = {}
        for head, data in re.findall(r"<DataArray ([^>]*)>([^<]*)<", text):
            told = dict(re.findall(r'(\w+)="([^"]*)"', head))
            values = decoded(data.strip(), TYPES[told["type"]])
            width = int(told.get("NumberOfComponents", 1))
            arrays[told["Name"]] = values.reshape(-1, width) if width > 1 else values
        arrays["places"] = arrays["Points"] + arrays["displacement"]
        return arrays


def decoded(text, kind):
    """The numbers of a compressed array of VTK: a header with the number of blocks, their sizes, then the blocks."""
    count = int(np.frombuffer(base64.b64decode(text[:32]), "<u8")[0])
    size = 4 * -(-8 * (3 + count) // 3)
    lengths = np.frombuffer(base64.b64decode(text[:size]), "<u8")[3 : 3 + count]
    data, start, blocks = base64.b64decode(text[size:]), 0, []
    for length in lengths:
        blocks.append(zlib.decompress(data[start : start + int(length)]))
        start += int(length)
    return np.frombuffer(b"".join(blocks), kind)
