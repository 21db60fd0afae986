"""Drawing of a parametric web: front view, sections and the table of its dimensions, in mm."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.cad.solid_files import surface_of
from cranktopo.errors import invalid
from cranktopo.report.drafting import GHOST, INK
from cranktopo.report.drawing_views import Sheet, cross_section, front_view, lengthwise_section
from cranktopo.scene import Scene
from cranktopo.scene.bevel import bevel_arc
from cranktopo.scene.geometry import EndBevel, Pocket, ProfileWeb

if TYPE_CHECKING:
    from cranktopo.triangles.surface_mesh import SurfaceMesh


def write_drawing(scene: Scene, surface: SurfaceMesh, notes: list[str], paths: list[Path]) -> None:
    """Draw a profile web with its dimensions over the outline of the body it was fitted to.

    Args:
        scene: a design with a profile web.
        surface: closed surface of the extracted half throw, drawn as dashed lines.
        notes: lines of the title block.
        paths: files to write; each ending gives its format.

    Raises:
        CranktopoError: another outline than a profile.
    """
    from matplotlib.figure import Figure

    from cranktopo.triangles.surface_mesh import solid_of

    if not isinstance(scene.web, ProfileWeb):
        raise invalid("web.outline", scene.web.outline, "only a profile web has a drawing")
    exact = surface_of(scene, "half")
    sheet = Sheet(
        scene,
        scene.web,
        solid_of(exact, "fitted half throw"),
        solid_of(surface, "surface to be re-modelled"),
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
    """Stations, bevels and pockets with every number that the scene holds."""
    web = sheet.web
    stations = enumerate(zip(web.stations_mm, web.half_widths_mm, strict=True), start=1)
    _legend(axes)
    lines = ["OUTLINE      y   half-width", *(f"   {i:2d}  {y:8.2f}  {h:8.2f}" for i, (y, h) in stations)]
    for bevel in web.bevel:
        lines += _bevel_lines(sheet.scene, bevel)
    for pocket in web.pocket:
        lines += _pocket_lines(pocket, web.stations_mm)
    axes.text(0, 1, "\n".join(lines), va="top", family="monospace", fontsize=9, transform=axes.transAxes)
    axes.axis("off")


def _bevel_lines(scene: Scene, bevel: EndBevel) -> list[str]:
    arc = bevel_arc(scene.web, scene.throw.radius_mm, bevel)
    angle = np.degrees(np.arctan2(arc.end_mm - arc.start_mm, arc.depth_mm))
    shape = f"R {arc.radius_mm:.1f}" if np.isfinite(arc.radius_mm) else "plane"
    return [
        "",
        f"BEVEL on the {bevel.face} face",
        f"   from y {bevel.y_mm:.2f}, depth {bevel.depth_mm:.2f}",
        f"   chord {angle:.1f}° to the crank axis, {shape}",
    ]


def _pocket_lines(pocket: Pocket, stations_mm: Sequence[float]) -> list[str]:
    values = pocket.model_dump(exclude={"shape", "face"}, exclude_none=True)
    title = "POCKET side" if pocket.shape == "side" else f"POCKET {pocket.shape}, {pocket.face}"
    if pocket.shape == "side" and pocket.length_mm > stations_mm[-1] - stations_mm[0]:
        title = "GROOVE on both sides, through both ends"
    lines = ["", title]
    for name, value in values.items():
        word, unit = name.rsplit("_", 1)
        lines.append(f"   {word.replace('_', ' ')} {value:.2f}{'°' if unit == 'deg' else ''}")
    return lines


def _title_block(axes: Any, notes: list[str]) -> None:
    axes.text(0, 1, "\n".join(notes), va="top", fontsize=9, transform=axes.transAxes, linespacing=1.5)
    axes.axis("off")


def _legend(axes: Any) -> None:
    axes.plot([], [], color=INK, lw=1.6, label="parametric web")
    axes.plot([], [], color=GHOST, lw=1, ls="--", label="extracted body")
    axes.legend(loc="lower left", frameon=False, fontsize=9)
