"""Measured histories and displacement fields of a case, and what its run predicts for them."""

from __future__ import annotations

import difflib
import warnings
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from ._places import value_at
from ._plain import refused
from ._records import Array, array_of, noise_of
from ._study_run import lean
from .case import Case
from .errors import RunWarning, Stopped
from .result import Result


class DisplacementField:
    """Displacements of points of a body at one time, as image correlation measures them.

    Args:
        time: when.
        x, y: undeformed points, shape (n,).
        ux, uy: their displacements, shape (n,); NaN where there is none.
        sigma: standard deviation of their noise: a number or shape (n,).
        body: the body that they belong to, where two touch.
    """

    def __init__(
        self,
        time: float,
        x: ArrayLike,
        y: ArrayLike,
        ux: ArrayLike,
        uy: ArrayLike,
        *,
        sigma: ArrayLike | None = None,
        body: str | None = None,
    ) -> None:
        self.time = float(array_of("time", time).reshape(()))
        self.points = np.stack([np.ravel(array_of(name, given)) for name, given in (("x", x), ("y", y))], axis=1)
        given = [np.ravel(np.asarray(values, dtype=float)) for values in (ux, uy)]
        if any(values.size != len(self.points) for values in given):
            raise ValueError(f"ux, uy: have {given[0].size} and {given[1].size} values: give one for each of the {len(self.points)} points")
        self.displacements = np.stack(given, axis=1)
        if not np.isfinite(self.displacements).any():
            raise ValueError("ux, uy: have no finite value")
        self.sigma = None if sigma is None else np.broadcast_to(np.ravel(array_of("sigma", sigma)), len(self.points))
        self.body = body

    def probes(self, name: str) -> dict[str, dict[str, Any]]:
        """Probes at the points that have a displacement."""
        of_body = {} if self.body is None else {"body": self.body}
        seen = np.isfinite(self.displacements).any(axis=1)
        return {f"{name}_{k}": {"at": self.points[k].tolist(), **of_body} for k in np.flatnonzero(seen)}

    def columns(self, name: str) -> list[tuple[str, float, float | None]]:
        """Column, value and noise of every displacement."""
        noise = [None] * len(self.points) if self.sigma is None else list(map(float, self.sigma))
        return [
            (f"{name}_{k}.{part}", float(value), noise[k])
            for k, pair in enumerate(self.displacements)
            for part, value in zip(("ux", "uy"), pair)
            if np.isfinite(value)
        ]


class Run:
    """Measured histories of a case, for fits of its values through the finite-element run.

    What is predicted is the history of the run and of its probes, linear in time between its increments: increments should be as close
    together as what was measured bends.

    Args:
        case: the case, with everything that is not to be fitted as it was in the experiment.
        measured: by column of ``history.csv`` or ``probes.csv``, such as ``base.tangential_force`` or ``gauge.strain_xx``, its times,
            ascending, and values, both (n,); times lie between the first increment and the last.
        fields: measured displacement fields.
        sigma: standard deviation of the noise: a number, or by column a number or shape (n,); by default estimated by the fit. Several columns need it,
            and so do histories beside fields.
        weight: weight of this record relative to others.
    """

    # What is fitted.
    _fitted = "case"

    def __init__(
        self,
        case: Case,
        measured: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
        *,
        fields: Sequence[DisplacementField] = (),
        sigma: float | Mapping[str, ArrayLike] | None = None,
        weight: float = 1.0,
    ) -> None:
        if not isinstance(case, Case):
            raise ValueError(f"case: is a {type(case).__name__}: give a Case")
        columns = {} if measured is None and fields else measured
        if not (isinstance(columns, Mapping) and (columns or fields) and all(isinstance(column, str) for column in columns)):
            raise ValueError('measured: give times and values by column of the history, as {"base.tangential_force": (time, force)}')
        self._times: dict[str, Array] = {}
        values, noises = [], []
        for column, pair in columns.items():
            if not (isinstance(pair, Sequence) and len(pair) == 2) and not (isinstance(pair, np.ndarray) and len(pair) == 2):
                raise ValueError(f"measured: {column}: give two arrays, (time, values)")
            time = np.atleast_1d(array_of(f"measured: {column}: time", pair[0]))
            if not (time.size and (np.diff(time) > 0).all()):
                raise ValueError(f"measured: {column}: time: must be ascending, with at least one time")
            self._times[column] = time
            values.append(np.broadcast_to(array_of(f"measured: {column}: values", pair[1], time.size), time.size))
            noises.append(self._noise_of(column, sigma, time.size))
        self._kinds = sorted(columns) + ["displacements"] * bool(fields)
        known = [sigma is not None] * bool(columns) + [field.sigma is not None for field in fields]
        probes: dict[str, Any] = {}
        for k, field in enumerate(fields):
            # A name that no probe of the case has.
            name = f"field {k}"
            probes.update(field.probes(name))
            for column, value, noise in field.columns(name):
                self._times[column] = np.array([field.time])
                values.append(np.array([value]))
                noises.append(np.array([1.0 if noise is None else noise]))
        self.case = case.replace({"probes": {**(case._document.get("probes") or {}), **probes}}) if probes else case
        self.measured = np.concatenate(values)
        if any(known) and not all(known):
            raise ValueError("sigma: is given for some of what was measured: give it for all, to the record and to its fields")
        self.sigma, self.weight = noise_of(np.concatenate(noises) if all(known) else None, weight, self.measured.size)
        if self.sigma is None and len(self._kinds) > 1:
            raise ValueError("sigma: several columns need it: the size of their noise determines the weight of each")

    @staticmethod
    def _noise_of(column: str, sigma: Any, size: int) -> Array:
        """Noise of a column; ones where it is not given."""
        if isinstance(sigma, Mapping):
            if column not in sigma:
                raise ValueError(f"sigma: there is none for {column}: give one for every column")
            return np.broadcast_to(array_of(f"sigma: {column}", sigma[column], size), size)
        if not isinstance(sigma, (Real, type(None))):
            raise ValueError(f"sigma: is a {type(sigma).__name__}: give a number, or by column of the history")
        return np.full(size, 1.0 if sigma is None else float(sigma))

    @property
    def kind(self) -> str:
        """What the residuals are of."""
        return ", ".join(self._kinds)

    def predicted(self, parameters: Mapping[str, Any], threads: int | None = None) -> Array:
        """What the run predicts with values by place, shape (1, n)."""
        values = {place: float(np.ravel(value)[0]) for place, value in parameters.items()}
        return self.solved(values, [], threads)[0][None]

    def _place(self, name: str) -> str:
        """The place of the case at which a free value stands."""
        return name

    def _value(self, name: str) -> tuple[str, float]:
        """The name of a free value as the case writes it, and the number there, which may be a default.

        Raises:
            ValueError: it is no place.
            CaseError: there is no number at the place, or 0.
        """
        if "." not in name:
            raise ValueError(f"free: {name}: runs are fitted by places of their cases, such as contacts.base.friction.mu_k")
        return value_at(self.case, name)

    def with_values(self, values: Mapping[str, float]) -> Case:
        """The case with values by name."""
        return self.case.replace({self._place(name): value for name, value in values.items()})

    def solved(self, values: Mapping[str, float], by: Sequence[str], threads: int | None) -> tuple[Array, Array]:
        """What the run predicts, (n,), and its derivatives by free values, (n, by).

        Raises:
            CaseError: the case has no such place, does not accept a value, or its run does not have what was measured.
            Stopped: the run stopped, or its derivatives are lost on the way.
        """
        with warnings.catch_warnings():
            # Those of every trial are the same; whoever runs the fitted case is warned.
            warnings.simplefilter("ignore", RunWarning)
            places = [self._place(name) for name in by]
            result = lean(self.with_values(values)).run(threads=threads, progress=False, gradients=places)
        history = self._measurable(_tables(result))
        self._check(history)
        slopes = np.empty((self.measured.size, len(by)))
        for k, place in enumerate(places):
            derivatives = self._derivatives(result, place)
            slopes[:, k] = self._sampled(derivatives)
            if not np.isfinite(slopes[:, k]).all():
                lost = derivatives["time"][~np.isfinite(derivatives.to_numpy(dtype=float)).all(axis=1)].min()
                raise Stopped(
                    f"the derivatives by {by[k]} are lost at time {lost:g} (docs/guide/gradients.md): give shorter increments there, or fix it",
                    result,
                )
        return self._sampled(history), slopes

    def _measurable(self, history: pd.DataFrame) -> pd.DataFrame:
        """A history with the columns that were measured."""
        return history

    def _derivatives(self, result: Result, place: str) -> pd.DataFrame:
        """Derivatives of the columns that were measured, over time.

        Raises:
            CaseError: a column has none.
        """
        gradients, table = result.gradients, {}
        for column in self._times:
            if (name := f"d({column})/d({place})") not in gradients:
                raise refused("fit", f"measured.{column}", "has no derivatives: give a force, displacement, strain or energy")
            table[column] = gradients[name]
        return pd.DataFrame({"time": gradients["time"], **table})

    def _sampled(self, table: pd.DataFrame) -> Array:
        """The columns at the times when they were measured, one after another."""
        return np.concatenate([np.interp(time, table["time"], table[column]) for column, time in self._times.items()])

    def _check(self, history: pd.DataFrame) -> None:
        """Check that a history has what was measured.

        Raises:
            CaseError: a column is missing, or times are outside.
        """
        known = [str(column) for column in history if column not in ("time", "step", "dt")]
        first, last = history["time"].iloc[0], history["time"].iloc[-1]
        for column, time in self._times.items():
            if column not in known:
                near = difflib.get_close_matches(column, known, 1)
                meant = f"did you mean `{near[0]}`? It" if near else "it"
                raise refused("fit", f"measured.{column}", f"the run has no such column; {meant} has {', '.join(known)}")
            # Times are sums of increments.
            slack = 1e-9 * max(abs(first), abs(last))
            for at in (time[0], time[-1]):
                if not first - slack <= at <= last + slack:
                    raise refused("fit", f"measured.{column}", f"was measured at time {at:g}, but increments end at {first:g} to {last:g}: leave it out")

    def __repr__(self) -> str:
        times = np.concatenate(list(self._times.values()))
        return f"<Run of {self.case!r}: {self.kind} at {times.size} times and places, {times.min():.6g} to {times.max():.6g}>"


def _tables(result: Result) -> pd.DataFrame:
    """The history, with the readings of the probes at its rows."""
    history = result.history
    if not (result.folder / "probes.csv").is_file():
        return history
    probes = result.probes
    return pd.concat([history, probes[[column for column in probes if column not in history]]], axis=1)
