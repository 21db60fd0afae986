"""One picture of a run: the half throw from four sides and the convergence of the optimiser."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.base.files import write_bytes
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.axes_style import GREY, plain
from cranktopo.report.gallery import JOURNAL_SIDE, PIN_SIDE, UP, Direction
from cranktopo.report.png import png
from cranktopo.report.shading import draw, extent_mm, shaded, view_axes
from cranktopo.tasks.optimise.convergence import PANELS

# Name, direction to the viewer, axis labels (none: not along the axes).
_VIEWS: tuple[tuple[str, Direction, tuple[str, str] | None], ...] = (
    ("from the journal side", JOURNAL_SIDE, None),
    ("from the crankpin side", PIN_SIDE, None),
    ("front, from the crankpin side", (0.0, 0.0, 1.0), ("x, lateral (mm)", "y, throw (mm)")),
    ("side", (-1.0, 0.0, 0.0), ("z, crank axis (mm)", "y, throw (mm)")),
)


def save_run_picture(
    path: Path,
    mesh: SurfaceMesh,
    history: Sequence[Mapping[str, Any]],
    title: str,
    web_z_mm: tuple[float, float],
) -> None:
    """Write the picture of a run as PNG, atomically.

    Args:
        web_z_mm: axial range of the web (journal face, pin face); the rest is drawn as journal.

    Raises:
        CranktopoError: the file cannot be written.
    """
    write_bytes(path, png(run_figure(mesh, history, title, web_z_mm)))


def run_figure(
    mesh: SurfaceMesh, history: Sequence[Mapping[str, Any]], title: str, web_z_mm: tuple[float, float]
) -> Figure:
    """The picture of a run as a figure of its own: no global matplotlib state is read or changed.

    Args:
        history: one row per iteration with `iteration` and any of `objective`, `<case>_compliance_N_mm`,
            `volume_fraction`, `greyness`, `beta`.
        web_z_mm: axial range of the web (journal face, pin face); the rest is drawn as journal.
    """
    figure = Figure(figsize=(15, 9.2), dpi=140, facecolor="white")
    FigureCanvasAgg(figure)
    figure.suptitle(title, x=0.035, y=0.975, ha="left", fontsize=15, fontweight="bold")
    _draw_views(figure, mesh, web_z_mm, bottom=0.43, top=0.91)
    _draw_curves(figure, history)
    return figure


def views_figure(mesh: SurfaceMesh, web_z_mm: tuple[float, float]) -> Figure:
    """The four views alone, on no background.

    Args:
        web_z_mm: axial range of the web (journal face, pin face); the rest is drawn as journal.
    """
    figure = Figure(figsize=(15, 4.9), dpi=110, facecolor="none")
    FigureCanvasAgg(figure)
    _draw_views(figure, mesh, web_z_mm, bottom=0.11, top=0.93)
    for axes in figure.axes:
        axes.set_facecolor("none")
    return figure


def _draw_views(
    figure: Figure, mesh: SurfaceMesh, web_z_mm: tuple[float, float], bottom: float, top: float
) -> None:
    """Four views in one row, all to the same scale."""
    body = shaded(mesh, web_z_mm)
    views = [view_axes(side, UP) for _, side, _ in _VIEWS]
    extents = [extent_mm(body, view) for view in views]
    height = 1.06 * max(np.ptp(extent[:, 1]) for extent in extents)
    widths = [1.10 * np.ptp(extent[:, 0]) for extent in extents]
    grid = figure.add_gridspec(
        1, 4, left=0.02, right=0.985, top=top, bottom=bottom, wspace=0.22, width_ratios=widths
    )
    for number, (name, _, labels) in enumerate(_VIEWS):
        axes = figure.add_subplot(grid[number])
        draw(axes, body, views[number])
        right, up = extents[number].mean(axis=0)
        axes.set_xlim(right - widths[number] / 2, right + widths[number] / 2)
        axes.set_ylim(up - height / 2, up + height / 2)
        axes.set_title(name, fontsize=10, color=GREY)
        if labels is None:
            axes.set_axis_off()
        else:
            axes.set_xlabel(labels[0], fontsize=9)
            axes.set_ylabel(labels[1], fontsize=9)
            plain(axes)


def _draw_curves(figure: Figure, history: Sequence[Mapping[str, Any]]) -> None:
    grid = figure.add_gridspec(
        1, 3, left=0.06, right=0.975, top=0.34, bottom=0.075, wspace=0.22, width_ratios=(1.5, 1, 1)
    )
    for number, panel in enumerate(PANELS):
        panel(figure.add_subplot(grid[number]), history)
