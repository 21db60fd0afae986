"""Texts and running dimensions of points of a view, clear of each other.

`paper_mm` is a millimetre of paper in millimetres of the view.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, pairwise, product
from typing import Any

import numpy as np
from scipy.spatial.distance import cdist

from cranktopo.base.arrays import Array
from cranktopo.report.drafting import INK, TEXT_SIZE, THIN, circle, leader, number_mm
from cranktopo.throw.profile import ProfileWeb

PLACE_MM = 15.0
"""Paper for running dimensions of places."""
_CLEAR_MM = 1.5
"""Paper between two leaders that is enough."""
_TEXT_ROOM_MM = 2.4
"""Paper between the middle of a text and a line beside it."""
NamedPoint = tuple[tuple[float, float], str]
"""A point of a view and the text about it."""


def stations(axes: Any, web: ProfileWeb, x_way: int) -> Iterator[NamedPoint]:
    """Mark the stations on the right of the outline; yield each with its number and place.

    `x_way` is -1 in a view in which x runs to the left.
    """
    for number, (y, x) in enumerate(zip(web.stations_mm, web.half_widths_mm, strict=True), 1):
        axes.plot(x, y, "o", ms=3.0, color=INK)
        yield (x, y), f"{number}:  y {y:.2f}, x {x_way * x + 0.0:.2f}"


def text_column(axes: Any, named: Sequence[NamedPoint], beside: float, paper_mm: float) -> None:
    """Write texts of points in a column right of all that is `beside` the axis, clear of each other.

    So are their leaders, which go over to the heights of their texts at the column, or at once at their
    points where that keeps them farther apart; texts that stand too close make room upward, or downward.
    """
    ordered, least = sorted(named, key=lambda one: one[0][1]), 3.4 * paper_mm
    tips, heights = [tip for tip, _ in ordered], [y for (_, y), _ in ordered]
    up, down = _spread(heights, least), _spread([-y for y in heights], least)[::-1]
    ways = [level for _, level in up], [-level for _, level in down]
    lines = max(
        (_leader_lines(tips, *one, beside, paper_mm) for one in product(ways, (False, True))),
        key=lambda found: min(_least_gap(found), _CLEAR_MM * paper_mm),
    )
    for (_, text), line in zip(ordered, lines, strict=True):
        axes.plot(*line.T, color=THIN, lw=0.4)
        white = {"fc": "white", "ec": "none", "pad": 0.4}  # lines of places pass under the column
        level = float(line[-1, 1])
        axes.text(beside + 5 * paper_mm, level, text, fontsize=TEXT_SIZE, va="center", bbox=white)


def _leader_lines(
    tips: Sequence[tuple[float, float]],
    levels: Sequence[float],
    at_once: bool,
    beside: float,
    paper_mm: float,
) -> list[Array]:
    """Return the corners (4, 2) of each leader from its point to its text's level in the column."""
    over, end = 2.5 * paper_mm, beside + 4 * paper_mm
    starts = [x if at_once else beside + paper_mm for x, _ in tips]
    places = zip(tips, starts, levels, strict=True)
    return [np.array([(x, y), (at, y), (at + over, level), (end, level)]) for (x, y), at, level in places]


def _least_gap(lines: Sequence[Array]) -> float:
    """Return the least distance between two lines of corners."""
    dense = [np.vstack([np.linspace(a, b, 50) for a, b in pairwise(line)]) for line in lines]
    return min((float(cdist(one, other).min()) for one, other in combinations(dense, 2)), default=np.inf)


def texts_about(
    axes: Any,
    named: Sequence[NamedPoint],
    gap: float,
    paper_mm: float,
    *,
    levels: Sequence[float] = (),
    edge: float,
) -> list[float]:
    """Write texts about points of the outline: on the right outward of them, on the left upon the body.

    Left of the body dimensions stand. Return the heights of the texts on the right.

    Args:
        levels: heights of lines that go to the right, which texts keep clear of.
        edge: place across of a line that goes down, to the right of which a text on it moves.
    """
    right = []
    for tip, text in named:
        outward = tip[0] > 0
        away = 1 + (0.6 if outward else -1.6) * gap / np.hypot(*tip)
        x, y = tip[0] * away, tip[1] * away
        if outward:
            y = _clear_of(y, levels, _TEXT_ROOM_MM * paper_mm)
            on_edge = x - _CLEAR_MM * paper_mm < edge < x + number_mm(text) * paper_mm
            x = edge + _CLEAR_MM * paper_mm if on_edge else x
            right.append(y)
        leader(axes, tip, (x, y), text, "left")
    return right


def _clear_of(place: float, taken: Sequence[float], room: float) -> float:
    """Return the nearest place with room to all that are taken, the lower one of two."""
    near = (place, *(level + way * room for level in taken for way in (-1, 1)))
    free = [one for one in near if all(abs(one - level) > room * (1 - 1e-9) for level in taken)]
    return min(free, key=lambda one: (round(abs(one - place), 6), one))


def line_levels(places: Sequence[tuple[float, float]]) -> list[float]:
    """Return the heights of the lines of running dimensions of points, with that of the axis."""
    return sorted({round(y, 2) + 0.0 for _, y in places} | {0.0}) if places else []


def running_dimensions(
    axes: Any,
    places: Sequence[tuple[float, float]],
    corner_mm: tuple[float, float],
    paper_mm: float,
    taken: Sequence[float],
    x_way: int = 1,
) -> None:
    """Dimension points from both axes by running dimensions (ISO 129-1), beside and above the body.

    They stand right of and above a corner, clear of texts at the `taken` heights. `x_way` is -1 in a view in
    which x runs to the left.
    """
    if not places:
        return
    right, top = corner_mm
    line, over = right + 5 * paper_mm, top + 4 * paper_mm
    for y, level in _spread({round(y, 2) + 0.0 for _, y in places}, 3.4 * paper_mm, taken):
        start = max(x for x, at in places if round(at, 2) + 0.0 == y)
        corner = line + 2.5 * paper_mm
        axes.plot([start, line, corner, line + PLACE_MM * paper_mm], [y, y, level, level], color=THIN, lw=0.4)
        axes.text(corner, level + 0.3 * paper_mm, f"{y:.2f}", fontsize=TEXT_SIZE, va="bottom")
    axes.plot([0.0, line, line + 2.5 * paper_mm], [0.0, 0.0, 0.0], color=THIN, lw=0.4)
    circle(axes, 0.8 * paper_mm, 0.0, "-", 0.6, "white", x=line)
    beside = {round(x, 2) for x, _ in places if round(x, 2)}
    for x, level in _spread(beside, 3.4 * paper_mm):
        start = max(at for across, at in places if round(across, 2) == x)
        axes.plot([x, x, level], [start, over, over + 2.5 * paper_mm], color=THIN, lw=0.4)
        axes.text(
            level,
            over + 3 * paper_mm,
            f"{x_way * x:.2f}",
            fontsize=TEXT_SIZE,
            ha="center",
            va="bottom",
            rotation=90,
        )
    if beside:
        circle(axes, 0.8 * paper_mm, over, "-", 0.6, "white")


def _spread(values: Iterable[float], least: float, taken: Sequence[float] = ()) -> list[tuple[float, float]]:
    """Return each value with the place of its text, apart from the others, in order.

    It stands clear of texts whose middles are at `taken` places.
    """
    found: list[tuple[float, float]] = []
    for value in sorted(values):
        level = max(value, found[-1][1] + least) if found else value
        for place in sorted(taken):
            low, high = place - 1.6 * least, place + 0.6 * least  # a text stands on its line
            if low < level < high:
                level = low if level < place and not (found and low < found[-1][1] + least) else high
        found.append((value, level))
    return found
