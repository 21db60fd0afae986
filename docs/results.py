"""The reference of results: each key of the JSON of commands and files, read off the models that write it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from cranktopo.base.units import stem_and_unit

ROOTS = {
    "import": ("`import --json` and `import.json`", "cranktopo.tasks.crank_import.result:CrankImport"),
    "plan": ("`plan --json`", "cranktopo.tasks.plan.result:DesignPlan"),
    "loads": ("`loads --json`", "cranktopo.tasks.loads.result:Loads"),
    "balance": ("`balance --json`", "cranktopo.tasks.balance.result:Balance"),
    "film": ("`film --json`", "cranktopo.tasks.film.result:FilmResult"),
    "vibration": ("`vibration --json`", "cranktopo.tasks.vibration.result:ShaftVibration"),
    "modes": ("`modes --json`", "cranktopo.tasks.modes.result:ShaftModes"),
    "shaft": ("`shaft --json`", "cranktopo.tasks.shaft_safety.result:ShaftAssessment"),
    "fatigue": ("`fatigue --json` and `fatigue.json`", "cranktopo.tasks.throw_fatigue.result:FatigueResult"),
    "bolts": ("`bolts --json`", "cranktopo.tasks.bolts.result:BoltChecks"),
    "rod": ("`rod --json`", "cranktopo.tasks.rod.result:RodStrength"),
    "balancer": ("`balancer --json`", "cranktopo.tasks.balancer.result:BalancerStrength"),
    "accuracy": ("`accuracy --json`", "cranktopo.tasks.throw_fea.studies:StudyResult"),
    "evaluate": ("`evaluate --json`", "cranktopo.tasks.evaluate.result:EvaluationList"),
    "compare": ("`compare --format json`", "cranktopo.tasks.compare.result:ComparisonResult"),
    "bound": ("`bound --json`", "cranktopo.tasks.bound.result:BoundResult"),
    "shape": ("`shape --json` and `shape.json`", "cranktopo.tasks.web_shape.result:ShapeResult"),
    "each_web": (
        "`shape --each-web --json` and `each-web.json`",
        "cranktopo.tasks.web_shape.each_web.result:EachWebResult",
    ),
    "metrics": ("`optimise --json` and `metrics.json`", "cranktopo.tasks.optimise.result:RunMetrics"),
    "extraction": ("`extract --json`", "cranktopo.tasks.extraction.result:Extraction"),
    "remodel": ("`remodel --json` and `remodel.json`", "cranktopo.tasks.refit.result:RefitResult"),
    "iterate": ("`iterate --json` and `iterate.json`", "cranktopo.tasks.iterate.result:LoopResult"),
    "sweep": ("`sweep --json` and `sweep.json`", "cranktopo.tasks.sweep.result:SweepResult"),
    "runs": ("`runs list --json`", "cranktopo.tasks.run_list.stage:RunList"),
    "designs": ("`designs list --json`", "cranktopo.tasks.designs.result:DesignList"),
    "doctor": ("`doctor --json`", "cranktopo.tasks.doctor.result:MachineChecks"),
}
"""Name of the schema file: where the JSON is found, and its model as "module:Class". One line a result."""
_TYPES = {
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
    "null": "null",
    "object": "table",
    "array": "list",
}


class _WhatIsWritten(GenerateJsonSchema):
    """The schema of what is written: a key with a default is always there, unless its value leaves it out."""

    def field_is_required(self, field: Any, total: bool) -> bool:
        return field.get("serialization_exclude_if") is None


@cache
def result_schema(name: str) -> dict[str, Any]:
    """Return the JSON schema of a result by its name in `ROOTS`."""
    module, _, kind = ROOTS[name][1].partition(":")
    model = getattr(import_module(module), kind)
    schema = model.model_json_schema(mode="serialization", schema_generator=_WhatIsWritten)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def schema_files() -> Iterator[tuple[str, str]]:
    """Yield path and text of the schema of every result."""
    for name in ROOTS:
        yield f"schema/{name}.json", json.dumps(result_schema(name), indent=2) + "\n"


def result_tables() -> str:
    """Return every result with its keys, and after them the tables in it that are not shown before."""
    shown: dict[str, dict[str, Any]] = {}
    return "\n\n".join(part for name in ROOTS for part in _result(name, shown))


def _result(name: str, shown: dict[str, dict[str, Any]]) -> Iterator[str]:
    schema = result_schema(name)
    yield f"## {ROOTS[name][0]} {{#{name}}}\n\n{_summary(schema)} [JSON schema](schema/{name}.json)."
    yield _key_rows(schema, schema.get("$defs", {}))
    for kind, table in schema.get("$defs", {}).items():
        if shown.setdefault(kind, table) != table:
            raise ValueError(f"two tables of results are named {kind}")
        if shown[kind] is table and "properties" in table:
            yield f"### {_words(kind)} {{#{kind.lower()}}}\n\n{_summary(table)}"
            yield _key_rows(table, schema["$defs"])


def _words(kind: str) -> str:
    """Return the name of a class as words: `BoundGoal` gives "Bound goal"."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", kind).capitalize()


def _summary(table: dict[str, Any]) -> str:
    return _line(str(table.get("description", "")).partition("\n\n")[0])


def _key_rows(table: dict[str, Any], defs: dict[str, Any]) -> str:
    head = "| key | meaning | unit | type | there |\n|---|---|---|---|---|"
    required, told = table.get("required", ()), _attributes(table)
    rows = [
        f"| `{name}` | {_meaning(node, told.get(name, ''), defs)} | {stem_and_unit(name)[1]} "
        f"| {_kind(node, defs)} | {'always' if name in required else 'optional'} |"
        for name, node in table.get("properties", {}).items()
    ]
    if table.get("additionalProperties") is True:
        rows.append("| ... | Further keys, with their units in their names. | | | optional |")
    return "\n".join([head, *rows])


def _attributes(table: dict[str, Any]) -> dict[str, str]:
    """Return what the section "Attributes" of a class says of its fields."""
    _, _, section = str(table.get("description", "")).partition("Attributes:\n")
    return dict(re.findall(r"(?ms)^    (\w+): (.*?)(?=^    \w|\Z)", section))


def _meaning(node: dict[str, Any], told: str, defs: dict[str, Any]) -> str:
    """Return the text below a key, or what the table that it holds is said to be."""
    kinds = [defs[kind] for kind in re.findall(r"#/\$defs/(\w+)", json.dumps(node))]
    said = node.get("description") or told or " ".join(map(_summary, kinds))
    found = re.sub(r"\bNone\b", "null", _line(said))
    return f"{found[:1].upper()}{found[1:]}"


def _kind(node: dict[str, Any], defs: dict[str, Any]) -> str:
    if "$ref" in node:
        kind = node["$ref"].rpartition("/")[2]
        table = defs[kind]
        return f"[{_words(kind).lower()}](#{kind.lower()})" if "properties" in table else _kind(table, defs)
    if "anyOf" in node or "oneOf" in node:
        return " or ".join(dict.fromkeys(_kind(part, defs) for part in node.get("anyOf") or node["oneOf"]))
    if "enum" in node or "const" in node:
        return "one of " + ", ".join(f"`{value}`" for value in node.get("enum") or [node["const"]])
    if node.get("type") == "array" and "prefixItems" in node:
        return f"list of {len(node['prefixItems'])}: {_kind(node['prefixItems'][0], defs)}"
    if node.get("type") == "array" and node.get("items"):
        return f"list of {_kind(node['items'], defs)}"
    if isinstance(node.get("additionalProperties"), dict):
        return f"by name: {_kind(node['additionalProperties'], defs)}"
    return _TYPES.get(node.get("type", ""), "any")


def _line(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
