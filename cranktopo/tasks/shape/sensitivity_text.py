"""Sensitivities of the dimensions, what holds them, and the worst case, as tables and text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cranktopo.report.result_table import ResultTable, Row, terminal
from cranktopo.tasks.shape.result import DimensionSensitivity, SensitivityTable, ShapeParameter, ShapeResult

Parameters = Sequence[DimensionSensitivity]


def dimensions_table(parameters: Parameters) -> ResultTable:
    """Return each dimension with its value, and the change of each quantity per mm or degree."""
    quantities = list(parameters[0].per_unit) if parameters else []
    starts = [p.start if isinstance(p, ShapeParameter) else None for p in parameters]
    start = {"start": 2} if any(value is not None for value in starts) else {}
    columns = {"dimension": 0, "unit": 0, **start, "value": 2, "at_bound": 0, **dict.fromkeys(quantities, 3)}
    rows = tuple(
        {
            "dimension": p.name,
            "unit": p.unit,
            "start": begun,
            "value": p.value,
            "at_bound": p.at_bound or "",
            **p.per_unit,
        }
        for p, begun in zip(parameters, starts, strict=True)
    )
    return ResultTable(columns, rows)


def held_table(parameters: Parameters) -> ResultTable:
    """Return each rule, bound or limit with the dimensions that it holds."""
    held: dict[str, list[str]] = {}
    for parameter in parameters:
        for name in parameter.held_by:
            held.setdefault(name, []).append(parameter.name)
    rows = tuple({"held_by": name, "dimensions": ", ".join(found)} for name, found in held.items())
    return ResultTable({"held_by": 0, "dimensions": 0}, rows)


def worst_case_table(worst_case_percent: Mapping[str, float]) -> ResultTable:
    """Return by how much every quantity may change within the tolerance, as one row."""
    worst = {f"{name}_percent": value for name, value in worst_case_percent.items() if name != "tolerance"}
    row: Row = {"off_by": f"{worst_case_percent['tolerance']:g} mm or degrees", **worst}
    return ResultTable({"off_by": 0, **dict.fromkeys(worst, 1)}, (row,))


def sensitivity_text(found: SensitivityTable | ShapeResult, whole: str) -> list[str]:
    """Return both tables and the worst case for a terminal.

    Args:
        whole: what the percentages refer to.
    """
    held = held_table(found.parameters)
    return [
        f"What a millimetre (degree) is worth, % of {whole}:",
        terminal(dimensions_table(found.parameters)),
        "",
        terminal(held) if held.rows else "No rule or bound holds any of them.",
        "",
        _worst_case_sentence(found.worst_case_percent),
    ]


def _worst_case_sentence(worst_case_percent: Mapping[str, float]) -> str:
    worst = {name: value for name, value in worst_case_percent.items() if name != "tolerance"}
    spread = ", ".join(f"{name.replace('_', ' ')} {value:.1f} %" for name, value in worst.items())
    tolerance = worst_case_percent["tolerance"]
    return f"With every dimension off by {tolerance:g} mm or degrees in the worst way: {spread}."
