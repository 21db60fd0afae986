"""Drillings cut out of a body, and their outlets rounded.

Where the edge of an outlet is whole the kernel rounds it on the body itself. That takes a thirtieth of the
time of a tool, whose surfaces touch those of the journal all around, where cuts are slow. Where the body ends
within the rounding it does so, too, but takes 8 % too little.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from operator import itemgetter
from types import MappingProxyType
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.seams import seams_closed
from cranktopo.bodies.solid.shapes import add_solid, cut, outlet_edges, turned
from cranktopo.numerics.gmsh_session import DimTags, unless_it_fails
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.checks import rim_z_mm
from cranktopo.throw.primitives import Cylinder, RoundedOutlet, Solid

Heights = tuple[float, float]
"""Least and largest height along the crank, mm."""
ALL_HEIGHTS: Heights = (-math.inf, math.inf)
NO_HEIGHTS: Mapping[DrillBore, Heights] = MappingProxyType({})
BEYOND = 0.2
"""Length of a tool beyond the middle of the crankpin, where it goes on, over the drilling's radius."""
_RING = 1 - math.pi / 4
"""Section of the ring that a rounding takes off a square edge, over its radius squared."""
_FAR = 4.0
"""Size of what is beyond the middle of the crankpin over the largest coordinate of a drilling."""
_PLAUSIBLE = 3.0
"""Largest factor between the ring of an oblique outlet and that of a square edge of its length."""


def drilled(
    occ: Any,
    body: DimTags,
    bores: Sequence[DrillBore],
    *,
    between_mm: Mapping[DrillBore, Heights] = NO_HEIGHTS,
    by_tools: bool = False,
) -> DimTags:
    """Return a body without what bores and the roundings of their outlets take.

    Args:
        between_mm: heights between which a bore is cut, where its mirror image goes on beyond one of them.
        by_tools: round by tools alone, for a body that cannot be cut or meshed otherwise.
    """

    def tools(some: Sequence[tuple[DrillBore, Solid]]) -> DimTags:
        return [
            pair
            for bore, solid in some
            for pair in _tool(occ, bore, solid, between_mm.get(bore, ALL_HEIGHTS))
        ]

    ends = _ends_mm(occ, body) if bores else ALL_HEIGHTS
    seams = {bore: _seam(bore, between_mm.get(bore, ALL_HEIGHTS), ends) for bore in bores}
    solids = [(bore, _with_seam(solid, seams[bore])) for bore in bores for solid in bore.solids()]
    outlets = {solid: bore for bore, solid in solids if isinstance(solid, RoundedOutlet)}
    body = cut(occ, body, tools([one for one in solids if not isinstance(one[1], RoundedOutlet)]))
    within = _within(ends, outlets) if not by_tools else []
    edges = _whole_edges(occ, body, within) if within else {}
    body, done = _rounded(occ, body, edges)
    rest = [(bore, solid) for solid, bore in outlets.items() if solid not in done]
    return _without_inverted(occ, cut(occ, body, tools(rest)))


def _without_inverted(occ: Any, body: DimTags) -> DimTags:
    """Return a body without tools that the kernel leaves in it inside out, beside what they have cut.

    Seen where a rounding ends in the plane of symmetry. The check of the volume follows.
    """
    if len(body) < 2:
        return body
    inverted = [pair for pair in body if occ.getMass(*pair) < 0]
    occ.remove(inverted, recursive=True)
    return [pair for pair in body if pair not in inverted]


def _tool(occ: Any, bore: DrillBore, solid: Solid, between_mm: Heights) -> DimTags:
    """Return the tool of a bore's solid between two heights.

    It ends in the middle of a journal where its mirror image begins: both then meet in one curve, as the
    halves of a throw do. Whole tools cross each other there, and the kernel loses one of two roundings.
    """
    tool = add_solid(occ, solid)
    low, high = bore.box_mm(bore.reach_mm)
    far = _FAR * float(np.abs([low, high]).max())
    for height, beyond, reached in zip(
        between_mm, (-2 * far, 0.0), (low[2] < between_mm[0], high[2] > between_mm[1]), strict=True
    ):
        if reached:
            box = occ.addBox(-2 * far, -2 * far, height + beyond, 4 * far, 4 * far, 2 * far)
            tool = cut(occ, tool, [(3, box)])
    return tool


def drilled_at(
    occ: Any,
    body: DimTags,
    bores: Sequence[tuple[float, DrillBore]],
    *,
    between_mm: Mapping[DrillBore, Heights] = NO_HEIGHTS,
    by_tools: bool = False,
) -> DimTags:
    """Return a body without bores, each turned by an angle, deg; other arguments as of `drilled`.

    Those that follow each other and are turned alike are cut in one call, see `_rounded`.
    """
    for turn, own in groupby(bores, key=itemgetter(0)):
        body = turned(occ, body, -turn)
        body = drilled(occ, body, [bore for _, bore in own], between_mm=between_mm, by_tools=by_tools)
        body = turned(occ, body, turn)
    return body


def to_middle(bores: Sequence[DrillBore], middle_mm: float) -> dict[DrillBore, Heights]:
    """Return the heights of bores that cross the middle of the crankpin, where their mirror image begins."""
    found = {}
    for bore in bores:
        first = sum(outlet.point_mm[2] for outlet in bore.outlets) < 2 * middle_mm
        if not bore.alone:
            found[bore] = (-math.inf, middle_mm) if first else (middle_mm, math.inf)
    return found


def _ends_mm(occ: Any, body: DimTags) -> Heights:
    """Return the least and the largest height of a body."""
    boxes = [occ.getBoundingBox(*pair) for pair in body]
    return min(box[2] for box in boxes), max(box[5] for box in boxes)


def _seam(bore: DrillBore, between_mm: Heights, ends_mm: Heights) -> float:
    """Return toward which end of the crank the seam of a bore lies; 0 where the kernel may lay it.

    Where a hole with a rounding ends in a plane across the crank its seam lies beyond: beside that plane it
    would leave a strip of the rounding, and in it corners that the kernel finds to micrometres.
    """
    rounded = [replace(outlet, rounding_mm=0.0) for outlet in bore.outlets if outlet.rounding_mm]
    if not rounded:
        return 0.0
    edges, near = np.concatenate([rim_z_mm(bore, outlet) for outlet in rounded]), BEYOND * bore.radius_mm
    if edges.max() > min(between_mm[1], ends_mm[1]) - near:
        return 1.0
    return -1.0 if edges.min() < max(between_mm[0], ends_mm[0]) + near else 0.0


def _with_seam(solid: Solid, seam: float) -> Solid:
    match solid:
        case Cylinder():
            return replace(solid, seam=seam)
        case RoundedOutlet():
            return replace(solid, hole=replace(solid.hole, seam=seam))
        case _:
            return solid


def _within(ends_mm: Heights, rounded: Mapping[RoundedOutlet, DrillBore]) -> Sequence[RoundedOutlet]:
    """Return the rounded outlets beyond whose rim a body goes on along the crank."""
    low, high = ends_mm
    rims = {one: _rim_z_mm(bore, one) for one, bore in rounded.items()}
    return [one for one, rim in rims.items() if low < rim.min() and rim.max() < high]


def _rim_z_mm(bore: DrillBore, rounded: RoundedOutlet) -> Array:
    outlets = (one for one in bore.outlets if one.rounding_mm and one.point_mm == rounded.at)
    return rim_z_mm(bore, next(outlets))


def _whole_edges(occ: Any, body: DimTags, outlets: Sequence[RoundedOutlet]) -> dict[RoundedOutlet, list[int]]:
    import gmsh

    occ.synchronize()
    found = {outlet: outlet_edges(body, outlet) for outlet in outlets}
    return {
        outlet: edges
        for outlet, edges in found.items()
        if edges and not gmsh.model.getBoundary([(1, edge) for edge in edges])
    }


def _rounded(
    occ: Any, body: DimTags, edges: Mapping[RoundedOutlet, Sequence[int]]
) -> tuple[DimTags, Collection[RoundedOutlet]]:
    """Return a body with the edges of outlets rounded, and these; as it was and none where the kernel fails.

    In one call: a body rounded twice may have no section with a plane. A copy is kept, because a fillet that
    fails may leave faces of its body without their edges.
    """
    radii = {edge: outlet.rounding_mm for outlet, loop in edges.items() for edge in loop}
    if not radii:
        return body, ()
    kept, before = occ.copy(body), volume_mm3(occ, body)
    about = _RING * sum(radius**2 * occ.getMass(1, edge) for edge, radius in radii.items())
    found = _filleted(occ, body, radii)
    taken = before - volume_mm3(occ, found)
    plausible = about / _PLAUSIBLE < taken < about * _PLAUSIBLE
    sound = len(found) == len(body) and plausible and seams_closed(occ, found)
    occ.remove([*body, *(kept if sound else found)], recursive=True)
    return (found, edges.keys()) if sound else (kept, ())


def _filleted(occ: Any, body: DimTags, radii: Mapping[int, float]) -> DimTags:
    """Return a body with edges rounded by radii, mm; nothing where the kernel fails."""
    tags, edges, sizes = [tag for _, tag in body], list(radii), list(radii.values())
    return unless_it_fails(lambda: list(occ.fillet(tags, edges, sizes, removeVolume=False)))
