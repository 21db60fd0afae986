"""OCC solid of the raw part that a die forges of a throw, checked against its volume by quadrature."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from cranktopo.bodies.raw_part import forging_of, raw_half_volume_mm3
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import add_solid, cut, fused, turned_half
from cranktopo.bodies.solid.throw import built
from cranktopo.design.halves import halves, mirror_image
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.feature import Body
from cranktopo.throw.primitives import Extrusion, LineSegment, Point
from cranktopo.throw.raw_part.bodies import DraftedPrism, RawBody, RawHalf
from cranktopo.throw.raw_part.half import raw_half

_BEYOND_MM = 1.0


def add_raw_throw(occ: Any, scene: Scene) -> DimTags:
    """Return the raw part of a throw between its two mid-main-journal planes as one checked body."""
    first, second = halves(scene)
    half, other = (add_raw_half(occ, one) for one in (first, mirror_image(second)))
    body, _ = occ.fuse(half, turned_half(occ, other, scene.pitch_mm))
    check_body(occ, body, ClosedForm(sum(map(raw_half_volume_mm3, (first, second)))), "raw part")
    return list(body)


def add_raw_half(occ: Any, scene: Scene) -> DimTags:
    """Return the raw half throw as one checked body; a refusal names the feature that is wrong."""
    return built(occ, scene, "raw half throw", _raw_half, lambda part: ClosedForm(raw_half_volume_mm3(part)))


def _raw_half(occ: Any, scene: Scene, *, pieces: int = 1) -> DimTags:
    half = raw_half(scene, forging_of(scene))
    web = [_web(occ, half, cuts, pieces) for cuts in dict.fromkeys(half.cuts_of)]
    return fused(occ, [*web, *raw_bodies(occ, half)])


def _web(occ: Any, half: RawHalf, cuts: tuple[Body, ...], pieces: int) -> DimTags:
    """Return the parts of the web that have the same cuts, without those."""
    parts = [part for part, own in zip(half.web, half.cuts_of, strict=True) if own == cuts]
    solids = [solid for tool in cuts for solid in tool.in_pieces(pieces).solids()]
    tools = [pair for solid in solids for pair in add_solid(occ, solid)]
    return cut(occ, fused(occ, [_prism(occ, part) for part in parts]), tools)


def raw_bodies(occ: Any, half: RawHalf) -> list[DimTags]:
    """Return the solids of what stands on the webs of a raw half."""
    return [_raw_body(occ, one) for one in half.journals]


def _raw_body(occ: Any, body: RawBody) -> DimTags:
    if isinstance(body, DraftedPrism):
        return _prism(occ, body)
    return [pair for solid in body.solids() for pair in add_solid(occ, solid)]


def _prism(occ: Any, prism: DraftedPrism) -> DimTags:
    """Return the prism with its ends straight where they have draft, cut by what its faces leave."""
    own = [pair for solid in prism.own.solids() for pair in add_solid(occ, solid)]
    fillers = []
    for corners in prism.outline.fillers:
        own = cut(occ, own, [_slab(occ, prism, corners[0][0], corners[-1][0])])
        fillers += _filler(occ, corners, prism.z_mm)
    own = fused(occ, [own, fillers]) if fillers else own
    profile = _extruded(occ, [(x, z) for x, z in prism.profile_mm()], prism.y_range_mm)
    return list(occ.intersect(own, profile)[0])


def _slab(occ: Any, prism: DraftedPrism, low: float, high: float) -> tuple[int, int]:
    (bottom, top), wide = prism.z_mm, prism.widest_mm + _BEYOND_MM
    size = 2 * wide, high - low, top - bottom + 2 * _BEYOND_MM
    return 3, occ.addBox(-wide, low, bottom - _BEYOND_MM, *size)


def _filler(occ: Any, corners: tuple[tuple[float, float], ...], z_mm: tuple[float, float]) -> DimTags:
    """Return the prism between both lines of a filler."""
    low, high = z_mm
    right = [(half, y, low) for y, half in corners]
    left = [(-half, y, low) for y, half in corners[::-1] if half > 0]
    return add_solid(occ, Extrusion(_loop([*right, *left]), (0.0, 0.0, high - low)))


def _extruded(occ: Any, corners: list[tuple[float, float]], y_mm: tuple[float, float]) -> DimTags:
    low, high = y_mm[0] - _BEYOND_MM, y_mm[1] + _BEYOND_MM
    points = [(x, low, z) for x, z in corners]
    return add_solid(occ, Extrusion(_loop(points), (0.0, high - low, 0.0)))


def _loop(points: list[Point]) -> tuple[LineSegment, ...]:
    return tuple(LineSegment(a, b) for a, b in pairwise([*points, points[0]]))
