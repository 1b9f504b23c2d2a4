"""Figures of results with matplotlib; each takes ``ax``, and returns it.

Labels contain the units named by the case under ``units``; legends and limits can be changed with matplotlib.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _quantities
from .law import Drive
from .result import Result, friction_ratio, labelled

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from .calibration import Fit
    from .convergence import Convergence

def friction(result: Result, contact: str | None = None, *, x: str = "time", ax: Axes | None = None, **line: Any) -> Axes:
    """|Q|/N of contacts over time, or over another column of the history.

    Args:
        result: the results.
        contact: one contact; all unless given.
        x: a column of the history, such as ``"time"`` or ``"base.mean_slip"``.
        ax: where to draw.
        **line: for ``ax.plot``.
    """
    ax = _axes(ax)
    history = result.history
    for name in _contacts(result, contact):
        ax.plot(history[x], friction_ratio(history, name), **{"label": name, **line})
    ax.set(xlabel=labelled(result, x), ylabel="|Q|/N [-]")
    return _legend(ax)


def slip_fraction(result: Result, contact: str | None = None, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Slipping fraction of the closed length of contacts over time."""
    ax = _axes(ax)
    for name in _contacts(result, contact):
        ax.plot(result.history["time"], result.history[f"{name}.slip_fraction"], **{"label": name, **line})
    ax.set(xlabel=labelled(result, "time"), ylabel="slip fraction [-]", ylim=(-0.03, 1.03))
    return _legend(ax)


def interface(
    result: Result,
    contact: str | None = None,
    field: str = "slip_rate",
    *,
    x: str = "position",
    y: str = "time",
    log: bool | None = None,
    ax: Axes | None = None,
    **mesh: Any,
) -> Axes:
    """A field of a contact over place and time as a colour map.

    Args:
        result: the results.
        contact: one contact; the first unless given.
        field: of ``result.interface[contact]``, such as ``slip``, ``slip_rate``, ``pressure``, ``traction``, ``mu``.
        x: place as ``"position"``, the arc length along the slave surface, or as coordinate ``"x"`` or ``"y"``.
        y: ``"time"``, or ``"row"`` of the history; rows are dense during events, which over earthquake cycles are
            too short to be visible in time. The axis is then labelled with the times of rows.
        log: whether colours are logarithmic; default: for slip rates only.
        ax: where to draw.
        **mesh: for ``ax.pcolormesh``.
    """
    from matplotlib.colors import LogNorm

    ax = _axes(ax)
    name = contact or _contacts(result, None)[0]
    data = result.interface[name]
    if x not in ("position", "x", "y") or y not in ("time", "row"):
        raise ValueError(f"x is {x!r}, y is {y!r}: x is position, x or y; y is time or row")
    order = np.argsort(data[x].values, kind="stable")
    values = np.asarray(data[field].values, dtype=float)[:, order]
    closed = np.asarray(data["pressure"].values)[:, order] > 0
    shown = np.ma.masked_where(~closed | ~np.isfinite(values), values)
    if log if log is not None else field == "slip_rate":
        shown = np.ma.masked_where(np.abs(shown) <= 0, np.abs(shown))
        if shown.count():
            high = float(shown.max())
            mesh.setdefault("norm", LogNorm(max(float(shown.min()), 1e-9 * high), high))
    times = data["time"].values
    rows = times if y == "time" else np.arange(times.size)
    colours = ax.pcolormesh(data[x].values[order], rows, shown, **{"shading": "nearest", **mesh})
    # Of quantities of laws the store knows the unit.
    unit = _quantities.unit_in("interface.zarr", field, result.units) or data[field].attrs.get("units")
    label = _quantities.spoken(field) + _unit(None if unit == "1" else unit)
    ax.figure.colorbar(colours, ax=ax, label=label)
    ax.set(xlabel=x + _unit(result.units.get("length")), ylabel=labelled(result, "time"), title=name)
    if y == "row":
        ticks = np.unique(np.linspace(0, times.size - 1, 7).astype(int))
        ax.set_yticks(ticks, [f"{times[tick]:.5g}" for tick in ticks])
        ax.set_ylabel(labelled(result, "time") + " (rows of the history evenly spaced)")
    return ax


#: Corners of the triangles of a cell, by VTK's number of its kind.
_TRIANGLES = {
    5: [(0, 1, 2)],
    9: [(0, 1, 2), (0, 2, 3)],
    22: [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
    23: [(0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 7), (5, 6, 7)],
    28: [(0, 4, 8), (0, 8, 7), (4, 1, 5), (4, 5, 8), (8, 5, 2), (8, 2, 6), (7, 8, 6), (7, 6, 3)],
}
#: Points around a cell, in order.
_RINGS = {5: (0, 1, 2), 9: (0, 1, 2, 3), 22: (0, 3, 1, 4, 2, 5), 23: (0, 4, 1, 5, 2, 6, 3, 7), 28: (0, 4, 1, 5, 2, 6, 3, 7)}
#: Components of arrays by their number.
_COMPONENTS = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "xy", "yz", "xz")}


def body(
    result: Result,
    field: str = "von_mises",
    *,
    time: float | None = None,
    deformed: float = 1.0,
    component: str | None = None,
    edges: bool = False,
    ax: Axes | None = None,
    **colours: Any,
) -> Axes:
    """A field of the deformed bodies as a colour map.

    Args:
        result: the results; needs PyVista (``pip install 'fecontact[fields]'``).
        field: of ``result.fields``, such as ``"von_mises"``, ``"displacement"``, ``"stress"`` or ``"mean_pressure"``.
        time: the frame nearest to it is drawn [T]; the last unless given.
        deformed: factor on the displacements; 0 draws the undeformed bodies.
        component: of a vector ``"x"`` or ``"y"``, of a tensor ``"xx"``, ``"yy"``, ``"zz"`` or ``"xy"``; of vectors the length unless given.
        edges: whether the edges of all elements are drawn, and not only the outline.
        ax: where to draw.
        **colours: for ``ax.tripcolor``, such as ``cmap``, ``vmin`` and ``vmax``.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.tri import Triangulation

    frames = result.fields
    at = float(frames.times[-1]) if time is None else float(time)
    grid = frames.at(at)
    if field not in grid.point_data:
        raise KeyError(f"the bodies have no field {field}; they have {', '.join(sorted(grid.point_data))}")
    values, label = _component(np.asarray(grid.point_data[field], dtype=float), field, component)
    places = (np.asarray(grid.points, dtype=float) + deformed * np.asarray(grid.point_data["displacement"], dtype=float))[:, :2]
    shown = np.asarray(grid.cell_data["vtkGhostType"]) == 0 if "vtkGhostType" in grid.cell_data else np.ones(grid.n_cells, dtype=bool)
    triangles, lines = _cells(grid, shown, edges)
    ax = _axes(ax)
    style: dict[str, Any] = {"shading": "gouraud", **colours}
    drawn = ax.tripcolor(Triangulation(places[:, 0], places[:, 1], triangles), values, **style)
    ax.add_collection(LineCollection([places[list(pair)] for pair in lines], colors="black", linewidths=0.3 if edges else 0.7))
    unit = _quantities.unit_in("solid.pvd", field, result.units)
    ax.figure.colorbar(drawn, ax=ax, label=label + _unit(unit))
    length = _unit(result.units.get("length"))
    at_time = f"t = {frames.times[np.abs(frames.times - at).argmin()]:.6g} {result.units.get('time', '')}".rstrip()
    ax.set(xlabel="x" + length, ylabel="y" + length, aspect="equal", title=at_time + ("" if deformed == 1 else f", displacement × {deformed:g}"))
    return ax


def _component(values: NDArray[np.float64], field: str, component: str | None) -> tuple[NDArray[np.float64], str]:
    """One number a node of a field, and what it is called."""
    spoken = _quantities.spoken(field)
    if values.ndim == 1:
        if component is not None:
            raise ValueError(f"component: {field} is one number per node")
        return values, spoken
    names = _COMPONENTS.get(values.shape[1], tuple(str(k + 1) for k in range(values.shape[1])))
    if component is None and values.shape[1] == 3 and not field.startswith("principal"):
        return np.asarray(np.linalg.norm(values[:, :2], axis=1)), f"|{spoken}|"
    if component not in names:
        raise ValueError(f"component: is {component!r}: {field} has {', '.join(names)}")
    return values[:, names.index(component)], f"{spoken} {component}"


def _cells(grid: Any, shown: NDArray[np.bool_], edges: bool) -> tuple[NDArray[np.int64], list[tuple[int, int]]]:
    """Triangles of the cells that are shown, and their edges: all of them, or those of one cell alone."""
    triangles: list[NDArray[np.int64]] = []
    count: dict[tuple[int, int], int] = {}
    ends = grid.offset
    for cell in np.flatnonzero(shown):
        nodes, kind = grid.cell_connectivity[ends[cell] : ends[cell + 1]], int(grid.celltypes[cell])
        triangles.extend(nodes[list(corners)] for corners in _TRIANGLES[kind])
        ring = nodes[list(_RINGS[kind])]
        for a, b in zip(ring, np.roll(ring, -1)):
            pair = (int(min(a, b)), int(max(a, b)))
            count[pair] = count.get(pair, 0) + 1
    return np.array(triangles), [pair for pair, cells in count.items() if edges or cells == 1]


def fronts(
    result: Result, contact: str | None = None, *, event: int | None = None, ax: Axes | None = None, **points: Any
) -> Axes:
    """Arrivals of fronts over the position along a contact, with the slopes of c_R, c_s and c_p of its slave's body.

    Args:
        result: the results; the case asks for fronts by ``output.fronts``.
        contact: one contact; the first unless given.
        event: its number in ``result.events``; default: the one with the greatest length. Time is measured from its onset.
        ax: where to draw.
        **points: for ``ax.plot``.
    """
    ax = _axes(ax)
    name = _contacts(result, contact)[0]
    events, arrivals = (table[table["contact"] == name] for table in (result.events, result.fronts))
    if events.empty:
        raise ValueError(f"{name}: no event of slip reached a point (output.fronts)")
    known = events.set_index("event")
    if event is not None and event not in known.index:
        raise KeyError(f"{name} has no event {event}; there are {', '.join(map(str, known.index))}")
    of: Any = known["length"].idxmax() if event is None else event
    own, onset = arrivals[arrivals["event"] == of], known["onset"][of]
    after = own["arrival"] - onset
    ax.plot(own["position"], after, **{"marker": ".", "linestyle": "", "color": "C0", "label": f"event {of}", **points})
    _slopes(ax, own, known["position"][of], float(after.max()))
    at = f"time after {onset:.6g}" + _unit(result.units.get("time"))
    ax.set(xlabel="position" + _unit(result.units.get("length")), ylabel=at, title=name)
    return _legend(ax)


def _slopes(ax: Axes, arrivals: pd.DataFrame, start: float, until: float) -> None:
    """Lines of waves from the first arrival, over the range of the arrivals."""
    low, high = arrivals["position"].min(), arrivals["position"].max()
    for k, wave in enumerate(("c_R", "c_s", "c_p")):
        # Of each row: speed/(speed/c); the same c in all.
        speeds = (arrivals["speed"] / arrivals[f"speed_over_{wave}"]).replace([np.inf, 0.0], np.nan).dropna()
        if speeds.empty or until <= 0.0:
            continue
        ends = np.clip([start - speeds.median() * until, start, start + speeds.median() * until], low, high)
        ax.plot(ends, np.abs(ends - start) / speeds.median(), color=f"C{k + 1}", linewidth=0.8, label=wave)


def events(result: Result, *, ax: Axes | None = None, **points: Any) -> Axes:
    """Largest slip of every event over its onset."""
    ax = _axes(ax)
    table = result.events
    for name, own in table.groupby("contact", sort=False):
        ax.plot(own["onset"], own["largest_slip"], **{"marker": "o", "linestyle": "", "label": name, **points})
    ax.set(xlabel=labelled(result, "time"), ylabel="largest slip" + _unit(result.units.get("length")))
    return _legend(ax)


def path(drive: Drive | Result, contact: str | None = None, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Traction over pressure: of a law test, or Q over N of a contact."""
    ax = _axes(ax)
    if isinstance(drive, Drive):
        pressures = np.atleast_2d(drive["pressure"].reshape(-1, drive["time"].size))
        tractions = np.atleast_2d(drive["traction"].reshape(-1, drive["time"].size))
        for pressure, traction in zip(pressures, tractions):
            ax.plot(pressure, traction, **line)
        ax.set(xlabel="p", ylabel="q")
        return ax
    for name in _contacts(drive, contact):
        history = drive.history
        ax.plot(history[f"{name}.normal_force"], history[f"{name}.tangential_force"], **{"label": name, **line})
    force = _unit(drive.units.get("force"))
    ax.set(xlabel="normal force N" + force, ylabel="tangential force Q" + force)
    return _legend(ax)


def newton(result: Result, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Relative residual of every iteration, one line per attempt."""
    ax = _axes(ax)
    for _, attempt in result.newton.groupby(["step", "increment", "attempt"], sort=False):
        ax.semilogy(attempt["iteration"], attempt["residual"], **{"linewidth": 0.6, "color": "C0", "alpha": 0.5, **line})
    ax.set(xlabel="iteration", ylabel="residual, relative [-]")
    return ax


def residuals(found: Fit, *, ax: Axes | None = None, **points: Any) -> Axes:
    """Fitted minus measured values of every record of a fit over its samples, in standard deviations of the noise; between the dashed
    lines lie 95 % of them where the fit follows the data."""
    ax = _axes(ax)
    for k, residuals in enumerate(found.standardized):
        ax.plot(residuals, **{"marker": ".", "linestyle": "none", "label": f"record {k}", **points})
    for level, style in ((0.0, "-"), (1.96, "--"), (-1.96, "--")):
        ax.axhline(level, color="0.5", linewidth=0.6, linestyle=style)
    ax.set(xlabel="sample", ylabel="fitted − measured, standard deviations [-]")
    if len(found.residuals) > 1:
        ax.legend()
    return ax


def convergence(found: Convergence, *, ax: Axes | None = None, **points: Any) -> Axes:
    """A number over the size of elements and increments, that of the first run being 1; where it converges, with the error bar of the last
    run, and the extrapolated value at the size 0."""
    ax = _axes(ax)
    sizes = 0.5 ** np.arange(len(found.runs))
    values = found.runs["value"]
    ax.plot(sizes, values, **{"marker": "o", "linestyle": "none", "color": "C0", "label": "runs", **points})
    if found.bar is not None and found.extrapolated is not None:
        ax.errorbar(sizes[-1], found.value, yerr=found.bar, color="C0", capsize=4, label=f"± {found.bar:.2g}")
        ax.plot(0, found.extrapolated, marker="x", linestyle="none", color="C1", label="extrapolated", clip_on=False)
        if found.order is not None:
            size = np.linspace(0, 1, 101)
            last = (found.value - found.extrapolated) * (size / sizes[-1]) ** found.order
            ax.plot(size, found.extrapolated + last, color="C1", linewidth=0.8, label=f"order {found.order:.3g}")
    ax.set(xlabel="size of elements and increments, relative [-]", ylabel=found.measure, xlim=(0, 1.04), title=found.verdict)
    ax.legend()
    return ax


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]


def _contacts(result: Result, contact: str | None) -> list[str]:
    known = result.contacts
    if contact is not None and contact not in known:
        raise KeyError(f"there is no contact {contact}; there are {', '.join(known)}")
    if not known:
        raise ValueError("this run has no contacts")
    return known if contact is None else [contact]


def _unit(unit: str | None) -> str:
    return f" [{unit}]" if unit else ""


def _legend(ax: Axes) -> Axes:
    if len(ax.get_lines()) > 1:
        ax.legend()
    return ax
