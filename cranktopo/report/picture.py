"""One picture of a run: the half throw from four sides and the convergence of the optimiser."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.report.shading import draw, extent_mm, shaded, view_axes
from cranktopo.store.files import write_bytes
from cranktopo.surface.mesh import SurfaceMesh

_UP = (0.0, 1.0, 0.0)
_GREY = "0.35"
# Name, direction to the viewer, axis labels (none: not along the axes).
_VIEWS: tuple[tuple[str, tuple[float, float, float], tuple[str, str] | None], ...] = (
    ("from the journal side", (0.75, 0.45, -0.8), None),
    ("from the crankpin side", (0.75, 0.45, 0.8), None),
    ("front, from the crankpin side", (0.0, 0.0, 1.0), ("x, lateral (mm)", "y, throw (mm)")),
    ("side", (-1.0, 0.0, 0.0), ("z, crank axis (mm)", "y, throw (mm)")),
)
_CASE_KEY = "_compliance_N_mm"
_COLOURS = ("#1f6fb4", "#d1632a", "#2c8c4f", "#8a4fa3")


def save_run_picture(
    path: Path,
    mesh: SurfaceMesh,
    history: Sequence[Mapping[str, Any]],
    title: str,
    web_z_mm: tuple[float, float],
) -> None:
    """Write the picture of a run as PNG, atomically.

    Args:
        path: the file.
        mesh: closed surface of the half throw, mm.
        history: rows as `run_figure` takes them.
        title: headline.
        web_z_mm: axial range of the web (journal face, pin face); the rest is drawn as journal.

    Raises:
        CranktopoError: the file cannot be written.
    """
    png = io.BytesIO()
    run_figure(mesh, history, title, web_z_mm).savefig(png, format="png")
    write_bytes(path, png.getvalue())


def run_figure(
    mesh: SurfaceMesh, history: Sequence[Mapping[str, Any]], title: str, web_z_mm: tuple[float, float]
) -> Figure:
    """The picture of a run as a figure of its own: no global matplotlib state is read or changed.

    Args:
        mesh: closed surface of the half throw, mm.
        history: one row per iteration with `iteration` and any of `objective`, `<case>_compliance_N_mm`,
            `volume_fraction`, `greyness`, `beta`.
        title: headline.
        web_z_mm: axial range of the web (journal face, pin face); the rest is drawn as journal.
    """
    figure = Figure(figsize=(15, 9.2), dpi=180, facecolor="white")
    FigureCanvasAgg(figure)
    figure.suptitle(title, x=0.035, y=0.975, ha="left", fontsize=15, fontweight="bold")
    _draw_views(figure, mesh, web_z_mm)
    _draw_curves(figure, history)
    return figure


def _draw_views(figure: Figure, mesh: SurfaceMesh, web_z_mm: tuple[float, float]) -> None:
    """Four views in one row, all to the same scale."""
    body = shaded(mesh, web_z_mm)
    views = [view_axes(side, _UP) for _, side, _ in _VIEWS]
    extents = [extent_mm(body, view) for view in views]
    height = 1.06 * max(np.ptp(extent[:, 1]) for extent in extents)
    widths = [1.10 * np.ptp(extent[:, 0]) for extent in extents]
    grid = figure.add_gridspec(
        1, 4, left=0.02, right=0.985, top=0.91, bottom=0.43, wspace=0.22, width_ratios=widths
    )
    for number, (name, _, labels) in enumerate(_VIEWS):
        axes = figure.add_subplot(grid[number])
        draw(axes, body, views[number])
        right, up = extents[number].mean(axis=0)
        axes.set_xlim(right - widths[number] / 2, right + widths[number] / 2)
        axes.set_ylim(up - height / 2, up + height / 2)
        axes.set_title(name, fontsize=10, color=_GREY)
        if labels is None:
            axes.set_axis_off()
        else:
            axes.set_xlabel(labels[0], fontsize=9)
            axes.set_ylabel(labels[1], fontsize=9)
            _plain(axes)


def _draw_curves(figure: Figure, history: Sequence[Mapping[str, Any]]) -> None:
    grid = figure.add_gridspec(
        1, 3, left=0.06, right=0.975, top=0.34, bottom=0.075, wspace=0.22, width_ratios=(1.5, 1, 1)
    )
    compliance, volume, greyness = (figure.add_subplot(grid[number]) for number in range(3))
    _draw_compliances(compliance, history)
    _draw_share(volume, history, "volume_fraction", "volume fraction (-)")
    _draw_share(greyness, history, "greyness", "greyness (-)")
    greyness.set_ylim(0.0, max(greyness.get_ylim()[1], 0.05))
    for axes in (compliance, volume, greyness):
        axes.set_xlabel("iteration", fontsize=9)
        axes.grid(color="0.9", linewidth=0.8)
        _plain(axes)
        _mark_projection(axes, history)
    if not history:
        compliance.text(0.5, 0.5, "no history", transform=compliance.transAxes, ha="center", color=_GREY)


def _draw_compliances(axes: Any, history: Sequence[Mapping[str, Any]]) -> None:
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
    axes.set_ylabel("compliance over its start (-)", fontsize=9)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=9, frameon=False)


def _draw_share(axes: Any, history: Sequence[Mapping[str, Any]], key: str, label: str) -> None:
    steps, values = _series(history, key)
    axes.plot(steps, values, color=_COLOURS[0], linewidth=1.6)
    axes.set_ylabel(label, fontsize=9)
    if values:  # a converged constraint is no reason to magnify rounding
        middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
        half = max(1.1 * half, 0.05 * middle)
        axes.set_ylim(middle - half, middle + half)


def _mark_projection(axes: Any, history: Sequence[Mapping[str, Any]]) -> None:
    """Thin lines where the sharpness of the projection changes: the curves jump there."""
    steps, betas = _series(history, "beta")
    for before, now, step in zip(betas, betas[1:], steps[1:], strict=False):
        if now != before:
            axes.axvline(step, color="0.6", linewidth=0.8, linestyle=":")
            axes.annotate(
                f"β {now:g}",
                (step, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(2, -9),
                textcoords="offset points",
                fontsize=7,
                color=_GREY,
            )


def _series(history: Sequence[Mapping[str, Any]], key: str) -> tuple[list[float], list[float]]:
    rows = [row for row in history if row.get(key) is not None]
    return [float(row["iteration"]) for row in rows], [float(row[key]) for row in rows]


def _plain(axes: Any) -> None:
    axes.tick_params(labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
