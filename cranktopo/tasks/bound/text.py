"""The bound of a design in words and a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.design.goal.outcome import GoalWords
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.report.goal_table import goal_words, value_text
from cranktopo.report.result_table import ResultTable, terminal

_ABOUT = "proven for every web in the envelope, whatever its topology, in the cells of the optimiser's model"


def bound_summary(data: Mapping[str, Any]) -> str:
    """What `cranktopo bound` prints."""
    lines = [
        f"{data['design']}: {goal_words(GoalWords.of_json(data['goal'], 'goal'))}",
        "",
        terminal(_table(data)),
        "",
        _claim(data),
        _error(data),
    ]
    lines += [
        f"left out, so that the bound is looser: {d['limit']}: {d['reason']}" for d in data["goal"]["dropped"]
    ]
    process = data["process"]
    if process != "free":
        lines.append(
            "the web comes from a die; its draft is left out"
            if data["die"]
            else f"process {process!r}: what it excludes is left out, so that the bound is looser"
        )
    if data["original_outside_envelope_percent"] > 0.1:
        share = data["original_outside_envelope_percent"]
        lines.append(
            f"{share:.1f} % of the original web lies outside of the envelope, and the bound is not about it"
        )
    return "\n".join(lines)


def bound_lines(data: Mapping[str, Any]) -> list[str]:
    """How far a result is from the best possible web, a line for each statement.

    Args:
        data: with `bound` as shape.json, metrics.json or iterate.json holds it.
    """
    return [statement_line(entry) for entry in statements(data)]


def statements(data: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The bounds beside a result, none where they were not asked for.

    Args:
        data: with `bound` as shape.json, metrics.json or iterate.json holds it.
    """
    bound = data.get("bound") or {"statements": []}
    found = bound.get("statements", [bound])
    return [entry for entry in found if "none" in entry or entry["reached_percent"] is not None]


def statement_line(bound: Mapping[str, Any]) -> str:
    """How far a result is from what no web can beat in one quantity."""
    if "none" in bound:
        return f"no bound: {bound['none']}"
    reached = bound["reached_percent"]
    if bound["value"] is None:
        return "bound: no web of the envelope keeps these limits in the cells of the bound"
    quantity, most = QUANTITIES[bound["quantity"]], bound["percent_of_original"] - 100
    name, at = quantity.label, " at this mass" if "at_mass_percent" in bound else ""
    cell = bound["model"]["cell_mm"]
    if (reached - 100 - most) * (1 if quantity.better == "high" else -1) > 0:
        return (
            f"{name} {reached - 100:+.1f} %{at}: beyond {most:+.1f} %, the best that cells of {cell:.3g} mm "
            "can hold; what is left to gain is less than their error"
        )
    return (
        f"{name} {reached - 100:+.1f} % of at most {most:+.1f} %{at}, which no web of the envelope can beat, "
        f"however it is made (proven on cells of {cell:.3g} mm)"
    )


def bound_table(bound: Mapping[str, Any]) -> ResultTable:
    """Original, result and bound on one scale, in percent of the original.

    Args:
        bound: a statement that has one.
    """
    rows = (
        ("original", 100.0),
        ("result", bound["reached_percent"]),
        ("bound", bound["percent_of_original"]),
    )
    return ResultTable({"web": 0, "percent": 1}, tuple({"web": web, "percent": value} for web, value in rows))


def _claim(data: Mapping[str, Any]) -> str:
    bound = data["bound"]
    if not bound["possible"]:
        return f"NO WEB of this envelope keeps these limits: {_ABOUT}"
    best = "at most" if "maximise" in data["goal"] else "not below"
    change = bound["percent_of_original"] - 100
    told = f"{value_text(bound['value'], bound['unit'])}, {change:+.1f} % of the original"
    return f"{best} {told}: {_ABOUT}"


def _error(data: Mapping[str, Any]) -> str:
    errors = data["model_error_percent"]
    told = ", ".join(f"{name} {value:.1f} %" for name, value in errors.items())
    return f"cells of {data['resolution_mm']:g} mm; their own error against exact solids: {told}"


def _table(data: Mapping[str, Any]) -> ResultTable:
    bound, relaxed, own = (
        data["bound"],
        data["variable_stiffness"],
        data["original"][data["bound"]["quantity"]],
    )
    unit = QUANTITIES[bound["quantity"]].unit
    rows = [
        {"web": "original", "value": value_text(own, unit), "percent": 100.0},
        {
            "web": "cells of any stiffness",
            "value": value_text(relaxed["value"], unit),
            "percent": relaxed["percent_of_original"],
        },
        {"web": "bound", "value": value_text(bound["value"], unit), "percent": bound["percent_of_original"]},
    ]
    return ResultTable({"web": 0, "value": 0, "percent": 1}, tuple(rows if bound["possible"] else rows[:1]))
