"""Assessment of a fit in words: parameters not determined by the data, and systematic deviations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Standard deviation of a logarithm, or share of a range, from which on data tell nothing: a factor of 3 either way.
UNKNOWN = 0.5
# Share in a direction from which on a parameter belongs to it.
SHARE = 0.3
# Correlation from which on two parameters are reported to trade off.
TRADE = 0.98
# Correlation of residuals beyond 1/√n at which they are no noise, in standard deviations.
NOISE = 4.0
# s/σ above which the law does not reach the noise that was given.
MISFIT = 1.3
# Residuals that are a smaller share of the largest value are what a law that was computed differs by, with its tolerance.
COMPUTED = 1e-5
# μ_s/μ_k − 1 below which nothing weakens.
EQUAL = 1e-6

NUMBERS = ("none", "one", "two", "three", "four", "five", "six")


@dataclass(frozen=True)
class Evidence:
    """Data for the assessment."""

    # Value, low and high of the free parameters.
    table: pd.DataFrame
    correlation: pd.DataFrame
    # Where each search has ended, the best first, with its sum of squares S.
    ends: pd.DataFrame
    # All parameters.
    parameters: Mapping[str, object]
    # Standard deviation along each direction (free,), and the directions (free, free) a row each.
    spread: Array
    directions: Array
    # Whether a parameter ends at the border of its range (free,).
    at_border: NDArray[np.bool_]
    # s, in units of sigma where that was given.
    noise: float
    sigma: bool
    # Correlation of a residual with the one before, and how many samples there are.
    memory: float
    samples: int
    # Root mean square of the residuals as a share of the largest value measured.
    misfit: float
    # What was fitted: a "law" or a "case".
    model: str = "law"


def words(of: Evidence) -> list[str]:
    """The assessment; empty if there is no problem."""
    weakens = not _no_weakening(of)
    findings = _undetermined(of, weakens) + _trades(of, weakens) + _borders(of)
    if not weakens:
        findings.append("mu_s = mu_k: these data show no weakening, and kappa, xi have no effect")
    if of.misfit > COMPUTED and of.memory > NOISE / np.sqrt(of.samples):
        findings.append(
            f"the residuals are not noise (each has the correlation {of.memory:.2f} with the one before): this {of.model} does not follow these "
            "data, or their noise has a memory; the intervals are widened as for a memory"
        )
    if of.sigma and of.noise > MISFIT:
        findings.append(
            f"the residuals are {of.noise:.3g} times as large as sigma: this {of.model} does not follow these data; the intervals are too narrow"
        )
    return findings + _others(of)


def _no_weakening(of: Evidence) -> bool:
    static, kinetic = of.parameters.get("mu_s"), of.parameters.get("mu_k")
    return isinstance(static, float) and isinstance(kinetic, float) and static <= kinetic * (1.0 + EQUAL)


def _unknown(of: Evidence) -> list[set[str]]:
    """The parameters of every direction not determined by the data."""
    names = list(of.table.index)
    return [
        {name for name, share in zip(names, direction) if abs(share) > SHARE}
        for much, direction in zip(of.spread[::-1], of.directions[::-1])
        if much >= UNKNOWN
    ]


def _undetermined(of: Evidence, weakens: bool) -> list[str]:
    """One sentence per group of parameters connected by undetermined directions."""
    directions, findings = _unknown(of), []
    for group in _joined(directions):
        lost = sum(members <= group for members in directions)
        names = [name for name in of.table.index if name in group]
        if not weakens and not {"mu_s", "mu_k"} >= group:
            # They have no effect, and are reported so.
            continue
        if len(names) == 1:
            findings.append(f"these data do not determine {names[0]}: fix it, or give data that depend on it")
        elif lost >= len(names):
            findings.append(f"these data do not determine {_and(names)}: fix them, or give data that depend on them")
        else:
            findings.append(f"{_and(names)} trade off: these data do not tell them apart: fix {_number(lost)}")
    return findings


def _trades(of: Evidence, weakens: bool) -> list[str]:
    """One sentence per group of parameters with correlated errors."""
    unknown = set().union(*_unknown(of))
    matrix, names = of.correlation.to_numpy(), list(of.table.index)
    pairs = [
        {one, names[k]}
        for i, one in enumerate(names)
        for k in range(i)
        if abs(matrix[i, k]) > TRADE and weakens and not {one, names[k]} <= unknown
    ]
    findings = []
    for group in _joined(pairs):
        members = [name for name in names if name in group]
        if len(members) == 2:
            correlation = of.correlation.loc[members[1], members[0]]
            findings.append(f"{_and(members)} trade off (correlation {correlation:.3f}): fix one for a narrower interval of the other")
        else:
            findings.append(f"{_and(members)} trade off (correlations above {TRADE}): fix one for narrower intervals of the others")
    return findings


def _borders(of: Evidence) -> list[str]:
    return [
        f"{name} ends at the border of its range, {of.table['value'][name]:.6g}: widen it, or fix it; its interval means nothing"
        for name, ends in zip(of.table.index, of.at_border)
        if ends
    ]


def _others(of: Evidence) -> list[str]:
    """Other fits of equal quality with different parameters."""
    best = of.ends.iloc[0]
    for _, end in of.ends.iloc[1:].iterrows():
        away = [name for name in of.table.index if not of.table["low"][name] <= end[name] <= of.table["high"][name]]
        if end["S"] <= 1.02 * best["S"] and of.misfit > COMPUTED and away:
            values = ", ".join(f"{name} {end[name]:.4g}" for name in of.table.index)
            return [f"another fit is as good within 1 %, {values}: these data do not choose between them"]
    return []


def _joined(sets: Iterable[set[str]]) -> list[set[str]]:
    """Unions of sets that share a member."""
    groups: list[set[str]] = []
    for members in sets:
        touched = [group for group in groups if group & members]
        groups = [group for group in groups if not group & members] + [members.union(*touched)]
    return groups


def _number(count: int) -> str:
    return NUMBERS[count] if count < len(NUMBERS) else str(count)


def _and(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
