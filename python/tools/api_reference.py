"""Writes docs/reference/python.md from the docstrings of the package: python tools/api_reference.py [--check].

There is no second truth: names, signatures and texts are those that ``help()`` shows. With --check nothing is written, and the exit code
is 1 where the committed page is another.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fecontact
from fecontact import calibration, model

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "python.md"
HEAD = """# The Python package

Written by `python/tools/api_reference.py` from the docstrings; not to be edited. [Python](../../python/README.md) is where to begin. [L], [F], [T] are
length, force and time in any consistent units.
"""
# Title, module and names.
SECTIONS = [
    ("Cases", "case", ["Case", "schema"]),
    ("Meshes", "mesh", ["Mesh"]),
    ("Results", "result", ["Result", "report"]),
    ("Increment by increment", "simulation", ["Simulation"]),
    ("Laws alone", "law", ["law", "Law", "Drive", "friction_law"]),
    ("Error bars", "convergence", ["converge", "Convergence"]),
    ("Factor of safety", "stability", ["safety", "Safety"]),
    ("Studies", "studies", ["study", "grid", "latin_hypercube", "sobol"]),
    ("Fits", "calibration", ["fit", *(name for name in calibration.__all__ if name != "fit")]),
    ("Figures", "plot", ["friction", "slip_fraction", "interface", "events", "path", "newton", "residuals"]),
    ("Errors", "errors", ["CaseError", "Stopped", "Interrupted", "Defect", "RunWarning"]),
]
TITLES = {"Args", "Returns", "Raises", "Attributes", "Yields"}


def argument(one: inspect.Parameter) -> str:
    """As it stands in the source."""
    stars = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
    kind = "" if one.annotation is one.empty else f": {one.annotation}"
    return stars + one.name + kind + ("" if one.default is one.empty else f" = {one.default!r}")


def signature(name: str, what: Any) -> str:
    """A call in one line, or with an argument a line where that is long."""
    given = inspect.signature(what)
    arguments: list[str] = []
    told = [one for one in given.parameters.values() if one.name != "self" and not one.name.startswith("_")]
    for one in told:
        if one.kind is one.KEYWORD_ONLY and not any(other.startswith("*") for other in arguments):
            arguments.append("*")
        arguments.append(argument(one))
    back = "" if inspect.isclass(what) else f" -> {given.return_annotation}"
    short = f"{name}({', '.join(arguments)}){back}"
    return short if len(short) <= 110 else f"{name}(\n" + "".join(f"    {one},\n" for one in arguments) + f"){back}"


def markdown(text: str) -> str:
    """A docstring: its roles, literals, lists of arguments and code."""
    text = re.sub(r":\w+:`~?(?:fecontact\.)?([^`]+)`", r"`\1`", inspect.cleandoc(text))
    text = re.sub(r"(?<!`)``(?!`)", "`", text)
    parts: list[str] = []
    title = code = fence = named = False
    for line in text.splitlines():
        if line.startswith("```"):
            fence = not fence
            parts.append(line)
        elif fence:
            parts.append(line)
        elif line.rstrip(":") in TITLES and line.endswith(":"):
            parts += ["```", ""] if code else []
            title, code, named = True, False, line not in ("Returns:", "Yields:")
            parts.append(f"*{line.rstrip(':')}*\n")
        elif title and named and re.match(r"    \*{0,2}\w[\w, ]*: ", line):
            name, told = line.strip().split(": ", 1)
            parts.append(f"- `{name}`: {told}")
        elif title and line.startswith("    "):
            # What is returned has no name; what goes on is indented below its argument.
            goes_on = bool(parts) and parts[-1].startswith(("- ", "  "))
            parts.append("  " + line.strip() if goes_on else line.strip())
        elif code and (line.startswith("    ") or not line):
            parts.append(line[4:])
        else:
            parts += ["```", ""] if code else []
            title = code = False
            if line.endswith("::"):
                parts += [line[:-1], "", "```python"]
                code = True
                continue
            parts.append(line)
        if code and not line and parts[-2] == "```python":
            parts.pop()
    if code:
        parts.append("```")
    return re.sub(r"\n{3,}", "\n\n", re.sub(r"\n+```\n\n", "\n```\n\n", "\n".join(parts))).strip()


def members(what: type) -> Iterator[str]:
    """Its own public methods and properties, in their order."""
    for name, member in vars(what).items():
        if name.startswith("_"):
            continue
        if isinstance(member, (property, functools.cached_property)):
            call = member.func if isinstance(member, functools.cached_property) else member.fget
            back = inspect.signature(call).return_annotation if call else ""
            yield f"#### {what.__name__}.{name}\n\n```python\n{name}: {back}\n```\n\n{markdown(member.__doc__ or '')}"
        elif inspect.isfunction(member) or isinstance(member, classmethod):
            called = getattr(what, name)
            shown = f"{what.__name__}.{name}" if isinstance(member, classmethod) else name
            yield f"#### {what.__name__}.{name}\n\n```python\n{signature(shown, called)}\n```\n\n{markdown(called.__doc__ or '')}"


def entry(module: str, name: str) -> str:
    """A class with its members, or a function."""
    what = getattr(importlib.import_module(f"fecontact.{module}"), name)
    full = f"fecontact.{name}" if getattr(fecontact, name, None) is what else f"fecontact.{module}.{name}"
    head = f"### {full}\n\n"
    # What only the package itself makes has private arguments.
    called = inspect.isfunction(what) or "__init__" in vars(what)
    if called and not any(str(one.annotation).startswith("_") for one in inspect.signature(what).parameters.values()):
        head += f"```python\n{signature(name, what)}\n```\n\n"
    parts = [head + markdown(what.__doc__ or "")]
    if inspect.isclass(what):
        parts += members(what)
    return "\n\n".join(parts)


def parts_of_cases() -> str:
    """The classes of fecontact.model, which the reference of the case file tells all about."""
    rows = []
    for name, what in vars(model).items():
        if inspect.isclass(what) and what.__module__ == model.__name__ and issubclass(what, dict) and name != "CaseKeys":
            told = " ".join((what.__doc__ or "").split("Args:")[0].split()).replace("|", "\\|")
            keys = ", ".join(f"`{key}`" for key in inspect.signature(what).parameters)
            rows.append(f"| `{name}` | {keys} | {told} |")
    return "\n".join(
        [
            "## Parts of a case",
            "",
            "The classes of `fecontact.model`: each is a dict of the keys that it is given. [The case file](case_file.md) tells what each key means.",
            "",
            "| class | keys | |",
            "|---|---|---|",
            *sorted(rows),
        ]
    )


def written() -> str:
    """The text of the page."""
    parts = [HEAD.strip()]
    for title, module, names in SECTIONS:
        parts += [f"## {title}", *(entry(module, name) for name in names)]
    return "\n\n".join([*parts, parts_of_cases()]) + "\n"


if __name__ == "__main__":
    if "--check" not in sys.argv:
        PAGE.write_text(written())
    elif PAGE.read_text() != written():
        sys.exit(f"{PAGE} is not what the docstrings say: python {sys.argv[0]}")
