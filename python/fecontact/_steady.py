"""Steady sliding of the laws that have it."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._plain import refused

Array = NDArray[np.float64]


def steady(sets: Iterable[str], rate: Array) -> Array:
    """The coefficient of steady sliding of every set of parameters (JSON) at every rate, shape (sets, rates)."""
    return np.stack([np.broadcast_to(_coefficient(json.loads(text), rate), rate.shape) for text in sets])


def _coefficient(given: dict[str, Any], rate: Array) -> Array:
    name = given["law"]
    if name == "coulomb":
        return np.asarray(given["mu"], dtype=float)
    if name == "slip_weakening" and not given.get("cohesion"):
        return np.asarray(given["mu_d"], dtype=float)
    if name == "rate_and_state":
        a, b, reference = given["a"], given["b"], given["V_0"]
        b += given.get("b_2") or 0.0
        exponent = (given["f_0"] + b * np.log(reference / rate)) / a + np.log(rate / (2.0 * reference))
        # a arsinh(e^x), which e^x alone would overflow.
        return np.asarray(a * np.logaddexp(exponent, 0.5 * np.logaddexp(0.0, 2.0 * exponent)))
    if name == "super_subloading":
        return _super_subloading(given, rate)
    raise refused("law", "law", f"{name} has no steady sliding whose coefficient depends on the rate alone")


def _super_subloading(given: dict[str, Any], rate: Array) -> Array:
    a, reference = given.get("a") or 0.0, given.get("V_0")
    factor = 1.0 + a * np.log1p(rate / reference) if a > 0.0 and reference else 1.0
    return _peak_in_slip(given, rate) * factor


def _peak_in_slip(given: dict[str, Any], rate: Array) -> Array:
    mu_s, mu_k, kappa, xi = given["mu_s"], given["mu_k"], given.get("kappa", 0.0), given.get("xi", 0.0)
    m, n = given.get("m", 1.0), given.get("n", 1.0)
    if mu_s == mu_k:
        return np.asarray(mu_k, dtype=float)
    if kappa == 0.0 and xi == 0.0:
        raise refused("law", "kappa", "and xi are 0: the structure stays as it is, and steady sliding depends on it")
    loss = kappa * rate
    if m == 1.0 and n == 1.0:
        return np.asarray((loss + xi) / (loss / mu_k + xi / mu_s))
    low, high = np.full(rate.shape, mu_k, dtype=float), np.full(rate.shape, mu_s, dtype=float)
    # What weakens grows with μ, what heals falls: bisection to the last digit.
    for _ in range(200):
        middle = 0.5 * (low + high)
        heals = loss * (middle / mu_k - 1.0) ** m < xi * (1.0 - middle / mu_s) ** n
        low, high = np.where(heals, middle, low), np.where(heals, high, middle)
    return np.asarray(0.5 * (low + high))
