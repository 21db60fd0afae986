"""Pockets of a half throw: round ones read from cylinders along the crank axis, boxes from planes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.box_cuts import BoxCut, box_cuts
from cranktopo.tasks.crank_import.counterweight import ALONG, ORIGIN
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.importing.faces import DIGITS, FLAT, ConeFace, CylinderFace, span_along
from cranktopo.throw.face_pocket import BoxPocket
from cranktopo.throw.side_pocket import SidePocket
from cranktopo.throw.side_slots import BEYOND_MM
from cranktopo.throw.web import Pocket

_ACROSS, _UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])

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
    """Yield tables of the pockets and holes that faces show."""
    yield from _round_pockets(body, scene)
    yield from _box_pockets(body, scene)
    yield from _side_pockets(body, scene)


def _round_pockets(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
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


def _near_mm(body: HalfBody, scene: Scene) -> float:
    return max(FLAT * scene.throw.radius_mm, body.near.outline_mm)


def _box_pockets(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield tables of boxes that open at a face of the web, with a wall on each of their four sides."""
    (start, end), near = scene.web_z_mm, _near_mm(body, scene)
    for face, sign, mouth in (("journal", -1.0, start), ("pin", 1.0, end)):
        for cut in box_cuts(body.faces, sign * ALONG, (_ACROSS, _UP), near):
            depth = sign * mouth - cut.floor_mm
            (left, right), (low, high) = cut.first_mm, cut.second_mm
            if depth < near or not math.isfinite(right - left):
                continue
            yield {
                "shape": "box",
                "face": face,
                "x_mm": _number((left + right) / 2),
                "y_mm": _number((low + high) / 2),
                "size_x_mm": _number(right - left),
                "size_y_mm": _number(high - low),
                "depth_mm": _number(depth),
                **_edges(cut),
                **({"floor_radius_mm": _number(cut.floor_radius_mm)} if cut.floor_radius_mm else {}),
            }


def _side_pockets(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield tables of slots that open at both sides; one without a wall at an end runs out there."""
    throw_end, near = scene.web.y_range_mm(scene.throw.radius_mm), _near_mm(body, scene)
    beyond = [float(plane.point_mm[0]) for plane in body.faces.planes if plane.normal[0] < FLAT - 1]
    for cut in box_cuts(body.faces, _ACROSS, (_UP, ALONG), near):
        if not any(abs(place + cut.floor_mm) < near for place in beyond):
            continue
        low, high = (
            wall if math.isfinite(wall) else end + side * BEYOND_MM
            for wall, end, side in zip(cut.first_mm, throw_end, (-1, 1), strict=True)
        )
        bottom, top = cut.second_mm
        yield {
            "shape": "side",
            "y_mm": _number((low + high) / 2),
            "length_mm": _number(high - low),
            "height_mm": _number(top - bottom),
            "depth_mm": _number(scene.web.largest_half_width_mm - cut.floor_mm),
            "offset_mm": _number((bottom + top) / 2 - sum(scene.web_z_mm) / 2),
            **_edges(cut),
        }


def corner_cones(body: HalfBody, scene: Scene) -> int:
    """Return how many conical faces are corners of drafted pockets in the design."""
    near = _near_mm(body, scene)
    return sum(
        any(_is_corner(cone, pocket, scene, near) for pocket in scene.web.pocket) for cone in body.faces.cones
    )


def _is_corner(cone: ConeFace, pocket: Pocket, scene: Scene, near_mm: float) -> bool:
    if isinstance(pocket, BoxPocket):
        place, sizes = cone.ends_mm[0][:2], (pocket.size_x_mm, pocket.size_y_mm)
        middle = (pocket.x_mm, pocket.y_mm)
    elif isinstance(pocket, SidePocket):
        place, sizes = cone.ends_mm[0][1:], (pocket.length_mm, pocket.height_mm)
        middle = (pocket.y_mm, sum(scene.web_z_mm) / 2 + pocket.offset_mm)
    else:
        return False
    beside = np.abs(place - np.array(middle)) - (np.array(sizes) / 2 - pocket.corner_radius_mm)
    return not cone.outward and float(np.abs(beside).max()) < near_mm


def _edges(cut: BoxCut) -> dict[str, float]:
    found = {"draft_deg": cut.draft_deg, "corner_radius_mm": cut.corner_mm}
    return {key: _number(value) for key, value in found.items() if value > FLAT}


def _number(value: float) -> float:
    return round(value, DIGITS) + 0.0


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
