"""The bound of a design in words and a table, and as a section of the page of a result."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from cranktopo.bodies.cells.outside import OutsideEnvelope, outside_words
from cranktopo.design.goal.quantities import QUANTITIES, QuantityName
from cranktopo.report.goal_table import goal_words, value_text
from cranktopo.report.page import Section
from cranktopo.report.plot import Picture, picture
from cranktopo.report.result_table import ResultTable, Row, terminal
from cranktopo.tasks.bound.result import AnyBound, BoundResult, BoundStatement, BoundStatements, NoBound

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_ABOUT = "proven for every web in the envelope, whatever its topology, in the cells of the optimiser's model"


def bound_summary(result: BoundResult) -> str:
    """Return what `cranktopo bound` prints."""
    head = f"{result.design}: {goal_words(result.goal)}"
    lines = [head, "", terminal(_table(result)), "", _claim(result), _error(result)]
    lines += [f"left out, so that the bound is looser: {d.limit}: {d.reason}" for d in result.goal.dropped]
    if result.process != "free":
        lines.append(
            "the web comes from a die; its draft is left out"
            if result.die
            else f"process {result.process!r}: what it excludes is left out, so that the bound is looser"
        )
    outside = OutsideEnvelope(
        volume_mm3=result.original_outside_envelope_mm3, percent=result.original_outside_envelope_percent
    )
    lines += filter(None, [outside_words(outside)])
    return "\n".join(lines)


def bound_lines(bound: AnyBound | BoundStatement | None) -> list[str]:
    """Return how far a result is from the best possible web, a line for each statement."""
    return [_statement_line(entry) for entry in _statements(bound)]


def _statements(bound: AnyBound | BoundStatement | None) -> list[BoundStatement | NoBound]:
    if bound is None:
        return []
    found = bound.statements if isinstance(bound, BoundStatements) else (bound,)
    return [entry for entry in found if isinstance(entry, NoBound) or entry.reached_percent is not None]


def _statement_line(bound: BoundStatement | NoBound) -> str:
    if isinstance(bound, NoBound):
        return f"no bound: {bound.none}"
    percent, reached = bound.percent_of_original, bound.reached_percent
    if bound.value is None or percent is None or reached is None:
        return "bound: no web of the envelope keeps these limits in the cells of the bound"
    quantity, most = QUANTITIES[bound.quantity], percent - 100
    name, at = quantity.label, "" if bound.at_mass_percent is None else " at this mass"
    cell = f"cells of {bound.model.cell_mm:.3g} mm{_dropped_words(bound.dropped)}"
    if (reached - 100 - most) * (1 if quantity.better == "high" else -1) > 0:
        return (
            f"{name} {reached - 100:+z.1f} %{at}: beyond {most:+z.1f} %, the best that {cell} can hold; what "
            "is left to gain is less than their error"
        )
    return (
        f"{name} {reached - 100:+z.1f} % of at most {most:+z.1f} %{at}, which no web of the envelope can "
        f"beat, however it is made (proven on {cell})"
    )


def _dropped_words(dropped: Sequence[str]) -> str:
    """Return the limits that a proof leaves out in words."""
    return f" without the limit{'s' * (len(dropped) > 1)} {', '.join(dropped)}" if dropped else ""


def bound_table(bound: BoundStatement) -> ResultTable:
    """Return original, result and bound of a statement that has one, in percent of the original."""
    webs = {"original": 100.0, "result": bound.reached_percent, "bound": bound.percent_of_original}
    rows = tuple({"web": web, "percent": percent} for web, percent in webs.items())
    return ResultTable({"web": 0, "percent": 1}, rows)


def _claim(result: BoundResult) -> str:
    bound = result.bound
    if bound.percent_of_original is None:
        return f"NO WEB of this envelope keeps these limits: {_ABOUT}"
    best = "at most" if result.goal.maximise else "not below"
    change = bound.percent_of_original - 100
    value = f"{value_text(bound.value, bound.unit)}, {change:+z.1f} % of the original"
    return f"{best} {value}: {_ABOUT}"


def _error(result: BoundResult) -> str:
    errors = ", ".join(f"{name} {value:.1f} %" for name, value in result.model_error_percent.items())
    return f"cells of {result.resolution_mm:g} mm; their own error against exact solids: {errors}"


def _table(result: BoundResult) -> ResultTable:
    bound, relaxed = result.bound, result.variable_stiffness
    webs = (
        ("original", result.original[bound.quantity], 100.0),
        ("cells of any stiffness", relaxed.value, relaxed.percent_of_original),
        ("bound", bound.value, bound.percent_of_original),
    )
    rows: tuple[Row, ...] = tuple(
        {"web": web, "value": value_text(value, bound.unit), "percent": percent}
        for web, value, percent in (webs if bound.possible else webs[:1])
    )
    return ResultTable({"web": 0, "value": 0, "percent": 1}, rows)


_COLOURS = {"original": "0.6", "result": "C0", "bound": "C3"}


def bound_sections(bound: AnyBound | BoundStatement | None, model: str) -> tuple[Section, ...]:
    """Return one section, none where no bound was asked for; `model` judged original and result."""
    statements = _statements(bound)
    if not statements:
        return ()
    known = [entry for entry in statements if isinstance(entry, BoundStatement) and entry.value is not None]
    outside = bound.outside_envelope if isinstance(bound, BoundStatements) else None
    lines = [*map(_statement_line, statements), *filter(None, [outside_words(outside)])]
    if known:
        lines.append(
            f"original and result are those of {model}; the bound is a change against the original in the "
            "cells of the bound"
        )
    return (
        Section(
            "bound",
            "How far from the best possible web",
            " ".join(f"{line[:1].upper()}{line[1:]}." for line in lines),
            tables=tuple(
                (f"{QUANTITIES[e.quantity].label.capitalize()}, percent of the original", bound_table(e))
                for e in known
            ),
            pictures=tuple(bound_picture(bound_table(entry), entry.quantity) for entry in known),
        ),
    )


def bound_picture(table: ResultTable, quantity: QuantityName) -> Picture:
    """Draw bars of the webs of a table with columns `web` and `percent`."""
    percents = ", ".join(f"{name} {percent:.1f} %" for name, percent in _rows(table))
    name = QUANTITIES[quantity].label
    return picture(f"bound-{quantity}", f"{name} of the original: {percents}", _draw, table, name)


def _rows(table: ResultTable) -> list[tuple[str, float]]:
    return [(str(row["web"]), float(row["percent"] or 0.0)) for row in table.rows]


def _draw(axes: Axes, table: ResultTable, name: str) -> None:
    rows = _rows(table)
    for web, percent in reversed(rows):
        bar = axes.barh(web, percent, color=_COLOURS.get(web))
        axes.bar_label(bar, [web], label_type="center", color="white")
        axes.bar_label(bar, [f"{percent - 100:+z.1f} %"], padding=3)
    axes.set_yticks([])
    axes.set(xlabel=f"{name}, % of the original", xlim=(0, 1.25 * max(percent for _, percent in rows)))
