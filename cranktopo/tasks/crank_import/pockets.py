"""Round pockets of a half throw, read from cylinders along the crank axis that lie on no journal's axis."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.counterweight import ALONG, ORIGIN
from cranktopo.tasks.crank_import.faces import DIGITS, CylinderFace, span_along
from cranktopo.tasks.crank_import.half_body import HalfBody

_ON_AXIS = 1e-3
"""Distance from a journal's axis over the throw's radius below which a hole is that journal's bore."""
_AT_FACE = 0.02
"""Share of the web's thickness within which a hole begins at its face: chamfers are left out."""


def round_holes(body: HalfBody, scene: Scene) -> list[CylinderFace]:
    """Return full cylinders of holes along the crank axis beside the axes of the journals."""
    axes, least = (0.0, scene.throw.radius_mm), _ON_AXIS * scene.throw.radius_mm
    return [
        face
        for face in body.faces.cylinders
        if face.full
        and face.upright
        and not face.outward
        and all(math.hypot(face.point_mm[0], face.point_mm[1] - y) > least for y in axes)
    ]


def read_pockets(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield tables of the round pockets and holes that cylinders show."""
    (start, end), thickness = scene.web_z_mm, scene.web.thickness_mm
    for face in round_holes(body, scene):
        low, high = span_along(face, ORIGIN, ALONG)
        at_journal, at_pin = low - start < _AT_FACE * thickness, end - high < _AT_FACE * thickness
        if not at_journal and not at_pin:
            continue
        table = {
            "shape": "cylinder",
            "x_mm": round(float(face.point_mm[0]), DIGITS) + 0.0,
            "y_mm": round(float(face.point_mm[1]), DIGITS),
            "diameter_mm": round(2 * face.radius_mm, DIGITS),
        }
        if at_journal and at_pin:
            yield {**table, "face": "through"}
        else:
            depth = high - start if at_journal else end - low
            yield {**table, "face": "journal" if at_journal else "pin", "depth_mm": round(depth, DIGITS)}


def unread_holes(body: HalfBody, scene: Scene) -> Iterator[str]:
    """Yield the holes that are not in the design, in words."""
    known = {(round(p.x_mm, 3), round(p.y_mm, 3)) for p in scene.web.pocket if p.shape == "cylinder"}
    for face in round_holes(body, scene):
        x, y = (float(place) for place in face.point_mm[:2])
        if (round(x, 3), round(y, 3)) not in known:
            yield f"a hole of {2 * face.radius_mm:.4g} mm along the crank at x {x:.4g}, y {y:.4g} mm"
    drilled = [cylinder for cylinder in body.faces.cylinders if cylinder.full and not cylinder.outward]
    for face in drilled if not scene.throw.drilling else ():
        if not face.upright:
            near = ", ".join(f"{place:.4g}" for place in face.middle_mm)
            yield f"a hole of {2 * face.radius_mm:.4g} mm across the crank near ({near}) mm"
