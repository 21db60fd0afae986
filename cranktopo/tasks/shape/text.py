"""A shape optimisation as tables and text: the web against the original, limits, dimensions, trials."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.design.goal.outcome import GoalOutcome
from cranktopo.report.goal_table import broken_limits, limits_table
from cranktopo.report.result_table import ResultTable, terminal
from cranktopo.tasks.bound.text import bound_lines
from cranktopo.tasks.fea.quantities import (
    BENDING,
    BENDING_PER_MASS,
    INERTIA,
    MASS,
    SAFETY,
    TORSION,
    TORSION_PER_MASS,
    UNBALANCE,
    Quantity,
)
from cranktopo.tasks.shape.multiplier_text import price_sentences
from cranktopo.tasks.shape.sensitivity_text import worth_lines

_ROWS: tuple[tuple[Quantity, str, float], ...] = (
    (MASS, "mass", 1.0),
    (TORSION, "torsion", 1e-3),
    (BENDING, "bending", 1e-3),
    (TORSION_PER_MASS, "torsion_per_mass", 1e-3),
    (BENDING_PER_MASS, "bending_per_mass", 1e-3),
    (INERTIA, "inertia", 1.0),
    (UNBALANCE, "unbalance", 1.0),
    (SAFETY, "fatigue_safety", 1.0),
)
QUANTITIES_TOLD = {key: quantity for quantity, key, _ in _ROWS}
"""Quantities of a shape result by their keys in shape.json."""
_UNITS = {
    "kg": "kg",
    "kNm_per_rad": "kN m/rad",
    "kN_per_mm": "kN/mm",
    "kNm_per_rad_kg": "kN m/(rad kg)",
    "kN_per_mm_kg": "kN/(mm kg)",
    "kg_mm2": "kg mm2",
    "kg_mm": "kg mm",
    "": "",
}

_KEPT_PERCENT = 0.05
"""Excess with which a limit still counts as kept, as in the search."""


def changes_table(data: Mapping[str, Any]) -> ResultTable:
    """Every quantity of the original and of the result, and its change."""
    columns = {"quantity": 0, "unit": 0, "original": 0, "result": 0, "change_percent": 2}
    before, after, rows = data["values"]["original"], data["values"]["result"], []
    for quantity, key, factor in _ROWS:
        if key in before and key in after:
            rows.append(
                {
                    "quantity": quantity.label,
                    "unit": _UNITS[quantity.unit],
                    "original": f"{factor * before[key]:.{quantity.digits}f}",
                    "result": f"{factor * after[key]:.{quantity.digits}f}",
                    "change_percent": data["change_percent"].get(key),
                }
            )
    return ResultTable(columns, tuple(rows))


def trials_table(data: Mapping[str, Any]) -> ResultTable:
    """What was tried, what it gained, and whether it was kept."""
    columns = {"step": 0, "parameters": 0, "gain_percent": 2, "kept": 0, "evaluations": 0}
    rows = tuple(
        {
            "step": t["step"],
            "parameters": t["parameters"],
            "gain_percent": t["gain_percent"],
            "kept": "yes" if t["kept"] else "no",
            "evaluations": t["evaluations"],
        }
        for t in data["trials"]
    )
    return ResultTable(columns, rows)


def rounds_table(data: Mapping[str, Any]) -> ResultTable:
    """Every web that was evaluated on the way, against the original, and by how much it missed its limits."""
    before, names = data["values"]["original"], named_first(data)
    columns = {"web": 0, **{f"{name}_percent": 2 for name in names}, "limits missed by": 0}
    rows = tuple(
        {
            "web": f"finish {number}" if number else "of the cells",
            **{f"{name}_percent": 100 * (found["values"][name] / before[name] - 1) for name in names},
            "limits missed by": _missed(found["excess_percent"]),
        }
        for number, found in enumerate(data["rounds"])
    )
    return ResultTable(columns, rows)


def _missed(excess_percent: list[float]) -> str:
    worst = max(excess_percent, default=0.0)
    return "-" if worst <= _KEPT_PERCENT else f"{worst:.2f} %"


def named_first(data: Mapping[str, Any]) -> tuple[str, ...]:
    """The quantities that a result is told by, that of the goal first."""
    goal, told = data["goal"], data["change_percent"]
    names = (goal.get("minimise") or goal["maximise"], "mass", "torsion", "bending", "fatigue_safety")
    return tuple(name for name in dict.fromkeys(names) if name in told)


def shape_headline(data: Mapping[str, Any]) -> str:
    """The result in one sentence; limits that are missed come first, then the goal."""
    change, missed = data["change_percent"], broken_limits(GoalOutcome.of_json(data["goal"], "goal"))
    names = named_first(data)
    said = ", ".join(f"{name.replace('_', ' ')} {change[name]:+.1f} %" for name in names)
    if not missed:
        return f"Every limit holds: {said} against the original web."
    return f"NOT MET: {'; '.join(missed)}; {said} against the original web."


def shape_summary(data: Mapping[str, Any], folder: Path) -> str:
    """A finished shape optimisation; `data` as shape.json holds it."""
    lines = [
        shape_headline(data),
        data["stop_reason"],
        *bound_lines(data),
        "",
        terminal(changes_table(data)),
        "",
        terminal(limits_table(GoalOutcome.of_json(data["goal"], "goal"))),
        "",
        *price_sentences(data),
        "",
        *worth_lines(data, "the original"),
        "",
        f"{data['seconds']['total']:.1f} s, {data['evaluations']} webs solved",
        *(str(folder / name) for name in data["files"].values()),
    ]
    return "\n".join(lines)
