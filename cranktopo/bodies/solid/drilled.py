"""Drillings cut out of a body, and their outlets rounded.

Where the edge of an outlet is whole the kernel rounds it on the body itself. That takes a thirtieth of the
time of a tool, whose surfaces touch those of the journal all around, where cuts are slow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.shapes import add_solid, cut, outlet_edges, turned
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.primitives import RoundedOutlet, Solid

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
    middle_mm: float = math.inf,
    by_tools: bool = False,
) -> DimTags:
    """Return a body without what bores and the roundings of their outlets take.

    Args:
        middle_mm: height of the middle of the crankpin in a body that goes on beyond it.
        by_tools: round by tools alone, for a body that cannot be cut or meshed otherwise.
    """
    solids = [(bore, solid) for bore in bores for solid in bore.solids()]
    outlets = {solid: bore for bore, solid in solids if isinstance(solid, RoundedOutlet)}
    holes = [(bore, solid) for bore, solid in solids if not isinstance(solid, RoundedOutlet)]
    body = cut(occ, body, [pair for hole in holes for pair in _tool(occ, *hole, middle_mm)])
    edges = _whole_edges(occ, body, list(outlets)) if outlets and not by_tools else {}
    rounded = _rounded(occ, body, edges)
    left = outlets if rounded is None else outlets.keys() - edges.keys()
    tools = [pair for one in outlets if one in left for pair in _tool(occ, outlets[one], one, middle_mm)]
    return cut(occ, rounded or body, tools)


def _tool(occ: Any, bore: DrillBore, solid: Solid, middle_mm: float) -> DimTags:
    """Return the tool of a bore's solid, up to the middle of the crankpin where its mirror image begins.

    Both then meet in one curve, as the halves of a throw do. Whole tools cross each other there, and the
    kernel loses one of two roundings.
    """
    tool = add_solid(occ, solid)
    first = sum(outlet.point_mm[2] for outlet in bore.outlets) < 2 * middle_mm
    low, high = bore.box_mm(bore.reach_mm)
    if bore.alone or (high[2] <= middle_mm if first else low[2] >= middle_mm):
        return tool
    far = _FAR * float(np.abs([low, high]).max())
    beyond = occ.addBox(-far, -far, middle_mm - (0 if first else far), 2 * far, 2 * far, far)
    return cut(occ, tool, [(3, beyond)])


def drilled_at(
    occ: Any,
    body: DimTags,
    bores: tuple[Sequence[DrillBore], Sequence[DrillBore]],
    turns_deg: tuple[float, float],
    *,
    middle_mm: float,
    by_tools: bool = False,
) -> DimTags:
    """Return a body without the bores of two halves of a throw, each half turned by its angle.

    In one call where both are turned alike, see `_rounded`. Other arguments as of `drilled`.
    """
    alike = turns_deg[0] == turns_deg[1]
    for own, turn in zip([[*bores[0], *bores[1]]] if alike else bores, turns_deg, strict=not alike):
        if own:
            body = turned(occ, body, -turn)
            body = turned(occ, drilled(occ, body, own, middle_mm=middle_mm, by_tools=by_tools), turn)
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
