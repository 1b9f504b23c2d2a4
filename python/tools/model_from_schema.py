"""Writes fecontact/model.py from the JSON Schema that the reader of cases makes: python tools/model_from_schema.py.

There is no second truth: names, types, units and descriptions are those of the schema, and a test holds the committed file
against it.
"""

from __future__ import annotations

import keyword
import re
import textwrap
from pathlib import Path
from typing import Any

HEAD = '''"""Parts of a case as Python objects: each is a dict, made from keyword arguments, that the reader of cases judges.

Written by tools/model_from_schema.py from the JSON Schema (``fecontact schema``); not to be edited.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, TypedDict, Union

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .mesh import Mesh

    Pairs = Union[Sequence[Sequence[float]], NDArray[Any]]
    Vector = Union[Sequence[float], NDArray[Any]]


class Given:
    """Stands for what is not given."""

    def __repr__(self) -> str:
        return "..."


NOT_GIVEN: Final = Given()


def _given(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key.rstrip("_"): value for key, value in values.items() if not isinstance(value, Given)}
'''

# Choices between objects of one key, or with a tag, whose objects have names that say what they are only together with this.
SUFFIX = {"ProfileTable": "Profile", "ArrivalInput": "Arrival"}
# What is one key around one value.
NAMES = {"rate": "Rate", "table": "Table", "x": "AlongX", "y": "AlongY", "R": "ArrivalR", "mu": "ArrivalMu"}
WIDTH = 116


def camel(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in name.split("_"))


class Writer:
    """Classes and aliases, in the order in which they are needed."""

    def __init__(self, schema: dict[str, Any]) -> None:
        self.schema, self.definitions = schema, schema["$defs"]
        self.classes: dict[str, str] = {}
        self.aliases: dict[str, str] = {}

    def type_of(self, schema: dict[str, Any]) -> str:
        if "$ref" in schema:
            return self.definition(schema["$ref"].rsplit("/", 1)[1])
        if "const" in schema:
            return f"Literal[{schema['const']!r}]".replace("'", '"')
        for several in ("anyOf", "oneOf"):
            if several in schema:
                return self.union([self.type_of(one) for one in schema[several]])
        kind = schema.get("type")
        if isinstance(kind, list):
            return self.union([self.type_of({**schema, "type": one}) for one in kind])
        if kind == "array":
            return self.array(schema)
        if kind == "object":
            return f"Mapping[str, {self.type_of(schema['additionalProperties'])}]"
        return {"string": "str", "number": "float", "integer": "int", "boolean": "bool", "null": "None"}[kind]

    def array(self, schema: dict[str, Any]) -> str:
        inside = schema["items"]
        if inside.get("type") == "number":
            return "Vector"
        if inside.get("type") == "array" and inside["items"].get("type") == "number":
            return "Pairs"
        return f"Sequence[{self.type_of(inside)}]"

    @staticmethod
    def union(types: list[str]) -> str:
        known = list(dict.fromkeys(types))
        literals = [one[8:-1] for one in known if one.startswith("Literal[")]
        rest = [one for one in known if not one.startswith("Literal[")]
        # A text among the alternatives holds the constants too, but these are told.
        whole = ([f"Literal[{', '.join(literals)}]"] if literals else []) + rest
        return " | ".join(whole)

    def definition(self, name: str) -> str:
        schema, own = self.definitions[name], name.removesuffix("Input").removesuffix("Parameters")
        if name == "InlineMesh":
            return "Mapping[str, Any]"
        if name == "Along":
            self.type_of(schema["properties"]["law"])
            return "Mapping[str, Any]"
        if own in self.classes or own in self.aliases:
            return own
        if "properties" in schema and "oneOf" not in schema:
            self.classes[own] = ""
            self.classes[own] = self.class_of(own, schema, schema.get("description", ""))
            return own
        self.aliases[own] = ""
        choices = schema.get("oneOf", schema.get("anyOf", []))
        types = [self.choice(name, one) for one in choices]
        text = textwrap.fill(" ".join(schema.get("description", "").split()), WIDTH)
        comment = "".join(f"# {line}\n" for line in text.splitlines())
        self.aliases[own] = f"{comment}{own} = Union[{', '.join(types)}]\n".replace("Union[Literal", "Union[Literal")
        return own

    def choice(self, name: str, schema: dict[str, Any]) -> str:
        """One of several: a tagged object, an object around one key, or a plain value."""
        properties = schema.get("properties")
        if not properties:
            return self.quoted(self.type_of(schema))
        tag = next((key for key, one in properties.items() if "const" in one), None)
        description = schema.get("description", "")
        if tag:
            own = camel(properties[tag]["const"])
            self.classes[own] = self.class_of(own, schema, description, tag=(tag, properties[tag]["const"]))
            return own
        [(key, inner)] = properties.items()
        own = NAMES.get(key, camel(key))
        if "properties" in inner:
            self.classes[own] = self.class_of(own, inner, description, around=key)
        elif "$ref" in inner and "properties" in self.definitions[inner["$ref"].rsplit("/", 1)[1]]:
            self.classes[own] = self.class_of(own, self.definitions[inner["$ref"].rsplit("/", 1)[1]], description, around=key)
        else:
            self.classes[own] = self.value_class(own, inner, description, key)
        return own

    @staticmethod
    def quoted(text: str) -> str:
        return f'"{text}"' if text in ("Vector", "Pairs") else text.replace(" | ", ", ")

    def value_class(self, own: str, inner: dict[str, Any], description: str, key: str) -> str:
        doc = self.docstring(description, [])
        return (
            f"class {own}(dict[str, Any]):\n{doc}\n    def __init__(self, {key}: {self.type_of(inner)}) -> None:\n"
            f'        super().__init__({{"{key}": {key}}})\n'
        )

    def class_of(
        self, own: str, schema: dict[str, Any], description: str, tag: tuple[str, str] | None = None, around: str = ""
    ) -> str:
        properties = {key: one for key, one in schema.get("properties", {}).items() if not tag or key != tag[0]}
        required = [key for key in schema.get("required", []) if key in properties]
        keys = required + [key for key in properties if key not in required]
        words = {key: key + "_" if keyword.iskeyword(key) else key for key in keys}
        types = {key: self.type_of(properties[key]) for key in keys}
        arguments = [f"{words[key]}: {types[key]}" for key in required]
        arguments += [f"{words[key]}: {types[key]} | Given = NOT_GIVEN" for key in keys if key not in required]
        told = [(words[key], " ".join(properties[key].get("description", "").split())) for key in keys]
        doc = self.docstring(description, told)
        self_ = ["self", "*", *arguments] if arguments else ["self"]
        lines = "".join(f"        {argument},\n" for argument in self_)
        head = f"    def __init__(\n{lines}    ) -> None:\n" if arguments else "    def __init__(self) -> None:\n"
        pairs = ", ".join(f'"{words[key]}": {words[key]}' for key in keys)
        given = f"_given({{{pairs}}})" if keys else "{}"
        if tag:
            given = f'{{"{tag[0]}": "{tag[1]}", **{given}}}' if keys else f'{{"{tag[0]}": "{tag[1]}"}}'
        if around:
            given = f'{{"{around}": {given}}}'
        return f"class {own}(dict[str, Any]):\n{doc}\n{head}        super().__init__({given})\n"

    @staticmethod
    def docstring(description: str, arguments: list[tuple[str, str]]) -> str:
        text = " ".join(description.split()).rstrip(".") + "."
        lines = textwrap.wrap(text, WIDTH - 4)
        if arguments:
            lines += ["", "Args:"]
            for name, told in arguments:
                lines += textwrap.wrap(f"{name}: {told}", WIDTH - 8, initial_indent="    ", subsequent_indent="        ")
        body = "".join(f"    {line}".rstrip() + "\n" for line in lines)
        return '    """' + body.lstrip() + '    """\n' if len(lines) > 1 else '    """' + lines[0] + '"""\n'

    def keys_of_case(self) -> str:
        fields = []
        for key, one in self.schema["properties"].items():
            kind = self.type_of(one)
            kind = f"Mesh | {kind}" if key == "mesh" else kind
            told = " ".join(one.get("description", "").split())
            fields += ["    " + f"# {line}" for line in textwrap.wrap(told, WIDTH - 6)]
            fields.append(f"    {key}: {kind}")
        body = "\n".join(fields)
        return f'class CaseKeys(TypedDict, total=False):\n    """The keys of a case."""\n\n{body}\n'


def written(schema: dict[str, Any]) -> str:
    """The text of model.py."""
    writer = Writer(schema)
    case = writer.keys_of_case()
    parts = [*writer.classes.values(), *writer.aliases.values()]
    # Aliases name classes and each other: those that name others come after them.
    aliases = dict(writer.aliases)
    ordered: list[str] = []
    while aliases:
        free = [name for name, text in aliases.items() if not any(_names(text, other) for other in aliases if other != name)]
        for name in free or list(aliases):
            ordered.append(aliases.pop(name))
    del parts
    body = "\n\n".join([*writer.classes.values()])
    return "\n\n".join([HEAD, body, "\n".join(ordered), case])


def _names(text: str, other: str) -> bool:
    code = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    return re.search(rf"\b{other}\b", code) is not None


if __name__ == "__main__":
    from fecontact import schema

    path = Path(__file__).parent.parent / "fecontact" / "model.py"
    path.write_text(written(schema("case")))
