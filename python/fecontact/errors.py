"""Errors and warnings, with the texts of the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .result import Result


class CaseError(ValueError):
    """The input is invalid: nothing was solved or written.

    Attributes:
        file: the case or mesh file; ``"case"`` for a case given as a dict.
        place: place in the file, such as ``"contacts.base.friction.mu_s"``.
        message: error and remedy.
    """

    def __init__(self, text: str, file: str = "", place: str = "", message: str = "") -> None:
        super().__init__(text)
        self.file = file
        self.place = place
        self.message = message or text

    def __reduce__(self) -> tuple[type[CaseError], tuple[str, str, str, str]]:
        return (CaseError, (str(self), self.file, self.place, self.message))


class Stopped(RuntimeError):
    """A run stopped while solving; its results so far are kept.

    Attributes:
        result: the results so far; ``None`` if there are none, as for a :class:`~fecontact.Simulation`.
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text)
        self.result = result


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a run after an increment; its results so far are kept.

    Attributes:
        result: the results so far.
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text)
        self.result = result


class Defect(RuntimeError):
    """The program has a defect; please report it.

    Attributes:
        result: the results so far, if there are any.
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text)
        self.result = result


class RunWarning(UserWarning):
    """Warning about a result, as listed in ``summary["warnings"]``; for a study: rows without measures."""
