"""Original, result and bound on one scale."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cranktopo.design.goal.quantities import QUANTITIES, QuantityName
from cranktopo.report.plot import Picture, picture
from cranktopo.report.result_table import ResultTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = {"original": "0.6", "result": "C0", "bound": "C3"}


def bound_picture(table: ResultTable, quantity: QuantityName) -> Picture:
    """Bars of the webs of a table with columns `web` and `percent`."""
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
