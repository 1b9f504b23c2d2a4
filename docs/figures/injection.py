"""Water injected into a fault: pressure and slip before the rupture, slip rate in it, and the years that follow.

    fecontact run cases/injection.json
    python3 docs/figures/injection.py out/injection cases/injection.png

Needs numpy, matplotlib, xarray and zarr.
"""

import sys

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
import xarray

folder, target = sys.argv[1:]
DAY, YEAR, FAST = 86400.0, 365.25 * 86400.0, 0.01

store = xarray.open_zarr(folder + "/interface.zarr")
along = np.argsort(store["fault.x"].values)
x, time = store["fault.x"].values[along], store["time"].values
slip, fluid = (np.abs(store[f"fault.{name}"].values[:, along]) for name in ("slip", "fluid_pressure"))
rate = np.maximum(np.gradient(slip, time, axis=0), 1e-14)
fastest = rate.max(axis=1)
onset = np.flatnonzero(fastest > FAST)[0]

figure, (slow, fast, years) = plt.subplots(1, 3, figsize=(13, 3.8), layout="constrained", width_ratios=[1, 1, 1.1])
before = slice(0, onset)
drawn = slow.pcolormesh(x, time[before] / DAY, np.log10(rate[before]), cmap="viridis", shading="nearest", vmin=-11, vmax=-6.5)
levels = slow.contour(x, time[before] / DAY, fluid[before], levels=[1, 2, 3, 4, 5], colors="white", linewidths=0.8)
slow.clabel(levels, fmt="%g MPa", fontsize=7)
slow.set(xlim=(-1800, 1800), xlabel="x [m]", ylabel="time [days]", title="before the rupture: log₁₀ of the slip rate [m/s]")
plt.colorbar(drawn, ax=slow)

during = (time > time[onset] - 0.5) & (time < time[onset] + 2.5)
drawn = fast.pcolormesh(x, time[during] - time[onset], rate[during], cmap="inferno", shading="nearest", vmin=0, vmax=0.6)
fast.set(xlim=(-2400, 2400), xlabel="x [m]", ylabel="time since the onset [s]", title="in the rupture: slip rate [m/s]")
plt.colorbar(drawn, ax=fast)

years.semilogy(time / YEAR, fastest, color="tab:blue", linewidth=0.9)
years.axhline(FAST, color="0.6", linewidth=0.6, linestyle="--")
years.set(xlabel="time [years]", ylabel="largest slip rate [m/s]", ylim=(1e-10, 10), xlim=(0, time[-1] / YEAR), title="rest, healing and a second event")
pressure = years.twinx()
pressure.plot(time / YEAR, fluid.max(axis=1), color="tab:orange", linewidth=1.2)
pressure.set(ylim=(0, None))
pressure.set_ylabel("largest pressure of the water [MPa]", color="tab:orange")
figure.savefig(target, dpi=100)
