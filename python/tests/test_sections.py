"""Forces of sections as a table of times and stations."""

import numpy as np
import pytest

import fecontact as fc

LONG, PRESSURE = 4.0, 3.0


def test_a_cantilever(tmp_path):
    case = fc.Case(
        {
            "mesh": {"blocks": [{"body": "beam", "corners": [[0, -0.1], [LONG, -0.1], [LONG, 0.1], [0, 0.1]], "elements": [8, 1], "kind": "Q8", "sides": [None, None, "top", "left"]}]},
            "bodies": {"beam": {"material": {"model": "linear", "E": 1e6, "nu": 0.2}}},
            "sections": {"cut": {"body": "beam", "from": [0, 0], "to": [LONG, 0]}},
            "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "left", "ux": 0, "uy": 0}], "loads": [{"on": "top", "dead_pressure": PRESSURE}]}],
        }
    )
    table = case.run(tmp_path / "out", progress=False).sections
    assert list(table) == ["time", "name", "station", "x", "y", "axial_force", "shear_force", "moment"]
    last = table.query("name == 'cut' and time == 1")
    assert len(last) == 9
    rest = LONG - last["x"].to_numpy()
    assert last["moment"].to_numpy() == pytest.approx(-0.5 * PRESSURE * rest**2, abs=1e-6)
    inner = slice(1, -1)
    assert last["shear_force"].to_numpy()[inner] == pytest.approx((PRESSURE * rest)[inner], abs=1e-6)
    assert np.abs(last["axial_force"]).max() < 1e-6

