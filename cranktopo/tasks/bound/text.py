"""The bound of a design in words and a table."""

from __future__ import annotations

from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.report.goal_table import goal_words, value_text
from cranktopo.report.result_table import ResultTable, Row, terminal
from cranktopo.tasks.bound.result import AnyBound, BoundResult, BoundStatement, BoundStatements, NoBound

_ABOUT = "proven for every web in the envelope, whatever its topology, in the cells of the optimiser's model"


def bound_summary(found: BoundResult) -> str:
    """Return what `cranktopo bound` prints."""
    lines = [
        f"{found.design}: {goal_words(found.goal)}",
        "",
        terminal(_table(found)),
        "",
        _claim(found),
        _error(found),
    ]
    lines += [f"left out, so that the bound is looser: {d.limit}: {d.reason}" for d in found.goal.dropped]
    if found.process != "free":
        lines.append(
            "the web comes from a die; its draft is left out"
            if found.die
            else f"process {found.process!r}: what it excludes is left out, so that the bound is looser"
        )
    share = found.original_outside_envelope_percent
    if share > 0.1:
        lines.append(
            f"{share:.1f} % of the original web lies outside of the envelope, and the bound is not about it"
        )
    return "\n".join(lines)


def bound_lines(bound: AnyBound | None) -> list[str]:
    """Return how far a result is from the best possible web, a line for each statement."""
    return [statement_line(entry) for entry in statements(bound)]


def statements(bound: AnyBound | None) -> list[BoundStatement | NoBound]:
    """Return the bounds beside a result, none where they were not asked for."""
    if bound is None:
        return []
    found = bound.statements if isinstance(bound, BoundStatements) else (bound,)
    return [entry for entry in found if isinstance(entry, NoBound) or entry.reached_percent is not None]


def statement_line(bound: BoundStatement | NoBound) -> str:
    """Return how far a result is from what no web can beat in one quantity."""
    if isinstance(bound, NoBound):
        return f"no bound: {bound.none}"
    percent, reached = bound.percent_of_original, bound.reached_percent
    if bound.value is None or percent is None or reached is None:
        return "bound: no web of the envelope keeps these limits in the cells of the bound"
    quantity, most = QUANTITIES[bound.quantity], percent - 100
    name, at = quantity.label, "" if bound.at_mass_percent is None else " at this mass"
    cell = bound.model.cell_mm
    if (reached - 100 - most) * (1 if quantity.better == "high" else -1) > 0:
        return (
            f"{name} {reached - 100:+.1f} %{at}: beyond {most:+.1f} %, the best that cells of {cell:.3g} mm "
            "can hold; what is left to gain is less than their error"
        )
    return (
        f"{name} {reached - 100:+.1f} % of at most {most:+.1f} %{at}, which no web of the envelope can beat, "
        f"however it is made (proven on cells of {cell:.3g} mm)"
    )


def bound_table(bound: BoundStatement) -> ResultTable:
    """Return original, result and bound on one scale, in percent of the original.

    Args:
        bound: a statement that has one.
    """
    rows = (
        ("original", 100.0),
        ("result", bound.reached_percent),
        ("bound", bound.percent_of_original),
    )
    return ResultTable({"web": 0, "percent": 1}, tuple({"web": web, "percent": value} for web, value in rows))


def _claim(found: BoundResult) -> str:
    bound = found.bound
    if bound.percent_of_original is None:
        return f"NO WEB of this envelope keeps these limits: {_ABOUT}"
    best = "at most" if found.goal.maximise else "not below"
    change = bound.percent_of_original - 100
    told = f"{value_text(bound.value, bound.unit)}, {change:+.1f} % of the original"
    return f"{best} {told}: {_ABOUT}"


def _error(found: BoundResult) -> str:
    told = ", ".join(f"{name} {value:.1f} %" for name, value in found.model_error_percent.items())
    return f"cells of {found.resolution_mm:g} mm; their own error against exact solids: {told}"


def _table(found: BoundResult) -> ResultTable:
    bound, relaxed, own = found.bound, found.variable_stiffness, found.original[found.bound.quantity]
    unit = bound.unit
    rows: list[Row] = [
        {"web": "original", "value": value_text(own, unit), "percent": 100.0},
        {
            "web": "cells of any stiffness",
            "value": value_text(relaxed.value, unit),
            "percent": relaxed.percent_of_original,
        },
        {"web": "bound", "value": value_text(bound.value, unit), "percent": bound.percent_of_original},
    ]
    return ResultTable({"web": 0, "value": 0, "percent": 1}, tuple(rows if bound.possible else rows[:1]))
