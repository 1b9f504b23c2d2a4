"""What a fit says of itself in plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .calibration import Fit

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


def words(fit: Fit, spread: NDArray[np.float64], turn: NDArray[np.float64], at_end: NDArray[np.bool_], sigma: bool) -> list[str]:
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
