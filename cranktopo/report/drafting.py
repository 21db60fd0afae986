"""Strokes of a technical drawing on matplotlib axes: dimensions, circles, the ghost of another body."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MM_PER_INCH

INK, THIN, GHOST, STEEL = "#1a1a1a", "#5a6472", "#d0482b", "#dfe4ea"
TEXT_SIZE = 7.5
DROP_MM = 2.6
"""Paper from a dimension line to a number that does not fit on it."""
_HEADS_MM = 4.0
"""Least paper between two arrowheads; a shorter line ends in dots."""
_LETTER_MM = 1.9
"""Mean width of a letter of a dimension on paper."""
_SAME_MM = 1e-3
"""Difference of places that is none."""
_Flat = tuple[float, float]


@dataclass(frozen=True)
class Measured:
    """Two points that a dimension is between, a point of its line, and its text."""

    start: _Flat
    end: _Flat
    on_line: _Flat
    text: str


def dimension(
    axes: Any,
    start: _Flat,
    end: _Flat,
    shift: _Flat,
    text: str,
    lift: _Flat = (0.0, 0.0),
    mm: float = 0.0,
) -> None:
    """Draw a dimension line between two points, with extension lines and its number.

    It is moved off the points across the line by `shift`, one component being 0; a number that does not fit
    on the line is lifted off it. All in mm; `mm` is one of paper where the line may be short.
    """
    a, b = (np.array(point) + np.array(shift) for point in (start, end))
    for across in np.flatnonzero(shift):  # both extension lines reach the dimension line
        a[across] = b[across] = (max if shift[across] > 0 else min)(a[across], b[across])
    parts = [
        axes.plot([point[0], at[0]], [point[1], at[1]], color=THIN, lw=0.5)[0]
        for point, at in ((start, a), (end, b))
    ]
    short = float(np.hypot(*(b - a))) < _HEADS_MM * mm
    style = "-" if short else "<|-|>"
    line = axes.annotate(
        "", a, b, arrowprops={"arrowstyle": style, "lw": 0.7, "color": INK, "shrinkA": 0, "shrinkB": 0}
    )
    if short:
        parts += axes.plot(*zip(a, b, strict=True), "o", ms=2.0, color=INK)
    middle, upright = (a + b) / 2, abs(a[0] - b[0]) < 1e-9
    number = axes.text(
        *(middle + lift),
        text,
        fontsize=TEXT_SIZE + 0.5,
        ha="center",
        va="center",
        rotation=90 if upright else 0,
        bbox={"fc": "white", "ec": "none", "pad": 0.8},
    )
    line.measured = Measured(start, end, (float(a[0]), float(a[1])), text)  # a DXF file dimensions by itself
    for part in (*parts, number):
        part.of_dimension = True


def extent(axes: Any, points: Array, axis: int, level: float, text: str) -> None:
    """Dimension how far points (n, 2) reach along an axis, its line at a level across that outside of them.

    Extension lines begin at the points that reach farthest, of several at the nearest to the line.
    """
    along, across = points[:, axis], points[:, 1 - axis]
    out = np.sign(level - across.mean())

    def nearest(end: float) -> _Flat:
        here = points[np.abs(along - end) < _SAME_MM]
        x, y = here[np.argmax(out * here[:, 1 - axis])]
        return float(x), float(y)

    first, last = nearest(along.min()), nearest(along.max())
    off = level - float(out * max(out * first[1 - axis], out * last[1 - axis]))
    dimension(axes, first, last, (off, 0.0) if axis else (0.0, off), text)


def number_mm(text: str) -> float:
    """Return the width of a dimension's number on paper."""
    return _LETTER_MM * len(text)


def folded(notes: Iterable[str], width_mm: float) -> list[str]:
    """Return notes in lines that fit a width of paper; what follows the first line of a note is indented."""
    return [line for note in notes for line in _lines(note, width_mm)]


def _lines(note: str, width_mm: float) -> list[str]:
    lines = [""]
    for word in note.split(" "):
        longer = f"{lines[-1]} {word}" if lines[-1].strip() else f"{lines[-1]}{word}"
        if lines[-1].strip() and _text_mm(longer) > width_mm:
            lines.append(f"   {word}")
        else:
            lines[-1] = longer
    return lines


def _text_mm(text: str) -> float:
    """Return the width of a line of a note on paper."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    size = FontProperties(size=TEXT_SIZE)
    width_pt, _, _ = text_to_path.get_text_width_height_descent(text, size, ismath=False)
    return float(width_pt) * MM_PER_INCH / 72


def fits(length_mm: float, text: str, mm: float) -> bool:
    """Tell whether a number fits on its dimension line between the arrowheads; `mm` is one of paper."""
    return length_mm >= (number_mm(text) + 6.0) * mm


def leader(axes: Any, tip: _Flat, at: _Flat, text: str, align: str = "center") -> None:
    """Write a text with a line from it to what it is about."""
    axes.annotate(
        text,
        tip,
        at,
        fontsize=TEXT_SIZE,
        ha=align,
        va="center",
        arrowprops={"arrowstyle": "-", "lw": 0.5, "color": THIN},
        bbox={"fc": "white", "ec": "none", "pad": 0.6},
    )


def edges(axes: Any, chains: Sequence[Any], width: float = 1.0) -> None:
    """Draw chains of points (n, 2) as visible edges."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(chains, colors=INK, linewidths=width))


def centre_line(axes: Any, start: _Flat, end: _Flat) -> None:
    """Draw an axis."""
    axes.plot(*zip(start, end, strict=True), color=THIN, lw=0.6, ls="-.")


def axis_mark(axes: Any, corner: _Flat, x_way: int, mm: float) -> None:
    """Draw arrows along +x, right or by -1 left, and along +y from a corner; `mm` is one of paper."""
    for letter, way in (("x", (x_way, 0.0)), ("y", (0.0, 1.0))):
        end, name = (np.array(corner) + length * mm * np.array(way) for length in (5.0, 7.6))
        arrow = {"arrowstyle": "-|>", "lw": 0.5, "color": THIN, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", end, corner, arrowprops=arrow)
        axes.text(*name, letter, fontsize=TEXT_SIZE, ha="center", va="center", color=THIN)


def tolerance_frame(axes: Any, x: float, y: float, cells: Sequence[str], mm: float) -> None:
    """Draw a tolerance frame (ISO 1101) with its lower left corner at (x, y); `mm` is one of paper."""
    for text in cells:
        width = (1.6 * len(text) + 3.4) * mm
        frame(axes, x, y, width, 5.0 * mm, 0.6)
        axes.text(x + width / 2, y + 2.4 * mm, text, fontsize=TEXT_SIZE, ha="center", va="center")
        x += width


def datum(axes: Any, x: float, y: float, letter: str, mm: float) -> None:
    """Draw a datum triangle (ISO 5459) below a surface at (x, y), and its letter in a box."""
    from matplotlib.patches import Polygon

    axes.add_patch(
        Polygon([(x, y), (x - 1.5 * mm, y - 2.2 * mm), (x + 1.5 * mm, y - 2.2 * mm)], fc=INK, ec=INK)
    )
    axes.plot([x, x], [y - 2.2 * mm, y - 5 * mm], color=INK, lw=0.6)
    frame(axes, x - 2.2 * mm, y - 9.4 * mm, 4.4 * mm, 4.4 * mm, 0.6)
    axes.text(x, y - 7.3 * mm, letter, fontsize=TEXT_SIZE, ha="center", va="center")


def circle(
    axes: Any, radius: float, y: float, style: str, width: float, fill: str = "none", x: float = 0.0
) -> None:
    """Draw a circle."""
    from matplotlib.patches import Circle

    axes.add_patch(Circle((x, y), radius, fc=fill, ec=INK, lw=width, ls=style))


def ghost(axes: Any, polygons: list[Any]) -> None:
    """Draw outlines of another body, (n, 2) each, dashed."""
    for polygon in polygons:
        closed = np.vstack([polygon, polygon[:1]])
        axes.plot(closed[:, 0], closed[:, 1], color=GHOST, lw=1.0, ls="--")


def finish(axes: Any, title: str) -> None:
    """Give the axes equal scales, a title and no frame."""
    axes.set_aspect("equal")
    axes.set_title(title, fontsize=10, loc="left", color=THIN)
    axes.axis("off")


def hatched(axes: Any, polygons: list[Any], hatch: str = "////") -> None:
    """Draw a cut area: outlines and holes by orientation, (n, 2) each, with matplotlib's hatch or none."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    path = Path.make_compound_path(*(Path(np.vstack([p, p[:1]]), closed=True) for p in polygons))
    axes.add_patch(PathPatch(path, fc=STEEL, ec=INK, lw=1.4, hatch=hatch))


def frame(axes: Any, x: float, y: float, width: float, height: float, line: float) -> None:
    """Draw a rectangle from its lower left corner."""
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle((x, y), width, height, fc="none", ec=INK, lw=line))


def projection_symbol(axes: Any, x: float, y: float) -> None:
    """Draw the sign of first-angle projection (ISO 5456-2), 14 x 6 mm: a cone from its side and its end."""
    axes.plot([x, x + 6, x + 6, x, x], [y - 1.5, y - 3, y + 3, y + 1.5, y - 1.5], color=INK, lw=0.8)
    for radius in (1.5, 3.0):
        circle(axes, radius, y, "-", 0.8, x=x + 11)
    axes.plot([x - 1.5, x + 15.5], [y, y], color=THIN, lw=0.4, ls="-.")
