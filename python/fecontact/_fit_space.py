"""Search space of a fit: free parameters as coordinates, and the part of the space where the law is valid.

Coordinates are logarithms where the range of a parameter is positive, else the parameter in widths of its range. A search uses shares,
fractions from 0 to 1 of a range; the range of ``mu_s`` begins at ``mu_k`` if both are free, so that no search ends where nothing weakens.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Error that the law is allowed where it controls it: far below what differences change, and where a search is only begun.
TOLERANCE, ROUGH = 1e-8, 1e-5
# Difference of μ_s and μ_k that is round-off, relative.
ROUND_OFF = 1e-12


class Space:
    """Free parameters as coordinates, and all parameters of points in it."""

    def __init__(self, law: str, ranges: Mapping[str, tuple[float, float]], fixed: Mapping[str, Any]) -> None:
        self.names = list(ranges)
        ends = np.array([_ends(name, given) for name, given in ranges.items()])
        self.log = ends[:, 0] > 0
        self.width = np.where(self.log, 1.0, ends[:, 1] - ends[:, 0])
        self.law, self.ranges, self.fixed = law, dict(ranges), dict(fixed)
        self.low, self.high = self.coordinates(ends[:, 0]), self.coordinates(ends[:, 1])
        # The room: the same, as far as μ_k ≤ μ_s can hold whatever the other parameters are.
        self.bottom, self.top = (self.coordinates(end) for end in self._room(ends))
        both = law == "super_subloading" and {"mu_s", "mu_k"} <= set(ranges)
        self._static: int | None = self.names.index("mu_s") if both else None
        self._kinetic: int | None = self.names.index("mu_k") if both else None

    def _room(self, ends: Array) -> tuple[Array, Array]:
        """Lowest and highest valid values."""
        low, high = ends.T.copy()
        known = {**self.fixed, **dict(zip(self.names, ends))}
        least, most = (np.ravel(known.get(name, np.nan)) for name in ("mu_k", "mu_s"))
        for k, name in enumerate(self.names if self.law == "super_subloading" else ()):
            if name == "mu_s" and least.dtype.kind in "fi":
                low[k] = np.fmax(low[k], least[0])
            if name == "mu_k" and most.dtype.kind in "fi":
                high[k] = np.fmin(high[k], most[-1])
        return low, high

    def rough(self) -> Space:
        """The same space with a law that is evaluated faster, with a larger tolerance if it controls its error."""
        tolerance = {"tolerance": ROUGH} if self.law == "super_subloading" else {}
        return Space(self.law, self.ranges, {**tolerance, **self.fixed})

    def coordinates(self, values: Array) -> Array:
        """Coordinates of values of the free parameters."""
        return np.where(self.log, np.log(np.where(self.log, values, 1.0)), values / self.width)

    def values(self, points: Array) -> Array:
        """Values of the free parameters at points (..., free)."""
        return np.where(self.log, np.exp(np.where(self.log, points, 0.0)), points * self.width)

    def within(self, shares: Array) -> Array:
        """Coordinates (..., free) at shares (..., free) of the valid ranges."""
        points = np.asarray(self.bottom + shares * (self.top - self.bottom))
        if (static := self._static) is not None:
            least, _ = self._least_static(points)
            points[..., static] = least + shares[..., static] * (self.top[static] - least)
        return points

    def slopes_within(self, shares: Array) -> Array:
        """∂coordinate/∂share (free, free) at one point."""
        extent = self.top - self.bottom
        slopes = np.diag(extent)
        if (static := self._static) is not None:
            least, slope = self._least_static(np.asarray(self.bottom + shares * extent))
            slopes[static, static] = self.top[static] - least
            slopes[static, self._kinetic] = (1.0 - shares[static]) * slope * extent[self._kinetic]
        return slopes

    def shares(self, point: Array) -> Array:
        """Shares (free,) of the valid ranges at one point."""
        low = self.bottom.copy()
        if self._static is not None:
            low[self._static], _ = self._least_static(point)
        extent = self.top - low
        return np.asarray(np.clip((point - low) / np.where(extent > 0.0, extent, 1.0), 0.0, 1.0))

    def _least_static(self, points: Array) -> tuple[Array, Array]:
        """Lowest valid coordinate of ``mu_s`` at points (..., free), and its derivative by that of ``mu_k``."""
        static, kinetic = self._static, self._kinetic
        value = np.maximum(self.values(points)[..., kinetic], np.finfo(float).tiny)
        least = np.log(value) if self.log[static] else value / self.width[static]
        by_value = 1.0 / value if self.log[static] else 1.0 / self.width[static]
        slope = by_value * (value if self.log[kinetic] else self.width[kinetic])
        bound = least > self.bottom[static]
        return np.where(bound, np.minimum(least, self.top[static]), self.bottom[static]), np.where(bound, slope, 0.0)

    def parameters(self, points: Array) -> dict[str, Any]:
        """All parameters at points (sets, free)."""
        free = dict(zip(self.names, self.values(points).T))
        given = {"law": self.law, **self.fixed, **free}
        if self.law == "super_subloading":
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
        """Derivatives of the free parameters by the coordinates (free,)."""
        values = self.values(point)
        rows = dict(zip(self.names, np.diag(np.where(self.log, values, self.width))))
        given = {**self.fixed, **dict(zip(self.names, values))}
        if self.law != "super_subloading" or not {"mu_s", "mu_k"} <= set(given):
            return rows
        none = np.zeros(len(self.names))
        if given["mu_s"] < given["mu_k"] * (1.0 - ROUND_OFF):
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


def _ends(name: str, given: Any) -> tuple[float, float]:
    """The ends of the range of a free parameter.

    Raises:
        ValueError: the range is invalid.
    """
    try:
        low, high = (float(end) for end in given)
    except (TypeError, ValueError):
        raise ValueError(f"free: {name}: the range is {given!r}: give two numbers, (low, high)") from None
    if not (np.isfinite([low, high]).all() and low < high):
        raise ValueError(f"free: {name}: the range ({low}, {high}) must be finite and ascending")
    return low, high
