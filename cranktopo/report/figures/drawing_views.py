"""Views of a profile web: front, section through both axes, section across; dimensions in mm."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.report.figures.drafting import INK, TEXT_SIZE, THIN, circle, dimension, finish, ghost, hatched
from cranktopo.scene import Scene
from cranktopo.scene.features import ProfileWeb
from cranktopo.scene.features.primitives import Circle, Dimension, FeatureDrawing, Polyline

if TYPE_CHECKING:
    from manifold3d import Manifold

Array = NDArray[np.float64]
_POINTS = 400


@dataclass(frozen=True)
class Sheet:
    """What is drawn.

    Attributes:
        solid: its exact half throw, triangulated.
        body: the extracted half throw, drawn as a ghost.
    """

    scene: Scene
    web: ProfileWeb
    solid: Manifold
    body: Manifold

    @property
    def features(self) -> list[FeatureDrawing]:
        """How each feature of the web appears."""
        return [feature.drawing(self.scene) for _, _, feature in self.web.features()]


def front_view(axes: Any, sheet: Sheet) -> None:
    """View along the crank axis from the crankpin side: outline with its stations, features."""
    web, radius = sheet.web, sheet.scene.throw.radius_mm
    low, high = web.y_range_mm(radius)
    y = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(0, np.pi, _POINTS))
    half = web.half_width_mm(radius, y)
    hatched(axes, [np.column_stack([np.r_[half, -half[::-1]], np.r_[y, y[::-1]]])], "")
    ghost(axes, sheet.body.project().to_polygons())
    _journals(axes, sheet.scene)
    for stroke in (stroke for feature in sheet.features for stroke in feature.front):
        _edges(axes, stroke)
    widest, place = web.largest_half_width_mm, float(y[np.argmax(half)])
    dimension(axes, (-widest, place), (widest, place), (0, low - 9 - place), f"{2 * widest:.2f}")
    dimension(axes, (-widest - 9, low), (-widest - 9, high), (-5, 0), f"{high - low:.2f}")
    dimension(axes, (-widest - 2, low), (-widest - 2, 0), (-4, 0), f"{-low:.2f}")
    dimension(axes, (-widest - 2, 0), (-widest - 2, radius), (-4, 0), f"{radius:g}")
    for station, width in zip(web.stations_mm, web.half_widths_mm, strict=True):
        axes.plot([width, widest + 4], [station, station], color=THIN, lw=0.5)
        axes.plot(width, station, "o", ms=3.2, color=INK)
        label = f"y {station:.2f}   half-width {width:.2f}"
        axes.text(widest + 5, station, label, fontsize=TEXT_SIZE, va="center")
    axes.set_xlim(-widest - 20, widest + 40)
    axes.set_ylim(low - 13, high + 5)
    finish(axes, "front, from the crankpin side")


def lengthwise_section(axes: Any, sheet: Sheet) -> None:
    """Section through both axes: crank axis to the right, throw upward."""
    scene, web = sheet.scene, sheet.web
    start, end = scene.web_z_mm
    low, high = web.y_range_mm(scene.throw.radius_mm)
    solid, body = (_section_x(which) for which in (sheet.solid, sheet.body))
    hatched(axes, solid)
    ghost(axes, body)
    for centre in (0.0, scene.throw.radius_mm):
        axes.plot([-3, scene.pitch_mm / 2 + 3], [centre, centre], color=THIN, lw=0.6, ls="-.")
    dimension(axes, (start, low), (end, low), (0, -8), f"{web.thickness_mm:g}")
    for feature in sheet.features:
        _dimensions(axes, feature.lengthwise)
    axes.set_xlim(-8, scene.pitch_mm / 2 + 8)
    axes.set_ylim(low - 13, high + 9)
    finish(axes, "section x = 0")


def cross_section(axes: Any, sheet: Sheet) -> None:
    """Section where a feature shows best, or half-way between the axes: x to the right, crank axis upward."""
    scene, web = sheet.scene, sheet.web
    start, end = scene.web_z_mm
    shown = next((feature for feature in sheet.features if feature.section_y_mm is not None), None)
    y = scene.throw.radius_mm / 2 if shown is None or shown.section_y_mm is None else shown.section_y_mm
    half = float(web.half_width_mm(scene.throw.radius_mm, np.array([y]))[0])
    hatched(axes, _section_y(sheet.solid, y))
    ghost(axes, _section_y(sheet.body, y))
    dimension(axes, (-half, start), (half, start), (0, -6), f"{2 * half:.2f}")
    dimension(axes, (-half, start), (-half, end), (-7, 0), f"{web.thickness_mm:g}")
    if shown is not None:
        _dimensions(axes, shown.across)
    axes.set_xlim(-half - 16, half + 18)
    axes.set_ylim(start - 12, end + 12)
    finish(axes, f"section y = {y:.2f}")


def _section_x(solid: Manifold) -> list[Array]:
    """Polygons (z, y) of the section x = 0."""
    turned = solid.rotate((0.0, -90.0, 0.0)).slice(0.0)
    return [np.asarray(polygon) * (-1.0, 1.0) for polygon in turned.to_polygons()]


def _section_y(solid: Manifold, y_mm: float) -> list[Array]:
    """Polygons (x, z) of a section across the throw."""
    turned = solid.translate((0.0, -y_mm, 0.0)).rotate((-90.0, 0.0, 0.0)).slice(0.0)
    return [np.asarray(polygon) for polygon in turned.to_polygons()]


def _journals(axes: Any, scene: Scene) -> None:
    throw = scene.throw
    for journal, y, name in (
        (throw.main_journal, 0.0, "main journal"),
        (throw.crankpin, throw.radius_mm, "crankpin"),
    ):
        circle(axes, journal.radius_mm, y, "--" if name == "main journal" else "-", 1.0)
        if journal.bore_radius_mm:
            circle(axes, journal.bore_radius_mm, y, "-", 1.4, "white")
        bore = f", bore ⌀{journal.bore_diameter_mm:g}" if journal.bore_diameter_mm else ""
        fillet = f"\nfillet R{journal.fillet_mm:g}" if journal.fillet_mm else ""
        text = f"{name}\n⌀{journal.outer_diameter_mm:g}{bore}{fillet}"
        clear = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
        axes.text(0, y, text, ha="center", va="center", fontsize=TEXT_SIZE, color=INK, bbox=clear)


def _edges(axes: Any, stroke: Circle | Polyline) -> None:
    """An edge of a feature, dashed where it is hidden."""
    style, width = ("--" if stroke.hidden else "-"), 1.0
    if isinstance(stroke, Circle):
        x, y = stroke.centre
        circle(axes, stroke.radius, y, style, width, x=x)
        axes.text(x, y, stroke.label, fontsize=TEXT_SIZE, ha="center", va="center")
    else:
        axes.plot(*zip(*stroke.points, strict=True), color=INK, lw=width, ls=style)


def _dimensions(axes: Any, found: tuple[Dimension, ...]) -> None:
    for one in found:
        dimension(axes, one.start, one.end, one.shift, one.text)
