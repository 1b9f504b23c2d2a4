"""Opens the store of a run with xarray, as its users do: python store.py FOLDER...

Needs xarray and zarr. What the store says is compared with history.csv of the same folder.
"""

import csv
import json
import sys
import warnings
from pathlib import Path

import numpy as np
import xarray as xr
import zarr  # noqa: F401  what it warns of when it is imported is not the store's


def check(folder: Path) -> None:
    with warnings.catch_warnings():
        # A warning on the way is a store that is not as it should be.
        warnings.simplefilter("error")
        store = xr.open_zarr(folder / "interface.zarr", consolidated=True, chunks=None)
    units = json.loads((folder / "summary.json").read_text())["units"]
    with open(folder / "history.csv", newline="") as text:
        history = list(csv.DictReader(text))
    column = lambda name: np.array([float(row[name]) for row in history])

    assert store.attrs["Conventions"].startswith("CF-"), store.attrs
    assert store["time"].dtype == np.float64 and "time" in store.coords
    np.testing.assert_array_equal(store["time"], column("time"))
    for contact, prefix in zip(store.attrs["contacts"], store.attrs["prefixes"]):
        of = lambda name: store[f"{prefix}.{name}"]
        for name in ["slip", "total_slip", "slip_rate", "pressure", "traction", "R", "mu", "structure", "gap"]:
            array = of(name)
            assert array.dims == ("time", f"{prefix}.point") and array.dtype == np.float32, array
            assert np.isfinite(array).all() and array.attrs["long_name"].startswith(contact), array
            assert f"{prefix}.position" in array.coords, array
        if "length" in units:
            assert of("slip").attrs["units"] == of("position").attrs["units"] == units["length"]
        closed = of("pressure") > 0
        # Means over the closed length lie between the least and the largest value of closed points.
        mean, error = column(f"{contact}.mean_slip"), of("slip").attrs["relative_error"]
        slack = 2 * error * np.abs(of("slip")).max("%s.point" % prefix).values
        some = closed.any(f"{prefix}.point").values
        assert (mean[some] >= of("slip").where(closed).min(f"{prefix}.point").values[some] - slack[some]).all()
        assert (mean[some] <= of("slip").where(closed).max(f"{prefix}.point").values[some] + slack[some]).all()
        force = column(f"{contact}.normal_force")
        assert ((force > 0) == some).all(), contact
    print(f"{folder}: {store.sizes['time']} records of {len(store.attrs['contacts'])} contacts")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        check(Path(name))
