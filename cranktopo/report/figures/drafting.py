"""Strokes of a technical drawing on matplotlib axes: dimensions, circles, the ghost of another body."""

from __future__ import annotations

from typing import Any

import numpy as np

INK, THIN, GHOST, STEEL = "#1a1a1a", "#5a6472", "#d0482b", "#dfe4ea"
TEXT_SIZE = 7.5


def dimension(
    axes: Any, start: tuple[float, float], end: tuple[float, float], shift: tuple[float, float], text: str
) -> None:
    """A dimension line between two points, with extension lines and its number.

    Args:
        start, end: the two points, mm.
        shift: how far the line is moved off the points, mm; across it, one component being 0.
    """
    a, b = (np.array(point) + np.array(shift) for point in (start, end))
    if shift[0]:  # vertical dimension: both extension lines reach the same x
        a[0] = b[0] = max(a[0], b[0]) if shift[0] > 0 else min(a[0], b[0])
    for point, at in ((start, a), (end, b)):
        axes.plot([point[0], at[0]], [point[1], at[1]], color=THIN, lw=0.5)
    axes.annotate(
        "", a, b, arrowprops={"arrowstyle": "<|-|>", "lw": 0.7, "color": INK, "shrinkA": 0, "shrinkB": 0}
    )
    middle, upright = (a + b) / 2, abs(a[0] - b[0]) < 1e-9
    axes.text(
        *middle,
        text,
        fontsize=TEXT_SIZE + 0.5,
        ha="center",
        va="center",
        rotation=90 if upright else 0,
        bbox={"fc": "white", "ec": "none", "pad": 0.8},
    )


def circle(
    axes: Any, radius: float, y: float, style: str, width: float, fill: str = "none", x: float = 0.0
) -> None:
    """A circle."""
    from matplotlib.patches import Circle

    axes.add_patch(Circle((x, y), radius, fc=fill, ec=INK, lw=width, ls=style))


def ghost(axes: Any, polygons: list[Any]) -> None:
    """Outlines of another body, dashed.

    Args:
        polygons: the outlines, (n, 2) each, mm.
    """
    for polygon in polygons:
        closed = np.vstack([polygon, polygon[:1]])
        axes.plot(closed[:, 0], closed[:, 1], color=GHOST, lw=1.0, ls="--")


def finish(axes: Any, title: str) -> None:
    """Equal scales, a title, no frame."""
    axes.set_aspect("equal")
    axes.set_title(title, fontsize=10, loc="left", color=THIN)
    axes.axis("off")


def hatched(axes: Any, polygons: list[Any], hatch: str = "////") -> None:
    """A cut area: polygons with their holes by orientation.

    Args:
        polygons: outlines and holes, (n, 2) each, mm.
        hatch: matplotlib's hatch pattern; empty for none.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    path = Path.make_compound_path(*(Path(np.vstack([p, p[:1]]), closed=True) for p in polygons))
    axes.add_patch(PathPatch(path, fc=STEEL, ec=INK, lw=1.4, hatch=hatch))
