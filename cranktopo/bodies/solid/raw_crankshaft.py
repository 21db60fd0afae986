"""OCC solid of the raw crank: raw throws turned into place and raw ends, checked against its volume."""

from __future__ import annotations

import math
from typing import Any

from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_ends import SIDES, main_journal_places_mm
from cranktopo.bodies.raw_crankshaft import raw_crank_end, raw_crank_volume_mm3
from cranktopo.bodies.raw_part import forging_of
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.crankshaft import placed_throws
from cranktopo.bodies.solid.raw_part import add_raw_throw, raw_bodies
from cranktopo.bodies.solid.shapes import fused
from cranktopo.design.crank import Side
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.moments import body_moments
from cranktopo.throw.raw_part.bodies import RawHalf


def add_raw_crankshaft(occ: Any, scene: Scene) -> DimTags:
    """Return raw throws, turned by firing order, and raw ends as one checked body, journal 0 at z = 0."""
    forging_of(scene)
    throws = placed_throws(occ, scene, add_raw_throw)
    ends = [add_raw_end(occ, scene, side, end) for side in SIDES if (end := raw_crank_end(scene, side))]
    body = fused(occ, [*throws, *ends])
    check_body(occ, body, ClosedForm(raw_crank_volume_mm3(scene)), "raw crankshaft")
    return body


def add_raw_end(occ: Any, scene: Scene, side: Side, end: RawHalf) -> DimTags:
    """Return a raw end as one checked body in its place, its parting plane that of the throw beside it."""
    body = fused(occ, raw_bodies(occ, end))
    check_body(occ, body, ClosedForm(body_moments([end]).volume), f"raw {side} end of the crank")
    if side == "free":
        occ.rotate(body, 0, 0, 0, 0, 1, 0, math.pi)
    index = 0 if side == "free" else -1
    angle, z = scene.shaft_angles_deg[index], main_journal_places_mm(scene)[index]
    occ.rotate(body, 0, 0, 0, 0, 0, 1, math.radians(about_z_deg(angle)))
    occ.translate(body, 0, 0, z)
    return body
