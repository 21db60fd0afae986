"""Drawing of a parametric web: front view, sections and the table of its dimensions, in mm."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.errors import invalid
from cranktopo.report.figures.drafting import GHOST, INK
from cranktopo.report.figures.drawing_views import Sheet, cross_section, front_view, lengthwise_section
from cranktopo.scene import Scene

if TYPE_CHECKING:
    from cranktopo.triangles.surface_mesh import SurfaceMesh


def write_drawing(
    scene: Scene, fitted: SurfaceMesh, body: SurfaceMesh, notes: list[str], paths: list[Path]
) -> None:
    """Draw a profile web with its dimensions over the outline of the body it was fitted to.

    Args:
        body: closed surface of the extracted half throw, drawn as dashed lines.
        paths: files to write; each ending gives its format.

    Raises:
        CranktopoError: another outline than a profile.
    """
    from matplotlib.figure import Figure

    from cranktopo.triangles.surface_mesh import solid_of

    if scene.web.outline != "profile":
        raise invalid("web.outline", scene.web.outline, "only a profile web has a drawing")
    sheet = Sheet(
        scene,
        scene.web,
        solid_of(fitted, "fitted half throw"),
        solid_of(body, "surface to be re-modelled"),
    )
    figure = Figure(figsize=(16.5, 11.7))
    grid = figure.add_gridspec(
        2,
        3,
        width_ratios=(1.35, 0.95, 0.85),
        height_ratios=(1.75, 1),
        left=0.04,
        right=0.98,
        top=0.94,
        bottom=0.05,
        wspace=0.12,
        hspace=0.16,
    )
    front_view(figure.add_subplot(grid[0, 0]), sheet)
    lengthwise_section(figure.add_subplot(grid[0, 1]), sheet)
    cross_section(figure.add_subplot(grid[1, 0]), sheet)
    _tables(figure.add_subplot(grid[:, 2]), sheet)
    _title_block(figure.add_subplot(grid[1, 1]), notes)
    figure.suptitle(
        f"{scene.name}: crank web, dimensions in mm", x=0.04, ha="left", fontsize=14, weight="bold"
    )
    for path in paths:
        figure.savefig(path, dpi=130)


def _tables(axes: Any, sheet: Sheet) -> None:
    """Stations and features with every number that the scene holds."""
    web = sheet.web
    stations = enumerate(zip(web.stations_mm, web.half_widths_mm, strict=True), start=1)
    _legend(axes)
    lines = ["OUTLINE      y   half-width", *(f"   {i:2d}  {y:8.2f}  {h:8.2f}" for i, (y, h) in stations)]
    for feature in sheet.features:
        lines += feature.lines
    axes.text(0, 1, "\n".join(lines), va="top", family="monospace", fontsize=9, transform=axes.transAxes)
    axes.axis("off")


def _title_block(axes: Any, notes: list[str]) -> None:
    axes.text(0, 1, "\n".join(notes), va="top", fontsize=9, transform=axes.transAxes, linespacing=1.5)
    axes.axis("off")


def _legend(axes: Any) -> None:
    axes.plot([], [], color=INK, lw=1.6, label="parametric web")
    axes.plot([], [], color=GHOST, lw=1, ls="--", label="extracted body")
    axes.legend(loc="lower left", frameon=False, fontsize=9)
