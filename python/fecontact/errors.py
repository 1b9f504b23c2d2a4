"""What goes wrong, with the texts of the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .result import Result


class CaseError(ValueError):
    """Bad input: nothing was solved or written.

    Attributes:
        file: the case or mesh file; ``"case"`` for a case given as a dict.
        place: where in it, such as ``"contacts.base.friction.mu_s"``.
        message: what is wrong, and what to do.
    """

    def __init__(self, text: str, file: str = "", place: str = "", message: str = "") -> None:
        super().__init__(text)
        self.file = file
        self.place = place
        self.message = message or text

    def __reduce__(self) -> tuple[type[CaseError], tuple[str, str, str, str]]:
        return (CaseError, (str(self), self.file, self.place, self.message))


class Stopped(RuntimeError):
    """A run stopped while solving; what it has found is kept.

    Attributes:
        result: the results so far; ``None`` where there are none, as of a :class:`~fecontact.Simulation`.
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text)
        self.result = result


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended a run at an increment; what it has found is kept.

    Attributes:
        result: the results so far.
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text)
        self.result = result


class Defect(RuntimeError):
    """The program itself is wrong: please report it.

    Attributes:
        result: the results so far, if there are any.
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text)
        self.result = result


class RunWarning(UserWarning):
    """Something to know about a result, as ``summary["warnings"]`` has it; of a study: rows that have no measures."""
