"""Plot of a comparison: torsional and bending stiffness over mass."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.base.files import replacing
from cranktopo.base.formats import PLOTS
from cranktopo.runs.destination import check_file
from cranktopo.tasks.compare.result import Comparison
from cranktopo.tasks.fea.quantities import MASS
from cranktopo.tasks.fea.scatter import LABELS, Point, draw_stiffness_over_mass, most_by_label


def plot_stiffness_over_mass(
    comparison: Comparison, path: Path, bound: Mapping[str, Any] | None = None
) -> None:
    """Draw torsional and bending stiffness over mass; dashed lines join equal stiffness per mass.

    Args:
        path: .png, .svg or .pdf; replaced only when the plot is complete.
        bound: whose curves are drawn, where there is one; the baseline is then the original.

    Raises:
        CranktopoError: another suffix, no such folder, or the file cannot be written.
    """
    check_file(path, "--plot", PLOTS)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    plots = scatter_points(comparison)
    baseline = {label: points[comparison.baseline] for label, points in plots.items()}
    most = most_by_label((bound or {}).get("stiffest", {}), baseline)
    for axes, (label, points) in zip(figure.subplots(1, 2), plots.items(), strict=True):
        draw_stiffness_over_mass(axes, points, comparison.baseline, label, most.get(label))
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=130)


def scatter_points(comparison: Comparison) -> dict[str, list[Point]]:
    """Return the points of a comparison by the label of their stiffness."""
    return {
        label: [Point(e.name, e.values[MASS.key], e.values[stiffness.key]) for e in comparison.entries]
        for stiffness, label in LABELS.items()
    }
