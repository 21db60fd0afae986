"""The bevelled edge of a counterweight, read from planes oblique to its flanks and from their end walls."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.importing.faces import DIGITS, FLAT
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.counterweight.tangent_circle import flank_directions

_FACES = ("journal", "pin")
_FLANKS = {(-1.0,): "leading", (1.0,): "trailing", (-1.0, 1.0): "both"}


def read_edge(body: HalfBody, scene: Scene) -> Iterator[dict[str, Any]]:
    """Yield the table of the bevelled edge, where every bevelled flank has the same on the same faces."""
    weight = scene.web.counterweight
    if weight is None:
        return
    sector = weight.sector(scene)
    found = {side: _bevels(body, sector, side) for side in (-1.0, 1.0)}
    sides = tuple(side for side, bevels in found.items() if bevels)
    sizes = [size for side in sides for size in found[side].values()]
    faces = {tuple(found[side]) for side in sides}
    if len(faces) != 1 or not np.allclose(sizes, sizes[0], rtol=0, atol=body.near.length * sector.radius_mm):
        return
    (cut,) = faces
    width, depth, length = (round(value, DIGITS) for value in sizes[0])
    face = "both" if len(cut) == 2 else cut[0]
    sized = {"width_mm": width, "depth_mm": depth, "length_mm": length}
    yield {"flanks": _FLANKS[sides], "face": face, **sized}


def _bevels(body: HalfBody, sector: Sector, side: float) -> dict[str, tuple[float, float, float]]:
    """Return width, depth and length of the bevels of a flank, by their face."""
    along, out = (np.array([side * way[0], way[1], 0.0]) for way in flank_directions(sector.half_angle))
    walls = [float(plane.point_mm @ along) for plane in body.faces.planes if plane.normal @ along > 1 - FLAT]
    starts = [start for start in walls if 0 < start < sector.radius_mm]
    found = {}
    for plane in body.faces.planes if starts else ():
        outward, up = float(plane.normal @ out), float(plane.normal[2])
        if abs(plane.normal @ along) > FLAT or outward < FLAT or abs(up) < FLAT:
            continue
        face, into = (0, 1.0) if up < 0 else (1, -1.0)
        width, depth = _sizes_mm(plane.normal, plane.point_mm, outward, sector.z_mm[face])
        if min(width, into * depth) > 0:
            found[_FACES[face]] = width, into * depth, sector.radius_mm - max(starts)
    return dict(sorted(found.items()))


def _sizes_mm(normal: Array, point: Array, outward: float, face_mm: float) -> tuple[float, float]:
    """Return where a bevel's plane meets the face, and by how much higher than it the flank."""
    at = float(normal @ point)
    return (normal[2] * face_mm - at) / outward, at / normal[2] - face_mm
