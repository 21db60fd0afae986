"""Marks of a sketch: dimensions, radii and angles under the names of their keys; one view of a sketch."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any

from cranktopo.design.schema import Scene
from cranktopo.report.drafting import INK, TEXT_SIZE, THIN, dimension

Flat = tuple[float, float]
_OFF = 3.5
"""From a dimension line to its name, mm."""


@dataclass(frozen=True)
class Panel:
    """One view of one body: what is drawn of it, and the names on it."""

    title: str
    tables: Mapping[str, Any]
    body: Callable[[Any, Scene], None]
    names: Callable[[Any], None]


def mark_size(axes: Any, start: Flat, end: Flat, shift: Flat, key: str) -> None:
    """Draw a dimension with its name beyond the line, away from the body: most are shorter than the name."""
    dimension(axes, start, end, shift, "")
    upright = abs(start[0] - end[0]) < abs(start[1] - end[1])
    out = _OFF if shift[0] + shift[1] >= 0 else -_OFF
    x, y = ((a + b) / 2 + by for a, b, by in zip(start, end, shift, strict=True))
    at = (x + out, y) if upright else (x, y + out)
    mark_word(axes, at, key, 90 if upright else 0)


def mark_leader(axes: Any, point: Flat, text_at: Flat, key: str) -> None:
    """Draw an arrow from a name to a point."""
    axes.annotate(
        key,
        point,
        text_at,
        fontsize=TEXT_SIZE + 0.5,
        ha="center",
        va="center",
        arrowprops={"arrowstyle": "->", "lw": 0.7, "color": INK, "shrinkA": 0, "shrinkB": 0},
        bbox={"fc": "white", "ec": "none", "pad": 0.8},
    )


def mark_radius(axes: Any, centre: Flat, length: float, deg: float, key: str) -> None:
    """Draw a radius from its centre to the circle, its name in the middle."""
    tip = (centre[0] + length * cos(radians(deg)), centre[1] + length * sin(radians(deg)))
    arrow = {"arrowstyle": "-|>", "lw": 0.7, "color": INK, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", tip, centre, arrowprops=arrow)
    mark_word(axes, ((centre[0] + tip[0]) / 2, (centre[1] + tip[1]) / 2), key)


def mark_word(axes: Any, at: Flat, key: str, turned_deg: float = 0.0) -> None:
    """Write a name with its middle at a place."""
    box = {"fc": "white", "ec": "none", "pad": 0.4}
    size = TEXT_SIZE + 0.5
    axes.text(*at, key, fontsize=size, ha="center", va="center", rotation=turned_deg, bbox=box)


def mark_angle(axes: Any, radius: float, start: float, end: float, key: str) -> None:
    """Draw an angle about the crank axis, counted from the throw direction toward +x."""
    from matplotlib.patches import Arc

    axes.add_patch(Arc((0, 0), 2 * radius, 2 * radius, theta1=90 - end, theta2=90 - start, color=INK, lw=0.7))
    for deg in (start, end):
        x, y = sin(radians(deg)), cos(radians(deg))
        axes.plot([0, 1.1 * radius * x], [0, 1.1 * radius * y], color=THIN, lw=0.5, ls="-.")
    middle = radians((start + end) / 2)
    mark_word(axes, (radius * sin(middle), radius * cos(middle)), key)
