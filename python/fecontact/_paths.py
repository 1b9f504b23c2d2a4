"""Paths that are given, and short descriptions of what is given instead."""

from __future__ import annotations

import os
from typing import Any


def path(given: Any, place: str) -> str:
    """The same as a text.

    Raises:
        ValueError: it is not a path.
    """
    if not isinstance(given, (str, os.PathLike)):
        raise ValueError(f"{place}: is {told(given)}: must be a path")
    return str(os.fspath(given))


def told(given: Any) -> str:
    """Short description of a value."""
    shown = " ".join(repr(given).split())
    return shown if len(shown) <= 40 else f"a {type(given).__name__}"
