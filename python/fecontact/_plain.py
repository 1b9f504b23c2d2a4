"""From what Python users write to what JSON holds."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .errors import CaseError


def plain(value: Any, place: str = "", file: str = "case") -> Any:
    """The same of dicts, lists, texts and numbers alone.

    Raises:
        CaseError: what JSON cannot hold, with its place.
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


def below(place: str, key: object, file: str) -> str:
    """The place of a key."""
    if not isinstance(key, str):
        raise refused(file, place, f"has the key {key!r}: keys are texts")
    return f"{place}.{key}" if place else key


def refused(file: str, place: str, message: str) -> CaseError:
    """A complaint about a place."""
    inside = f"{place}: " if place else ""
    return CaseError(f"{file}: {inside}{message}", file, place, message)
