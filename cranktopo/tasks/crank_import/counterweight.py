"""The counterweight of a half throw, read from its rim about the crank axis."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.importing.faces import (
    DIGITS,
    FLAT,
    CylinderFace,
    Faces,
    from_line_mm,
    span_along,
)

_CENTRED = 1e-5
"""Distance of a rim's axis from the crank axis over its radius."""
_EDGE = 0.15
"""Share of the web's thickness at its faces that chamfers of a counterweight may take."""
ORIGIN, ALONG = np.zeros(3), np.array([0.0, 0.0, 1.0])
"""A point of the crank axis, and its direction, in the frame of a throw."""


def counterweights(body: HalfBody) -> Iterator[dict[str, Any]]:
    """Yield tables of the counterweight that a rim shows, without and with its fillets."""
    rims = _rims(body)
    if not rims:
        return
    rim = max(rims, key=lambda face: face.radius_mm)
    table: dict[str, Any] = {
        "outer_radius_mm": round(rim.radius_mm, DIGITS),
        "half_angle_deg": round(_half_angle_deg(body.faces, rim), DIGITS),
        **_depth(body, rim),
    }
    yield table
    corners = _corners(body, rim)
    tables = [table, *({**table, "corner_mm": corner} for corner in corners)]
    yield from tables[1:]
    concave = {
        round(face.radius_mm, DIGITS)
        for face in body.faces.cylinders
        if face.upright and not face.outward and not face.full
    }
    yield from ({**one, "fillet_mm": fillet} for fillet in sorted(concave)[:2] for one in tables)


def _corners(body: HalfBody, rim: CylinderFace) -> list[float]:
    """Return radii of cylinders that touch the rim from inside below the crank axis, at its corners."""
    touching = {
        round(face.radius_mm, DIGITS)
        for face in body.faces.cylinders
        if face.upright
        and face.outward
        and not face.full
        and face.middle_mm[1] <= 0
        and abs(math.hypot(*face.point_mm[:2]) + face.radius_mm - rim.radius_mm) < FLAT * rim.radius_mm
        and face.radius_mm < rim.radius_mm / 2
    }
    return sorted(touching)[:2]


def _rims(body: HalfBody) -> Sequence[CylinderFace]:
    """Return partial cylinders about the crank axis, but for the round ends that plane sides touch."""
    ends = {float(side.normal @ side.point_mm) for side in body.faces.sides}
    return [
        face
        for face in body.faces.cylinders
        if face.outward
        and face.upright
        and not face.full
        and face.middle_mm[1] <= 0
        and face.radius_mm > body.half.main.radius_mm
        and from_line_mm(face.point_mm, ORIGIN, ALONG) < _CENTRED * face.radius_mm
        and all(abs(face.radius_mm - end) > FLAT * end for end in ends)
    ]


def _half_angle_deg(faces: Faces, rim: CylinderFace) -> float:
    """Return the angle of the largest flank, a plane through the crank axis; without one that of the rim."""
    flanks = [
        plane
        for plane in faces.planes
        if plane.upright
        and plane.normal[0] >= -FLAT
        and plane.point_mm[0] > 0
        and abs(float(plane.normal @ plane.point_mm)) < FLAT * rim.radius_mm
    ]
    if not flanks:
        return min(90.0, math.degrees(rim.turn_rad) / 2)
    normal = max(flanks, key=lambda plane: plane.area_mm2).normal
    return math.degrees(math.atan2(abs(normal[1]), abs(normal[0])))


def _depth(body: HalfBody, rim: CylinderFace) -> dict[str, Any]:
    """Return thickness and face of a counterweight that is thinner than its web, chamfers aside."""
    start, thickness = body.half.main_length_mm / 2, body.half.thickness_mm
    low, high = (height - start for height in span_along(rim, ORIGIN, ALONG))
    if low < _EDGE * thickness and high > (1 - _EDGE) * thickness:
        return {}
    face = "journal" if low < thickness - high else "pin"
    depth = high if face == "journal" else thickness - low
    return {"thickness_mm": round(depth, DIGITS), "face": face}
