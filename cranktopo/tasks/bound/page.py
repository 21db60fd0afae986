"""Distance of a result from the best possible web, as a section of its page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cranktopo.design.goal.quantities import QUANTITIES, QuantityName
from cranktopo.report.page import Section
from cranktopo.report.plot import Picture, picture
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.bound.result import AnyBound, BoundStatement
from cranktopo.tasks.bound.text import bound_table, statement_line, statements

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = {"original": "0.6", "result": "C0", "bound": "C3"}


def bound_sections(bound: AnyBound | None, model: str) -> tuple[Section, ...]:
    """Return one section, none where no bound was asked for.

    Args:
        model: what judged original and result.
    """
    told = statements(bound)
    if not told:
        return ()
    known = [entry for entry in told if isinstance(entry, BoundStatement) and entry.value is not None]
    lines = (statement_line(entry) for entry in told)
    text = " ".join(f"{line[:1].upper()}{line[1:]}." for line in lines)
    return (
        Section(
            "bound",
            "How far from the best possible web",
            f"{text} Original and result are those of {model}; the bound is a change against the original in "
            "the cells of the bound.",
            tables=tuple((_caption(entry), bound_table(entry)) for entry in known),
            pictures=tuple(bound_picture(bound_table(entry), entry.quantity) for entry in known),
        ),
    )


def _caption(bound: BoundStatement) -> str:
    return f"{QUANTITIES[bound.quantity].label.capitalize()}, percent of the original"


def bound_picture(table: ResultTable, quantity: QuantityName) -> Picture:
    """Draw bars of the webs of a table with columns `web` and `percent`."""
    told = ", ".join(f"{name} {percent:.1f} %" for name, percent in _rows(table))
    name = QUANTITIES[quantity].label
    return picture(f"bound-{quantity}", f"{name} of the original: {told}", _draw, table, name)


def _rows(table: ResultTable) -> list[tuple[str, float]]:
    return [(str(row["web"]), float(row["percent"] or 0.0)) for row in table.rows]


def _draw(axes: Axes, table: ResultTable, name: str) -> None:
    rows = _rows(table)
    for web, percent in reversed(rows):
        bar = axes.barh(web, percent, color=_COLOURS.get(web))
        axes.bar_label(bar, [web], label_type="center", color="white")
        axes.bar_label(bar, [f"{percent - 100:+.1f} %"], padding=3)
    axes.set_yticks([])
    axes.set(xlabel=f"{name}, % of the original", xlim=(0, 1.25 * max(percent for _, percent in rows)))
