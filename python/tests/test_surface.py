"""Public names of the package: what scripts of its users name.

Whoever changes one on purpose renews the file with ``SURFACE=renew pytest python/tests/test_surface.py`` and tells of each difference
in CHANGELOG.md, with what to use instead.
"""

from __future__ import annotations

import inspect
import os
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import fecontact as fc

FILE = Path(__file__).with_name("surface.txt")


def arguments(function: Any) -> str:
    """Names of the arguments, those with a default in brackets."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return ""
    shown = [one for one in parameters if one.name not in ("self", "cls") and not one.name.startswith("_")]
    marks = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    named = [(marks.get(one.kind, "") + one.name, one.default is inspect.Parameter.empty) for one in shown]
    return "(" + ", ".join(name if must else f"[{name}]" for name, must in named) + ")"


def attributes(base: type) -> list[str]:
    """What an object has from its beginning."""
    begin = vars(base).get("__init__")
    source = inspect.getsource(begin) if inspect.isfunction(begin) and "<string>" not in begin.__code__.co_filename else ""
    return re.findall(r"\bself\.([a-z]\w*)\b(?=[^=\n()]*=[^=])", source)


def members(path: str, owner: Any) -> list[str]:
    """A line for everything public that a class has from this package, or that a module shows."""
    if isinstance(owner, ModuleType):
        shown = getattr(owner, "__all__", None)
        named = {name: getattr(owner, name) for name in shown or vars(owner) if not name.startswith("_")}
        # What a module without a list of its own imports is not its to show.
        own = {name: value for name, value in named.items() if shown or getattr(value, "__module__", None) == owner.__name__}
    else:
        bases = [base for base in owner.__mro__ if base.__module__.startswith("fecontact")]
        own = {name: getattr(owner, name) for base in bases for name in vars(base) if not name.startswith("_")}
        fields = (name for base in bases for name in (*vars(base).get("__annotations__", {}), *attributes(base)))
        own |= {name: own.get(name) for name in fields if not name.startswith("_")}
    return [line for name in sorted(own) for line in told(f"{path}.{name}", own[name])]


def told(path: str, value: Any) -> list[str]:
    if isinstance(value, ModuleType):
        return [path, *members(path, value)]
    if inspect.isclass(value):
        return [f"{path}{arguments(value)}", *members(path, value)]
    if callable(value):
        return [f"{path}{arguments(value)}"]
    return [path]


def test_public_names_are_those_that_users_know() -> None:
    found = [line for name in sorted(fc.__all__) for line in told(f"fecontact.{name}", getattr(fc, name))]
    if os.environ.get("SURFACE") == "renew":
        FILE.write_text("\n".join(found) + "\n", encoding="utf-8")
    known = FILE.read_text(encoding="utf-8").splitlines()
    lost, new = sorted(set(known) - set(found)), sorted(set(found) - set(known))
    assert known == found, (
        f"users lose {lost}, and get {new}: if this is meant, tell of it in CHANGELOG.md with what to use instead, and run "
        "`SURFACE=renew pytest python/tests/test_surface.py`"
    )
