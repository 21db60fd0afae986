"""Results for tests that look at a few keys of them: the others are filled with plain values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.base.result import Result

_PLAIN: dict[str, Any] = {"string": "", "number": 1.0, "integer": 1, "boolean": False, "null": None}


def filled(kind: type[Result], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON of a result: the given keys, and what its schema requires beside them."""
    schema = kind.model_json_schema()
    found = _table(schema, schema.get("$defs", {}), given)
    return kind.of_json(found, "filled").as_json()


def _table(schema: dict[str, Any], defs: dict[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    keys = {name: node for name, node in schema["properties"].items() if name in schema.get("required", ())}
    found = {name: _value(node, defs) for name, node in keys.items() if name not in given}
    own = {name: _given(schema["properties"][name], defs, value) for name, value in given.items()}
    return found | own


def _given(node: dict[str, Any], defs: dict[str, Any], value: Any) -> Any:
    node = _resolved(node, defs, value)
    if isinstance(value, Mapping) and "properties" in node:
        return _table(node, defs, value)
    if isinstance(value, Mapping):
        return {key: _given(node.get("additionalProperties", {}), defs, one) for key, one in value.items()}
    return [_given(node["items"], defs, one) for one in value] if isinstance(value, list) else value


def _resolved(node: dict[str, Any], defs: dict[str, Any], value: Any = None) -> dict[str, Any]:
    while "$ref" in node or "anyOf" in node:
        choices = [_resolved(part, defs) for part in node.get("anyOf", [])]
        fits = [
            part
            for part in choices
            if isinstance(value, Mapping) and set(value) <= set(part.get("properties", ()))
        ]
        node = defs[node["$ref"].rpartition("/")[2]] if "$ref" in node else (fits or choices)[0]
    return node


def _value(node: dict[str, Any], defs: dict[str, Any]) -> Any:
    node = _resolved(node, defs)
    if "properties" in node:
        return _table(node, defs, {})
    if "enum" in node or "const" in node:
        return node.get("enum", [node.get("const")])[0]
    if node.get("type") == "array":
        return [_value(one, defs) for one in node.get("prefixItems", ())]
    return {} if node.get("type") == "object" else _PLAIN.get(node.get("type", ""))
