"""Half throws side by side, in one oblique view each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.report.plot import GREY, Picture
from cranktopo.report.shading import ShadedMesh, draw, extent_mm, shaded, view_axes
from cranktopo.report.viewer.scene3d import ShownBody

_GALLERY_COLUMNS = 4
UP = (0.0, 1.0, 0.0)
Direction = tuple[float, float, float]
JOURNAL_SIDE: Direction = (0.75, 0.45, -0.8)
PIN_SIDE: Direction = (0.75, 0.45, 0.8)


def gallery(bodies: Sequence[tuple[str, ShadedMesh, Direction]]) -> tuple[Figure, list[Axes]]:
    """Return a figure of bodies side by side, all to the same scale, on no background, and the axes of each.

    Each has a title and a direction to the viewer.
    """
    columns = min(len(bodies), _GALLERY_COLUMNS)
    rows = -(-len(bodies) // columns)
    figure = Figure(figsize=(3.75 * columns, 4.0 * rows), dpi=110, facecolor="none")
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=1 - 0.08 / rows, wspace=0.03, hspace=0.1)
    FigureCanvasAgg(figure)
    views = [view_axes(side, UP) for _, _, side in bodies]
    extents = [extent_mm(body, view) for (_, body, _), view in zip(bodies, views, strict=True)]
    half = 0.53 * max(np.ptp(extent, axis=0).max() for extent in extents)
    found = []
    for number, ((name, body, _), view, extent) in enumerate(
        zip(bodies, views, extents, strict=True), start=1
    ):
        axes = figure.add_subplot(rows, columns, number)
        draw(axes, body, view)
        right, up = extent.mean(axis=0)
        axes.set_xlim(right - half, right + half)
        axes.set_ylim(up - half, up + half)
        axes.set_title(name, fontsize=10, color=GREY)
        axes.set_axis_off()
        found.append(axes)
    return figure, found


def gallery_picture(bodies: Sequence[ShownBody]) -> Picture:
    """Return a still picture of half throws, side by side."""
    alt = f"Half throws of {', '.join(body.name for body in bodies)}; journals grey, webs blue"
    figure, _ = gallery([(body.name, shaded(body.mesh, body.web_z_mm), PIN_SIDE) for body in bodies])
    return Picture("gallery", figure, alt)
