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
        raise ValueError(f"{place}: is {shown(given)}: must be a path")
    return str(os.fspath(given))


def shown(given: Any) -> str:
    """Short description of a value."""
    text = " ".join(repr(given).split())
    return text if len(text) <= 40 else f"a {type(given).__name__}"
