"""The bound of a design in words and a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.tables.goal_table import goal_words, value_text
from cranktopo.report.tables.result_table import ResultTable, terminal
from cranktopo.scene.goal import QUANTITIES

_ABOUT = "proven for every web in the envelope, whatever its topology, in the cells of the optimiser's model"


def bound_summary(data: Mapping[str, Any]) -> str:
    """What `cranktopo bound` prints."""
    lines = [
        f"{data['design']}: {goal_words(data['goal'])}",
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


def bound_line(data: Mapping[str, Any]) -> str:
    """How far the result of a search is from the best possible web; empty where that is not known.

    Args:
        data: with `goal` and `bound` as shape.json holds them.
    """
    bound, reached = data.get("bound"), data["goal"]["reached_percent"]
    if not bound or reached is None:
        return ""
    if "none" in bound:
        return f"no bound: {bound['none']}"
    if bound["value"] is None:
        return "bound: no web of the envelope keeps these limits in the cells of the bound"
    name, most = QUANTITIES[bound["quantity"]].label, bound["percent_of_original"] - 100
    cell = bound["model"]["cell_mm"]
    return (
        f"{name} {reached - 100:+.1f} % of at most {most:+.1f} %, which no web of the envelope can beat, "
        f"however it is made (proven on cells of {cell:.3g} mm)"
    )


def bound_table(data: Mapping[str, Any]) -> ResultTable:
    """Original, result and bound on one scale, in percent of the original.

    Args:
        data: as for `bound_line`, with a bound.
    """
    rows = (
        ("original", 100.0),
        ("result", data["goal"]["reached_percent"]),
        ("bound", data["bound"]["percent_of_original"]),
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
