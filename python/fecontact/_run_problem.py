"""Fits of cases: values at places as a space, and residuals of runs over it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from ._fit_problem import Problem
from ._fit_space import Array, Space
from ._plain import names
from ._run_record import Run
from .errors import CaseError, Stopped

# Range of a value that has none given, either way.
FACTOR = 10.0


class Places(Space):
    """Values at places of a case."""

    def parameters(self, points: Array) -> dict[str, Any]:
        """Values by place at points (sets, free)."""
        return {place: value for place, value in super().parameters(points).items() if place != "law"}


class RunProblem(Problem):
    """Residuals of all runs; a point is run once, with its derivatives."""

    # Far below what noise leaves uncertain, above what the tolerance of runs does.
    accuracy = 1e-6

    def __init__(self, records: Sequence[Run], space: Space, threads: int | None) -> None:
        super().__init__(records, space, threads)
        self.model = records[0]._fitted
        self.runs = 0
        self._known: dict[bytes, tuple[Array, Array] | None] = {}

    def residuals(self, points: Array) -> Array:
        """Weighted residuals (sets, samples) at points (sets, free); NaN where a case is refused, or its run stops."""
        nothing = np.full(sum(record.measured.size for record in self.records), np.nan)
        answers = [self._answer(point) for point in points]
        return np.stack([nothing if answer is None else answer[0] for answer in answers])

    def jacobian(self, point: Array) -> Array:
        """∂residual/∂coordinate (samples, free)."""
        answer = self._answer(point)
        return np.zeros((self.residuals(point[None]).size, point.size)) if answer is None else answer[1]

    def _answer(self, point: Array) -> tuple[Array, Array] | None:
        key = np.asarray(point).tobytes()
        if key not in self._known:
            try:
                self._known[key] = self._run(point)
            except (CaseError, Stopped) as error:
                self.refusal, self._known[key] = self.refusal or error, None
        return self._known[key]

    def _run(self, point: Array) -> tuple[Array, Array]:
        """Residuals, and their derivatives by the coordinates."""
        values = {place: float(np.ravel(value)[0]) for place, value in self.space.parameters(point[None]).items()}
        slopes = self.space.slopes(point)
        residuals, jacobians = [], []
        for record, scale in zip(self.records, self.scales):
            self.runs += 1
            predicted, by = record.solved(values, list(slopes), self.threads)
            share = record.weight / scale
            residuals.append((predicted - record.measured) * share)
            jacobians.append(by * share[:, None])
        return np.concatenate(residuals), np.asarray(np.concatenate(jacobians) @ np.stack(list(slopes.values())))


def run_problem(records: Sequence[Run], free: Any, start: Any, threads: int | None) -> tuple[RunProblem, Array]:
    """The problem, and the shares of the ranges at which its search begins.

    Raises:
        ValueError: a range or value of the start is none.
        CaseError: a case has no value at a place.
    """
    given = names(list(free), "free", "fit")
    if not isinstance(start, Mapping):
        raise ValueError(f"start: is a {type(start).__name__}: give values by place")
    if not given:
        raise ValueError("free: is empty: name what is to be found, such as contacts.base.friction.mu_k")
    found = {place: [record._value(place) for record in records] for place in given}
    written = {place: own[0][0] for place, own in found.items()}
    # Two ways to write a place are one place.
    if twice := [place for k, place in enumerate(given) if written[place] in [written[other] for other in given[:k]]]:
        raise ValueError(f"free: {twice[0]} is given twice")
    first = {written[place]: own[0][1] for place, own in found.items()}
    ranges = free if isinstance(free, Mapping) else {place: _range(first[written[place]]) for place in given}
    space = Places("", {written[place]: ranges[place] for place in given}, {})
    for place, value in start.items():
        name = written.get(place, place)
        if name not in space.names:
            raise ValueError(f"start: {place} is not free; there are {', '.join(space.names)}")
        low, high = space.ranges[name]
        if not (isinstance(value, Real) and low <= float(value) <= high):
            raise ValueError(f"start: {place}: {value!r} is not within its range, {low:g} to {high:g}")
        first[name] = float(value)
    middle = space.values((space.low + space.high) / 2)
    values = [first[name] if low <= first[name] <= high else middle[k] for k, (name, (low, high)) in enumerate(space.ranges.items())]
    return RunProblem(records, space, threads), space.shares(space.coordinates(np.array(values)))


def _range(value: float) -> tuple[float, float]:
    return (value / FACTOR, value * FACTOR) if value > 0 else (value * FACTOR, value / FACTOR)
