"""Conversion of Python values to JSON."""

from __future__ import annotations

import functools
import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._paths import shown
from .errors import CaseError

P = ParamSpec("P")
R = TypeVar("R")


def renamed(**names: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Refuses arguments by their former names, with the names that they have now."""

    def of(function: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(function)
        def call(*given: P.args, **named: P.kwargs) -> R:
            for former in names.keys() & named.keys():
                raise TypeError(f"{function.__name__}() has no argument `{former}`: it is called `{names[former]}`")
            return function(*given, **named)

        return call

    return of


def plain(value: Any, place: str = "", file: str = "case") -> Any:
    """The same of dicts, lists, texts and numbers alone.

    Raises:
        CaseError: a value cannot be written as JSON; with its place.
    """
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, np.generic):
        return plain(value.item(), place, file)
    if isinstance(value, float):
        if math.isfinite(value):
            return value
        raise refused(file, place, f"is {value}: must be a finite number")
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), place, file)
    if isinstance(value, Mapping):
        return {key: plain(item, below(place, key, file), file) for key, item in value.items()}
    if isinstance(value, Sequence):
        return [plain(item, f"{place}[{k}]", file) for k, item in enumerate(value)]
    raise refused(file, place, f"is a {type(value).__name__}, which a case cannot hold")


def numbers(given: Any, place: str, file: str) -> NDArray[np.float64]:
    """The same as an array of numbers.

    Raises:
        CaseError: it is none, with its place.
    """
    try:
        return np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise refused(file, place, f"is {shown(given)}: must be a number, or numbers in rows of one length") from None


def number(given: Any, place: str, file: str) -> float:
    """The same as one finite number.

    Raises:
        CaseError: it is none, with its place.
    """
    values = numbers(given, place, file)
    if values.ndim or not np.isfinite(values):
        raise refused(file, place, f"is {shown(given)}: must be a finite number")
    return float(values)


def count(given: Any, name: str) -> int | None:
    """An integer count, or None.

    Raises:
        ValueError: it is not an integer.
    """
    if given is not None and (isinstance(given, (bool, np.bool_)) or not isinstance(given, (int, np.integer))):
        raise ValueError(f"{name}: is {shown(given)}: must be a whole number")
    return None if given is None else int(given)


def names(given: Any, place: str, file: str) -> list[str]:
    """The same as a list of texts.

    Raises:
        CaseError: it is none, with its place.
    """
    listed: list[Any] = list(given) if isinstance(given, Sequence) and not isinstance(given, str) else [None]
    if not all(isinstance(name, str) for name in listed):
        raise refused(file, place, f"is {shown(given)}: must be a list of names")
    return listed


def a_name(given: Any, place: str, file: str) -> str:
    """The same if it is a text.

    Raises:
        CaseError: it is none, with its place.
    """
    if not isinstance(given, str):
        raise refused(file, place, f"is {shown(given)}: must be a name")
    return given


def below(place: str, key: object, file: str) -> str:
    """The place of a key."""
    if not isinstance(key, str):
        raise refused(file, place, f"has the key {key!r}: keys are texts")
    return f"{place}.{key}" if place else key


def refused(file: str, place: str, message: str) -> CaseError:
    """An error at a place."""
    inside = f"{place}: " if place else ""
    return CaseError(f"{file}: {inside}{message}", file, place, message)
