"""Writes docs/reference/case_file.md, case.schema.json and the tables of outputs.md there: python3 docs/reference.py [--check] [PROGRAM].

There is no second truth: keys, types, defaults, units and descriptions are those of `fecontact schema`, names, units and meanings of
results those of `fecontact schema results`. With --check nothing is written, and the exit code is 1 where a committed page is
not what the program says.
"""

import json
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).parent / "reference" / "case_file.md"
RESULTS = PAGE.with_name("outputs.md")
SCHEMA = PAGE.with_name("case.schema.json")
HEAD = """# The case file

Written by `docs/reference.py` from the JSON Schema that the program prints (`fecontact schema`, `fecontact schema law`); not to be edited.
Editors and validators take [the schema itself](case.schema.json) ([how](../guide/writing_cases.md)). A key without *required* may be left out. Units
stand in brackets: L length, F force, T time, M mass; any consistent set will do. Any object may have a `"note"`, text for readers.
"""


def anchor(name):
    return "#" + re.sub(r"[^a-z0-9_\- ]", "", title(name).lower()).replace(" ", "-")


def title(name):
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name.removesuffix("Input").removesuffix("Parameters"))
    return words[:1] + words[1:].lower()


def in_cell(text):
    """A description on one line of a table; equations in fences stay out of tables."""
    text = re.sub(r"```text\n.*?```", "", text, flags=re.S)
    return " ".join(text.split()).replace("|", "\\|")


def type_of(schema):
    """A type in a few words, with links to what has a section of its own."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return f"[{title(name)}]({anchor(name)})"
    if "const" in schema:
        return f'`"{schema["const"]}"`'
    for several in ("anyOf", "oneOf"):
        if several in schema:
            return " or ".join(dict.fromkeys(type_of(one) for one in schema[several]))
    kind = schema.get("type")
    if isinstance(kind, list):
        return " or ".join(type_of({**schema, "type": one}) for one in kind)
    if kind == "array":
        return f"list of {type_of(schema['items'])}" if "items" in schema else "list"
    if kind == "object":
        others = schema.get("additionalProperties")
        return f"object: name → {type_of(others)}" if isinstance(others, dict) else "object"
    return {"string": "text", "number": "number", "integer": "integer", "boolean": "true or false", "null": "null"}[kind]


def table(schema, skip=()):
    """The keys of an object."""
    rows = []
    for key, value in schema.get("properties", {}).items():
        if key in skip:
            continue
        told = in_cell(value.get("description", ""))
        default = value.get("default")
        notes = " *required*" if key in schema.get("required", []) else ""
        if default not in (None, {}, [], ""):
            notes = f" default `{json.dumps(default, ensure_ascii=False)}`"
        rows.append(f"| `{key}` | {type_of(value)}{notes} | {told} |")
    return "\n".join(["| key | value | meaning |", "|---|---|---|", *rows]) if rows else ""


def choice(schema):
    """One of several: a plain value, an object around one key, or an object with a tag."""
    properties = schema.get("properties", {})
    tag = next((key for key, value in properties.items() if "const" in value), None)
    told = schema.get("description", "").strip()
    if tag:
        head = f'**`"{tag}": "{properties[tag]["const"]}"`**: {told}'
        return f"{head}\n\n{table(schema, skip=(tag,))}".strip()
    if len(properties) == 1:
        [(key, inner)] = properties.items()
        keys = f"\n\n{table(inner)}" if "properties" in inner else ""
        return f"**`{{\"{key}\": …}}`** ({type_of(inner)}): {told}{keys}"
    return f"{type_of(schema)}: {in_cell(told)}" if told else type_of(schema)


def section(name, schema):
    parts = [f"## {name}", schema.get("description", "").strip()]
    several = schema.get("oneOf", schema.get("anyOf"))
    if several:
        plain = [one for one in several if not one.get("properties")]
        parts += ["\n".join(f"- {choice(one)}" for one in plain)] if plain else []
        parts += [choice(one) for one in several if one.get("properties")]
    else:
        parts.append(table(schema))
        others = schema.get("additionalProperties")
        if isinstance(others, dict):
            parts.append(f"Any other key is a name: {type_of(others)}.")
    return "\n\n".join(part for part in parts if part)


def written(case, law):
    """The text of the page."""
    whole = [HEAD, section("Case", case)]
    whole += [section(title(name), schema) for name, schema in case["$defs"].items()]
    whole.append(section("Test of a law", law))
    whole += [section(title(name), schema) for name, schema in law["$defs"].items() if name not in case["$defs"]]
    return "\n\n".join(part.strip() for part in whole) + "\n"


def with_quantities(page, results):
    """The page of results with a table of the quantities of each file where it names one."""
    def table_of(mark):
        rows = [f"| `{one['name']}` | {one['unit'] or '–'} | {in_cell(one['meaning'])} |" for one in results[mark[1]]]
        return "\n".join([f"<!-- quantities of {mark[1]} -->\n", "| name | unit | |", "|---|---|---|", *rows, "\n<!-- end -->"])

    return re.sub(r"<!-- quantities of (\S+) -->\n.*?<!-- end -->", table_of, page, flags=re.DOTALL)


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--check"]
    program = arguments[0] if arguments else "target/release/fecontact"
    of = {kind: json.loads(subprocess.check_output([program, "schema", kind])) for kind in ("case", "law", "results")}
    pages = {PAGE: written(of["case"], of["law"]), RESULTS: with_quantities(RESULTS.read_text(), of["results"]),
             SCHEMA: json.dumps(of["case"], ensure_ascii=False, indent=1) + "\n"}
    for file, page in pages.items():
        if "--check" not in sys.argv:
            file.write_text(page)
        elif file.read_text() != page:
            sys.exit(f"{file} is not what the program says: python3 docs/reference.py {program}")


if __name__ == "__main__":
    main()
