"""Drillings cut out of a body, and their outlets rounded.

Where the edge of an outlet is whole the kernel rounds it on the body itself. That takes a thirtieth of the
time of a tool, whose surfaces touch those of the journal all around, where cuts are slow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.shapes import add_solid, cut, outlet_edges, turned
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.feature import Body
from cranktopo.throw.primitives import RoundedOutlet

_RING = 1 - math.pi / 4
"""Section of the ring that a rounding takes off a square edge, over its radius squared."""
_PLAUSIBLE = 3.0
"""Largest factor between the ring of an oblique outlet and that of a square edge of its length."""


def drilled(occ: Any, body: DimTags, bores: Sequence[Body], *, by_tools: bool = False) -> DimTags:
    """Return a body without what bores and the roundings of their outlets take.

    Args:
        by_tools: round by tools alone, for a body that cannot be cut or meshed otherwise.
    """
    solids = [solid for bore in bores for solid in bore.solids()]
    outlets = [solid for solid in solids if isinstance(solid, RoundedOutlet)]
    holes = [solid for solid in solids if not isinstance(solid, RoundedOutlet)]
    body = cut(occ, body, [pair for hole in holes for pair in add_solid(occ, hole)])
    edges = _whole_edges(occ, body, outlets) if outlets and not by_tools else {}
    rounded = _rounded(occ, body, edges)
    left = outlets if rounded is None else [outlet for outlet in outlets if outlet not in edges]
    return cut(occ, rounded or body, [pair for outlet in left for pair in add_solid(occ, outlet)])


def drilled_at(
    occ: Any,
    body: DimTags,
    bores: tuple[Sequence[Body], Sequence[Body]],
    turns_deg: tuple[float, float],
    *,
    by_tools: bool = False,
) -> DimTags:
    """Return a body without the bores of two halves of a throw, each half turned by its angle.

    In one call where both are turned alike, see `_rounded`.
    """
    alike = turns_deg[0] == turns_deg[1]
    for own, turn in zip([[*bores[0], *bores[1]]] if alike else bores, turns_deg, strict=not alike):
        if own:
            body = turned(occ, drilled(occ, turned(occ, body, -turn), own, by_tools=by_tools), turn)
    return body


def _whole_edges(occ: Any, body: DimTags, outlets: Sequence[RoundedOutlet]) -> dict[RoundedOutlet, list[int]]:
    import gmsh

    occ.synchronize()
    found = {outlet: outlet_edges(body, outlet) for outlet in outlets}
    return {
        outlet: edges
        for outlet, edges in found.items()
        if edges and not gmsh.model.getBoundary([(1, edge) for edge in edges])
    }


def _rounded(occ: Any, body: DimTags, edges: Mapping[RoundedOutlet, Sequence[int]]) -> DimTags | None:
    """Return a body with the edges of outlets rounded; None without one, or where the kernel fails.

    In one call: a body rounded twice may have no section with a plane.
    """
    radii = {edge: outlet.rounding_mm for outlet, loop in edges.items() for edge in loop}
    if not radii:
        return None
    try:
        found = occ.fillet([tag for _, tag in body], list(radii), list(radii.values()), removeVolume=False)
    except Exception as error:
        if type(error) is not Exception:  # gmsh raises the bare class; anything else is a defect
            raise
        return None
    about = _RING * sum(radius**2 * occ.getMass(1, edge) for edge, radius in radii.items())
    taken = volume_mm3(occ, body) - volume_mm3(occ, found)
    sound = len(found) == len(body) and about / _PLAUSIBLE < taken < about * _PLAUSIBLE
    occ.remove(body if sound else found, recursive=True)
    return list(found) if sound else None
