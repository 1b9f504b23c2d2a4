"""Cases: given as a file, a dict or keyword arguments, checked and run."""

from __future__ import annotations

import copy
import difflib
import hashlib
import json
import os
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._paths import path as as_path
from ._plain import a_name, count, plain, refused
from ._progress import Progress
from .errors import Defect, Interrupted, RunWarning, Stopped
from .mesh import Mesh
from .result import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .model import CaseKeys

# What a case says of a mesh that is at hand.
AT_HAND = "a mesh at hand"


class Report(str):
    """A text displayed without escapes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


class Case:
    """A case: mesh, bodies, contacts and steps, as ``fecontact schema`` describes them.

    Args:
        source: the path of a case file, or its content as a dict. The mesh may be a :class:`Mesh`, and any part an object of
            :mod:`fecontact.model`; arrays of numpy stand for lists.
        folder: reference folder of relative paths in a dict; default: the current folder.
        **keys: the keys of a case, instead of a dict: ``Case(mesh=..., bodies=..., contacts=..., steps=...)``.

    Raises:
        CaseError: the case is invalid; with file, place and value, as on the command line. Errors that require the mesh are found by
            :meth:`check` and :meth:`run`.
    """

    def __init__(
        self,
        source: str | os.PathLike[str] | Mapping[str, Any] | None = None,
        *,
        folder: str | os.PathLike[str] = "",
        **keys: Unpack[CaseKeys],
    ) -> None:
        self._mesh: Mesh | None = None
        if isinstance(source, (str, os.PathLike)):
            if keys:
                raise TypeError(f"a case file is complete: {', '.join(keys)} cannot be given in addition")
            self._path = os.fspath(source)
            self._native = _native.Case.read(self._path)
            self._document: dict[str, Any] = json.loads(self._native.document())
            return
        self._path = os.path.join(as_path(folder, "folder"), "case")
        if not isinstance(source, (Mapping, type(None))):
            raise refused(self._path, "", f"is a {type(source).__name__}: give the path of a case file, or a case as a dict")
        given = {**(source or {}), **keys}
        if isinstance(given.get("mesh"), Mesh):
            self._mesh = given["mesh"]
            given = {**given, "mesh": AT_HAND}
        self._document = plain(given, file=self._path)
        self._native = self._made()

    def _made(self) -> _native.Case:
        text = json.dumps(self._document, allow_nan=False)
        return _native.Case(text, self._path, None if self._mesh is None else self._mesh._native)

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return (_again, (self._document, self._path, self._mesh))

    @property
    def document(self) -> dict[str, Any]:
        """The case as a dict; a copy."""
        return copy.deepcopy(self._document)

    @property
    def mesh(self) -> Mesh | None:
        """The mesh in memory, if it was given instead of a file."""
        return self._mesh

    @property
    def title(self) -> str:
        """Title of the case."""
        return str(self._document.get("title", ""))

    def check(self) -> str:
        """Check the case and its mesh, and return the case as interpreted; solves nothing.

        Raises:
            CaseError: the case is invalid; with file, place and value.
        """
        return Report(self._native.check())

    def resolved(self) -> Case:
        """The case with every default filled in, with bitwise identical results; as printed by ``fecontact check --resolved``.

        Raises:
            CaseError: the same as for :meth:`check`.
        """
        case = Case.__new__(Case)
        case._path, case._mesh, case._document = self._path, self._mesh, json.loads(self._native.resolved())
        case._native = case._made()
        return case

    def refined(self, times: int = 1, increments: int | None = None) -> Case:
        """The case with elements and increments halved so many times; it writes no fields. What it leaves open has the default of the
        finer mesh. Blocks have twice as many elements along their sides; of other meshes every element becomes four, and their boundaries
        stay as they are.

        Args:
            times: how many times elements are halved.
            increments: how many times increments are halved; default: as often as elements.

        Raises:
            CaseError: the case is invalid, or a group of nodes in its mesh stands for a side.
        """
        increments = times if increments is None else increments
        for name, value in (("times", times), ("increments", increments)):
            if value < 0:
                raise ValueError(f"{name}: is {value}: give 0 or more")
        case = Case.__new__(Case)
        case._path, case._document = self._path, json.loads(self._native.refined(times, increments))
        case._mesh = self._mesh if times == 0 else None
        case._native = case._made()
        return case

    def replace(self, values: Mapping[str, Any]) -> Case:
        """The case with other values at some places.

        Args:
            values: by place, such as ``{"contacts.base.friction.mu_s": 0.5, "steps[1].duration": 10, "mesh": mesh}``.

        Raises:
            CaseError: a place does not exist, or a value is invalid.
        """
        if not isinstance(values, Mapping) or not all(isinstance(place, str) for place in values):
            raise refused(self._path, "", f"replace: is a {type(values).__name__}: give values by place, as {{\"steps[0].duration\": 2.0}}")
        case = Case.__new__(Case)
        case._path, case._mesh, case._document = self._path, self._mesh, copy.deepcopy(self._document)
        for place, value in values.items():
            if place == "mesh":
                case._mesh = value if isinstance(value, Mesh) else None
                value = AT_HAND if isinstance(value, Mesh) else value
            _put(case._document, place, plain(value, place, self._path), self._path)
        case._native = case._made()
        return case

    @property
    def digest(self) -> str:
        """Hash of the problem to be solved, including the mesh: 16 hexadecimal digits."""
        solved = {key: value for key, value in self._document.items() if key not in ("title", "units")}
        of = hashlib.sha256(json.dumps(solved, sort_keys=True).encode())
        mesh = self._document.get("mesh")
        if self._mesh is not None:
            of.update(json.dumps(self._mesh.document(), sort_keys=True).encode())
        else:
            for file in _files(mesh):
                of.update(Path(os.path.dirname(self._path), file).read_bytes())
        for measured in _measured(self._document):
            of.update(Path(os.path.dirname(self._path), measured["file"]).read_bytes())
        return of.hexdigest()[:16]

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the case as a file for ``fecontact run``, including a mesh in memory."""
        path = as_path(path, "path")
        document = self.document
        mesh = document.get("mesh")
        folder = os.path.dirname(path) or "."
        for measured in _measured(document):
            measured["file"] = os.path.relpath(os.path.join(os.path.dirname(self._path), measured["file"]), folder)
        if self._mesh is not None:
            document["mesh"] = self._mesh.document()
        elif _files(mesh):
            beside = [os.path.relpath(os.path.join(os.path.dirname(self._path), file), folder) for file in _files(mesh)]
            document["mesh"] = beside[0] if isinstance(mesh, str) else beside
        Path(path).write_text(json.dumps(document, indent=1) + "\n")

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        progress: bool = True,
        resume: bool = False,
        report: bool = False,
        gradients: Sequence[str] | None = None,
    ) -> Result:
        """Run the case, with results bitwise identical to ``fecontact run``.

        Ctrl-C ends it after the current increment, a second one immediately. SIGTERM and SIGHUP terminate Python as usual,
        and the run can be resumed from its last checkpoint (``resume``).

        Args:
            out: results folder; default: a temporary one, deleted with the result.
            threads: number of threads, without effect on the results; default: all cores.
            progress: whether a progress bar is shown, on a terminal or in a notebook.
            resume: whether to resume from the last checkpoint in ``out``; if this case's own run has left none yet, it starts anew,
                with a warning.
            report: whether to write ``report.html`` into ``out``.
            gradients: places of values by which the history is differentiated, such as ``["contacts.base.friction.mu_k"]``, instead of those
                of the case; they are in :attr:`Result.gradients`.

        Raises:
            CaseError: the input is invalid; nothing was written.
            Stopped: the run stopped while solving; ``.result`` contains the results so far.
            Interrupted: Ctrl-C was pressed; ``.result`` contains the results so far.
        """
        native = self._native if gradients is None else self.replace({"gradients": list(gradients)})._native
        holder = None
        if out is None:
            if resume:
                raise ValueError("resume: give the folder `out` of the run to go on with")
            holder = tempfile.TemporaryDirectory(prefix="fecontact-", ignore_cleanup_errors=True)
            out = holder.name
        out, threads = as_path(out, "out"), count(threads, "threads")
        with Progress(progress) as bar:

            def poll(messages: list[str], place: _native.Place | None) -> None:
                bar.show(place)
                for text in messages:
                    warnings.warn(text, RunWarning, stacklevel=3)

            status, why, raised = _native.run(native, out, threads, bool(resume), bool(report), poll)
        result = Result(out, _holder=holder)
        _raise(status, why, raised, result)
        return result

    def __repr__(self) -> str:
        title = f" «{self.title}»" if self.title else ""
        parts = {"bodies": self._document.get("bodies"), "contacts": self._document.get("contacts")}
        described = "; ".join(f"{name} {', '.join(part)}" for name, part in parts.items() if part)
        return f"<Case{title}: {described}; {len(self._document.get('steps', []))} steps>"


def _raise(status: str, why: str | None, raised: BaseException | None, result: Result) -> None:
    """The exception of a run that did not finish, or during which an exception was raised."""
    if isinstance(raised, KeyboardInterrupt):
        text = f"interrupted; the results so far are the .result of this exception, in {result.folder}"
        raise Interrupted(text, result) from None
    if raised is not None and status == "interrupted":
        # What was raised on the way, such as a warning that is an error.
        raised.__notes__ = [*getattr(raised, "__notes__", []), f"the results so far are in {result.folder}"]
        raise raised
    if status == "defect":
        raise Defect(why or "", result)
    if status != "completed":
        raise Stopped(why or "", result) from raised
    if raised is not None:
        raise raised


def _files(mesh: Any) -> list[str]:
    """The files that a case names as its mesh."""
    return [mesh] if isinstance(mesh, str) else mesh if isinstance(mesh, list) else []


def _measured(document: dict[str, Any]) -> list[dict[str, Any]]:
    """What a case says of the tables of pressure that it names."""
    given = [contact.get("fluid_pressure") for contact in document.get("contacts", {}).values()]
    pores = [body.get("pore_pressure") for body in document.get("bodies", {}).values()]
    given += [pressure.get("pressure") for pressure in pores if isinstance(pressure, dict)]
    return [pressure["measured"] for pressure in given if isinstance(pressure, dict) and "measured" in pressure]


def _again(document: dict[str, Any], path: str, mesh: Mesh | None) -> Case:
    case = Case.__new__(Case)
    case._document, case._path, case._mesh = document, path, mesh
    case._native = case._made()
    return case


def _put(document: dict[str, Any], place: str, value: Any, file: str) -> None:
    """Set a value at a place such as ``steps[1].duration``; the last key may be new."""
    keys: list[str | int] = []
    for part in place.split("."):
        name, *numbers = part.split("[")
        keys.append(name)
        for number in numbers:
            if not number.endswith("]") or not (number[:-1].isascii() and number[:-1].isdigit()):
                raise refused(file, place, "is not a place: write it like steps[1].duration")
            keys.append(int(number[:-1]))
    at: Any = document
    for k, key in enumerate(keys):
        known = isinstance(at, list) and isinstance(key, int) and key < len(at)
        known = known or (isinstance(at, dict) and isinstance(key, str) and (key in at or k == len(keys) - 1))
        if key in ("frictions", "materials"):
            raise refused(file, place, f"laws by name ({key}) stand where they are used: name one use, as contacts.NAME.friction.mu or bodies.NAME.material.E")
        if not known:
            there = f"0 to {len(at) - 1}" if isinstance(at, list) else ", ".join(at) if isinstance(at, dict) else "nothing"
            near = difflib.get_close_matches(str(key), at, 1) if isinstance(at, dict) else []
            meant = f"did you mean `{near[0]}`? There" if near else "there"
            raise refused(file, place, f"there is no `{key}` in this case; {meant} is {there}")
        if k == len(keys) - 1:
            at[key] = value
        else:
            at = at[key]


def schema(of: str = "case") -> dict[str, Any]:
    """The JSON Schema of a ``"case"`` or of a ``"law"`` test; for ``"results"`` the quantities of the result files: names, units
    composed of F, L and T, and meanings."""
    found: dict[str, Any] = json.loads(_native.schema(a_name(of, "schema", "schema")))
    return found
