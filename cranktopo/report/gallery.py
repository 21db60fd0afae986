"""Half throws side by side, in one oblique view each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.plot import GREY, Picture
from cranktopo.report.shading import ShadedMesh, draw, extent_mm, shaded, view_axes
from cranktopo.report.viewer.scene3d import ShownBody

_GALLERY_COLUMNS = 4
UP = (0.0, 1.0, 0.0)
Direction = tuple[float, float, float]
JOURNAL_SIDE: Direction = (0.75, 0.45, -0.8)
PIN_SIDE: Direction = (0.75, 0.45, 0.8)


def _gallery_figure(designs: Sequence[tuple[str, SurfaceMesh, tuple[float, float]]]) -> Figure:
    """Return one oblique view of each design beside the other, all to the same scale, on no background.

    Args:
        designs: name, closed surface of the half throw (mm) and axial range of the web of each.
    """
    return gallery([(name, shaded(mesh, web_z_mm), PIN_SIDE) for name, mesh, web_z_mm in designs])[0]


def gallery(bodies: Sequence[tuple[str, ShadedMesh, Direction]]) -> tuple[Figure, list[Axes]]:
    """Return one view of each body beside the other, all to the same scale, on no background.

    Args:
        bodies: title, what to draw, and the direction to the viewer.

    Returns:
        The figure and the axes of each body.
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
    """Still picture of half throws, side by side."""
    alt = f"Half throws of {', '.join(body.name for body in bodies)}; journals grey, webs blue"
    figure = _gallery_figure([(body.name, body.mesh, body.web_z_mm) for body in bodies])
    return Picture("gallery", figure, alt)
