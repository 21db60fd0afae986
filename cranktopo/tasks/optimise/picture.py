"""One picture of a run: the half throw from four sides and the convergence of the optimiser."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.plot import GREY, plain, plain_decades, png
from cranktopo.report.shading import ShadedMesh, draw, extent_mm, shaded, view_axes
from cranktopo.report.viewer.scene3d import JOURNAL_SIDE, PIN_SIDE, UP, Direction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_History = Sequence[Mapping[str, Any]]
# Name, direction to the viewer, axis labels (none: not along the axes).
_VIEWS: tuple[tuple[str, Direction, tuple[str, str] | None], ...] = (
    ("from the journal side", JOURNAL_SIDE, None),
    ("from the crankpin side", PIN_SIDE, None),
    ("front, from the crankpin side", (0.0, 0.0, 1.0), ("x, lateral (mm)", "y, throw (mm)")),
    ("side", (-1.0, 0.0, 0.0), ("z, crank axis (mm)", "y, throw (mm)")),
)


class RunPictures(NamedTuple):
    """PNGs of a run: the half throw from four sides with the convergence, and the four views alone."""

    run: bytes
    views: bytes


def run_pictures(
    mesh: SurfaceMesh, history: _History, title: str, web_z_mm: tuple[float, float]
) -> RunPictures:
    """Draw the pictures of a run, in any process; what is outside `web_z_mm` is drawn as journal.

    The rows of `history` have `iteration` and any of the columns of history.csv.
    """
    body = shaded(mesh, web_z_mm)
    return RunPictures(png(run_figure(body, history, title)), png(views_figure(body)))


def run_figure(body: ShadedMesh, history: _History, title: str) -> Figure:
    """Return the picture of a run as a figure of its own: no global matplotlib state is read or changed."""
    figure = _sheet(9.2, 140, "white")
    figure.suptitle(title, x=0.035, y=0.975, ha="left", fontsize=15, fontweight="bold")
    _draw_views(figure, body, bottom=0.43, top=0.91)
    _draw_curves(figure, history)
    return figure


def views_figure(body: ShadedMesh) -> Figure:
    """Return the four views alone, on no background."""
    figure = _sheet(4.9, 110, "none")
    _draw_views(figure, body, bottom=0.11, top=0.93)
    for axes in figure.axes:
        axes.set_facecolor("none")
    return figure


def _sheet(height_inches: float, dpi: int, facecolor: str) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, height_inches), dpi=dpi, facecolor=facecolor)
    FigureCanvasAgg(figure)
    return figure


def _draw_views(figure: Figure, body: ShadedMesh, bottom: float, top: float) -> None:
    """Draw four views in one row, all to the same scale."""
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


def _draw_curves(figure: Figure, history: _History) -> None:
    grid = figure.add_gridspec(
        1, 3, left=0.06, right=0.975, top=0.34, bottom=0.075, wspace=0.22, width_ratios=(1.5, 1, 1)
    )
    for number, panel in enumerate(PANELS):
        panel(figure.add_subplot(grid[number]), history)
    if figure.axes[-len(PANELS)].get_legend_handles_labels()[0]:
        figure.axes[-len(PANELS)].legend(
            fontsize=9, frameon=False, loc="upper right", bbox_to_anchor=(1.0, 0.94)
        )


_CASE_KEY = "_compliance_N_mm"
_COLOURS = ("#1f6fb4", "#d1632a", "#2c8c4f", "#8a4fa3")


def _compliances_panel(axes: Any, history: _History) -> None:
    """Draw the compliance of every load case and the objective, each over its first value."""
    _draw_compliances(axes, history)
    _frame(axes, history)
    if not history:
        axes.text(0.5, 0.5, "no history", transform=axes.transAxes, ha="center", color=GREY)


def _fraction_panel(key: str, label: str, axes: Any, history: _History) -> None:
    _draw_fraction(axes, history, key, label)
    if key == "greyness":
        axes.set_ylim(0.0, max(axes.get_ylim()[1], 0.05))
    _frame(axes, history)


PANELS: tuple[Callable[[Any, _History], None], ...] = (
    _compliances_panel,
    partial(_fraction_panel, "volume_fraction", "volume fraction (-)"),
    partial(_fraction_panel, "greyness", "greyness (-)"),
)


def _frame(axes: Any, history: _History) -> None:
    axes.set_xlabel("iteration", fontsize=9)
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)
    _mark_projection(axes, history)


def _draw_compliances(axes: Any, history: _History) -> None:
    keys = [key for key in dict.fromkeys(k for row in history for k in row) if key.endswith(_CASE_KEY)]
    lowest, highest = 1.0, 1.0
    lines = [(key, key.removesuffix(_CASE_KEY), "-") for key in keys] + [("objective", "objective", "--")]
    for number, (key, name, style) in enumerate(lines):
        steps, values = _series(history, key)
        if not values or values[0] == 0:
            continue
        relative = [value / values[0] for value in values]
        lowest, highest = min(lowest, *relative), max(highest, *relative)
        unit = "" if key == "objective" else f", {values[-1]:.4g} N mm"
        colour = "black" if key == "objective" else _COLOURS[number % len(_COLOURS)]
        text = f"{name}: {relative[-1]:.3g} of its start{unit}"
        axes.plot(steps, relative, style, color=colour, linewidth=1.6, label=text)
    if highest > 8 * lowest > 0:
        axes.set_yscale("log")
        plain_decades(axes.yaxis)
    axes.set_ylabel("compliance over its start (-)", fontsize=9)


def _draw_fraction(axes: Any, history: _History, key: str, label: str) -> None:
    steps, values = _series(history, key)
    axes.plot(steps, values, color=_COLOURS[0], linewidth=1.6)
    axes.set_ylabel(label, fontsize=9)
    if values:  # a converged constraint is no reason to magnify rounding
        middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
        half = max(1.1 * half, 0.05 * middle)
        axes.set_ylim(middle - half, middle + half)


def _mark_projection(axes: Any, history: _History) -> None:
    """Draw thin lines where the sharpness of the projection changes: the curves jump there.

    They are named above the axes, where no curve goes.
    """
    steps, betas = _series(history, "beta")
    for before, now, step in zip(betas, betas[1:], steps[1:], strict=False):
        if now != before:
            axes.axvline(step, color="0.6", linewidth=0.8, linestyle=":")
            axes.annotate(
                f"β {now:g}",
                (step, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, 2),
                textcoords="offset points",
                ha="center",
                fontsize=7,
                color=GREY,
            )


def _series(history: _History, key: str) -> tuple[list[float], list[float]]:
    rows = [row for row in history if row.get(key) is not None]
    return [float(row["iteration"]) for row in rows], [float(row[key]) for row in rows]
