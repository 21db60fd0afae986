"""Plot of a shape optimisation: goal and worst limit of every web that was evaluated on the way."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.axes_style import plain

_GOAL, _MISSED = "#1f6fb4", "#d1632a"


def draw_goal(axes: Any, data: Mapping[str, Any]) -> None:
    """The goal of every web, % of the original's; `data` as shape.json holds it."""
    goal, original = data["goal"], data["values"]["original"]
    name = goal.get("minimise") or goal["maximise"]
    values = [100 * found["values"][name] / original[name] for found in data["rounds"]]
    _draw(axes, data, values, f"{name.replace('_', ' ')} (% of the original)", _GOAL, 0.5)


def draw_worst_limit(axes: Any, data: Mapping[str, Any]) -> None:
    """By how much every web misses its worst limit, %; 0 or less is kept."""
    values = [max(found["excess_percent"], default=0.0) for found in data["rounds"]]
    _draw(axes, data, values, "worst limit missed by (%)", _MISSED, 0.1)
    axes.axhline(0.0, color="0.4", linewidth=1, zorder=0)


def _draw(
    axes: Any, data: Mapping[str, Any], values: list[float], label: str, colour: str, least: float
) -> None:
    places, best = range(len(values)), data.get("best_round")
    axes.plot(places, values, "o-", color=colour, linewidth=1.6)
    if best is not None:
        axes.plot([best], [values[best]], "o", markersize=11, fillstyle="none", color="black")
    for place, value in zip(places, values, strict=True):
        axes.annotate(
            f"{value:.2f}", (place, value), xytext=(0, 7), textcoords="offset points", ha="center", fontsize=8
        )
    axes.set_xticks(places, ["cells", *(f"finish {number}" for number in places[1:])])
    middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
    half = max(1.35 * half, least)  # a settled goal is no reason to magnify its last digits
    axes.set_ylim(middle - half, middle + half)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.margins(x=0.12)
    axes.set_ylabel(label, fontsize=9)
    axes.grid(color="0.9", linewidth=0.8, axis="y")
    plain(axes)
