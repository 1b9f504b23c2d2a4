"""Results of a run, read on demand."""

from __future__ import annotations

import html
import io
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from . import _native, _quantities
from ._paths import path as as_path

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


class Result:
    """The results of a run by ``case.run()``, or by ``fecontact run`` (:meth:`open`).

    Tables and fields are read on demand and cached; :meth:`reload` clears the cache, for an active run.
    ``history.attrs["units"]`` contains the unit of every column, as labelled by the case, else composed of F, L and T; the same holds for
    the other tables.
    """

    def __init__(self, folder: str | os.PathLike[str], *, _holder: Any = None) -> None:
        self.folder = Path(as_path(folder, "folder"))
        # A temporary folder lives as long as the result.
        self._holder = _holder

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Result:
        """The results in a folder, of a finished or active run.

        Raises:
            FileNotFoundError: there is no ``summary.json``.
        """
        result = cls(folder)
        if not (result.folder / "summary.json").is_file():
            raise FileNotFoundError(f"{result.folder}: there are no results here (no summary.json); check the path")
        return result

    def reload(self) -> Result:
        """The same folder, without cached data."""
        return Result(self.folder, _holder=self._holder)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """``summary.json``: status, reason, counts, times, warnings.

        Raises:
            ValueError: the file is damaged.
        """
        path = self.folder / "summary.json"
        try:
            summary = json.loads(path.read_text())
        except ValueError as error:
            raise ValueError(f"{path}: is damaged ({error}); resume the run, or run it again") from None
        if not isinstance(summary, dict):
            raise ValueError(f"{path}: is damaged (not a JSON object); resume the run, or run it again")
        return summary

    @property
    def status(self) -> str:
        """``"completed"``, ``"stopped"``, ``"interrupted"`` or ``"running"``."""
        return str(self.summary["status"])

    @property
    def warnings(self) -> list[str]:
        """Warnings about the result."""
        return list(self.summary["warnings"])

    @property
    def contacts(self) -> list[str]:
        """Names of the contacts."""
        return list(self.summary["friction"])

    @property
    def units(self) -> dict[str, str]:
        """Labels of the units given by the case."""
        return dict(self.summary["units"])

    @cached_property
    def history(self) -> pd.DataFrame:
        """One row per increment: time [T], energies [F·L], forces [F] and means of every contact, watched sets."""
        return self._table("history.csv")

    @cached_property
    def newton(self) -> pd.DataFrame:
        """One row per linear solve: residual, correction, numbers of points open, sticking, slipping; the outcome of the attempt (``verdict``)
        and the reason of its rejection (``reason``). An attempt rejected before its first solve has a row with ``iteration`` 0."""
        return self._table("newton.csv")

    @cached_property
    def events(self) -> pd.DataFrame:
        """One row per slip event; requires ``output.fronts`` in the case."""
        return self._table("events.csv", "the case asks for events by output.fronts")

    @cached_property
    def fronts(self) -> pd.DataFrame:
        """One row per passage of a front; requires ``output.fronts`` in the case."""
        return self._table("fronts.csv", "the case asks for fronts by output.fronts")

    @cached_property
    def probes(self) -> pd.DataFrame:
        """Displacement [L], velocity [L/T], strain [-] and stress [F/L²] of every probe over time."""
        return self._table("probes.csv", "the case asks for them by probes")

    @cached_property
    def sections(self) -> pd.DataFrame:
        """Forces of the sections of bodies, one row per time [T] and station: ``name`` of the sections, number of the ``station`` from 1,
        its place ``x``, ``y`` in the mesh [L], ``axial_force``, ``shear_force`` [F] and ``moment`` [F·L]; requires ``sections`` in the case."""
        wide = self._table("sections.csv", "the case asks for them by sections")
        columns = [str(column) for column in wide]
        stations = list(dict.fromkeys(column.rsplit(".", 1)[0] for column in columns if column != "time"))
        parts = []
        for station in stations:
            own = wide[[column for column in columns if column.rsplit(".", 1)[0] == station]]
            name, number = station.rsplit(".", 1)
            own = own.rename(columns=lambda column: column.rsplit(".", 1)[-1])
            parts.append(own.assign(time=wide["time"], name=name, station=int(number)))
        order = ["time", "name", "station", "x", "y", "axial_force", "shear_force", "moment"]
        return pd.concat(parts).sort_values(["time", "name", "station"], ignore_index=True)[order]

    @cached_property
    def gradients(self) -> pd.DataFrame:
        """Derivatives of the history by values of the case, with its rows: ``d(base.tangential_force)/d(contacts.base.friction.mu_k)`` for
        every quantity and place; requires ``gradients`` in the case or its run."""
        table = self._table("gradients.csv", "the case asks for derivatives by gradients")
        # Units are those of quantity and value, which has none that is known.
        table.attrs.clear()
        return table

    @cached_property
    def interface_gradients(self) -> Mapping[str, xr.Dataset]:
        """Derivatives of slip, pressure and traction of every contact by values of the case:
        ``result.interface_gradients["base"].slip.sel(by="contacts.base.friction.mu_k")`` has the dimensions (time, point)."""
        return _Interfaces(self.folder / "gradients.zarr", self._holder is not None, "the case has no contacts, or asks for no derivatives by gradients")

    @cached_property
    def displacement_gradients(self) -> xr.DataArray:
        """Derivatives of the displacements of all nodes by values of the case, with the dimensions (time, by, node, component) and the
        undeformed coordinates x and y of nodes [L]; requires ``output.displacement_gradients``."""
        whole = _store(self.folder / "gradients.zarr", self._holder is not None, "the case asks for no derivatives by gradients")
        if "displacement" not in whole:
            raise FileNotFoundError(f"{self.folder}: has no derivatives of displacements: the case asks for them by output.displacement_gradients")
        of_nodes: xr.DataArray = whole["displacement"].assign_coords(x=whole["x"], y=whole["y"], component=["ux", "uy"])
        return of_nodes

    def spread(self, deviations: Mapping[str, float]) -> pd.DataFrame:
        """Standard deviation of the history by deviations of values of the case that are independent of each other, to first order:
        √Σ (∂Q/∂θ s_θ)² of every quantity Q, with the rows and units of the history.

        Args:
            deviations: standard deviation s_θ by place, such as ``{"contacts.base.friction.mu_k": 0.02}``. The run must have the derivatives
                (:attr:`gradients`) by these places. They must be so small that the history is nearly linear over them.

        Raises:
            FileNotFoundError: the run has no derivatives.
            ValueError: a place has none, or its deviation is not zero or positive.
        """
        if not isinstance(deviations, Mapping) or not deviations:
            raise ValueError(f"deviations: is {deviations!r}: give standard deviations by place")
        table = self.gradients
        places = dict.fromkeys(column.rpartition(")/d(")[2][:-1] for column in map(str, table) if column.startswith("d("))
        variance: dict[str, Any] = {}
        for place, deviation in deviations.items():
            if place not in places:
                raise ValueError(f"deviations: this run has no derivatives by {place}; it has those by {', '.join(places)}")
            if not (isinstance(deviation, Real) and 0 <= float(deviation) < np.inf):
                raise ValueError(f"deviations: {place}: is {deviation!r}: must be zero or positive")
            end = f")/d({place})"
            for column in map(str, table):
                if column.startswith("d(") and column.endswith(end):
                    quantity = column[2 : -len(end)]
                    variance[quantity] = variance.get(quantity, 0.0) + (table[column] * float(deviation)) ** 2
        spread = pd.DataFrame({"time": table["time"], **{quantity: np.sqrt(of) for quantity, of in variance.items()}})
        labels = self.units if (self.folder / "summary.json").is_file() else {}
        spread.attrs["units"] = {str(column): _quantities.unit_in("history.csv", str(column), labels) for column in spread}
        return spread

    @cached_property
    def interface(self) -> Mapping[str, xr.Dataset]:
        """Fields of every contact over time and place, by contact name: ``result.interface["base"].slip`` has the dimensions
        (time, point) and the coordinates time [T] and position [L]."""
        return _Interfaces(self.folder / "interface.zarr", self._holder is not None)

    @cached_property
    def fields(self) -> Fields:
        """Fields of the bodies, one PyVista grid per time; ``.contact`` and ``.points`` are those of contacts and of
        integration points."""
        return Fields(self.folder, "solid")

    def report(self, file: str | os.PathLike[str] | None = None) -> Path:
        """Write one HTML page for viewing the results in a browser; default: into the results folder."""
        return report([self.folder], file or self.folder / "report.html")

    def _table(self, name: str, hint: str = "") -> pd.DataFrame:
        path = self.folder / name
        if not path.is_file():
            raise FileNotFoundError(f"{path}: this run did not write it" + (f" ({hint})" if hint else ""))
        # Numbers to the last digit, as pandas 3 reads them by itself.
        exact: Any = {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
        # An increment that was accepted has no reason why not: an empty text.
        table: pd.DataFrame = pd.read_csv(_finished(path), converters={"reason": str}, **exact)
        labels = self.units if (self.folder / "summary.json").is_file() else {}
        table.attrs["units"] = {str(column): _quantities.unit_in(name, str(column), labels) for column in table}
        return table

    def __repr__(self) -> str:
        summary = self.summary
        why = f" ({summary['reason']})" if summary.get("reason") else ""
        title = f" «{summary['title']}»" if summary.get("title") else ""
        return f"<Result{title} in {self.folder}: {self.status}{why}, {summary['increments']} increments>"

    def _repr_html_(self) -> str:
        summary = self.summary
        rows = {
            "status": self.status + (f": {summary['reason']}" if summary.get("reason") else ""),
            "model": f"{summary['dofs']} dofs, {summary['elements']} elements, {summary['contact_points']} contact points",
            "work": f"{summary['increments']} increments, {summary['cutbacks']} cut-backs, "
            f"{summary['newton_iterations']} linear solves in {summary['wall_s']['total']:.2f} s",
            "folder": str(self.folder),
        }
        rows.update({f"warning {k + 1}": text for k, text in enumerate(self.warnings)})
        cells = "".join(
            f"<tr><th style='text-align:left'>{html.escape(key)}</th><td style='text-align:left'>{html.escape(text)}</td></tr>"
            for key, text in rows.items()
        )
        title = html.escape(str(summary.get("title") or "Result"))
        return f"<div><b>{title}</b><table>{cells}</table>{self._figure()}</div>"

    def _figure(self) -> str:
        """Friction over time as an SVG; empty without friction."""
        if not self.contacts or not (self.folder / "history.csv").is_file() or len(self.history) < 2:
            return ""
        from matplotlib.backends.backend_svg import FigureCanvasSVG
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.4, 2.8), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        for name in self.contacts:
            axes.plot(self.history["time"], friction_ratio(self.history, name), label=name)
        axes.set(xlabel=labelled(self, "time"), ylabel="|Q|/N [-]")
        if len(self.contacts) > 1:
            axes.legend()
        text = io.StringIO()
        figure.savefig(text, format="svg")
        svg = text.getvalue()
        return svg[svg.index("<svg") :]


def friction_ratio(history: pd.DataFrame, contact: str) -> pd.Series:
    """|Q|/N of a contact, where it is closed [-]."""
    normal, tangential = history[f"{contact}.normal_force"], history[f"{contact}.tangential_force"]
    return (tangential.abs() / normal).where(normal > 0)


def labelled(result: Result, column: str) -> str:
    """A column with its unit."""
    unit = _quantities.unit(column, result.units)
    return f"{column} [{unit}]" if unit else column


class Fields(Sequence[Any]):
    """Grids of PyVista over time; each is read when it is asked for, and has principal stresses and strains (``principal_stress``,
    ``principal_strain``, the largest first) and the stretch across the plane (``stretch_zz``) as well."""

    def __init__(self, folder: Path, kind: str) -> None:
        self._folder, self._kind = folder, kind
        path = folder / f"{kind}.pvd"
        if not path.is_file():
            raise FileNotFoundError(f"{path}: this run did not write it (output.fields, output.points)")
        from xml.etree import ElementTree

        frames = ElementTree.fromstring(_closed(path.read_text())).iter("DataSet")
        self._frames = [(float(frame.attrib["timestep"]), folder / frame.attrib["file"]) for frame in frames]

    @property
    def times(self) -> NDArray[np.float64]:
        """Times of the grids, shape (frames,) [T]."""
        return np.array([time for time, _ in self._frames])

    def at(self, time: float) -> Any:
        """The grid nearest to a time [T]."""
        if not self._frames:
            raise IndexError("there are no fields yet")
        return self[int(np.argmin(np.abs(self.times - time)))]

    @property
    def contact(self) -> Fields:
        """Grids of the contacts: polylines through the contact points."""
        return Fields(self._folder, "contact")

    @property
    def bars(self) -> Fields:
        """Grids of the bars: a line to each segment."""
        return Fields(self._folder, "bars")

    @property
    def points(self) -> Fields:
        """Grids of the integration points."""
        return Fields(self._folder, "points")

    def __len__(self) -> int:
        return len(self._frames)

    def __getitem__(self, k: Any) -> Any:
        if isinstance(k, slice):
            return [self[i] for i in range(*k.indices(len(self)))]
        try:
            import pyvista
        except ImportError as error:
            raise ImportError("fields need PyVista: pip install 'fecontact[fields]'") from error
        return _with_derived(pyvista.read(self._frames[k][1]))

    def __repr__(self) -> str:
        return f"<{len(self)} grids of {self._kind}>"


def _principal_values(tensors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Principal values of symmetric tensors, shape (..., 4) with the components xx, yy, zz, xy: shape (..., 3), the largest first."""
    xx, yy, zz, xy = np.moveaxis(np.asarray(tensors, dtype=float), -1, 0)
    middle, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    return np.sort(np.stack([middle + radius, middle - radius, zz], axis=-1), axis=-1)[..., ::-1]


def _with_derived(grid: Any) -> Any:
    """The grid with what follows from its stress and logarithmic strain, where it has them and the run did not write it."""
    of = grid.point_data
    for name, tensor in (("principal_stress", "stress"), ("principal_strain", "log_strain")):
        if tensor in of and name not in of:
            of[name] = _principal_values(of[tensor][:, :4])
    if "log_strain" in of and "stretch_zz" not in of:
        of["stretch_zz"] = np.exp(of["log_strain"][:, 2])
    return grid


class _Interfaces(Mapping[str, "xr.Dataset"]):
    """Datasets of the contacts of one store."""

    def __init__(self, store: Path, load: bool, without: str = "it has no contacts") -> None:
        whole = _store(store, load, without)
        self._sets = {
            contact: _of_contact(whole, prefix)
            for contact, prefix in zip(whole.attrs["contacts"], whole.attrs["prefixes"])
        }

    def __getitem__(self, contact: str) -> xr.Dataset:
        if contact not in self._sets:
            raise KeyError(f"there is no contact {contact}; there are {', '.join(self._sets)}")
        return self._sets[contact]

    def __iter__(self) -> Iterator[str]:
        return iter(self._sets)

    def __len__(self) -> int:
        return len(self._sets)


def _store(store: Path, load: bool, without: str) -> xr.Dataset:
    """A store; arrays are read when they are used, those of a temporary folder at once, because it may go before they do."""
    if not store.is_dir():
        raise FileNotFoundError(f"{store}: this run did not write it: {without}")
    import xarray as xr

    whole: xr.Dataset = xr.open_zarr(store, consolidated=True, chunks=None)
    if "by" in whole.attrs:
        whole = whole.assign_coords(by=whole.attrs["by"])
    return whole.load() if load else whole


def _of_contact(whole: xr.Dataset, prefix: str) -> xr.Dataset:
    """The arrays of one contact, without the prefix of its name."""
    own = [name for name in whole.variables if str(name).startswith(f"{prefix}.")]
    part = whole[own]
    of_contact = [name for name in [*part.variables, *part.dims] if str(name).startswith(f"{prefix}.")]
    return part.rename({name: _quantities.name_of_now(str(name)[len(prefix) + 1 :]) for name in of_contact})


def _closed(text: str) -> str:
    """The text of a collection, completed if it is still growing."""
    return text if "</VTKFile>" in text else text[: text.rindex("/>") + 2] + "</Collection></VTKFile>"


def report(folders: Sequence[str | os.PathLike[str]], file: str | os.PathLike[str]) -> Path:
    """Write one HTML page with the results of several folders, overlaid, as ``fecontact report``."""
    if isinstance(folders, str) or not isinstance(folders, Sequence):
        raise ValueError(f"folders: is {folders!r}: give a list of folders")
    _native.report([as_path(folder, "folders") for folder in folders], as_path(file, "file"))
    return Path(file)


def _finished(path: Path) -> Path | io.BytesIO:
    """A table without an incomplete last row, whose last number would be truncated."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - 1))
        if file.read() in (b"", b"\n"):
            return path
        file.seek(0)
        rows = file.read()
    return io.BytesIO(rows[: rows.rfind(b"\n") + 1])
