"""Tables of measured columns from text files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY

from fecontact import calibration


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("time,force\n0,1.5\n1e0,2.5\n", ["time", "force"]),
        ("# time\tforce\n0\t1.5\n1\t2.5\n", ["time", "force"]),
        ("Time; Force\ns; kN\n0;1,5\n1;2,5\n", ["Time", "Force"]),
        ("a sample, tested in spring\r\n\r\n time force\r\n  0   1.5\r\n  1   2.5\r\n", ["time", "force"]),
        ("0 1.5\n1 2.5\n", [0, 1]),
        ('\ufeff"time","force"\n0,1.5\n# a pause\n1,2.5\n', ["time", "force"]),
    ],
)
def test_usual_formats(tmp_path: Path, text: str, names: list[str | int]) -> None:
    file = tmp_path / "record.txt"
    file.write_bytes(text.encode())
    table = calibration.read(file)
    assert list(table.columns) == names
    np.testing.assert_array_equal(table.to_numpy(), [[0, 1.5], [1, 2.5]])


def test_what_is_missing_and_latin_letters(tmp_path: Path) -> None:
    file = tmp_path / "record.csv"
    file.write_bytes("Zeit [s],Kraft [kN],Länge [µm]\n0,,3\n1,2,4\n".encode("latin-1"))
    table = calibration.read(file)
    assert list(table.columns) == ["Zeit [s]", "Kraft [kN]", "Länge [µm]"]
    assert np.isnan(table["Kraft [kN]"][0]) and table["Länge [µm]"].tolist() == [3, 4]


@pytest.mark.parametrize(
    ("text", "message"),
    [("time,force\n", "no line consists of numbers"), ("t,f\n0,1\n1\n", "line 3: '1' is not a row of 2 numbers"), ("t,f\n0,1\n1,x\n", "line 3: '1,x'")],
)
def test_other_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "record.csv"
    file.write_text(text)
    with pytest.raises(ValueError, match=f"record.csv: {message}"):
        calibration.read(file)


def test_the_measured_records_are_read() -> None:
    pile = calibration.read(REPOSITORY / "cases" / "laboratory" / "pile_load_test.csv")
    assert list(pile.columns) == ["settlement_mm", "load_kN"] and len(pile) == 25 and pile["load_kN"].max() == 2216.7
