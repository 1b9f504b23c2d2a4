"""A run increment by increment, controlled by its caller."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from numbers import Real
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._paths import path
from ._plain import a_name, count, number, plain, refused
from .case import Case

Array = NDArray[np.float64]


class Increment:
    """An accepted state. Its nodal arrays are read-only views of the solver's data, not copies."""

    def __init__(self, native: _native.Increment) -> None:
        self._native = native

    @property
    def time(self) -> float:
        """t [T]."""
        return self._native.time

    @property
    def dt(self) -> float:
        """Δt of the increment that led here [T]."""
        return self._native.dt

    @property
    def number(self) -> int:
        """Accepted increments so far."""
        return self._native.number

    @property
    def step(self) -> str:
        """Name of the step."""
        return self._native.step

    @property
    def iterations(self) -> int:
        """Linear solves."""
        return self._native.iterations

    @property
    def displacement(self) -> Array:
        """u, shape (nodes, 2) [L]; a view."""
        return self._native.field("displacement")

    @property
    def velocity(self) -> Array:
        """v, shape (nodes, 2) [L/T]; a view."""
        return self._native.field("velocity")

    @property
    def acceleration(self) -> Array:
        """a, shape (nodes, 2) [L/T²]; a view."""
        return self._native.field("acceleration")

    @property
    def reaction(self) -> Array:
        """Forces of the supports on the nodes, shape (nodes, 2) [F]; a view."""
        return self._native.field("reaction")

    @property
    def external(self) -> Array:
        """Forces of loads and supports on the nodes, shape (nodes, 2) [F]; a view."""
        return self._native.field("external")

    def __repr__(self) -> str:
        return f"<Increment {self.number} of step {self.step}: t = {self.time:g}, dt = {self.dt:g}>"


class ContactFields(Mapping[str, Array]):
    """Current fields of a contact by name, shape (points,); each is computed on demand, and so a copy.

    ``gap``, ``slip``, ``elastic_slip`` [L], ``pressure``, ``traction`` [F/L²], ``slip_rate`` [L/T], ``state`` (0 open, 1
    sticking, 2 slipping), ``dissipation`` [F/L], ``R``, ``mu``, ``structure`` [-], and further variables of its law.
    """

    ALWAYS = (
        "gap",
        "pressure",
        "traction",
        "slip",
        "elastic_slip",
        "slip_rate",
        "R",
        "mu",
        "structure",
        "state",
        "dissipation",
    )

    def __init__(self, native: _native.Simulation, name: str) -> None:
        self._native, self._name = native, name

    def __getitem__(self, field: str) -> Array:
        return self._native.contact_field(self._name, a_name(field, "field", "contacts"))

    def __iter__(self) -> Iterator[str]:
        return iter(self.ALWAYS)

    def __len__(self) -> int:
        return len(self.ALWAYS)

    @property
    def position(self) -> Array:
        """Positions of the slave points, shape (points, 2) [L]; a copy."""
        return self._native.contact_positions(self._name)

    @property
    def force(self) -> Array:
        """Force of the master on the slave, without fluid pressure, shape (2,) [F]."""
        return np.array(self._native.contact_force(self._name))


class BarFields(Mapping[str, Array]):
    """Current fields of a bar by name; each is computed on demand, and so a copy.

    At its points ``moment`` [F L], ``slip`` [L], ``bond_shear``, ``bond_normal`` [F/L], of its segments ``axial_force``, ``shear_force``
    [F] and ``yielding``.
    """

    ALWAYS = ("moment", "slip", "bond_shear", "bond_normal", "axial_force", "shear_force", "yielding")

    def __init__(self, native: _native.Simulation, name: str) -> None:
        self._native, self._name = native, name

    def __getitem__(self, field: str) -> Array:
        return self._native.bar_field(self._name, a_name(field, "field", "bars"))

    def __iter__(self) -> Iterator[str]:
        return iter(self.ALWAYS)

    def __len__(self) -> int:
        return len(self.ALWAYS)

    @property
    def position(self) -> Array:
        """Positions of the points of the bar, shape (points, 2) [L]; a copy."""
        return self._native.bar_positions(self._name)


class Simulation:
    """A run as an iterator over its increments; supports and loads can be changed between them.

    Force control of a machine, based on the last increment::

        machine = fc.Simulation(case)
        for increment in machine:
            error = wanted - machine.reaction("piston")[0]
            machine.prescribe("piston", ux=machine.displacement("piston")[0] + error / stiffness, by=increment.time + dt)

    Args:
        case: a case, or the arguments of one.
        threads: number of threads, without effect on the results; default: all cores.

    Raises:
        CaseError: the same as for ``case.check()``.
    """

    def __init__(self, case: Case | Mapping[str, Any] | str | os.PathLike[str], threads: int | None = None) -> None:
        self.case = case if isinstance(case, Case) else Case(case)
        self._native = _native.Simulation(self.case._native, count(threads, "threads"))

    def __iter__(self) -> Simulation:
        return self

    def __next__(self) -> Increment:
        """The next accepted increment; of an explicit step, all of them to the next output.

        Raises:
            Stopped: no increment is short enough to be solved; the previous state is kept.
        """
        increment = self._native.next_increment()
        if increment is None:
            raise StopIteration
        return Increment(increment)

    @property
    def state(self) -> Increment:
        """The accepted state."""
        return Increment(self._native.state)

    @property
    def time(self) -> float:
        """t [T]."""
        return self._native.state.time

    @property
    def step(self) -> str:
        """Name of the step of the next increment."""
        return self._native.state.step

    @property
    def span(self) -> tuple[float, float]:
        """Start and end of the step of the next increment [T]."""
        return self._native.span

    @property
    def is_complete(self) -> bool:
        """Whether the last step is over, or :meth:`stop` has ended it."""
        return self._native.is_complete

    @property
    def report(self) -> dict[str, Any]:
        """Counts, energies and times so far, as in ``summary.json``."""
        report: dict[str, Any] = json.loads(self._native.report())
        return report

    @property
    def nodes(self) -> Array:
        """Reference positions, shape (nodes, 2) [L]; a copy."""
        return self._native.nodes()

    def nodes_of(self, group: str) -> NDArray[np.intp]:
        """Numbers of the nodes of a group, ascending."""
        return np.array(self._native.nodes_of(a_name(group, "group", "nodes_of")), dtype=np.intp)

    def reaction(self, group: str) -> Array:
        """Sum of the support reactions on a group, shape (2,) [F]."""
        return np.array(self._native.reaction(a_name(group, "group", "reaction")))

    def displacement(self, group: str) -> Array:
        """Mean displacement of the nodes of a group, shape (2,) [L]."""
        return np.array(self._native.displacement(a_name(group, "group", "displacement")))

    @property
    def pore_pressures(self) -> Array:
        """Pressures of water that flows through bodies at all nodes, NaN at others, shape (nodes,) [F/L²]; a copy."""
        return self._native.pore_pressures()

    @property
    def contacts(self) -> dict[str, ContactFields]:
        """Contacts by name, with their current fields."""
        return {name: ContactFields(self._native, name) for name in self._native.contacts}

    @property
    def bars(self) -> dict[str, BarFields]:
        """Bars by name, with their current fields."""
        return {name: BarFields(self._native, name) for name in self._native.bars}

    def prescribe(self, group: str, *, ux: float | None = None, uy: float | None = None, by: float) -> None:
        """Move the supports of a group linearly from their current position to a displacement, and hold them there to the end of the
        step.

        Args:
            group: a group supported in these directions.
            ux, uy: displacements [L].
            by: time at which they are reached [T].
        """
        end = number(by, "by", "prescribe")
        for axis, (name, to) in enumerate((("ux", ux), ("uy", uy))):
            if to is not None:
                self._native.prescribe(a_name(group, "group", "prescribe"), axis, number(to, name, "prescribe"), end)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            now = ": it is called `prescribe`" if name == "lead" else ""
            raise AttributeError(f"`Simulation` has no `{name}`{now}", name=name, obj=self)

    def load(self, on: str, *, by: float | None = None, **load: Any) -> None:
        """Change a load until the end of the step.

        Args:
            on: group on which it acts.
            by: time at which its value is reached, linearly from the current one [T]; default: immediately.
            **load: one kind of load, as in a step: ``pressure=2.0``, ``traction={"x": 1.0}``, ``force=``, ``gravity=``,
                ``spring={"kx": 10, "driver": {"x": 0.1}}``, ``dashpot=``; ``None`` ends it.
        """
        self._native.load(json.dumps(plain({"on": on, **load}, file="load")), None if by is None else number(by, "by", "load"))

    def increments(self, *, max: float | None = None, min: float | None = None) -> None:
        """Bound the increments of the current step [T].

        Args:
            max: longest increment; default: unchanged.
            min: shortest increment; default: unchanged, and at most ``max``.

        Raises:
            CaseError: a bound is not positive, ``min`` is above ``max``, or too many increments would be needed, as for ``dt`` in a case.
        """
        for name, bound in (("max", max), ("min", min)):
            if not isinstance(bound, (Real, type(None))):
                raise refused("increments", name, f"is {bound!r}: must be a number")
        self._native.increments(max, min)

    def stop(self) -> None:
        """Stop the run: no increment follows. A saved run continues as if it had not been stopped."""
        self._native.stop()

    def save(self) -> _native.Saved:
        """Save the run, to be continued in this process by :meth:`resume`, any number of times."""
        return self._native.save()

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Write a checkpoint into a folder; another case can begin with it once this run is complete (``begin_with``).

        Raises:
            Stopped: it cannot be written, or supports and loads of the current step were changed, which a file cannot hold.
        """
        self._native.write(path(folder, "folder"))

    @classmethod
    def resume(
        cls, case: Case | Mapping[str, Any] | str | os.PathLike[str], saved: _native.Saved, threads: int | None = None
    ) -> Simulation:
        """Resume from the result of :meth:`save`, bitwise identical to an uninterrupted run.

        Args:
            case: the case of the saved run. Its title, units, watched sets and output may differ, as may
                steps that had not begun; a step that was changed by the caller has begun.
            saved: the saved run.
            threads: number of threads; default: all cores.

        Raises:
            CaseError: the case has other changes, which the message lists, as for ``case.run(out, resume=True)``.
        """
        if not isinstance(saved, _native.Saved):
            raise ValueError(f"saved: is a {type(saved).__name__}: give what save() has returned")
        simulation = cls(case, threads)
        simulation._native.restore(saved)
        return simulation

    def __repr__(self) -> str:
        return f"<Simulation of {self.case!r} at t = {self.time:g}>"


