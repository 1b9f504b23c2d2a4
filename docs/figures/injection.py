"""Water injected into a fault: slip before the rupture, and slip rate in it.

    fecontact run cases/injection.json
    python3 docs/figures/injection.py out/injection cases/injection.png

The dashed line is where the pressure takes the strength down to the traction, μ_s (p − p_w) = τ₀. Needs numpy, matplotlib, xarray and zarr.
"""

import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import xarray

folder, target = sys.argv[1:]
MU_S, PRESSURE, TRACTION, DAY = 0.6, 10.0, 4.8, 86400.0

store = xarray.open_zarr(folder + "/interface.zarr")
along = np.argsort(store["fault.x"].values)
x, time = store["fault.x"].values[along], store["time"].values
slip, fluid = (np.abs(store[f"fault.{name}"].values[:, along]) for name in ("slip", "fluid_pressure"))
rate = np.gradient(slip, time, axis=0)
onset = np.flatnonzero(rate.max(axis=1) > 0.01)[0]

figure, (slow, fast) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
before = slice(0, onset)
drawn = slow.pcolormesh(x, time[before] / DAY, 1e3 * slip[before], cmap="viridis", shading="nearest", vmax=1e3 * slip[onset - 1].max())
slow.contour(x, time[before] / DAY, MU_S * (PRESSURE - fluid[before]), levels=[TRACTION], colors="white", linestyles="--", linewidths=1)
slow.set(xlim=(-250, 250), ylim=(1.58, time[onset - 1] / DAY), xlabel="x [m]", ylabel="time [days]", title="slip before the rupture [mm]")
plt.colorbar(drawn, ax=slow)
during = (time > time[onset]) & (time < time[onset] + 1.2)
drawn = fast.pcolormesh(x, time[during] - time[onset], rate[during], cmap="inferno", shading="nearest", vmin=0, vmax=0.6)
fast.set(xlim=(-1700, 1700), xlabel="x [m]", ylabel="time [s]", title="slip rate in the rupture [m/s]")
plt.colorbar(drawn, ax=fast)
figure.savefig(target, dpi=100)
