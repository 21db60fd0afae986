"""Scatter plot of stiffness against mass with lines of equal stiffness per mass."""

from __future__ import annotations

import os
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.report.comparison import Comparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARKERS = "osD^vP*X"
_LINES = (0.8, 0.9, 1.0, 1.1, 1.2)
_FORMATS = (".png", ".svg", ".pdf")


def plot_stiffness_over_mass(comparison: Comparison, path: Path) -> None:
    """Draw torsional and bending stiffness over mass; dashed lines join equal stiffness per mass.

    Args:
        comparison: evaluated targets.
        path: .png, .svg or .pdf; replaced only when the plot is complete.

    Raises:
        CranktopoError: another suffix.
    """
    if path.suffix.lower() not in _FORMATS:
        raise CranktopoError(
            f"plot file '{path}': unknown format.", hint="Use .png, .svg or .pdf.", code=ExitCode.USAGE
        )
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    panels = (("torsional stiffness, kN m/rad", 1), ("bending stiffness, kN/mm", 2))
    for axes, (label, column) in zip(figure.subplots(1, 2), panels, strict=True):
        _panel(axes, comparison, label, column)
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        figure.savefig(partial, dpi=130)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _panel(axes: Axes, comparison: Comparison, label: str, column: int) -> None:
    masses = [entry.values[0] for entry in comparison.entries]
    stiffness = [entry.values[column] for entry in comparison.entries]
    x_range = 0.92 * min(masses), 1.08 * max(masses)
    y_range = 0.88 * min(stiffness), 1.12 * max(stiffness)
    axes.set(xlim=x_range, ylim=y_range, xlabel="mass of the throw, kg", ylabel=label)
    ratio = stiffness[comparison.baseline] / masses[comparison.baseline]
    for factor in _LINES:
        _equal_ratio(axes, factor, factor * ratio, x_range, y_range[1])
    for entry, x, y, marker in zip(comparison.entries, masses, stiffness, cycle(_MARKERS), strict=False):
        axes.scatter([x], [y], marker=marker, label=entry.evaluation.target, zorder=2)
    axes.legend(fontsize=8, loc="lower right")
    baseline = comparison.entries[comparison.baseline].evaluation.target
    axes.set_title(f"dashed: equal stiffness per mass, % of {baseline}", fontsize=9)


def _equal_ratio(axes: Axes, factor: float, slope: float, x_range: tuple[float, float], top: float) -> None:
    """One dashed line through the origin, labelled where it leaves the picture."""
    low, high = x_range
    axes.plot([low, high], [slope * low, slope * high], "--", color="0.75", linewidth=1, zorder=1)
    x = min(high, top / slope)
    axes.annotate(
        f"{100 * factor:.0f}",
        (x, slope * x),
        (-3, -3),
        textcoords="offset points",
        color="0.45",
        fontsize=8,
        ha="right",
        va="top",
    )
