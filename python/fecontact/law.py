"""Friction laws without a mesh, driven along paths of slip and pressure; many parameter sets at once."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._plain import a_name, count, names, number, numbers, plain, refused
from ._steady import steady

Array = NDArray[np.float64]


class Drive(Mapping[str, Array]):
    """Response of a law along a path, by name; each array has the shape (..., n): that of the parameters, and the times.

    ``time`` (n,) [T], ``slip`` [L], ``pressure``, ``traction`` [F/L²], ``R``, ``mu``, ``structure`` [-], ``plastic_slip`` [L],
    ``dissipation`` [F/L], the consistent tangents of every step ``dtraction_dslip`` [F/L³] and ``dtraction_dpressure`` [-],
    ``evaluations`` of the law's equation, and further variables of the law; of an interface that opens also ``dilation``, ``wear`` and
    its ``gap`` [L]; beside a bond also its ``opening`` [L] and ``bond``, what is left of it; traction, pressure and dissipation include it. Also available as attributes: ``drive.traction``.
    """

    def __init__(self, arrays: Mapping[str, Array]) -> None:
        self._arrays = dict(arrays)

    def __getitem__(self, name: str) -> Array:
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __getattr__(self, name: str) -> Array:
        # One that is being copied has no arrays yet.
        arrays: dict[str, Array] = self.__dict__.get("_arrays", {})
        if name not in arrays:
            raise AttributeError(f"a drive has no `{name}`; it has {', '.join(arrays)}")
        return arrays[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._arrays]

    def __repr__(self) -> str:
        return f"<Drive of shape {self['traction'].shape}: {', '.join(self)}>"


class Law:
    """A friction law with its parameters, each a number, or an array of any shape with one set of parameters per entry."""

    def __init__(self, parameters: Mapping[str, Any]) -> None:
        parameters = _flat(parameters)
        arrays = {name: _array(name, value) for name, value in parameters.items() if _is_array(value)}
        try:
            self.shape: tuple[int, ...] = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise refused("law", "", f"the shapes of the parameters do not match: {shapes}") from None
        if 0 in self.shape:
            raise refused("law", "", f"the parameters have the shape {self.shape}: give one set of them or more")
        self.parameters = dict(parameters)
        self._sets = []
        for index in np.ndindex(self.shape):
            one = {name: np.broadcast_to(array, self.shape)[index] for name, array in arrays.items()}
            self._sets.append(json.dumps(plain(_nested({**parameters, **one}), file="law")))

    def check(self) -> None:
        """Check the parameters of all sets.

        Raises:
            CaseError: a parameter is invalid.
        """
        self.drive([0.0, 1.0], 0.0, 1.0)

    def drive(
        self,
        time: ArrayLike,
        slip: ArrayLike,
        pressure: ArrayLike,
        *,
        opening: ArrayLike | None = None,
        traction: float = 0.0,
        dilatancy: Mapping[str, Any] | None = None,
        wear: float | None = None,
        normal: Mapping[str, Any] | None = None,
        by: Sequence[str] = (),
        threads: int | None = None,
    ) -> Drive:
        """Drive the law along straight lines from sample to sample, bitwise identical to ``fecontact law`` with a table.

        However far apart the samples are, the traction is accurate to about 1e-6 μ p: super/subloading friction (except with backward
        Euler) and rate-and-state friction take sub-steps; the increments of Coulomb friction and slip weakening are exact.

        Args:
            time: ascending, shape (n,), n ≥ 2 [T].
            slip: total slip since the start, shape (n,), or (..., n) with a path for every set of parameters [L].
            pressure: the same, or a number; at or below 0 the surfaces are separated [F/L²].
            opening: opening of the surfaces under which a ``bond`` of the law acts, in the same forms; where it is positive friction has no
                pressure. Default: 0 [L].
            traction: traction at the start [F/L²].
            dilatancy: opening by plastic slip, as of a contact: ``model.Dilatancy(structure=0.3)``.
            wear: k of Archard's law, as of a contact [L²/F].
            normal: how the pressure answers to the opening, p = p_a + K_n g with the given pressure p_a; constant load by default.
                ``{"stiffness": 4 * G / D}`` is the constant normal stiffness K_n of a shaft, ``{"constant_volume": True, "alpha_n": 1e6}``
                holds the gap g = d − (p − p₀)/α_n at zero; ``alpha_n`` is the normal stiffness of the interface itself, rigid by default.
            by: parameters by which to differentiate the traction, not with ``normal``, among those of :meth:`sensitivities`: the drive contains
                ``dtraction_dmu_s`` for ``"mu_s"``, at constant initial traction. The derivatives are those of the computed values, to
                round-off, at fixed sub-steps.
            threads: number of threads; default: all cores.

        Raises:
            CaseError: a parameter or the path is wrong.
            Stopped: the law has no answer somewhere.
        """
        times = _times(time)
        courses = {name: self._course(name, given, times.size) for name, given in (("slip", slip), ("pressure", pressure))}
        besides = {"dilatancy": dilatancy, "wear": wear, "normal": normal}
        given = {name: value for name, value in besides.items() if value is not None}
        interface = {"initial": {"traction": number(traction, "traction", "law")}, **given}
        opened = None if opening is None else self._course("opening", opening, times.size)
        return self._drive(self._sets, times, courses, opened, interface, by, threads)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            now = ": it is called `slider`" if name == "ride" else ""
            raise AttributeError(f"`Law` has no `{name}`{now}", name=name, obj=self)

    def slider(
        self,
        time: ArrayLike,
        load_point: ArrayLike,
        pressure: ArrayLike,
        *,
        stiffness: ArrayLike,
        mass: ArrayLike,
        force: float = 0.0,
        by: Sequence[str] = (),
        tolerance: float = 1e-8,
        threads: int | None = None,
    ) -> Drive:
        """Simulate a spring-slider: a mass with the law, pulled by the spring of a machine, initially at rest in equilibrium::

            M ü = F − q,   F = F₀ + k (w − u)

        Its steps are adapted to slip events by halving the samples; only friction damps it.

        Args:
            time: ascending, shape (n,), n ≥ 2 [T].
            load_point: w since the start, shape (n,), or (..., n) with a path for every set of parameters [L].
            pressure: the same, or a number [F/L²].
            stiffness: k of the machine, k > 0, a number or an array of the shape of the parameters [F/L³].
            mass: M > 0, likewise [F T²/L³].
            force: initial force F₀ [F/L²].
            by: parameters by which to differentiate the force, among those of :meth:`sensitivities`, ``"stiffness"`` and ``"mass"``:
                the drive contains ``dforce_dmass``, exact for fixed steps.
            tolerance: error of force and traction in a step, as a fraction of the largest pressure.
            threads: number of threads; default: all cores.

        Returns:
            what :meth:`drive` returns, with ``load_point`` [L], ``force`` [F/L²] and ``slip_rate`` [L/T]; ``slip`` is that of the mass.

        Raises:
            CaseError: a parameter or the path is wrong.
            Stopped: the law has no answer somewhere.
        """
        times, machine = _times(time), {}
        for name, given in (("stiffness", stiffness), ("mass", mass)):
            if (values := _finite(name, given)).shape not in ((), self.shape):
                raise refused("law", name, f"has the shape {values.shape}: must be {self.shape}, as the parameters")
            machine[name] = np.broadcast_to(values, self.shape).reshape(-1).tolist()
        machine["tolerance"] = [number(tolerance, "tolerance", "law")] * len(self._sets)
        sliders = [dict(zip(machine, values)) for values in zip(*machine.values())]
        sets = [json.dumps({**json.loads(one), "slider": slider}) for one, slider in zip(self._sets, sliders)]
        courses = {name: self._course(name, given, times.size) for name, given in (("load_point", load_point), ("pressure", pressure))}
        return self._drive(sets, times, courses, None, {"initial": {"traction": number(force, "force", "law")}}, by, threads)

    def _drive(
        self,
        sets: list[str],
        times: Array,
        courses: dict[str, Array],
        opening: Array | None,
        interface: dict[str, Any],
        by: Sequence[str],
        threads: int | None,
    ) -> Drive:
        document = json.dumps(plain({**interface, "by": names(by, "by", "law")}, file="law"))
        along, pressure = courses.values()
        arrays = _native.drive(sets, times, along, pressure, opening, document, count(threads, "threads"))
        answers = {name: array.reshape(*self.shape, times.size) for name, array in arrays}
        led = {name: np.broadcast_to(given, (len(sets), times.size)).reshape(*self.shape, -1) for name, given in courses.items()}
        return Drive({"time": times, **led, **answers})

    def sensitivities(self) -> list[str]:
        """Parameters by which :meth:`drive` can differentiate: those of Coulomb friction, adhesion, slip weakening, rate-and-state friction,
        and super/subloading friction except with backward Euler; none for other laws."""
        return _native.sensitivities(self._sets[0])

    def steady(self, rate: ArrayLike) -> Array:
        """Friction coefficient q/p in steady sliding at a rate, with the shape (..., rates) of the parameters and the rates.

        ```text
        coulomb            μ
        slip_weakening     μ_d, without cohesion
        rate_and_state     a arsinh(V/(2 V₀) exp((f₀ + (b + b₂) ln(V₀/V))/a))
        super_subloading   the root of κ V (μ/μ_k − 1)^m = ξ (1 − μ/μ_s)^n; (κ V + ξ)/(κ V/μ_k + ξ/μ_s) for m = n = 1;
                           times 1 + a ln(1 + V/V₀)
        ```

        Args:
            rate: V > 0, shape (rates,) or a number [L/T].

        Raises:
            CaseError: the law has no steady state, or a parameter is invalid.
        """
        rates = _finite("rate", rate)
        if not (rates > 0).all():
            raise refused("law", "rate", f"is {rates.min()}: must be positive")
        self.check()
        return steady(self._sets, rates).reshape((*self.shape, *rates.shape))

    def _course(self, name: str, given: ArrayLike, samples: int) -> Array:
        values = _finite(name, given)
        whole = (*self.shape, samples)
        allowed = {(): (1, samples), (samples,): (1, samples), whole: (len(self._sets), samples)}
        if values.shape not in allowed:
            also = f" or {whole}" if self.shape else ""
            raise refused("law", name, f"has the shape {values.shape}: must be ({samples},), as time has{also}")
        return np.ascontiguousarray(np.broadcast_to(values.reshape(-1, samples) if values.ndim else values, allowed[values.shape]))

    def __repr__(self) -> str:
        sets = f", {len(self._sets)} sets of parameters {self.shape}" if self.shape else ""
        return f"<Law {self.parameters.get('law')}{sets}>"


def law(law: str | Mapping[str, Any], **parameters: Any) -> Law:
    """Create a friction law without a mesh: ``law("coulomb", mu=[0.3, 0.4], alpha_t=1e5)``, from an object of :mod:`fecontact.model`, or
    from the ``friction`` of a contact; ``alpha_t`` is required, since there is no mesh for a default. ``bond`` is a bond in parallel with it,
    ``bond={"strength": 40, "tension": 15, "opening": 0.002}``, whose ``opening`` is required likewise; its values may be arrays, too.

    Args:
        law: its name, or all its parameters; see ``fecontact.model`` for the available laws.
        **parameters: numbers, or arrays that are broadcast by the rules of numpy, with one set of parameters per entry.

    Raises:
        CaseError: there is no such law, or a parameter is invalid.
    """
    if not isinstance(law, (str, Mapping)):
        raise refused("law", "", f"is a {type(law).__name__}: give the name of a law, or its parameters")
    given = {"law": law} if isinstance(law, str) else dict(law)
    made = Law({**given, **parameters})
    made.check()
    return made


def friction_law(
    name: str, variables: Mapping[str, float] | None = None
) -> Callable[[Callable[..., Mapping[str, Any]]], Callable[..., Mapping[str, Any]]]:
    """Register a law written in Python, for trying ideas: ``model.Registered(name=...)`` uses it in cases and in :func:`law`.

    It is slow: Python is called for every slice of points at every iterate. Workers in other processes must register it too.
    The function receives arrays of the n closed points, shape (n,), and the parameters as keywords::

        @fc.friction_law("my_coulomb")
        def my_coulomb(old, slip, pressure, dt, *, mu, alpha_t):
            trial = old["traction"] + alpha_t * slip
            sliding = np.abs(trial) > mu * pressure
            traction = np.where(sliding, np.sign(trial) * mu * pressure, trial)
            return {
                "traction": traction,
                "dtraction_dslip": np.where(sliding, 0.0, alpha_t),
                "dtraction_dpressure": np.where(sliding, np.sign(trial) * mu, 0.0),
                "plastic_increment": np.where(sliding, (trial - traction) / alpha_t, 0.0),
            }

    ``old`` contains traction, pressure [F/L²], plastic_slip [L], dissipation [F/L] and the variables at the start; slip [L], pressure
    [F/L²] and dt [T] are those of the increment, alpha_t is the tangential stiffness [F/L³]. It returns the traction at the end, its
    consistent tangents [F/L³], [-], the plastic part of the slip [L], all variables and optionally, in place of the
    trapezoidal rule, the dissipation of the increment [F/L]: each an array of shape (n,), or a number for all points.

    Args:
        name: name of the law in cases.
        variables: internal variables, any number of them, with their values at first contact. They appear in results by
            their names, which begin with a letter, consist of letters, digits and ``_``, and differ from those of other results
            (``slip``, ``pressure``, ``q``); ``mu`` is shown in results as μ.

    Raises:
        ValueError: a name is invalid.
    """

    if not isinstance(variables or {}, Mapping):
        raise ValueError(f"law `{name}`: variables: is a {type(variables).__name__}: give values at first touch by name")
    remembered = [(a_name(key, "variables", "law"), number(value, key, "law")) for key, value in (variables or {}).items()]

    def register(function: Callable[..., Mapping[str, Any]]) -> Callable[..., Mapping[str, Any]]:
        _native.register_law(a_name(name, "name", "law"), function, remembered)
        return function

    return register


def _flat(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters of a law, those of its bond by names such as ``bond.strength``."""
    bond = parameters.get("bond")
    if not isinstance(bond, Mapping):
        return dict(parameters)
    return {**{name: value for name, value in parameters.items() if name != "bond"}, **{f"bond.{name}": value for name, value in bond.items()}}


def _nested(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The same as a document has them."""
    bond = {name.removeprefix("bond."): value for name, value in parameters.items() if name.startswith("bond.")}
    own = {name: value for name, value in parameters.items() if not name.startswith("bond.")}
    return {**own, "bond": bond} if bond else own


def _array(name: str, given: Any) -> NDArray[Any]:
    """Values of a parameter, which may be texts."""
    try:
        return np.asarray(given)
    except ValueError:
        raise refused("law", name, f"is {given!r}: must be values in rows of one length") from None


def _is_array(value: object) -> bool:
    return isinstance(value, (np.ndarray, list, tuple))


def _times(given: ArrayLike) -> Array:
    times = _finite("time", given)
    if times.ndim != 1 or times.size < 2:
        raise refused("law", "time", f"has the shape {times.shape}: must be (n,), n ≥ 2")
    return times


def _finite(name: str, given: ArrayLike) -> Array:
    values = numbers(given, name, "law")
    if not np.isfinite(values).all():
        at = np.argwhere(~np.isfinite(values))[0]
        place = name + "".join(f"[{k}]" for k in at)
        raise refused("law", place, f"is {values[tuple(at)]}: must be a finite number")
    return values


