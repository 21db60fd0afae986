"""Every key of a scene, read off the schema, and a template with all of them, each explained."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from itertools import groupby
from typing import Any

from cranktopo.base.units import stem_and_unit
from cranktopo.design.schema import Scene

_TYPES = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false"}


@dataclass(frozen=True)
class KeyReference:
    """One key of a table.

    Attributes:
        kind: what the value is, such as `number` or `one of "a", "b"`.
        allowed: range of the value, such as `0.05 to 20000`; empty where everything is allowed.
        required: whether the table needs it, `unless` what this says.
        shown: whether a template has the key switched on although it is optional.
    """

    name: str
    meaning: str
    kind: str
    unit: str
    allowed: str
    required: bool
    unless: str
    default: Any
    example: Any
    shown: bool


@dataclass(frozen=True)
class TableReference:
    """One TOML table, or one of the choices that a table has.

    Attributes:
        path: dotted path; empty for the keys at the top of the file.
        choice: key that makes the choice, such as `outline`; empty for what all choices share.
        required: whether a scene must have the table.
        empty: whether the table may be there with no key at all.
        repeated: whether it may be given several times, as `[[path]]`.
    """

    path: str
    meaning: str
    choice: str
    required: bool
    empty: bool
    repeated: bool
    keys: tuple[KeyReference, ...]


SKETCHES = {
    "throw": "throw",
    "throw.drilling": "drilling",
    "web": "web",
    "web.bevel": "bevel",
    "web.pocket": "pocket",
    "web.counterweight": "counterweight",
    "web.counterweight.edge": "counterweight",
    "crank.end.step": "crank",
}
"""Sketches of `cranktopo designs sketch`, by the table whose keys they show."""


@cache
def scene_reference() -> tuple[TableReference, ...]:
    """Return every table of a scene in the order of a file: the keys of a table before the tables in it."""
    schema = Scene.model_json_schema()
    return tuple(_tables(schema["$defs"], "", schema, required=True, repeated=False))


def _tables(
    defs: dict[str, Any], path: str, node: dict[str, Any], *, required: bool, repeated: bool
) -> Iterator[TableReference]:
    """Yield the table that a node of the JSON schema describes, its choices, then the tables in it."""
    node = _resolved(defs, node)
    variants = [_resolved(defs, variant) for variant in node.get("oneOf", [node])]
    common = _common(variants)
    tables = {name: part for name, part in common.items() if _table(defs, part) is not None}
    needed = set.intersection(*(set(variant.get("required", ())) for variant in variants))
    plain = {name: part for name, part in common.items() if name not in tables}
    meaning = node.get("description", "")
    empty = not repeated and node.get("default") is not None
    yield TableReference(path, meaning, "", required, empty, repeated, _keys(defs, plain, needed))
    for variant in variants if len(variants) > 1 else []:
        choice = node["discriminator"]["propertyName"]
        own = {name: part for name, part in variant["properties"].items() if name not in common}
        own[choice] = {**own[choice], "description": variant["description"].split("\n\n")[0]}
        keys = _keys(defs, own, set(variant.get("required", ())))
        yield TableReference(path, variant["description"], choice, required, False, repeated, keys)
    for name, part in tables.items() if "like" not in node else ():
        inner, many = _table(defs, part) or ({}, False)
        below = f"{path}.{name}" if path else name
        yield from _tables(defs, below, inner, required=required and name in needed, repeated=many)


def _common(variants: list[dict[str, Any]]) -> dict[str, Any]:
    first, *others = (variant["properties"] for variant in variants)
    return {name: part for name, part in first.items() if all(o.get(name) == part for o in others)}


def _table(defs: dict[str, Any], node: dict[str, Any]) -> tuple[dict[str, Any], bool] | None:
    """The schema of the table that a property holds, and whether it is a list of them; None for a value."""
    full = _resolved(defs, node)
    items = full.get("items", {})
    if full.get("type") == "array" and _is_table(_resolved(defs, items)):
        return {**_resolved(defs, items), **_described(node)}, True
    return ({**full, **_described(node)}, False) if _is_table(full) else None


def _is_table(node: dict[str, Any]) -> bool:
    return "properties" in node or "oneOf" in node


def _described(node: dict[str, Any]) -> dict[str, Any]:
    return {name: node[name] for name in ("description", "default") if name in node}


def _resolved(defs: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    """Return a node with its references followed and null left out of its choices."""
    own_keys = {name: value for name, value in node.items() if name not in ("anyOf", "$ref")}
    if "$ref" in node:
        return {**_resolved(defs, defs[node["$ref"].rpartition("/")[2]]), **own_keys}
    if "anyOf" in node:
        (kept,) = (part for part in node["anyOf"] if part != {"type": "null"})
        return {**_resolved(defs, kept), **own_keys}
    return node


def _keys(defs: dict[str, Any], properties: dict[str, Any], required: set[str]) -> tuple[KeyReference, ...]:
    return tuple(_key(name, _resolved(defs, part), name in required) for name, part in properties.items())


def _key(name: str, node: dict[str, Any], required: bool) -> KeyReference:
    return KeyReference(
        name=name,
        meaning=" ".join(node.get("description", "").split()),
        kind=_kind(node),
        unit=stem_and_unit(name)[1],
        allowed=_allowed(node) or _allowed(node.get("items", {})),
        required=required,
        unless=node.get("unless", ""),
        default=node.get("default"),
        example=node["const"] if "const" in node else node.get("examples", [None])[0],
        shown=node.get("shown", False),
    )


def _kind(node: dict[str, Any]) -> str:
    if "kind" in node:
        return str(node["kind"])
    if "const" in node:
        return f'"{node["const"]}"' if isinstance(node["const"], str) else str(node["const"])
    if "enum" in node:
        return "one of " + ", ".join(
            f'"{value}"' if isinstance(value, str) else str(value) for value in node["enum"]
        )
    if node["type"] == "array":
        items = node["items"]
        return "list of pairs" if items.get("type") == "array" else f"list of {_TYPES[items['type']]}s"
    return _TYPES[node["type"]]


def _allowed(node: dict[str, Any]) -> str:
    if "minimum" in node and "maximum" in node:
        return f"{node['minimum']:g} to {node['maximum']:g}"
    signs = (("exclusiveMinimum", ">"), ("minimum", "≥"), ("exclusiveMaximum", "<"), ("maximum", "≤"))
    found = [f"{sign} {node[key]:g}" for key, sign in signs if key in node]
    count = [f"at least {node['minItems']} values"] if "minItems" in node and node["type"] == "array" else []
    return ", ".join(found + count)


_WIDTH = 110
_HEADING = """\
{name}: a crank throw, with every key that a design may have.
Replace the values. A line that begins with "#" and a key is switched off and shows the default, or an \
example where there is none. Take one "#" off each line of a block to switch the block on; what is optional \
in it has another.
"""


Sized = Callable[[str, str, Any], Any]
"""Gives the example of a key, from the path of its table, its name and the example of the schema."""


def template(
    name: str, values: Mapping[str, Any] | None = None, origin: str = "", sized: Sized | None = None
) -> str:
    """Return TOML text of a design of that name with every key of a scene; it is valid as it stands.

    Args:
        values: by key path; they are switched on with their tables, in place of the examples.
        origin: where the values are from, for the heading; a paragraph a line.
        sized: gives examples for another size of engine than that of the schema.
    """
    values_by_key = {"name": name, **(values or {})}
    lines = [*_HEADING.format(name=name).splitlines(), *filter(None, origin.splitlines())]
    heading = "\n".join(map(_prose, lines))
    off: set[str] = set()
    blocks = [heading]
    for path, group in groupby(_sized_reference(sized), key=lambda table: table.path):
        tables = list(group)
        first = tables[0]
        has_values = any(key.startswith(f"{path}.") for key in values_by_key)
        if not has_values and (first.path.rpartition(".")[0] in off or not (first.required or first.empty)):
            off.add(path)
        blocks += _blocks(tables, values_by_key, "#" if path in off else "")
    return "\n\n".join(blocks) + "\n"


def _sized_reference(sized: Sized | None) -> Iterator[TableReference]:
    for table in scene_reference():
        if sized is None:
            yield table
            continue
        keys = (replace(key, example=sized(table.path, key.name, key.example)) for key in table.keys)
        yield replace(table, keys=tuple(keys))


def _blocks(tables: list[TableReference], values: Mapping[str, Any], off: str) -> Iterator[str]:
    common, *choices = tables
    header = f"[[{common.path}]]" if common.repeated else f"[{common.path}]"
    sketch = SKETCHES.get(common.path)
    drawn = [f"# Sketch: cranktopo designs sketch {sketch} {sketch}.svg"] if sketch else []
    top = [_prose(common.meaning), *drawn, off + header] if common.path else []
    if common.repeated and choices:
        for choice in choices:
            keys = [*_lines(choice.keys, off), *_lines(common.keys, off)]
            yield "\n".join([*drawn, off + header, *keys])
        return
    start = f"{common.path}." if common.path else ""
    own = {key.removeprefix(start): value for key, value in values.items() if key.startswith(start)}
    lines = [*top, *_lines(common.keys, off, own)]
    for number, choice in enumerate(choices):
        if number:
            lines.append(_prose(f"Instead of {choice.choice} and the keys that follow it above:"))
        lines += _lines(choice.keys, off + "#" * bool(number), {} if number else own)
    yield "\n".join(lines)


def _lines(
    keys: tuple[KeyReference, ...], off: str, values: Mapping[str, Any] | None = None
) -> Iterator[str]:
    values_by_key = values or {}
    for key in keys:
        on = (key.required and not key.unless) or key.shown or key.name in values_by_key
        use_example = on or key.default is None
        value = values_by_key.get(key.name, key.example if use_example else key.default)
        yield _prose(f"{key.meaning} ({_facts(key)})")
        yield f"{off}{'' if on else '#'}{key.name} = {json.dumps(value, ensure_ascii=False)}"


def _facts(key: KeyReference) -> str:
    needed = f"required unless {key.unless}" if key.unless else "required" if key.required else "optional"
    kind = "" if key.kind == "number" and key.unit else key.kind
    return ", ".join(filter(None, (kind, key.unit, key.allowed, needed)))


@cache
def _prose(text: str) -> str:
    words = " ".join(text.split("\n\n")[0].split())
    return "\n".join(textwrap.wrap(words, _WIDTH, initial_indent="# ", subsequent_indent="# "))
