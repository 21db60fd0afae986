"""Scatter plot of stiffness against mass with lines of equal stiffness per mass."""

from __future__ import annotations

import os
from pathlib import Path

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.report.comparison import Comparison

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


def _panel(axes: object, comparison: Comparison, label: str, column: int) -> None:
    import matplotlib.axes

    if not isinstance(axes, matplotlib.axes.Axes):
        raise TypeError(axes)
    masses = [entry.values[0] for entry in comparison.entries]
    stiffness = [entry.values[column] for entry in comparison.entries]
    low, high = 0.92 * min(masses), 1.08 * max(masses)
    ratio = stiffness[comparison.baseline] / masses[comparison.baseline]
    axes.set_xlim(low, high)
    axes.set_ylim(0.88 * min(stiffness), 1.12 * max(stiffness))
    for factor in _LINES:
        line = [factor * ratio * low, factor * ratio * high]
        axes.plot([low, high], line, "--", color="0.75", linewidth=1, zorder=1)
        axes.annotate(f"{100 * factor:.0f} %", (high, line[1]), color="0.5", fontsize=8, annotation_clip=True)
    axes.scatter(masses, stiffness, zorder=2)
    for entry, x, y in zip(comparison.entries, masses, stiffness, strict=True):
        axes.annotate(entry.evaluation.target, (x, y), (5, 5), textcoords="offset points", fontsize=8)
    axes.set_xlabel("mass of the throw, kg")
    axes.set_ylabel(label)
    axes.set_title(f"dashed: equal stiffness per mass, % of {_baseline(comparison)}", fontsize=9)


def _baseline(comparison: Comparison) -> str:
    return comparison.entries[comparison.baseline].evaluation.target
