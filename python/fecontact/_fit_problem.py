"""Residuals of records over the space of a fit, their derivatives, and a search from one point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._fit_space import Array, Space
from ._records import OF_RECORDS, Record
from .errors import CaseError, Stopped
from .law import law as law_of

# Step of differences, in logarithms or shares of the range.
STEP = 1e-4


class Problem:
    """Residuals of all records over points of the space."""

    # What is fitted.
    model = "law"
    # Relative change of S, and of the shares, at which a search ends.
    accuracy = 1e-8

    def __init__(self, records: Sequence[Any], space: Space, threads: int | None) -> None:
        self.records, self.space, self.threads = records, space, threads
        # What the law said of the first parameters that it does not accept.
        self.refusal: CaseError | Stopped | None = None
        # Why the law first had no answer.
        self.stopped: Stopped | None = None
        self.scales = [np.ones(record.measured.size) if record.sigma is None else record.sigma for record in records]

    def residuals(self, points: Array) -> Array:
        """Weighted residuals (sets, samples) at points (sets, free)."""
        parameters = self.space.parameters(points)
        parts = [
            (self._predicted(record, parameters) - record.measured) * (record.weight / scale)
            for record, scale in zip(self.records, self.scales)
        ]
        return np.concatenate(parts, axis=-1)

    def _predicted(self, record: Record, parameters: dict[str, Any]) -> Array:
        """Prediction of the law; NaN for sets that it does not accept or cannot solve, which the search avoids."""
        try:
            return record.predicted(parameters, self.threads)
        except (CaseError, Stopped) as error:
            if isinstance(error, CaseError):
                self.refusal = self.refusal or error
            else:
                self.stopped = self.stopped or error
            sets = next(value.size for value in parameters.values() if isinstance(value, np.ndarray))
            if sets == 1:
                return np.full((1, record.measured.size), np.nan)
            one = [{name: _entry(value, k) for name, value in parameters.items()} for k in range(sets)]
            return np.concatenate([self._predicted(record, each) for each in one])

    def at(self, point: Array) -> Array:
        """Residuals at one point."""
        return np.asarray(self.residuals(point[None])[0])

    def jacobian(self, point: Array) -> Array:
        """∂residual/∂coordinate (samples, free), exact if the law provides derivatives."""
        try:
            found = self._exact(point)
        except (CaseError, Stopped):
            found = None
        if found is None or not np.isfinite(found).all():
            found = self.differences(point)
        return np.nan_to_num(found, nan=0.0, posinf=0.0, neginf=0.0)

    def _exact(self, point: Array) -> Array | None:
        """The same from the derivatives of the law; None if it has none."""
        slopes = self.space.slopes(point)
        parameters = {name: plain_of(value) for name, value in self.space.parameters(point[None]).items()}
        of_law = law_of({name: value for name, value in parameters.items() if name not in OF_RECORDS})
        if not set(slopes) <= {*of_law.sensitivities(), *OF_RECORDS}:
            return None
        by = list(slopes)
        parts = [
            record.derivatives(parameters, by, self.threads) * (record.weight / np.broadcast_to(scale, record.measured.size))[:, None]
            for record, scale in zip(self.records, self.scales)
        ]
        return np.asarray(np.concatenate(parts) @ np.stack(list(slopes.values())))

    def differences(self, point: Array) -> Array:
        """The same by central differences within the ranges, one-sided where the law fails on the other side."""
        above, below = np.minimum(point + STEP, self.space.high), np.maximum(point - STEP, self.space.low)
        sides = self.residuals(point + np.concatenate([np.diag(above - point), np.diag(below - point)]))
        here, count = self.at(point), point.size
        known = np.asarray(np.isfinite(sides).all(axis=-1))
        sides[~known] = here
        steps = np.where(known[:count], above - point, 0.0) - np.where(known[count:], below - point, 0.0)
        return np.asarray(((sides[:count] - sides[count:]) / np.where(steps > 0.0, steps, 1.0)[:, None]).T)


@dataclass(frozen=True)
class End:
    """End of a search: shares of the valid ranges, the point, and its residuals."""

    shares: Array
    point: Array
    residuals: Array
    # Whether a search ended by itself.
    converged: bool = True

    @property
    def squares(self) -> float:
        """S."""
        return float(np.sum(self.residuals**2))


def search(problem: Problem, shares: Array, most: int) -> End | None:
    """A search from one point, with a limited number of solves; None if the law fails there."""
    from scipy.optimize import least_squares

    space, shares = problem.space, np.clip(shares, 1e-9, 1.0 - 1e-9)
    if not np.isfinite(problem.at(space.within(shares))).all():
        return None
    # Where there are no residuals at all, it divides by nothing.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = least_squares(
            lambda shares: problem.at(space.within(shares)),
            shares,
            lambda shares: problem.jacobian(space.within(shares)) @ space.slopes_within(shares),
            (0.0, 1.0), x_scale="jac", ftol=problem.accuracy, xtol=problem.accuracy, gtol=None, max_nfev=most,
        )  # fmt: skip
    return End(found.x, space.within(found.x), found.fun, found.status > 0)


def _entry(value: Any, k: int) -> Any:
    return value[k : k + 1] if isinstance(value, np.ndarray) else value


def plain_of(value: Any) -> Any:
    return float(value[0]) if isinstance(value, np.ndarray) else value
