"""Plot of a shape optimisation: goal and worst limit of every web that was evaluated on the way."""

from __future__ import annotations

from typing import Any

from cranktopo.report.axes_style import plain
from cranktopo.tasks.shape.result import ShapeResult

_GOAL, _MISSED = "#1f6fb4", "#d1632a"


def draw_goal(axes: Any, found: ShapeResult) -> None:
    """Draw the goal of every web, % of the original's."""
    name, original = found.goal.quantity.name, found.values.original
    values = [100 * web.values[name] / original[name] for web in found.rounds]
    _draw(axes, found.best_round, values, f"{name.replace('_', ' ')} (% of the original)", _GOAL, 0.5)


def draw_worst_limit(axes: Any, found: ShapeResult) -> None:
    """Draw by how much every web misses its worst limit, %; 0 or less is kept."""
    values = [max(web.excess_percent, default=0.0) for web in found.rounds]
    _draw(axes, found.best_round, values, "worst limit missed by (%)", _MISSED, 0.1)
    axes.axhline(0.0, color="0.4", linewidth=1, zorder=0)


def _draw(axes: Any, best: int, values: list[float], label: str, colour: str, minimum: float) -> None:
    places = range(len(values))
    axes.plot(places, values, "o-", color=colour, linewidth=1.6)
    axes.plot([best], [values[best]], "o", markersize=11, fillstyle="none", color="black")
    for place, value in zip(places, values, strict=True):
        axes.annotate(
            f"{value:.2f}", (place, value), xytext=(0, 7), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set_xticks(places, ["cells", *(f"finish {number}" for number in places[1:])])
    middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
    half = max(1.35 * half, minimum)  # a settled goal is no reason to magnify its last digits
    axes.set_ylim(middle - half, middle + half)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.margins(x=0.12)
    axes.set_ylabel(label, fontsize=9)
    axes.grid(color="0.9", linewidth=0.8, axis="y")
    plain(axes)
