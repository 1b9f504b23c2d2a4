"""Measured curves for fits: prescribed and measured quantities, and the prediction of a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .law import Drive, law

Array = NDArray[np.float64]
Parameters = Mapping[str, Any]

# Parameters of the machine of a spring-slider, which no law has.
MACHINE = ("stiffness", "mass")
# Parameters of a record that no law has: those of the machine, and what the measured traction drifts by along the way.
OF_RECORDS = (*MACHINE, "drift")
# Rows with which a search begins, and the error that steps of a spring-slider have there and later.
ROWS = 200
ROUGH, EXACT = 1e-5, 1e-8


class Interface:
    """Slip, pressure and traction over time at an interface, as in direct shear.

    Args:
        time: ascending, shape (n,) [T].
        slip: since the start, shape (n,) [L].
        pressure: shape (n,), or a number [F/L²].
        traction: measured, shape (n,) [F/L²].
        sigma: standard deviation of the noise of ``traction``: a number or shape (n,); by default estimated by the fit [F/L²].
        weight: weight of this record relative to others.
        initial: traction at the start [F/L²].
        opening: of the surfaces, under which a bond acts, shape (n,); default: 0 [L].

    A record may have the parameter ``drift`` [F/L³], given or free, which no law has: D times the slip since its first row is added to the traction of the law.
    """

    # What the residuals are of; records of several kinds need a sigma each.
    kind = "traction"
    # What is led.
    led = "slip"
    # Error of steps that adapt themselves to slip events.
    _tolerance = EXACT

    def __init__(
        self,
        time: ArrayLike,
        slip: ArrayLike,
        pressure: ArrayLike,
        traction: ArrayLike,
        *,
        sigma: ArrayLike | None = None,
        weight: float = 1.0,
        initial: float = 0.0,
        opening: ArrayLike | None = None,
    ) -> None:
        self.time = array_of("time", time)
        size = self.time.size
        self.slip, self.measured = array_of("slip", slip, size), array_of("traction", traction, size)
        self.pressure = np.broadcast_to(array_of("pressure", pressure, size), size)
        self.initial = float(array_of("initial", initial, 1).ravel()[0])
        self.sigma, self.weight = noise_of(sigma, weight, size)
        self.opening = None if opening is None else np.broadcast_to(array_of("opening", opening, size), size)

    def rough(self) -> Interface:
        """The record as a search begins with it: with longer steps, and of a long one some rows only."""
        short, every = copy(self), max(self.time.size // ROWS, 1)
        short._tolerance = ROUGH
        for name in ("time", "slip", "pressure", "measured", "sigma", "opening"):
            if (column := getattr(self, name)) is not None:
                setattr(short, name, column[::every])
        return short

    def scales(self) -> tuple[float, float, float]:
        """Coefficient of friction, slip [L] and time [T] that the record covers."""
        closed = self.pressure > 0
        coefficient = np.max(np.abs(self.measured[closed]) / self.pressure[closed], initial=0.0)
        return float(coefficient), float(np.ptp(self.slip)), float(np.ptp(self.time))

    def predicted(self, parameters: Parameters, threads: int | None = None) -> Array:
        """Prediction of the measured quantity by the law, shape (sets, n)."""
        return self._drifted(self._driven(parameters, threads)["traction"], parameters)

    def _driven(self, parameters: Parameters, threads: int | None) -> Drive:
        path = (self.time, self.slip, self.pressure)
        return law(_of_law(parameters)).drive(*path, opening=self.opening, traction=self.initial, threads=threads)

    def derivatives(self, parameters: Parameters, by: Sequence[str], threads: int | None = None) -> Array:
        """How that varies with parameters of one set, shape (n, by)."""
        own = [name for name in by if name not in OF_RECORDS]
        drive = law(_of_law(parameters)).drive(self.time, self.slip, self.pressure, traction=self.initial, by=own, threads=threads)
        return self._with_drift(_columns(drive, "traction", by), by)

    def _drifted(self, traction: Array, parameters: Parameters) -> Array:
        """A predicted traction, and what the record drifts by: D times the way so far."""
        return np.asarray(traction + np.multiply.outer(np.asarray(parameters.get("drift", 0.0), dtype=float), self.slip - self.slip[0]))

    def _with_drift(self, columns: Array, by: Sequence[str]) -> Array:
        """Derivatives, those by the drift filled in."""
        for column in (k for k, name in enumerate(by) if name == "drift"):
            columns[:, column] = self.slip - self.slip[0]
        return columns

    def __repr__(self) -> str:
        return _shown(self, time=self.time, **{self.led: self.slip}, pressure=self.pressure, traction=self.measured)


class SpringSlider(Interface):
    """Load-point displacement and force of a machine, whose stiffness k is a parameter, ``stiffness``, and mass M may be one, ``mass``.

    With a mass the record is simulated by :meth:`fecontact.law.Law.slider`, from rest: M ü = F − q, F = F₀ + k (w − u). Without, the machine
    and what the interface yields are springs in series: the load point drives a law with 1/α = 1/α_t + 1/k, of which the data tell no more
    than α, and a slip event is a jump.

    Args:
        time: ascending, shape (n,) [T].
        load_point: displacement since the start, shape (n,) [L].
        pressure: shape (n,), or a number [F/L²].
        traction: measured force per area, shape (n,) [F/L²].
        sigma, weight, initial: as for :class:`Interface`.
    """

    led = "load_point"

    def __init__(self, time: ArrayLike, load_point: ArrayLike, pressure: ArrayLike, traction: ArrayLike, **options: Any) -> None:
        super().__init__(time, load_point, pressure, traction, **options)

    def predicted(self, parameters: Parameters, threads: int | None = None) -> Array:
        """Predicted force of the spring-slider, shape (sets, n)."""
        if "mass" in parameters:
            return self._drifted(self._ride(parameters, (), threads)["force"], parameters)
        return super().predicted({**parameters, "alpha_t": self._series(parameters)[0]}, threads)

    def derivatives(self, parameters: Parameters, by: Sequence[str], threads: int | None = None) -> Array:
        """How that varies with parameters of one set, shape (n, by)."""
        if "mass" in parameters:
            own = [name for name in by if name != "drift"]
            return self._with_drift(_columns(self._ride(parameters, own, threads), "force", by), by)
        series, shares = self._series(parameters)
        own = list(dict.fromkeys("alpha_t" if name == "stiffness" else name for name in by))
        columns = dict(zip(own, super().derivatives({**parameters, "alpha_t": series}, own, threads).T))
        scaled = {name: columns["alpha_t"] * share for name, share in shares.items() if name in by}
        return np.stack([{**columns, **scaled}[name] for name in by], axis=-1)

    def _ride(self, parameters: Parameters, by: Sequence[str], threads: int | None) -> Drive:
        self._check(parameters)
        sets = np.broadcast_shapes(*(np.shape(value) for value in parameters.values() if isinstance(value, np.ndarray)))
        whole = {**_of_law(parameters), "alpha_t": np.broadcast_to(parameters["alpha_t"], sets)}
        stiffness, mass = (np.broadcast_to(parameters[name], sets) for name in MACHINE)
        path = (self.time, self.slip, self.pressure)
        return law(whole).slider(*path, stiffness=stiffness, mass=mass, force=self.initial, by=by, tolerance=self._tolerance, threads=threads)

    def _series(self, parameters: Parameters) -> tuple[Array, dict[str, Array]]:
        """α, and its derivatives by k and α_t."""
        self._check(parameters)
        springs = {name: np.asarray(parameters[name], dtype=float) for name in ("stiffness", "alpha_t")}
        series = np.asarray(1.0 / (1.0 / springs["stiffness"] + 1.0 / springs["alpha_t"]))
        return series, {name: (series / spring) ** 2 for name, spring in springs.items()}

    def _check(self, parameters: Parameters) -> None:
        for name in ("stiffness", "alpha_t"):
            if name not in parameters:
                raise ValueError(f"{name}: a spring-slider needs it: give it, or a range to find it in")


class PullOff(Interface):
    """Opening and stress over time of a joint that is pulled apart, whose law has a bond with a ``bond.tension``.

    Args:
        time: ascending, shape (n,) [T].
        opening: of the surfaces, shape (n,) [L].
        stress: measured tensile stress, shape (n,) [F/L²].
        sigma: standard deviation of the noise of ``stress``; by default estimated by the fit [F/L²].
        weight: weight of this record relative to others.
    """

    kind = "tension"
    led = "opening"

    def __init__(self, time: ArrayLike, opening: ArrayLike, stress: ArrayLike, *, sigma: ArrayLike | None = None, weight: float = 1.0) -> None:
        none = np.zeros(np.size(np.asarray(time)))
        super().__init__(time, none, 0.0, stress, sigma=sigma, weight=weight, opening=opening)

    def scales(self) -> tuple[float, float, float]:
        """Coefficient of friction, slip [L] and time [T] that the record covers: no friction."""
        return 0.0, 0.0, float(np.ptp(self.time))

    def predicted(self, parameters: Parameters, threads: int | None = None) -> Array:
        """Predicted tensile stress, shape (sets, n).

        Raises:
            ValueError: a drift is asked for.
        """
        _no_drift(parameters)
        return -self._driven(parameters, threads)["pressure"]

    def __repr__(self) -> str:
        opening = np.zeros(0) if self.opening is None else self.opening
        return _shown(self, time=self.time, opening=opening, stress=self.measured)


class Holds:
    """Peaks of the coefficient of friction after holds, in one slide-hold-slide sequence of a stiff machine.

    Args:
        hold: durations of the successive holds, shape (n,) [T].
        peak: measured largest q/p of the slide after each hold, shape (n,) [-].
        rate: slip rate of the slides [L/T].
        slide: length of every slide, including the first one, which starts from rest [L].
        pressure: [F/L²].
        sigma: standard deviation of the noise of ``peak``; by default estimated by the fit [-].
        weight: weight of this record relative to others.
    """

    kind = "peak"
    # Samples of a slide, closer together where it begins: the peak comes after an unknown share of it.
    SAMPLES = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 150)])

    def __init__(
        self,
        hold: ArrayLike,
        peak: ArrayLike,
        *,
        rate: float,
        slide: float,
        pressure: float,
        sigma: ArrayLike | None = None,
        weight: float = 1.0,
    ) -> None:
        self.hold = array_of("hold", hold)
        size = self.hold.size
        self.measured = array_of("peak", peak, size)
        for name, value in (("rate", rate), ("slide", slide), ("pressure", pressure), ("hold", self.hold.min(initial=1.0))):
            if not (isinstance(value, Real) and float(value) > 0):
                raise ValueError(f"{name}: is {value}: must be positive")
        self.rate, self.slide, self.pressure = float(rate), float(slide), float(pressure)
        self.sigma, self.weight = noise_of(sigma, weight, size)
        starts = np.concatenate([[0.0], np.cumsum(self.hold + slide / rate)])
        self._time = (starts[:, None] + slide / rate * self.SAMPLES).ravel()
        self._slip = (slide * (np.arange(size + 1)[:, None] + self.SAMPLES)).ravel()

    def rough(self) -> Holds:
        """The record as a search begins with it: the same."""
        return self

    def scales(self) -> tuple[float, float, float]:
        """Coefficient of friction, slip [L] and time [T] that the record covers."""
        return float(self.measured.max()), self.slide, float(self.hold.max())

    def predicted(self, parameters: Parameters, threads: int | None = None) -> Array:
        """Predicted peaks, shape (sets, n).

        Raises:
            ValueError: a drift is asked for.
        """
        _no_drift(parameters)
        drive = law(_of_law(parameters)).drive(self._time, self._slip, self.pressure, threads=threads)
        return np.asarray(self._slides(drive["traction"]).max(axis=-1) / self.pressure)

    def derivatives(self, parameters: Parameters, by: Sequence[str], threads: int | None = None) -> Array:
        """Their derivatives by parameters of one set, shape (n, by), taken at the sample of the peak."""
        own = [name for name in by if name not in OF_RECORDS]
        drive = law(_of_law(parameters)).drive(self._time, self._slip, self.pressure, by=own, threads=threads)
        peaks = self._slides(drive["traction"]).argmax(axis=-1)
        columns = [self._slides(column)[np.arange(self.hold.size), peaks] for column in _columns(drive, "traction", by).T]
        return np.stack(columns, axis=-1) / self.pressure

    def __repr__(self) -> str:
        return _shown(self, hold=self.hold, peak=self.measured, rate=self.rate, slide=self.slide, pressure=self.pressure)

    def _slides(self, sampled: Array) -> Array:
        """Samples (..., holds, samples) of the slides after holds."""
        return sampled.reshape(*sampled.shape[:-1], self.hold.size + 1, self.SAMPLES.size)[..., 1:, :]


Record = Interface | SpringSlider | PullOff | Holds


def _shown(record: Record, **ranges: Array | float) -> str:
    """Description of a record in one line: number and range of its samples."""
    spans = {name: np.unique([np.min(values, initial=np.inf), np.max(values, initial=-np.inf)]) for name, values in ranges.items()}
    spans_text = ", ".join(f"{name} {' to '.join(f'{end:.6g}' for end in span)}" for name, span in spans.items())
    return f"<{type(record).__name__} of {record.measured.size} samples: {spans_text}>"


def _no_drift(parameters: Parameters) -> None:
    if "drift" in parameters:
        raise ValueError("drift: it is along the slip of a record, which this one has none of: fit it to an Interface or SpringSlider")


def _of_law(parameters: Parameters) -> dict[str, Any]:
    return {name: value for name, value in parameters.items() if name not in OF_RECORDS}


def _columns(drive: Drive, what: str, by: Sequence[str]) -> Array:
    """∂what/∂parameter of a drive, one column per parameter; 0 for those without effect."""
    return np.stack([drive.get(f"d{what}_d{name}", np.zeros_like(drive[what])) for name in by], axis=-1)


def array_of(name: str, given: ArrayLike, size: int | None = None) -> Array:
    try:
        values = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: is a {type(given).__name__}: must be numbers") from None
    if values.ndim > 1 or (size is not None and values.shape not in ((), (size,))):
        raise ValueError(f"{name}: has the shape {values.shape}: must be ({'n' if size is None else size},)")
    if not np.isfinite(values).all():
        raise ValueError(f"{name}: is not a finite number at {np.flatnonzero(~np.isfinite(np.atleast_1d(values)))[0]}")
    return values


def noise_of(sigma: ArrayLike | None, weight: float, size: int) -> tuple[Array | None, float]:
    if not (isinstance(weight, Real) and weight > 0):
        raise ValueError(f"weight: is {weight}: must be positive")
    if sigma is None:
        return None, float(weight)
    values = np.broadcast_to(array_of("sigma", sigma, size), size)
    if not (values > 0).all():
        raise ValueError("sigma: must be positive")
    return values, float(weight)
