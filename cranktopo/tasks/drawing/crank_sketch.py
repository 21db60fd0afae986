"""Sketch of the keys of a crank's ends: their steps cut along the crank, flange and keyway seen along it."""

from __future__ import annotations

from math import cos, radians, sin
from typing import Any

import numpy as np

from cranktopo.design.schema import Scene
from cranktopo.report.drafting import INK, THIN, circle, hatched
from cranktopo.tasks.drawing.sketch_marks import Panel, mark_angle, mark_leader, mark_size
from cranktopo.throw.crank_end import ConeStep, EndStep, FlangeStep, KeywayStep

_CONE = ConeStep(
    kind="cone", length_mm=46.0, diameter_mm=40.0, outer_end_diameter_mm=30.0, bore_diameter_mm=14.0
)
_FLANGE = FlangeStep(
    kind="flange",
    length_mm=16.0,
    diameter_mm=90.0,
    bore_diameter_mm=14.0,
    bolts=6,
    bolt_circle_mm=64.0,
    bolt_diameter_mm=12.0,
    first_bolt_deg=30.0,
)
_KEYWAY = KeywayStep(
    kind="keyway", length_mm=40.0, diameter_mm=60.0, width_mm=18.0, depth_mm=11.0, angle_deg=40.0
)
_JOURNAL_MM = 24.0
_GAP = 10.0


def _along(axes: Any, scene: Scene) -> None:
    """Journal, cone and flange cut along the crank, its axis to the right."""
    journal = 42.0 / 2
    z = -_JOURNAL_MM
    for inner, outer, length in (
        (journal, journal, _JOURNAL_MM),
        (*_CONE.radii_mm, _CONE.length_mm),
        (*_FLANGE.radii_mm, _FLANGE.length_mm),
    ):
        bore, end = _FLANGE.bore_radius_mm, z + length
        for side in (1, -1):
            corners = [(z, bore), (end, bore), (end, outer), (z, inner)]
            hatched(axes, [np.array([(at, side * y) for at, y in corners])])
        z = end
    axes.plot([-_JOURNAL_MM - 6, z + 6], [0, 0], color=THIN, lw=0.5, ls="-.")


def _along_names(axes: Any) -> None:
    length = _CONE.length_mm
    inner, outer = _CONE.radii_mm
    mark_size(axes, (0, -inner), (length, -inner), (0, -3 * _GAP), "length_mm")
    mark_leader(axes, (1.0, inner), (4.0, inner + 22), "diameter_mm")
    mark_leader(axes, (length, outer), (24.0, outer + 14), "outer_end_diameter_mm")
    mark_leader(axes, (length / 2, -_CONE.bore_radius_mm), (length / 2, 0.0), "bore_diameter_mm")
    axes.text(-_JOURNAL_MM / 2, -28, "outer main\njournal", ha="center", va="top", fontsize=8, color=THIN)


def _seen(step: EndStep, axes: Any) -> None:
    circle(axes, step.radii_mm[0], 0.0, "-", 1.4)
    if step.bore_radius_mm:
        circle(axes, step.bore_radius_mm, 0.0, "-", 1.2)


def _flange(axes: Any, scene: Scene) -> None:
    _seen(_FLANGE, axes)
    circle(axes, _FLANGE.bolt_circle_mm / 2, 0.0, "-.", 0.6)
    for x, y, radius in _FLANGE.bolt_holes_mm:
        circle(axes, radius, y, "-", 1.2, x=x)


def _flange_names(axes: Any) -> None:
    arm = _FLANGE.bolt_circle_mm / 2
    mark_size(axes, (-arm, 0), (arm, 0), (0, -5.8 * _GAP), "bolt_circle_mm")
    x, y, radius = _FLANGE.bolt_holes_mm[2]
    mark_leader(axes, (x + radius * 0.7, y - radius * 0.7), (46.0, -44.0), "bolt_diameter_mm")
    mark_angle(axes, _FLANGE.radii_mm[0] + 10, 0.0, _FLANGE.first_bolt_deg, "first_bolt_deg")
    _toward_throw(axes, _FLANGE.radii_mm[0] + 24)


def _keyway(axes: Any, scene: Scene) -> None:
    radius, half = _KEYWAY.radii_mm[0], _KEYWAY.width_mm / 2
    edge = np.sqrt(radius**2 - half**2)
    turn = np.arcsin(half / radius)
    around = np.linspace(turn, 2 * np.pi - turn, 200)
    low = radius - _KEYWAY.depth_mm
    outline = [*zip(radius * np.sin(around), radius * np.cos(around), strict=True)]
    outline += [(-half, edge), (-half, low), (half, low), (half, edge)]
    axes.plot(*np.array([_turned(point) for point in outline]).T, color=INK, lw=1.4)


def _turned(point: tuple[float, float]) -> tuple[float, float]:
    angle = radians(_KEYWAY.angle_deg)
    return point[0] * cos(angle) + point[1] * sin(angle), point[1] * cos(angle) - point[0] * sin(angle)


def _keyway_names(axes: Any) -> None:
    radius, low = _KEYWAY.radii_mm[0], _KEYWAY.radii_mm[0] - _KEYWAY.depth_mm
    mark_leader(axes, _turned((_KEYWAY.width_mm / 2, radius - 4)), (radius + 16, 6.0), "width_mm")
    mark_leader(axes, _turned((0.0, low)), (-6.0, -8.0), "depth_mm")
    mark_angle(axes, radius + 12, 0.0, _KEYWAY.angle_deg, "angle_deg")
    _toward_throw(axes, radius + 22)


def _toward_throw(axes: Any, reach: float) -> None:
    axes.text(0.0, reach, "toward throw 1", ha="center", va="bottom", fontsize=8, color=THIN)


CRANK_PANELS = (
    Panel("[[crank.end.step]]", {}, _along, _along_names),
    Panel('kind = "flange", along the crank', {}, _flange, _flange_names),
    Panel('kind = "keyway", along the crank', {}, _keyway, _keyway_names),
)
