"""What a millimetre of each dimension is worth, what holds it, and the worst case, as tables and text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.result_table import ResultTable, terminal


def dimensions_table(data: Mapping[str, Any]) -> ResultTable:
    """Each dimension with its value, and the change of each quantity per mm or degree."""
    parameters = data["parameters"]
    worth = list(parameters[0]["per_unit"]) if parameters else []
    start = {"start": 2} if any(p.get("start") is not None for p in parameters) else {}
    columns = {"dimension": 0, "unit": 0, **start, "value": 2, "at_bound": 0, **dict.fromkeys(worth, 3)}
    rows = tuple(
        {
            "dimension": p["name"],
            "unit": p["unit"],
            "start": p.get("start"),
            "value": p["value"],
            "at_bound": p["at_bound"] or "",
            **p["per_unit"],
        }
        for p in parameters
    )
    return ResultTable(columns, rows)


def held_table(data: Mapping[str, Any]) -> ResultTable:
    """Each rule, bound or limit with the dimensions that it holds."""
    held: dict[str, list[str]] = {}
    for parameter in data["parameters"]:
        for name in parameter["held_by"]:
            held.setdefault(name, []).append(parameter["name"])
    rows = tuple({"held_by": name, "dimensions": ", ".join(found)} for name, found in held.items())
    return ResultTable({"held_by": 0, "dimensions": 0}, rows)


def worst_case_sentence(data: Mapping[str, Any]) -> str:
    """By how much every quantity may change within the tolerance."""
    worst = {k: v for k, v in data["worst_case_percent"].items() if k != "tolerance"}
    spread = ", ".join(f"{name.replace('_', ' ')} {value:.1f} %" for name, value in worst.items())
    tolerance = data["worst_case_percent"]["tolerance"]
    return f"With every dimension off by {tolerance:g} mm or degrees in the worst way: {spread}."


def worst_case_table(data: Mapping[str, Any]) -> ResultTable:
    """The same as one row."""
    worst = {k: v for k, v in data["worst_case_percent"].items() if k != "tolerance"}
    columns = {"off_by": 0, **{f"{name}_percent": 1 for name in worst}}
    row = {f"{name}_percent": value for name, value in worst.items()}
    tolerance = f"{data['worst_case_percent']['tolerance']:g} mm or degrees"
    return ResultTable(columns, ({"off_by": tolerance, **row},))


def worth_lines(data: Mapping[str, Any], whole: str) -> list[str]:
    """Both tables and the worst case for a terminal.

    Args:
        whole: what the percentages refer to.
    """
    held = held_table(data)
    return [
        f"What a millimetre (degree) is worth, % of {whole}:",
        terminal(dimensions_table(data)),
        "",
        terminal(held) if held.rows else "No rule or bound holds any of them.",
        "",
        worst_case_sentence(data),
    ]
