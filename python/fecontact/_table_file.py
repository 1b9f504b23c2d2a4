"""Tables of measured columns from text files, as instruments write them."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pandas as pd

# Marks of comments at the beginning of a line.
COMMENTS = ("#", "%", "//", "!")
# Separators, the first that makes a row of several numbers.
SEPARATORS = (";", "\t", ",", " ")


def read(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Read a table of numbers from a text file: csv, or txt with columns behind spaces or tabs.

    Names are those of the first line with as many fields as the rows have, or else of the last such comment; a line of units between names and
    numbers is left out. Without names the columns are 0, 1, …; commas are decimal where the separator is none. Empty fields are NaN.

    Args:
        path: the file, in UTF-8 or Latin 1.

    Returns:
        A column per quantity, of floats, by name.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: it has no rows of numbers, or a row has a field that is no number, or another number of fields; the message names the line.
    """
    raw = Path(path).read_bytes()
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    lines = [(number, line.strip(" \r\n")) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    for separator in SEPARATORS:
        first = next((k for k, (_, line) in enumerate(lines) if _numbers(line, separator) is not None), None)
        if first is not None and (len(_fields(lines[first][1], separator)) > 1 or separator == SEPARATORS[-1]):
            return _table(path, lines, first, separator)
    raise ValueError(f"{os.fspath(path)}: no line consists of numbers: columns are separated by commas, semicolons, tabs or spaces")


def _table(path: str | os.PathLike[str], lines: list[tuple[int, str]], first: int, separator: str) -> pd.DataFrame:
    width = len(_fields(lines[first][1], separator))
    rows = []
    for number, line in lines[first:]:
        if line.startswith(COMMENTS):
            continue
        row = _numbers(line, separator)
        if row is None or len(row) != width:
            raise ValueError(f"{os.fspath(path)}: line {number}: {line[:60]!r} is not a row of {width} numbers, as the lines before are")
        rows.append(row)
    return pd.DataFrame(rows, columns=_names(lines[:first], separator, width))


def _names(heads: list[tuple[int, str]], separator: str, width: int) -> list[str] | range:
    """Names of the columns: of the first line above that has as many fields, else of the last such comment."""
    plain = [line for _, line in heads if not line.startswith(COMMENTS)]
    marked = [line for _, line in reversed(heads) if line.startswith(COMMENTS)]
    for line in plain + marked:
        fields = [field.strip("\"' ") for field in _fields(line.lstrip("#%/! "), separator)]
        if len(fields) == width and len(set(fields)) == width and all(fields):
            return fields
    return range(width)


def _fields(line: str, separator: str) -> list[str]:
    return line.split() if separator == " " else [field.strip() for field in line.split(separator)]


def _numbers(line: str, separator: str) -> list[float] | None:
    """Numbers of a row, NaN where a field is empty; nothing where it is no row."""
    fields = _fields(line, separator)
    if separator != ",":
        fields = [re.sub(r"^([-+]?\d+),(\d+)", r"\1.\2", field) for field in fields]
    try:
        return [float(field or "nan") for field in fields] if any(fields) else None
    except ValueError:
        return None
