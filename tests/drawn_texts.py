"""Texts of a drawing that lie over each other, over edges of the body, or beyond the frame of its sheet."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, PathPatch
from matplotlib.path import Path
from matplotlib.transforms import Bbox
from scipy.spatial.distance import cdist

from cranktopo.base.units import MM_PER_INCH

EDGE = 0.9
"""Least width in points of the edge of a body; thin lines are below."""


def drawn_boxes(figure: Figure) -> list[tuple[Any, Any, Bbox]]:
    """Axes, text and its box, a little shrunk since letters do not fill it, of all texts and titles."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw_without_rendering()
    found = []
    for axes in figure.axes:
        for text in (*axes.texts, axes._left_title):  # type: ignore[attr-defined]
            if text.get_text().strip():
                box = super(type(text), text).get_window_extent(renderer) if _annotation(text) else None
                found.append((axes, text, (box or text.get_window_extent(renderer)).expanded(0.94, 0.75)))
    return found


def _annotation(text: Any) -> bool:
    """Tell whether a text has an arrow, which its own extent takes in."""
    return getattr(text, "arrow_patch", None) is not None


def over_each_other(figure: Figure) -> list[tuple[str, str]]:
    """Pairs of texts that lie over each other."""
    pairs = combinations(drawn_boxes(figure), 2)
    return [(a.get_text(), b.get_text()) for (_, a, one), (_, b, two) in pairs if one.overlaps(two)]


def beyond_frame(figure: Figure) -> list[str]:
    """Texts that leave the frame of the sheet."""
    page, border = figure.bbox, 10.0 / MM_PER_INCH * figure.dpi
    inner = Bbox.from_extents(border, border, page.x1 - border, page.y1 - border)
    return [
        text.get_text()
        for _, text, box in drawn_boxes(figure)
        if box.x0 < inner.x0 or box.y0 < inner.y0 or box.x1 > inner.x1 or box.y1 > inner.y1
    ]


def over_edges(figure: Figure) -> list[str]:
    """Texts that an edge of a body runs through."""
    edges = {axes: list(_edges(axes)) for axes in figure.axes}
    return [
        text.get_text()
        for axes, text, box in drawn_boxes(figure)
        if any(path.intersects_bbox(box, filled=False) for path in edges[axes])
    ]


def over_lines(figure: Figure) -> list[str]:
    """Texts without a white ground on hatching, or that a line runs through: a dimension, a leader."""
    lines = {axes: list(_lines(axes)) for axes in figure.axes}
    hatched = {axes: [one for one in axes.patches if one.get_hatch()] for axes in figure.axes}
    return [
        text.get_text()
        for axes, text, box in drawn_boxes(figure)
        if text.get_bbox_patch() is None
        and (
            any(path.intersects_bbox(_ringed(axes, text, box), filled=False) for path in lines[axes])
            or any(
                one.contains_point((box.x0 + box.x1, box.y0 + box.y1) / np.array(2)) for one in hatched[axes]
            )
        )
    ]


def near_leaders(figure: Figure, least_mm: float = 1.0) -> list[tuple[str, str]]:
    """Texts of a column whose leaders come closer to each other than so much paper, as if they were one."""
    found = []
    for axes in figure.axes:
        for (one, a), (other, b) in combinations(leaders(axes), 2):
            apart = float(cdist(_along(a), _along(b)).min()) * MM_PER_INCH / figure.dpi
            if apart < least_mm:
                found.append((one, other))
    return found


def leaders(axes: Any) -> Iterator[tuple[str, Any]]:
    """Texts of a column with the corners of their leaders, in pixels: one ends at the height of its text."""
    levels = {float(text.get_position()[1]): text.get_text() for text in axes.texts if text.get_text()}
    for line in axes.lines:
        end = float(line.get_ydata()[-1])
        if len(line.get_xdata()) == 4 and end in levels:
            yield levels[end], axes.transData.transform(line.get_xydata())


def _along(corners: Any) -> Any:
    return np.vstack([np.linspace(a, b, 60) for a, b in pairwise(corners)])


def _ringed(axes: Any, text: Any, box: Bbox) -> Bbox:
    """Return the box of the thin circle around a text, that of the text where it has none."""
    at = text.get_position()
    rings = (one for one in axes.patches if isinstance(one, Circle) and np.allclose(one.center, at))
    ring = next((one for one in rings if one.get_linewidth() < EDGE), None)
    return box if ring is None else ring.get_window_extent().expanded(0.9, 0.9)


def _lines(axes: Any) -> Iterator[Path]:
    """All lines of axes, in pixels."""
    yield from _edges(axes)
    for line in axes.lines:
        if len(line.get_xdata()) > 1:
            yield Path(axes.transData.transform(line.get_xydata()))
    for arrow in (text.arrow_patch for text in axes.texts if _annotation(text)):
        path = arrow.get_path().transformed(arrow.get_transform())
        yield from (Path(one) for one in path.to_polygons(closed_only=False))


def _edges(axes: Any) -> Iterator[Path]:
    """Thick lines of axes, in pixels: of the body's edges, not of frames around texts."""
    for line in axes.lines:
        if line.get_linewidth() >= EDGE and line.get_linestyle() in ("-", "--") and len(line.get_xdata()) > 1:
            yield Path(axes.transData.transform(line.get_xydata()))
    for patch in axes.patches:
        if isinstance(patch, PathPatch | Circle) and patch.get_linewidth() >= EDGE:
            path = patch.get_transform().transform_path(patch.get_path())
            # one by one: matplotlib's check takes the way from one polygon to the next for an edge
            yield from (Path(one) for one in path.to_polygons(closed_only=False))
    for chains in (one for one in axes.collections if isinstance(one, LineCollection)):
        for path in chains.get_paths():
            yield Path(axes.transData.transform(np.asarray(path.vertices)))
