"""Laws fitted to measurements: least squares, with what the data tell of each parameter, and what they do not.

The parameters x are fitted by their logarithms where the range to find them in is positive, and as they are where it is not::

    S(x) = Σ w² ((y(x) − ŷ)/σ)² → min,   cov = s² (JᵀJ)⁻¹,   interval = x ± t₀.₉₇₅(n − m) √cov

J is exact, of what the law computes with its sub-steps as they are: parameters and state are differentiated together from sample to sample
(:meth:`fecontact.law.Law.drive`, ``by``). Laws that do not differentiate, those written in Python and backward Euler, have central differences.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ._fit_names import check_names, check_room, no_room
from ._records import MACHINE, Array, Holds, Interface, Record, SpringSlider
from .errors import CaseError, Stopped
from .law import Law
from .law import law as law_of

__all__ = ["Fit", "Holds", "Interface", "SpringSlider", "fit"]

# Step of differences, in logarithms or shares of the range.
STEP = 1e-4
# Error that the law is allowed where it controls it: far below what STEP changes.
TOLERANCE = 1e-8
# Points at which the search may start, from which the best are taken.
SCREENED = 128
# Standard deviation of a logarithm, or share of a range, from which on data tell nothing: a factor of 3 either way.
UNKNOWN = 0.5
# Share in a direction from which on a parameter belongs to it.
SHARE = 0.3
# Correlation from which on two parameters are told to trade off.
TRADE = 0.98
# Correlation of residuals beyond 1/√n at which they are no noise, in standard deviations.
NOISE = 4.0
# s/σ above which the law does not reach the noise that was given.
MISFIT = 1.3

# Ranges of the parameters of super/subloading friction, of what the records cover: of the coefficient, 1/slip, 1/time, or
# coefficient times pressure over slip.
RANGES = {
    "mu_s": ("coefficient", 0.5, 3.0),
    "mu_k": ("coefficient", 0.1, 1.0),
    "r": ("slip", 1.0, 1e6),
    "kappa": ("slip", 1e-2, 1e4),
    "xi": ("time", 1e-4, 1e3),
    "alpha_t": ("stiffness", 1.0, 1e6),
    "stiffness": ("stiffness", 1e-2, 1e4),
}


class _Space:
    """Free parameters as coordinates between −1 and 1 or logarithms, and all parameters of points in it."""

    def __init__(self, law: str, ranges: Mapping[str, tuple[float, float]], fixed: Mapping[str, Any]) -> None:
        self.names = list(ranges)
        for name, (low, high) in ranges.items():
            if not (np.isfinite([low, high]).all() and low < high):
                raise ValueError(f"free: {name}: the range ({low}, {high}) must be finite and ascending")
        ends = np.array(list(ranges.values()), dtype=float)
        self.log = ends[:, 0] > 0
        self.width = np.where(self.log, 1.0, ends[:, 1] - ends[:, 0])
        self._law, self._fixed = law, dict(fixed)
        self.low, self.high = self.coordinates(ends[:, 0]), self.coordinates(ends[:, 1])

    def coordinates(self, values: Array) -> Array:
        """Coordinates of values of the free parameters."""
        return np.where(self.log, np.log(np.where(self.log, values, 1.0)), values / self.width)

    def values(self, points: Array) -> Array:
        """Values of the free parameters at points (..., free)."""
        return np.where(self.log, np.exp(np.where(self.log, points, 0.0)), points * self.width)

    def parameters(self, points: Array) -> dict[str, Any]:
        """All parameters at points (sets, free)."""
        free = dict(zip(self.names, self.values(points).T))
        given = {"law": self._law, **self._fixed, **free}
        if self._law == "super_subloading":
            given.setdefault("tolerance", TOLERANCE)
            # The law has μ_k ≤ μ_s only, and a structure up to μ_s/μ_k; what is missing it complains of itself.
            if {"mu_s", "mu_k"} <= set(given):
                if "mu_s" in free:
                    given["mu_s"] = np.maximum(given["mu_s"], given["mu_k"])
                elif "mu_k" in free:
                    given["mu_k"] = np.minimum(given["mu_k"], given["mu_s"])
                if given.get("structure") is not None:
                    given["structure"] = np.clip(given["structure"], 1.0, given["mu_s"] / np.asarray(given["mu_k"]))
        return given

    def slopes(self, point: Array) -> dict[str, Array]:
        """Derivatives of the parameters that vary, by the coordinates (free,)."""
        values = self.values(point)
        rows = dict(zip(self.names, np.diag(np.where(self.log, values, self.width))))
        given = {**self._fixed, **dict(zip(self.names, values))}
        if self._law != "super_subloading" or not {"mu_s", "mu_k"} <= set(given):
            return rows
        none = np.zeros(len(self.names))
        if given["mu_s"] < given["mu_k"]:
            if "mu_s" in rows:
                rows["mu_s"], given["mu_s"] = rows.get("mu_k", none), given["mu_k"]
            elif "mu_k" in rows:
                rows["mu_k"], given["mu_k"] = none, given["mu_s"]
        if given.get("structure") is not None:
            most = given["mu_s"] / given["mu_k"]
            if given["structure"] > most:
                rows["structure"] = (rows.get("mu_s", none) - most * rows.get("mu_k", none)) / given["mu_k"]
            elif given["structure"] < 1.0:
                rows["structure"] = none
        return rows


class _Problem:
    """Residuals of all records over points of the space."""

    def __init__(self, records: Sequence[Record], space: _Space, threads: int | None) -> None:
        self.records, self.space, self._threads = records, space, threads
        # What the law said of the first parameters that it does not accept.
        self.refusal: CaseError | None = None
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
        """What the law says; not a number for sets that it does not accept or has no answer for, from which the search turns back."""
        try:
            return record.predicted(parameters, self._threads)
        except (CaseError, Stopped) as error:
            if isinstance(error, CaseError):
                self.refusal = self.refusal or error
            sets = next(value.size for value in parameters.values() if isinstance(value, np.ndarray))
            if sets == 1:
                return np.full((1, record.measured.size), np.nan)
            one = [{name: _entry(value, k) for name, value in parameters.items()} for k in range(sets)]
            return np.concatenate([self._predicted(record, each) for each in one])

    def at(self, point: Array) -> Array:
        """Those of one point."""
        return np.asarray(self.residuals(point[None])[0])

    def jacobian(self, point: Array) -> Array:
        """∂residual/∂coordinate (samples, free), exact where the law says how its answers vary."""
        slopes = self.space.slopes(point)
        parameters = {name: _plain(value) for name, value in self.space.parameters(point[None]).items()}
        of_law = law_of({name: value for name, value in parameters.items() if name not in MACHINE})
        if not set(slopes) <= {*of_law.sensitivities(), *MACHINE}:
            return self.differences(point)
        by = list(slopes)
        parts = [
            record.derivatives(parameters, by, self._threads) * (record.weight / np.broadcast_to(scale, record.measured.size))[:, None]
            for record, scale in zip(self.records, self.scales)
        ]
        return np.asarray(np.concatenate(parts) @ np.stack(list(slopes.values())))

    def differences(self, point: Array) -> Array:
        """The same by central differences within the ranges, by one side where the other has no answer."""
        above, below = np.minimum(point + STEP, self.space.high), np.maximum(point - STEP, self.space.low)
        sides = self.residuals(point + np.concatenate([np.diag(above - point), np.diag(below - point)]))
        here, count = self.at(point), point.size
        known = np.asarray(np.isfinite(sides).all(axis=-1))
        sides[~known] = here
        steps = np.where(known[:count], above - point, 0.0) - np.where(known[count:], below - point, 0.0)
        return np.asarray(((sides[:count] - sides[count:]) / np.where(steps > 0.0, steps, 1.0)[:, None]).T)


class Fit:
    """A fitted law.

    Attributes:
        parameters: all, those given included.
        table: a row a free parameter: ``value``, ``low`` and ``high`` of its 95 % interval, ``std`` (of its logarithm where ``log``).
        correlation: of the free parameters.
        words: what to know about it, in plain words; empty where nothing is wrong.
        noise: s, standard deviation of the residuals; in units of sigma where sigma was given.
        residuals: of each record, fitted minus measured.
        memory: correlation of a residual with the one before; 0 for noise, near 1 where the law cannot follow the data.
        ends: where each start has ended: the free parameters and S.
    """

    def __init__(self, problem: _Problem, ends: list[Any]) -> None:
        from scipy.stats import t

        best, space = ends[0], problem.space
        samples, free = best.jac.shape
        self.noise = float(np.sqrt(2.0 * best.cost / (samples - free)))
        self.parameters = {name: _plain(value) for name, value in space.parameters(best.x[None]).items()}
        # Beyond this a direction says nothing; it keeps the inverse finite.
        _, singular, turn = np.linalg.svd(problem.jacobian(best.x), full_matrices=False)
        scale = 1.0 if problem.records[0].sigma is not None else self.noise
        spread = scale / np.maximum(singular, 1e-12 * max(singular[0], np.finfo(float).tiny))
        covariance = (turn.T * spread**2) @ turn
        std = np.sqrt(np.diag(covariance))
        half = t.ppf(0.975, samples - free) * std
        with np.errstate(over="ignore"):
            low, value, high = (space.values(best.x + side * half) for side in (-1.0, 0.0, 1.0))
        index = pd.Index(space.names, name="parameter")
        columns = {"value": value, "low": low, "high": high, "std": std * space.width, "log": space.log}
        self.table = pd.DataFrame(columns, index=index)
        self.correlation = pd.DataFrame(covariance / np.outer(std, std), index=index, columns=index)
        parts = np.split(best.fun, np.cumsum([record.measured.size for record in problem.records])[:-1])
        self.residuals = [part * noise / record.weight for part, noise, record in zip(parts, problem.scales, problem.records)]
        self.memory = max(_memory(part) for part in parts)
        self.ends = pd.DataFrame([[*space.values(end.x), 2.0 * end.cost] for end in ends], columns=[*space.names, "S"])
        at_end = [np.abs(best.x - end) <= 1e-6 * (space.high - space.low) for end in (space.low, space.high)]
        self.words = _words(self, spread, turn, at_end[0] | at_end[1], problem.records[0].sigma is not None)

    @property
    def law(self) -> Law:
        """The law with these parameters."""
        return law_of({name: value for name, value in self.parameters.items() if name not in MACHINE})

    def predicted(self, record: Record) -> Array:
        """What it says for a record, also for one that it was not fitted to, shape (n,)."""
        sets = {name: np.array([value]) if isinstance(value, float) else value for name, value in self.parameters.items()}
        return np.asarray(record.predicted(sets)[0])

    def __repr__(self) -> str:
        told = self.table[["value", "low", "high"]].to_string(float_format=lambda number: f"{number:.5g}")
        return "\n".join([told, *self.words])


def fit(
    data: Record | Iterable[Record],
    law: str = "super_subloading",
    free: Sequence[str] | Mapping[str, tuple[float, float]] = ("mu_s", "mu_k", "r", "kappa", "xi"),
    *,
    starts: int = 4,
    seed: int = 0,
    threads: int | None = None,
    **fixed: Any,
) -> Fit:
    """Fit a law to measured curves.

    Args:
        data: records: :class:`Interface`, :class:`SpringSlider`, :class:`Holds`, or several of them. Records of different kinds need a
            ``sigma`` each.
        law: its name.
        free: parameters to find, with the ranges to find them in; positive ones are searched by their logarithm. Without ranges
            (super/subloading friction only) they come from what the records cover, wide. Ranges may overlap: trials that the law does not accept,
            ``mu_d`` above ``mu_s``, are passed over.
        starts: searches, from the best of 128 points spread over the ranges.
        seed: of those points.
        threads: all cores unless given.
        **fixed: the other parameters; ``stiffness`` and ``mass`` are those of the machine of a :class:`SpringSlider`.

    Returns:
        The best of the fits. Read its ``words``: they say which parameters these data do not determine.

    Raises:
        ValueError: a name that the law does not have, with the nearest that it has; ranges in which no start is valid.
    """
    from scipy.optimize import least_squares
    from scipy.stats import qmc

    records = [data] if isinstance(data, (Interface, Holds)) else list(data)
    _check(records, free, fixed)
    check_names(law, [*free, *fixed])
    ranges = dict(free) if isinstance(free, Mapping) else _ranges(law, free, records)
    space = _Space(law, ranges, fixed)
    check_room(law, ranges, fixed)
    problem = _Problem(records, space, threads)
    spread = space.low + (space.high - space.low) * qmc.LatinHypercube(len(space.names), rng=seed).random(SCREENED)
    costs = np.sum(problem.residuals(spread) ** 2, axis=-1)
    ends = [
        least_squares(problem.at, spread[k], problem.jacobian, (space.low, space.high), x_scale="jac", ftol=1e-8, xtol=1e-8, gtol=None, max_nfev=100)
        for k in np.argsort(costs)[:starts]
        if np.isfinite(costs[k])
    ]
    if not ends and problem.refusal is not None:
        raise no_room(ranges, str(problem.refusal)) or problem.refusal
    if not ends:
        raise ValueError("free: the law has no answer to these records anywhere in the ranges: narrow them")
    return Fit(problem, sorted(ends, key=lambda end: end.cost))


def _check(records: Sequence[Record], free: Iterable[str], fixed: Mapping[str, Any]) -> None:
    if not records:
        raise ValueError("data: there are no records")
    if both := set(free) & set(fixed):
        raise ValueError(f"free: {', '.join(sorted(both))}: given as well")
    known = [record.sigma is not None for record in records]
    if any(known) != all(known):
        raise ValueError("data: give sigma to all records, or to none")
    if len({record.kind for record in records}) > 1 and not all(known):
        raise ValueError("data: records of different kinds need a sigma each: their residuals have different units")
    samples, wanted = sum(record.measured.size for record in records), len(list(free))
    if not 0 < wanted < samples:
        raise ValueError(f"free: {wanted} parameters from {samples} samples: there must be some, and fewer than samples")


def _ranges(law: str, free: Iterable[str], records: Sequence[Record]) -> dict[str, tuple[float, float]]:
    """Wide ranges, from what the records cover."""
    coefficient, slip, time = np.max([record.scales() for record in records], axis=0)
    pressure = max(float(np.max(record.pressure)) for record in records)
    if not min(coefficient, slip, time, pressure) > 0:
        raise ValueError("free: the records have no slip, pressure or friction to take ranges from: give ranges")
    units = {"coefficient": coefficient, "slip": 1.0 / slip, "time": 1.0 / time, "stiffness": coefficient * pressure / slip}
    found = {}
    for name in free:
        if law != "super_subloading" or name not in RANGES:
            raise ValueError(f"free: {name}: give the range to find it in: free={{{name!r}: (low, high)}}")
        of, low, high = RANGES[name]
        found[name] = (low * units[of], high * units[of])
    return found


def _memory(residuals: NDArray[np.float64]) -> float:
    """Correlation of a residual with the one before it."""
    power = float(np.sum(residuals**2))
    return float(np.sum(residuals[1:] * residuals[:-1])) / power if power > 0 else 0.0


def _entry(value: Any, k: int) -> Any:
    return value[k : k + 1] if isinstance(value, np.ndarray) else value


def _plain(value: Any) -> Any:
    return float(value[0]) if isinstance(value, np.ndarray) else value


def _words(fit: Fit, spread: NDArray[np.float64], turn: NDArray[np.float64], at_end: NDArray[np.bool_], sigma: bool) -> list[str]:
    """What to know of a fit, with the spread along each direction of its space."""
    names, told = list(fit.table.index), []
    unknown: set[str] = set()
    for much, direction in zip(spread[::-1], turn[::-1]):
        if much < UNKNOWN:
            break
        members = [name for name, share in zip(names, direction) if abs(share) > SHARE]
        unknown.update(members)
        if len(members) == 1:
            told.append(f"these data do not determine {members[0]}: fix it, or give data that depend on it")
        else:
            told.append(f"{_and(members)} trade off: these data do not tell them apart: fix one")
    told += _trades(fit, unknown)
    for name, ends in zip(names, at_end):
        if ends:
            border = f"{name} ends at the border of its range, {fit.table['value'][name]:.6g}"
            told.append(f"{border}: widen it, or fix it; its interval means nothing")
    if {"mu_s", "mu_k"} <= set(fit.parameters) and fit.parameters["mu_s"] <= fit.parameters["mu_k"] * (1 + 1e-9):
        told.append("mu_s = mu_k: these data show no weakening, and kappa, xi have no effect")
    samples = sum(residuals.size for residuals in fit.residuals)
    if fit.memory > NOISE / np.sqrt(samples):
        told.append(
            f"the residuals are no noise (each has the correlation {fit.memory:.2f} with the one before): this law does not follow these "
            "data, or their noise has a memory; the intervals are too narrow"
        )
    if sigma and fit.noise > MISFIT:
        told.append(
            f"the residuals are {fit.noise:.3g} times as large as sigma: this law does not follow these data; the intervals are too narrow"
        )
    return told + _others(fit)


def _trades(fit: Fit, unknown: set[str]) -> list[str]:
    names, told = list(fit.table.index), []
    for i, one in enumerate(names):
        for other in names[:i]:
            correlation = fit.correlation.loc[one, other]
            if abs(correlation) > TRADE and not {one, other} <= unknown:
                told.append(f"{other} and {one} trade off (correlation {correlation:.3f}): fix one for a narrower interval of the other")
    return told


def _others(fit: Fit) -> list[str]:
    """Other fits that are as good and lie elsewhere."""
    best = fit.ends.iloc[0]
    for _, end in fit.ends.iloc[1:].iterrows():
        away = [name for name in fit.table.index if not fit.table["low"][name] <= end[name] <= fit.table["high"][name]]
        if end["S"] <= 1.02 * best["S"] and away:
            values = ", ".join(f"{name} {end[name]:.4g}" for name in fit.table.index)
            return [f"another fit is as good within 1 %, {values}: these data do not choose between them"]
    return []


def _and(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
