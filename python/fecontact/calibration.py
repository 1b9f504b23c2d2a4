"""Fits of laws to measurements by least squares, with the parameters that the data do and do not determine.

The parameters x are fitted by their logarithms if their range is positive, otherwise directly::

    S(x) = Σ w² ((y(x) − ŷ)/σ)² → min,   cov = (JᵀJ/s² + diag(1/range²))⁻¹,   interval = x ± t₀.₉₇₅(n − m) √cov

J is weighted by the share of rows that count as independent where residuals have a memory. The ranges are prior information: a parameter not determined by the data lies within its range, which also limits its effect on the others. J
is the exact derivative of the computed values at fixed sub-steps: parameters and state are differentiated together from sample to sample
(:meth:`fecontact.law.Law.drive`, ``by``). For laws without derivatives (written in Python, or backward Euler) central differences are used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ._element_tests import ElementTest, Oedometer, Triaxial
from ._fit_names import check_names, check_room, no_room
from ._fit_problem import End, plain_of, search
from ._fit_problem import Problem as _Problem
from ._fit_space import Array, Space
from ._fit_words import COMPUTED, NOISE, Evidence, words
from ._plain import a_name, count, names, number
from ._records import OF_RECORDS, Holds, Interface, PullOff, Record, SpringSlider
from ._run_problem import RunProblem, run_problem
from ._run_record import DisplacementField, Run
from ._table_file import read
from .case import Case
from .law import Law
from .law import law as law_of

__all__ = [
    "DisplacementField", "ElementTest", "Fit", "Holds", "Interface", "Oedometer", "PullOff", "Run", "SpringSlider", "Triaxial", "compare", "fit", "read",
]  # fmt: skip

# Points at which the search may start, from which the best are taken.
SCREENED = 128
# Searches that are begun for each that is carried on to its end, and linear solves that they have for it.
BEGUN, BEGINNING = 3, 12
# Law and number of completed searches of a fit, unless others are given.
LAW, STARTS = "super_subloading", 4
# Trials of a search through runs.
MOST_RUNS = 40
# Standard deviation of a logarithm, or share of a range, from which on an interval says nothing: a factor of 100 either way.
NOTHING = 2.3
# Coordinates nearer to a border than this share of the range are there.
BORDER = 1e-6
# Standard deviation of residuals that are nothing at all.
LEAST_NOISE = 1e-100

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


def _searched(problem: _Problem, start: Mapping[str, float], starts: int, seed: int) -> list[End]:
    """Ends of the searches, the best first: many are started, the most promising are continued."""
    from scipy.stats import qmc

    rough = _Problem([record.rough() for record in problem.records], problem.space.rough(), problem.threads)
    spread = qmc.LatinHypercube(len(problem.space.names), rng=seed).random(SCREENED)
    with np.errstate(over="ignore"):
        costs = np.sum(rough.residuals(problem.space.within(spread)) ** 2, axis=-1)
    screened = [spread[k] for k in np.argsort(costs) if np.isfinite(costs[k])]
    carried = [end.shares for end in _ends(rough, screened[: BEGUN * starts], BEGINNING)]
    problem.refusal, problem.stopped = rough.refusal, rough.stopped
    if start:
        first = _first(problem, start, problem.space.within(np.stack([*carried, np.full(len(spread[0]), 0.5)]))[0])
        carried = [first, *carried]
    # What the rough law answers, the exact one may not.
    return _ends(problem, carried[:starts], 100) or _ends(problem, carried[starts:], 100)


def _ends(problem: _Problem, begin: list[Array], most: int) -> list[End]:
    """Ends of searches from some points, the best first."""
    found = (search(problem, shares, most) for shares in begin)
    return sorted((end for end in found if end is not None), key=lambda end: end.squares)


def _first(problem: _Problem, start: Mapping[str, float], point: Array) -> Array:
    """Shares of the requested starting point of a search; parameters not given are those of the point.

    Raises:
        ValueError: there is no such free parameter, or its value is out of its range.
    """
    space, point = problem.space, point.copy()
    for name, value in start.items():
        if name not in space.names:
            raise ValueError(f"start: {name} is not a free parameter; there are {', '.join(space.names)}")
        low, high = space.ranges[name]
        if not (isinstance(value, Real) and low <= value <= high):
            raise ValueError(f"start: {name}: {value!r} is not within its range, {low:g} to {high:g}")
        values = space.values(point)
        values[space.names.index(name)] = value
        point = space.coordinates(values)
    if not np.isfinite(problem.at(point)).all():
        raise ValueError("start: the law has no answer to these records there")
    return space.shares(point)


def _profile(problem: _Problem, best: End, name: str, step: float, excess: float, points: int) -> pd.DataFrame:
    """Minimum sums of squares with a parameter fixed at values on either side of the best, up to `excess` above it."""
    space, k = problem.space, problem.space.names.index(name)
    # √(S − S_min), linear in the parameter where the law is.
    target, rows = np.sqrt(excess), {float(best.point[k]): (0.0, best)}

    def distance(at: float, near: End) -> tuple[float, End]:
        rows[at] = (0.0, end := _held(problem, k, at, near.point))
        rows[at] = (float(np.sqrt(max(end.squares - best.squares, 0.0))), end)
        return rows[at]

    ends = []
    for side, border in ((-1.0, space.bottom[k]), (1.0, space.top[k])):
        (inner, near), stride = (float(best.point[k]), best), min(max(step, 1e-6), 0.1 * float(space.high[k] - space.low[k]))
        inside = 0.0
        for left in range(points, 0, -1):
            outer = float(border) if left == 1 else side * min(side * (inner + side * stride), side * float(border))
            beyond, end = distance(outer, near)
            if beyond > target or outer == border:
                break
            inner, near, inside, stride = outer, end, beyond, 1.5 * stride
        if beyond <= target:
            ends.append(side * np.inf)
            continue
        for _ in range(3):
            middle = inner + (target - inside) / (beyond - inside) * (outer - inner)
            found, end = distance(middle, near)
            if found <= target:
                inner, inside, near = middle, found, end
            else:
                outer, beyond = middle, found
        ends.append(inner + (target - inside) / (beyond - inside) * (outer - inner))
    table = pd.DataFrame(
        [{**dict(zip(space.names, space.values(rows[at][1].point))), "S": rows[at][1].squares} for at in sorted(rows)]
    )
    low, high = (float(space.values(np.where(np.arange(len(space.names)) == k, end, best.point))[k]) for end in ends)
    table.attrs.update(low=low, high=high, limit=best.squares + excess)
    return table


def _held(problem: _Problem, k: int, at: float, near: Array) -> End:
    """The best fit with one coordinate fixed, starting from a nearby point."""
    space, point = problem.space, near.copy()
    point[k] = at
    name = space.names[k]
    others = {other: ends for other, ends in space.ranges.items() if other != name}
    if not others:
        return End(point, point, problem.at(point))
    rest = type(space)(space.law, others, {**space.fixed, name: float(space.values(point)[k])})
    end = search(type(problem)(problem.records, rest, problem.threads), rest.shares(np.delete(point, k)), 40)
    if end is None:
        return End(point, point, np.full(problem.at(near).size, np.inf))
    return End(end.shares, np.insert(end.point, k, at), end.residuals)


class Fit:
    """A fitted law, or fitted parameters of cases.

    Attributes:
        parameters: all parameters, including the given ones; of a fit through runs the fitted ones, by place; of tests of samples those of the law.
        table: one row per free parameter: ``value``, ``low`` and ``high`` of its 95 % interval, from zero to infinity where the data do not
            determine it, ``std`` (of its logarithm where ``log``). Where residuals have a memory ρ, n of them count as n (1 − ρ)/(1 + ρ).
        correlation: correlation of the free parameters.
        words: assessment of the fit in words; empty if there is no problem.
        noise: s, standard deviation of the residuals; in units of sigma where sigma was given.
        residuals: fitted minus measured values of each record.
        memory: correlation of successive residuals; 0 for noise, near 1 where the law cannot follow the data.
        ends: result of each search: the free parameters and S.
        runs: number of finite-element runs that it took; 0 for records of a point.
    """

    def __init__(self, problem: _Problem, ends: list[End], tested: Mapping[str, Any] | None = None) -> None:
        from scipy.stats import t

        self._problem, self._best, self._tested = problem, ends[0], tested
        best, space, samples = ends[0], problem.space, ends[0].residuals.size
        free, sigma = len(space.names), problem.records[0].sigma is not None
        self.noise = float(np.sqrt(best.squares / (samples - free)))
        self.parameters = {name: plain_of(value) for name, value in space.parameters(best.point[None]).items()}
        at_border = np.minimum(abs(best.point - space.low), abs(best.point - space.high)) <= BORDER * (space.high - space.low)
        scale = 1.0 if sigma else max(self.noise, LEAST_NOISE)
        # That a parameter is somewhere in its range is known beforehand: without data its standard deviation is the width of it.
        known = np.diag(1.0 / (space.high - space.low))
        parts = np.split(best.residuals, np.cumsum([record.measured.size for record in problem.records])[:-1])
        self.residuals = [part * noise / record.weight for part, noise, record in zip(parts, problem.scales, problem.records)]
        misfits = [_share(part, record.measured) for part, record in zip(self.residuals, problem.records)]
        shares = [_independent(part, misfit) for part, misfit in zip(parts, misfits)]
        rows = np.concatenate([np.full(part.size, share) for part, share in zip(parts, shares)])
        self._independent, self._measured = min(shares), [record.measured for record in problem.records]
        counted = problem.jacobian(best.point) * np.sqrt(rows)[:, None] / scale
        _, singular, directions = np.linalg.svd(np.vstack([counted, known]), full_matrices=False)
        spread = 1.0 / singular
        covariance = (directions.T * spread**2) @ directions
        self._covariance, self._std = covariance, np.sqrt(np.diag(covariance))
        self._sigma, self._quantile = sigma, float(t.ppf(0.975, samples - free))
        index = pd.Index(space.names, name="parameter")
        self.correlation = pd.DataFrame(covariance / np.outer(self._std, self._std), index=index, columns=index)
        self.table = _table(space, best.point, self._std, self._quantile)
        self.memory = max(_memory(part) for part in parts)
        self.ends = pd.DataFrame([[*space.values(end.point), end.squares] for end in ends], columns=[*space.names, "S"])
        self.words = words(
            Evidence(
                self.table, self.correlation, self.ends, self.parameters, spread, directions, at_border,
                self.noise, sigma, self.memory, samples, max(misfits), problem.model,
            )
        )  # fmt: skip
        self.runs = problem.runs if isinstance(problem, RunProblem) else 0
        if self.runs and not best.converged:
            self.words.append(f"the search had not converged after {MOST_RUNS} trials: continue from here with start, or narrow the ranges")

    @property
    def standardized(self) -> list[Array]:
        """Residuals of each record in standard deviations of the noise: of ``sigma`` where given, else s."""
        size = 1.0 if self._sigma else max(self.noise, LEAST_NOISE)
        sizes = [size * scale / record.weight for scale, record in zip(self._problem.scales, self._problem.records)]
        return [residuals / size for residuals, size in zip(self.residuals, sizes)]

    @property
    def cases(self) -> list[Case]:
        """The cases of the fitted runs, with these parameters; none for records of a point."""
        return [record.with_values(self.parameters) for record in self._problem.records if isinstance(record, Run)]

    @property
    def material(self) -> dict[str, Any]:
        """The law of tests of samples with these parameters, as the ``material`` of a body.

        Raises:
            ValueError: something else was fitted.
        """
        if self._tested is None:
            raise ValueError("material: no tests of samples were fitted: see law, or cases")
        document: dict[str, Any] = self.cases[0].document
        return dict(document["bodies"]["sample"]["material"])

    @property
    def law(self) -> Law:
        """The law of an interface with these parameters.

        Raises:
            ValueError: cases or tests of samples were fitted.
        """
        if isinstance(self._problem, RunProblem):
            kind = "cases were fitted, not a law alone: they are in cases" if self._tested is None else "the law of a body is in material"
            raise ValueError(f"law: {kind}")
        return law_of({name: value for name, value in self.parameters.items() if name not in OF_RECORDS})

    def _with_law(self, record: Record | Run | ElementTest) -> Record | Run:
        """A record that predicts; that of a test of a sample by the law that was fitted.

        Raises:
            ValueError: it is a test of a sample, but none were fitted.
        """
        if not isinstance(record, ElementTest):
            return record
        if self._tested is None:
            raise ValueError("record: is a test of a sample, whose law was not fitted")
        return record.of(self._tested)

    def predicted(self, record: Record | Run | ElementTest) -> Array:
        """Prediction for a record, also for one that was not fitted, shape (n,); of a :class:`Run` or a test of a sample its columns or
        quantities, one after another, of the latter without the start."""
        record = self._with_law(record)
        sets = {name: np.array([value]) if isinstance(value, float) else value for name, value in self.parameters.items()}
        return np.asarray(record.predicted(sets)[0])

    def band(self, record: Record | Run | ElementTest) -> pd.DataFrame:
        """Prediction for a record, also for one that was not fitted, and how sure it is::

            y ± t₀.₉₇₅ √diag(J cov Jᵀ),   J = ∂y/∂x

        Returns:
            One row per sample: ``predicted``, and ``low`` and ``high``, between which the curve of the true parameters lies in 95 % of all
            cases; noise of a measurement comes on top.
        """
        record = self._with_law(record)
        other = type(self._problem)([record], self._problem.space, self._problem.threads)
        scale = other.scales[0] / record.weight
        predicted = other.at(self._best.point) * scale + record.measured
        slopes = other.jacobian(self._best.point) * np.broadcast_to(scale, predicted.shape)[:, None]
        reach = self._quantile * np.sqrt(np.einsum("ni,ij,nj->n", slopes, self._covariance, slopes))
        if not np.isfinite(predicted).all():
            raise other.refusal or ValueError("record: the fitted parameters have no answer to it")
        return pd.DataFrame({"predicted": predicted, "low": predicted - reach, "high": predicted + reach})

    def profile(self, name: str, points: int = 12) -> pd.DataFrame:
        """Quality of the fit with a parameter fixed at other values: its profile likelihood, for intervals where the law is
        strongly nonlinear. It takes one search per point. n/n′ is how many of the rows count as one, for the memory of residuals.

        ```text
        S(x) = min over the other parameters,   95 %:  S(x) ≤ S_min + t₀.₉₇₅² s² n/n′,   s = 1 where sigma was given
        ```

        Args:
            name: name of a free parameter.
            points: maximum number on either side.

        Returns:
            One row per value, ascending: the free parameters, and S; ``attrs["low"]`` and ``attrs["high"]`` of the 95 % interval, ``attrs["limit"]``
            of S. An end not determined by the data, where S stays below the limit up to the border of the range, is 0 (−∞ if the
            range is not positive) or ∞.

        Raises:
            ValueError: it is not a free parameter.
        """
        if name not in self.table.index:
            raise ValueError(f"name: {name} is not a free parameter; there are {', '.join(self.table.index)}")
        excess = self._quantile**2 * (1.0 if self._sigma else self.noise**2) / self._independent
        step = float(self._std[list(self.table.index).index(name)])
        return _profile(self._problem, self._best, name, step, excess, max(2, points))

    def __repr__(self) -> str:
        rows = {
            name: {"value": f"{row['value']:.5g}", "95 % interval": f"{row['low']:.5g} to {row['high']:.5g}" if row["high"] < np.inf else "not determined"}
            for name, row in self.table.iterrows()
        }
        return "\n".join([pd.DataFrame(rows).T.to_string(), *self.words])


def fit(
    data: Record | Run | ElementTest | Iterable[Record | Run | ElementTest],
    law: str | Mapping[str, Any] = LAW,
    free: Sequence[str] | Mapping[str, tuple[float, float]] = ("mu_s", "mu_k", "r", "kappa", "xi"),
    *,
    start: Mapping[str, float] | None = None,
    starts: int = STARTS,
    seed: int = 0,
    threads: int | None = None,
    **fixed: Any,
) -> Fit:
    """Fit a law to measured curves, or parameters of cases to measured histories of their runs.

    A fit through runs has one search, by Gauss–Newton steps in a trust region with :attr:`Result.gradients` as derivatives: a run a step.
    Tests of samples are fitted so as well, through the run of one element.

    Args:
        data: records: :class:`Interface`, :class:`SpringSlider`, :class:`PullOff`, :class:`Holds`, or several of them; or :class:`Run`, one or several; or tests
            of samples, :class:`Triaxial` and :class:`Oedometer`. Records of different kinds need a ``sigma`` each.
        law: name of the law of an interface; of tests of samples the ``material`` of the body with its constants, at which the search begins:
            ``{"model": "cam_clay", "lambda": 0.2, …}``; cases have theirs.
        free: parameters to be found, with their ranges; positive ranges are searched by the logarithm. Without ranges
            (super/subloading friction only) wide ones are derived from the records. Ranges may overlap: trials that the law does not accept,
            such as ``mu_d`` above ``mu_s``, are skipped. Of runs they are places that every case has, such as
            ``"contacts.base.friction.mu_k"``, of tests of samples constants of the law; without ranges a factor of 10 either way of the
            value in the first case, or in the law.
        start: start of the first search: values of free parameters, within their ranges; others are taken from the
            best starting point of the other searches, through runs from the first case (where outside its range, the middle of that).
        starts: number of completed searches; three times as many are started from the best of 128 points spread over the ranges.
        seed: random seed of those points.
        threads: number of threads; default: all cores.
        **fixed: the other parameters; ``stiffness`` and ``mass`` are those of the machine of a :class:`SpringSlider`,
            ``drift`` is that of a record.

    Returns:
        The best fit. Read its ``words``, which name the parameters not determined by these data.

    Raises:
        ValueError: the law has no parameter of a name (the message suggests the nearest one), or no starting point in the ranges is valid.
        CaseError: a given parameter is invalid.
        Stopped: the first run of a case stopped; ``.result`` contains its results so far.
        Interrupted: Ctrl-C was pressed during a run.
    """
    records = _records(data)
    if any(isinstance(record, (Run, ElementTest)) for record in records):
        return _through_runs(records, law, free, start or {}, starts, threads, fixed)
    free = free if isinstance(free, Mapping) else [free] if isinstance(free, str) else free
    names(list(free) if isinstance(free, Mapping) else free, "free", "fit")
    if not isinstance(start, (Mapping, type(None))):
        raise ValueError(f"start: is a {type(start).__name__}: give values of free parameters by name")
    starts, seed, threads = count(starts, "starts") or 0, count(seed, "seed") or 0, count(threads, "threads")
    _check(records, free, fixed, starts)
    _check_fixed(fixed)
    law = a_name(law, "law", "fit")
    check_names(law, [*free, *fixed])
    ranges = dict(free) if isinstance(free, Mapping) else _ranges(law, free, records)
    space = Space(law, ranges, fixed)
    check_room(law, ranges, fixed)
    problem = _Problem(records, space, threads)
    ends = _searched(problem, start or {}, starts, seed)
    if not ends and problem.refusal is not None:
        raise no_room(ranges, str(problem.refusal)) or problem.refusal
    if not ends:
        why = "" if problem.stopped is None else f" first, {problem.stopped};"
        raise ValueError(f"free: the law has no answer to these records anywhere in the ranges:{why} narrow the ranges, or mend the records")
    return Fit(problem, ends)


def compare(fits: Mapping[str, Fit]) -> pd.DataFrame:
    """Which of several fits of the same records is worth its parameters: Akaike's criterion, corrected for few samples, and Schwarz's.

    ```text
    AICc = D + 2 m + 2 m (m + 1)/(n′ − m − 1),   BIC = D + m ln n′,   D = n′ ln(S/n), or S n′/n where sigma was given
    ```

    of m parameters (and one for the noise where the fit finds it); n rows count as n′ for the memory of residuals, that of the fit whose residuals have least.
    Differences below 2 mean nothing, those above 10 decide.

    Args:
        fits: by name; of the same records, with the same sigma and weights.

    Returns:
        A row per fit, the best first: ``parameters`` m, ``noise`` s, ``memory``, ``AICc`` and ``BIC`` above the lowest, and ``weight``, the
        probability exp(−AICc/2) over the sum of them.

    Raises:
        ValueError: there are none, their records differ, or there are too few rows for so many parameters.
    """
    if not fits:
        raise ValueError("fits: there are none")
    first = next(iter(fits.values()))
    for name, fit in fits.items():
        same = len(fit._measured) == len(first._measured) and all(map(np.array_equal, fit._measured, first._measured))
        if not same or fit._sigma != first._sigma:
            raise ValueError(f"fits: {name} is of other records than {next(iter(fits))}: criteria compare fits of the same rows, with the same sigma")
    rows = sum(part.size for part in first._measured)
    share = max(fit._independent for fit in fits.values())
    counted, table = rows * share, {}
    for name, fit in fits.items():
        parameters = len(fit.table) + (0 if fit._sigma else 1)
        if counted <= parameters + 1:
            raise ValueError(f"fits: {name}: {rows} rows count as {counted:.3g} for the memory of residuals: too few for {parameters} parameters")
        squares = max(float(fit.ends["S"].iloc[0]), np.finfo(float).tiny)
        deviance = squares * share if fit._sigma else counted * np.log(squares / rows)
        akaike = deviance + 2 * parameters + 2 * parameters * (parameters + 1) / (counted - parameters - 1)
        table[name] = [len(fit.table), fit.noise, fit.memory, akaike, deviance + parameters * np.log(counted)]
    compared = pd.DataFrame.from_dict(table, orient="index", columns=["parameters", "noise", "memory", "AICc", "BIC"]).sort_values("AICc")
    compared[["AICc", "BIC"]] -= compared[["AICc", "BIC"]].min()
    weight = np.exp(-compared["AICc"] / 2)
    return compared.assign(weight=weight / weight.sum()).astype({"parameters": int})


def _through_runs(
    records: Sequence[Any], law: Any, free: Any, start: Any, starts: int, threads: int | None, fixed: Mapping[str, Any]
) -> Fit:
    """The fit of cases, or of tests of samples.

    Raises:
        ValueError: an argument is one of a law alone, or not what it must be.
    """
    tests = all(isinstance(record, ElementTest) for record in records)
    if not tests and not all(isinstance(record, Run) for record in records):
        raise ValueError("data: there are runs and records of a point, or tests of samples: fit them one after another")
    given = [name for name, own in (("law", law == LAW or tests), ("starts", starts == STARTS)) if not own] + list(fixed)
    if given:
        theirs = "the law" if tests else "its cases"
        raise ValueError(f"{given[0]}: a fit through runs has none: values that are not free are those of {theirs}, and its one search begins at start")
    runs = [record.of(law) for record in records] if tests else records
    problem, shares = run_problem(runs, [free] if isinstance(free, str) else free, start, count(threads, "threads"))
    _check(runs, problem.space.names, {}, 1)
    end = search(problem, shares, MOST_RUNS)
    if end is None:
        raise problem.refusal or ValueError("start: the runs have no answer there: give another start")
    return Fit(problem, [end], law if tests else None)


def _records(data: Any) -> list[Any]:
    """The records of a fit.

    Raises:
        ValueError: there are none, or something else.
    """
    records: list[Any] = [data] if isinstance(data, np.ndarray) or not isinstance(data, Iterable) else list(data)
    for record in records:
        if not isinstance(record, (Interface, Holds, Run, ElementTest)):
            raise ValueError(f"data: is a {type(record).__name__}: give Interface, SpringSlider, PullOff, Holds, Run, Triaxial or Oedometer, or several of them")
    return records


def _check(records: Sequence[Record | Run], free: Iterable[str], fixed: Mapping[str, Any], starts: int) -> None:
    if not records:
        raise ValueError("data: there are no records")
    if starts < 1:
        raise ValueError(f"starts: is {starts}: must be at least 1")
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


def _check_fixed(fixed: Mapping[str, Any]) -> None:
    """Check that each given parameter has one value.

    Raises:
        CaseError: one is none.
    """
    for name, value in fixed.items():
        if name in ("mu_s", "mu_k") or isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, str):
            number(value, name, "law")


def _ranges(law: str, free: Iterable[str], records: Sequence[Record]) -> dict[str, tuple[float, float]]:
    """Wide ranges, derived from the records."""
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


def _table(space: Space, point: Array, std: Array, quantile: float) -> pd.DataFrame:
    """Values and 95 % intervals; uninformative ones, wider than the range on both sides or by far, have no ends."""
    with np.errstate(over="ignore"):
        low, value, high = (space.values(point + side * quantile * std) for side in (-1.0, 0.0, 1.0))
    wide = (point - quantile * std < space.low) & (point + quantile * std > space.high)
    nothing = wide | (std > np.where(space.log, NOTHING, 1.0))
    low, high = np.where(nothing, np.where(space.log, 0.0, -np.inf), low), np.where(nothing, np.inf, high)
    columns = {"value": value, "low": low, "high": high, "std": std * space.width, "log": space.log}
    return pd.DataFrame(columns, index=pd.Index(space.names, name="parameter"))


def _share(residuals: Array, measured: Array) -> float:
    """Root mean square of residuals, as a fraction of the largest measured value."""
    size, largest = float(np.sqrt(np.mean(residuals**2))), float(np.abs(measured).max())
    return size / largest if largest > size else float(size > 0.0)


def _independent(residuals: Array, misfit: float) -> float:
    """Share of rows that count as independent: (1 − ρ)/(1 + ρ) where each residual has the correlation ρ with the one before.

    So the variance of a mean of an autoregressive noise of first order is that of so many independent values.
    """
    memory = _memory(residuals)
    return (1.0 - memory) / (1.0 + memory) if misfit > COMPUTED and NOISE / np.sqrt(residuals.size) < memory < 1.0 else 1.0


def _memory(residuals: NDArray[np.float64]) -> float:
    """Correlation of successive residuals."""
    power = float(np.sum(residuals**2))
    return float(np.sum(residuals[1:] * residuals[:-1])) / power if power > 0 else 0.0
