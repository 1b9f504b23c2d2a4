"""Tests of samples of soil, rock or metal that strain evenly: records, and the run of one axisymmetric element that predicts them.

The element is a cylinder of radius 1 and height 1, so that every column of its history is a stress or strain but for factors of its shape.
Each sample of the record ends a step of the run.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from ._places import value_at
from ._paths import shown
from ._plain import refused
from ._records import Array, array_of, noise_of
from ._run_record import Run
from .case import Case
from .errors import CaseError
from .result import Result

# Where the constants of the law stand in the case.
SAMPLE = "bodies.sample."
MATERIAL = SAMPLE + "material."
# Columns of the history that quantities are made of.
COLUMNS = ("top.uy", "top.fy", "right.ux", "right.fx")
# Increments of a triaxial test, unless its largest strain increment is given.
INCREMENTS = 400
# Increments from a pressure of 0 on, where steps in proportion to it begin nowhere.
FROM_NOTHING = 50
# What begins with this is of the water in the pores, and else of the material.
FLUID = "pore_fluid."
# Elements of a sample through which water flows: along the way that it takes, and their heights at its end over those at its start.
ALONG, GRADING = 12, 0.1
# Increments before the first reading under a pressure, and the time since it came at the end of an increment over that at its start after this.
BEFORE_READING, RATIO = 5, 1.1
# Imaginary step of derivatives of quantities by columns, which is exact as long as its square is nothing.
IMAGINARY = 1e-30


class ElementTest:
    """What tests of a sample have in common: quantities over steps, their noise, and the case of the run.

    The first row of a record is the state at the start, which is known; the others are compared.
    """

    def __init__(self, measured: Mapping[str, Array], sigma: Any, weight: float, increment: float) -> None:
        self._measured = dict(measured)
        self._noise = sigma
        if not (isinstance(increment, Real) and 0 < float(increment) < math.inf):
            raise ValueError(f"increment: is {shown(increment)}: must be positive")
        self.increment: float = float(increment)
        self.weight: float = noise_of(None, weight, 1)[1]
        # Times of the rows behind the first.
        self._stops: list[float] = []
        self.times: Array = np.arange(1.0, next(iter(measured.values())).size)
        names = list(measured)
        if isinstance(sigma, Mapping):
            if unknown := [name for name in sigma if name not in names]:
                raise ValueError(f"sigma: {unknown[0]!r} was not measured; there is {', '.join(names)}")
        elif len(names) > 1:
            raise ValueError(f"sigma: {' and '.join(names)} need it: the size of their noise determines the weight of each: {{{names[0]!r}: …, {names[1]!r}: …}}")
        elif sigma is not None:
            self._noise = {names[0]: sigma}

    def of(self, law: Mapping[str, Any]) -> ElementRun:
        """The run of the test with a law, which is the `material` of a case: ``test.of(law).predicted({})`` is what it predicts.

        Raises:
            CaseError: the law is invalid.
            ValueError: it cannot be tested so.
        """
        return ElementRun(self, law, self._measured, sigma=self._noise, weight=self.weight)

    def _quantities(self, columns: Mapping[str, Any]) -> dict[str, Any]:
        """What is measured of the columns of the history; complex numbers carry derivatives."""
        raise NotImplementedError

    def _parts(self) -> tuple[dict[str, Any], list[dict[str, Any]]]:
        """Initial stress of the case, and its steps."""
        raise NotImplementedError

    def _sample(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Block of the sample, and what its body has beside the material."""
        return {"corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": [1, 1]}, {"element": "f_bar"}

    def case(self, law: Mapping[str, Any]) -> Case:
        """The case of the test with a law.

        Raises:
            CaseError: the law is invalid.
            ValueError: it cannot be tested so.
        """
        initial, steps = self._parts()
        block, body = self._sample()
        block = {"body": "sample", "sides": ["bottom", "right", "top", "left"], **block}
        body = {"material": _checked(law, "pore_fluid" in body), **body}
        if any(initial.values()):
            body["initial_stress"] = {"components": initial}
        try:
            return Case(
                {
                    "title": f"{type(self).__name__} test of a sample",
                    "section": "axisymmetric",
                    "mesh": {"blocks": [block]},
                    "bodies": {"sample": body},
                    "steps": steps,
                    "watch": ["top", "right"],
                    "newton": {"tolerance": 1e-10},
                    "output": {"fields": False, "times": self._stops},
                }
            )
        except CaseError as error:
            raise _of_law(error) from None

    def __repr__(self) -> str:
        spans = ", ".join(f"{name} {values[1:].min():.6g} to {values[1:].max():.6g}" for name, values in self._measured.items())
        return f"<{type(self).__name__} of {next(iter(self._measured.values())).size - 1} samples: {spans}>"


class Triaxial(ElementTest):
    """A triaxial test: a cylinder under constant cell pressure is compressed (or extended) along its axis.

    Compression is positive, strains are engineering strains, ΔH/H₀ and ΔV/V₀, stresses are those of the deformed sample (with the area
    A₀ (1 − ε_v)/(1 − ε_a)). Undrained, the volume stays, and the cell pressure is total: Δu = σ_r′(start) − σ_r′.

    Args:
        axial_strain: at the samples, shape (n,); it may turn, for unloading. The first row is the start of shearing, from which strains count [-].
        deviator: q = σ_a − σ_r there, shape (n,) [F/L²].
        cell_pressure: effective σ_r at the start of shearing, 0 or more [F/L²].
        volumetric_strain: drained tests: ε_v, shape (n,), positive where the sample loses volume, counted from its first value [-].
        pore_pressure: undrained tests: shape (n,), counted from its first value [F/L²].
        drained: whether water flows out; otherwise the volume stays.
        initial_deviator: q at the start of shearing, of samples that were not consolidated isotropically [F/L²].
        sigma: standard deviation of the noise: by quantity (``deviator``, ``volumetric_strain``, ``pore_pressure``) a number or shape (n,), of the
            deviator alone as it is; by default estimated by the fit. Two quantities need it.
        weight: weight of this record relative to others.
        increment: largest axial strain of an increment of the run; default: 1/400 of the way. The error is of first order in it.
    """

    def __init__(
        self,
        axial_strain: ArrayLike,
        deviator: ArrayLike,
        *,
        cell_pressure: float,
        volumetric_strain: ArrayLike | None = None,
        pore_pressure: ArrayLike | None = None,
        drained: bool = True,
        initial_deviator: float = 0.0,
        sigma: Any = None,
        weight: float = 1.0,
        increment: float | None = None,
    ) -> None:
        strain = _rows("axial_strain", axial_strain)
        self.axial_strain = strain - strain[0]
        if (self.axial_strain >= 1).any():
            raise ValueError(f"axial_strain: is {self.axial_strain.max():g}: must be below 1; 10 % is 0.1")
        if not np.diff(self.axial_strain).any():
            raise ValueError("axial_strain: does not change: the sample is not strained")
        self.cell_pressure, self.initial_deviator = _finite("cell_pressure", cell_pressure), _finite("initial_deviator", initial_deviator)
        if self.cell_pressure < 0:
            raise ValueError(f"cell_pressure: is {self.cell_pressure:g}: must not be negative: compression is positive")
        self.drained = bool(drained)
        for name, given, fits in (("volumetric_strain", volumetric_strain, drained), ("pore_pressure", pore_pressure, not drained)):
            if given is not None and not fits:
                raise ValueError(f"{name}: stays as it is in {'a drained' if drained else 'an undrained'} test: leave it out, or give drained={not drained}")
        measured = {"deviator": array_of("deviator", deviator, strain.size)}
        for name, given in (("volumetric_strain", volumetric_strain), ("pore_pressure", pore_pressure)):
            if given is not None:
                values = _rows(name, given, strain.size)
                measured[name] = values - values[0]
        way = float(np.abs(np.diff(self.axial_strain)).sum())
        super().__init__(measured, sigma, weight, way / INCREMENTS if increment is None else increment)

    def _quantities(self, columns: Mapping[str, Any]) -> dict[str, Any]:
        height, radius = 1.0 + columns["top.uy"], 1.0 + columns["right.ux"]
        axial = -columns["top.fy"] / (math.pi * radius**2)
        if self.drained:
            return {"deviator": axial - self.cell_pressure, "volumetric_strain": 1.0 - radius**2 * height}
        radial = -columns["right.fx"] / (2.0 * math.pi * radius * height)
        return {"deviator": axial - radial, "pore_pressure": self.cell_pressure - radial}

    def _parts(self) -> tuple[dict[str, Any], list[dict[str, Any]]]:
        radial, axial = -self.cell_pressure, -self.cell_pressure - self.initial_deviator
        steps = []
        for k, (before, strain) in enumerate(zip(self.axial_strain[:-1].tolist(), self.axial_strain[1:].tolist())):
            supports: list[dict[str, Any]] = [{"on": "top", "uy": -strain}]
            if not self.drained:
                # Constant volume at every time of the step.
                supports.append({"on": "right", "ux": f"(1 - ({before!r} + ({strain - before!r})*(t - {k})))^(-1/2) - 1"})
            steps.append(_step(k, abs(strain - before) / self.increment, supports))
        steps[0]["supports"] += HELD
        if self.drained:
            steps[0]["loads"] = [{"on": "right", "pressure": repr(self.cell_pressure)}]
        return {"xx": radial, "yy": axial, "zz": radial}, steps


class Oedometer(ElementTest):
    """A test in a ring: a sample that cannot widen is loaded, and unloaded, along its axis.

    Compression is positive, strains are engineering strains, ΔH/H₀ from the first row on. With ``time`` water flows out of the sample while it is
    pressed, which tells its permeability: the free value ``pore_fluid.permeability``.

    Args:
        pressure: vertical effective stress, shape (n,), 0 or more. The first row is the start of the test. With ``time`` that of the load: what a row has
            acts from the time of the row before on [F/L²].
        strain: shape (n,), counted from its first value, ... [-]
        void_ratio: ... or the void ratio e, shape (n,): e = e₀ − (1 + e₀) ε, e₀ its first value [-].
        time: when the rows were read, ascending, shape (n,); without it the water has all the time to flow [T].
        drainage: with ``time``: longest way of the water out of the sample, half its height where it drains at both ends [L].
        pore_fluid: with ``time``: the water, as ``pore_fluid`` of a body, ``{"permeability": 1e-9, "unit_weight": 9810, "bulk_modulus": 2.2e9,
            "porosity": 0.5}``.
        K0: ratio of the lateral to the vertical effective stress at the first pressure; needed unless that is 0 [-].
        sigma: standard deviation of the noise of what was measured: a number or shape (n,), or by its name; by default estimated by the fit.
        weight: weight of this record relative to others.
        increment: largest change of ln pressure within an increment of the run, without ``time``. The error is of first order in it.
    """

    def __init__(
        self,
        pressure: ArrayLike,
        strain: ArrayLike | None = None,
        *,
        void_ratio: ArrayLike | None = None,
        time: ArrayLike | None = None,
        drainage: float | None = None,
        pore_fluid: Mapping[str, Any] | None = None,
        K0: float | None = None,
        sigma: Any = None,
        weight: float = 1.0,
        increment: float = 0.02,
    ) -> None:
        self.pressure = _rows("pressure", pressure)
        if (self.pressure < 0).any():
            raise ValueError(f"pressure: is {self.pressure.min():g}: must not be negative: compression is positive")
        if self.pressure[0] > 0 and K0 is None:
            raise ValueError("K0: give the ratio of the lateral to the vertical effective stress at the first pressure, such as 1 − sin φ of normally consolidated soil")
        self.K0 = 0.0 if K0 is None else _finite("K0", K0)
        if (strain is None) == (void_ratio is None):
            raise ValueError("strain: give strain or void_ratio, one of them")
        if void_ratio is not None:
            measured = {"void_ratio": _rows("void_ratio", void_ratio, self.pressure.size)}
            if not (measured["void_ratio"] > 0).all():
                raise ValueError(f"void_ratio: is {measured['void_ratio'].min():g}: must be positive")
        else:
            assert strain is not None
            values = _rows("strain", strain, self.pressure.size)
            measured = {"strain": values - values[0]}
        super().__init__(measured, sigma, weight, increment)
        self._water: dict[str, Any] = {}
        self._way = 1.0
        if time is None:
            if drainage is not None or pore_fluid is not None:
                raise ValueError("time: give it as well: drainage and pore_fluid are those of a record in time")
            return
        at = _rows("time", time, self.pressure.size)
        if not (np.diff(at) > 0).all():
            raise ValueError("time: must be ascending")
        if not isinstance(pore_fluid, Mapping) or "permeability" not in pore_fluid:
            raise ValueError('pore_fluid: give the water of a record in time, with its permeability: {"permeability": 1e-9, "unit_weight": 9810, …}')
        if drainage is None or not _finite("drainage", drainage) > 0:
            raise ValueError("drainage: give the longest way of the water out of the sample, half its height where it drains at both ends")
        self.times, self._water, self._way = at[1:] - at[0], dict(pore_fluid), float(drainage)

    def _sample(self) -> tuple[dict[str, Any], dict[str, Any]]:
        if not self._water:
            return super()._sample()
        corners = [[0, 0], [1, 0], [1, self._way], [0, self._way]]
        block = {"corners": corners, "elements": [1, ALONG], "grading": [1, GRADING], "kind": "Q8"}
        return block, {"element": "reduced", "pore_fluid": self._water}

    def _quantities(self, columns: Mapping[str, Any]) -> dict[str, Any]:
        strain = -columns["top.uy"] / self._way
        if "strain" in self._measured:
            return {"strain": strain}
        first = float(self._measured["void_ratio"][0])
        return {"void_ratio": first - (1.0 + first) * strain}

    def _parts(self) -> tuple[dict[str, Any], list[dict[str, Any]]]:
        steps = self._stages() if self._water else []
        in_turn = [] if self._water else zip(self.pressure[:-1].tolist(), self.pressure[1:].tolist())
        for k, (before, after) in enumerate(in_turn):
            even = before > 0 and after > 0
            share = abs(math.log(after / before)) / self.increment if even else FROM_NOTHING
            steps.append(_step(k, share, [], [{"on": "top", "pressure": f"{before!r}*{after / before!r}^(t - {k})" if even else after}]))
        steps[0]["supports"] = [*HELD, {"on": "right", "ux": 0}]
        axial, radial = -float(self.pressure[0]), -self.K0 * float(self.pressure[0])
        return {"xx": radial, "yy": axial, "zz": radial}, steps

    def _stages(self) -> list[dict[str, Any]]:
        """A step for every pressure, which acts at once, and until the last row that has it; increments end at the rows, and between them."""
        ends = np.append(0.0, self.times)
        starts = [0, *(np.flatnonzero(np.diff(self.pressure[1:])) + 1).tolist()]
        steps: list[dict[str, Any]] = []
        self._stops = []
        for start, last in zip(starts, [*starts[1:], ends.size - 1]):
            since = ends[start + 1 : last + 1] - ends[start]
            parts = np.ceil(np.log(since[1:] / since[:-1]) / math.log(RATIO)).astype(int)
            between = [np.geomspace(a, b, n + 1)[:-1] for a, b, n in zip(since[:-1].tolist(), since[1:].tolist(), parts.tolist())]
            self._stops += (ends[start] + np.concatenate([*between, since[-1:]])).tolist()
            dt = {"initial": since[0] / BEFORE_READING, "max": since[-1], "min": 1e-4 * since[0]}
            loads = [{"on": "top", "dead_pressure": repr(float(self.pressure[start + 1]))}]
            steps.append({"name": f"from row {start + 1}", "duration": since[-1], "dt": dt, "loads": loads})
        steps[0]["drainage"] = [{"on": "top", "pressure": 0}]
        return steps


class ElementRun(Run):
    """A test of a sample with a law: what it measures are quantities made of the history of the run; free values are constants of the law."""

    _fitted = "law"

    def __init__(self, test: ElementTest, law: Mapping[str, Any], measured: Mapping[str, Array], **options: Any) -> None:
        times = test.times
        if isinstance(options["sigma"], Mapping):
            options["sigma"] = {name: _noise(name, sigma, times.size) for name, sigma in options["sigma"].items()}
        super().__init__(test.case(law), {name: (times, values[1:]) for name, values in measured.items()}, **options)
        self._test = test

    def _place(self, name: str) -> str:
        return SAMPLE + name if name.startswith(FLUID) else MATERIAL + name

    def _value(self, name: str) -> tuple[str, float]:
        try:
            written, value = value_at(self.case, self._place(name))
        except CaseError as error:
            raise _of_law(error) from None
        return written.removeprefix(MATERIAL).removeprefix(SAMPLE), value

    def solved(self, values: Mapping[str, float], by: Sequence[str], threads: int | None) -> tuple[Array, Array]:
        try:
            return super().solved(values, by, threads)
        except CaseError as error:
            raise _of_law(error) from None

    def _measurable(self, history: pd.DataFrame) -> pd.DataFrame:
        found = self._test._quantities({name: history[name].to_numpy() for name in COLUMNS})
        return pd.DataFrame({"time": history["time"], **found})

    def _derivatives(self, result: Result, place: str) -> pd.DataFrame:
        history, gradients = result.history, result.gradients
        columns = {name: history[name].to_numpy() + 1j * IMAGINARY * gradients[f"d({name})/d({place})"].to_numpy() for name in COLUMNS}
        found = {name: values.imag / IMAGINARY for name, values in self._test._quantities(columns).items()}
        return pd.DataFrame({"time": history["time"], **{name: found[name] for name in self._times}})


# The axis and the bottom of the sample.
HELD = [{"on": "left", "ux": 0}, {"on": "bottom", "uy": 0}]


def _step(k: int, increments: float, supports: list[dict[str, Any]], loads: list[dict[str, Any]] | None = None) -> dict[str, Any]:
    """The step to sample k + 1, of duration 1."""
    length = 1.0 / max(1, math.ceil(increments * (1.0 - 1e-9)))
    step = {"name": f"to sample {k + 1}", "duration": 1, "dt": {"initial": length, "max": length, "min": 1e-4 * length}, "supports": supports}
    return {**step, "loads": loads} if loads else step


def _checked(law: Any, timed: bool) -> dict[str, Any]:
    """A law that can be tested.

    Raises:
        ValueError: it is none, or needs times, which this record has not, or is one of small strains.
    """
    if not isinstance(law, Mapping) or "model" not in law:
        raise ValueError(f'law: is {shown(law)}: give the material of a body with its constants, such as {{"model": "mohr_coulomb", "E": 5e7, …}}')
    if law["model"] == "linear":
        raise ValueError("law: `linear` is for small strains, which tests of samples exceed: give `hencky`, which has the same constants")
    if not timed and (law["model"] == "viscoelastic" or law.get("viscosity")):
        raise ValueError("law: its answer depends on the rate, but this record has no times: leave viscosity out, or fit a case by Run")
    return dict(law)


def _of_law(error: CaseError) -> CaseError:
    """An error of the case, as one of the law if that has it."""
    place = f"{error.place}."
    return refused("law", place.removeprefix(MATERIAL).rstrip("."), str(error.message)) if place.startswith(MATERIAL) else error


def _rows(name: str, given: ArrayLike, size: int | None = None) -> Array:
    """A column of a record, with a start and at least one sample."""
    values = array_of(name, given, size)
    if values.ndim != 1 or values.size < 2:
        raise ValueError(f"{name}: has the shape {values.shape}: must be (n,), the start and at least one sample")
    return values


def _finite(name: str, given: Any) -> float:
    if isinstance(given, bool) or not (isinstance(given, Real) and math.isfinite(float(given))):
        raise ValueError(f"{name}: is {shown(given)}: must be a number")
    return float(given)


def _noise(name: str, sigma: Any, samples: int) -> Array:
    """Noise of a quantity at the samples behind the start."""
    values = array_of(f"sigma: {name}", sigma)
    if values.ndim and values.size == samples + 1:
        return values[1:]
    return np.broadcast_to(array_of(f"sigma: {name}", sigma, samples), samples)
