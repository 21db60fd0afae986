"""Bevels of a half throw, read from slanted planes, those of a draft, and from cylinders across its web."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.importing.faces import DIGITS, FLAT, CylinderFace
from cranktopo.throw.bevel import LARGEST_DRAFT_DEG

_SLANTED = 1e-3
_MOST_ASIDE = math.sin(math.radians(LARGEST_DRAFT_DEG)) + FLAT
"""Largest part across the throw of the normal of a plane bevel: that of the largest draft."""


def read_bevels(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield tables of the bevels that slanted planes, or cylinders across the web, show."""
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    journal_face, pin_face = scene.web_z_mm
    for plane in body.faces.planes:
        nx, ny, nz = plane.normal
        if abs(nx) > _MOST_ASIDE or min(abs(ny), abs(nz)) < _SLANTED:
            continue
        draft = {"draft_deg": round(math.degrees(math.asin(abs(nx))), DIGITS)} if abs(nx) > FLAT else {}
        at = float(plane.normal @ plane.point_mm)
        if nz < 0 < ny:
            y, depth = (at - nz * journal_face) / ny, (at - ny * high) / nz - journal_face
            yield {**_bevel("journal", y, depth), **draft}
        elif ny < 0 < nz:
            y, depth = (at - nz * pin_face) / ny, pin_face - (at - ny * low) / nz
            yield {**_bevel("pin", y, depth), **draft}
    for face in body.faces.cylinders:
        if abs(abs(face.axis[0]) - 1) < FLAT:
            yield from _crowned(face, (low, high), (journal_face, pin_face))


def _crowned(
    face: CylinderFace, ends: tuple[float, float], faces: tuple[float, float]
) -> Iterator[dict[str, Any]]:
    """Yield the bevel of a cylinder across the web."""
    y0, z0, radius = float(face.point_mm[1]), float(face.point_mm[2]), face.radius_mm
    for name, end, at, inward in (("journal", ends[1], faces[0], 1.0), ("pin", ends[0], faces[1], -1.0)):
        reach, run = radius**2 - (at - z0) ** 2, radius**2 - (end - y0) ** 2
        if reach < 0 or run < 0 or (face.middle_mm[1] - sum(ends) / 2) * (end - sum(ends) / 2) < 0:
            continue
        side = 1.0 if face.outward else -1.0
        toward = math.copysign(1.0, end - sum(ends) / 2)
        y = y0 + side * toward * math.sqrt(reach)
        z = z0 - side * inward * math.sqrt(run)
        depth = inward * (z - at)
        chord = math.hypot(end - y, z - at)
        rise = radius - math.sqrt(max(radius**2 - chord**2 / 4, 0.0))
        if depth > 0 and chord > 0:
            yield {**_bevel(name, y, depth), "crown_mm": round(side * rise, DIGITS)}


def _bevel(face: str, y: float, depth: float) -> dict[str, Any]:
    return {"face": face, "y_mm": round(y, DIGITS), "depth_mm": round(depth, DIGITS)}
