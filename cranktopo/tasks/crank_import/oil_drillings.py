"""Oil drillings of a half throw, read from oblique bores among its faces."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.halves import mirror_image
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.alike import alike, dumped
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.crank_import.outlet_fit import outlet_radius_mm
from cranktopo.tasks.importing.faces import CylinderFace, same_axis, span_along
from cranktopo.throw.drilling.table import Drilling, drill_bores

_DIGITS = 6
_BACK_DEG = -179.9995
"""Angle below which -180 is written as 180, at three decimals of triangles."""
_OBLIQUE = 6.0
"""Way from the outermost edge of an oblique outlet to the drilling's axis, over its radius."""
_LARGEST = 0.4
"""Diameter of a drilling over the pin's."""


def read_drillings(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield tables of the drillings that straight bores across the journals show, each once."""
    for face in _bores(body, scene):
        ends = _ends(body, scene, face)
        if len(ends) == 2 and ends[0] != ends[1]:
            yield {"diameter_mm": round(2 * face.radius_mm, _DIGITS), "from": ends[0], "to": ends[1]}


def has_neighbours_bore(body: HalfBody, scene: Scene) -> bool:
    """Tell whether a bore comes from beyond the middle of the main journal.

    Both its ends are on that journal in one place, as its way goes on in the neighbouring throw.
    """
    found = (_ends(body, scene, face) for face in _bores(body, scene))
    return any(ends[1:] == ends[:1] and ends[0]["on"] == "main_journal" for ends in found if ends)


def _bores(body: HalfBody, scene: Scene) -> Iterator[CylinderFace]:
    """Yield a face of each straight bore across the journals."""
    seen: list[CylinderFace] = []
    for face in body.faces.cylinders:
        wide = 2 * face.radius_mm > _LARGEST * scene.throw.crankpin.outer_diameter_mm
        if face.outward or face.upright or wide or any(same_axis(face, other) for other in seen):
            continue
        seen.append(face)
        yield face


def _ends(body: HalfBody, scene: Scene, face: CylinderFace) -> list[dict[str, Any]]:
    """Return the ends of a bore on surfaces of the journals, that of the main journal first.

    A bore has no direction; one from either side would be no drilling that is alike.
    """
    ends = (_end(face, scene, span) for span in _span(body, face))
    return sorted(filter(None, ends), key=lambda end: str(end["on"]), reverse=True)


def with_known_outlets(table: Mapping[str, Any], others: Sequence[Scene]) -> dict[str, Any]:
    """Return a drilling's table with the rounded outlets of the same drilling, or its image, elsewhere.

    Fits to two halves leave a hair between radii that are one in the body.
    """
    own = dumped(Drilling.model_validate(table))
    images = (
        drilling
        for other in others
        for twin in (other, mirror_image(other))
        for drilling in twin.throw.drilling
    )
    for drilling in images:
        if alike(dumped(drilling.model_copy(update={"outlet_radius_mm": 0.0})), own):
            return {**table, "outlet_radius_mm": drilling.outlet_radius_mm}
    return dict(table)


def with_outlet_radius(table: Mapping[str, Any], body: HalfBody, scene: Scene) -> dict[str, Any]:
    """Return a drilling's table with the radius of its outlets, where corners of triangles lie on roundings.

    These are approximate surfaces in a file, so that no face tells their radius.
    """
    drilling = Drilling.model_validate({**table, "outlet_radius_mm": 0.0})
    (bore,) = drill_bores(scene.with_drillings((drilling,)))
    radius = outlet_radius_mm(bore, body.mesh.vertices_mm)
    return {**table, "outlet_radius_mm": radius} if radius else dict(table)


def _span(body: HalfBody, face: CylinderFace) -> tuple[float, float]:
    """Return the ends of all faces on the line of a drilling, along the first."""
    spans = [
        span_along(other, face.point_mm, face.axis)
        for other in body.faces.cylinders
        if not other.outward and same_axis(face, other)
    ]
    return min(low for low, _ in spans), max(high for _, high in spans)


def _end(face: CylinderFace, scene: Scene, at: float) -> dict[str, Any] | None:
    """Return the surface on which a drilling ends, and where."""
    throw, near = scene.throw, face.point_mm + at * face.axis
    found: list[tuple[float, dict[str, Any]]] = []
    for key, journal, y, middle, side in (
        ("main_journal", throw.main_journal, 0.0, 0.0, 1.0),
        ("crankpin", throw.crankpin, throw.radius_mm, scene.pitch_mm / 2, -1.0),
    ):
        for on, radius in ((key, journal.radius_mm), (f"{key}_bore", journal.bore_radius_mm)):
            for point in _meets(face, y, radius):
                off = float(np.linalg.norm(point - near))
                angle = round(math.degrees(math.atan2(point[0], point[1] - y)), _DIGITS)
                place = side * (float(point[2]) - middle)
                if place > -1e-6:
                    entry = {
                        "on": on,
                        "angle_deg": 180.0 if angle < _BACK_DEG else angle + 0.0,
                        "place_mm": round(max(place, 0.0), _DIGITS),
                    }
                    found.append((off, entry))
    near_enough = [one for one in found if one[0] < _OBLIQUE * face.radius_mm]
    return min(near_enough, key=lambda one: one[0])[1] if near_enough else None


def _meets(face: CylinderFace, y: float, radius: float) -> Iterator[Array]:
    """Yield where a drilling's axis meets a cylinder along z."""
    if radius <= 0:
        return
    px, py = float(face.point_mm[0]), float(face.point_mm[1]) - y
    dx, dy = float(face.axis[0]), float(face.axis[1])
    a, b, c = dx**2 + dy**2, px * dx + py * dy, px**2 + py**2 - radius**2
    root = b**2 - a * c
    if a > 0 and root >= 0:
        for sign in (-1.0, 1.0):
            yield face.point_mm + (-b + sign * math.sqrt(root)) / a * face.axis
