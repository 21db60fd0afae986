"""Exact solids of oil drillings: what they take out of the half throw, their outlets rounded.

`occ` is `gmsh.model.occ` of the open session. The rounding is the kernel's own fillet, made on a plain piece
of the journal: what that piece loses is the tool, whatever else the throw has there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.solid.web import DimTags
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling import DrillBore, DrillOutlet, drill_bores

_ROOM = 2.5
"""Radius of the piece of the journal over that of the outlet with its rounding."""
_ON_EDGE_MM = 1e-3


def add_drillings(occ: Any, scene: Scene, *, alone: bool = False) -> DimTags:
    """The tools that drill the half throw, as gmsh (dimension, tag) pairs; none for most throws.

    Args:
        alone: only those of drillings that the other half has no mirror image of.
    """
    tools: DimTags = []
    for channel in (found for found in drill_bores(scene) if found.alone or not alone):
        tools.append(_cylinder(occ, channel))
        rounded = (mouth for mouth in channel.mouths if mouth.rounding_mm)
        tools += [pair for mouth in rounded for pair in _rounded_outlet(occ, channel, mouth)]
    return tools


def drill(occ: Any, body: DimTags, tools: DimTags) -> DimTags:
    """A body without what the tools take; the body itself where there are none."""
    return list(occ.cut(body, tools)[0]) if tools else body


def _cylinder(occ: Any, channel: DrillBore) -> tuple[int, int]:
    low, high = channel.extent_mm
    start = np.array(channel.mouths[0].point_mm) + low * channel.direction
    return 3, occ.addCylinder(*start, *((high - low) * channel.direction), channel.radius_mm)


def _rounded_outlet(occ: Any, channel: DrillBore, mouth: DrillOutlet) -> DimTags:
    """The drilling in a piece of its journal around the outlet, with the rounding."""
    piece = _piece(occ, channel, mouth)
    bored, _ = occ.cut(occ.copy(piece), [_cylinder(occ, channel)])
    occ.synchronize()  # curves can be asked for their points only then
    edges = _edges(occ, bored, channel, mouth)
    if not edges:
        raise CranktopoError(
            f"{channel.key}: the CAD kernel finds no edge at the outlet on {mouth.journal}.",
            hint="Change diameter_mm slightly.",
            code=ExitCode.SOLVER,
        )
    rounded = occ.fillet([tag for _, tag in bored], edges, [mouth.rounding_mm])
    return list(occ.cut(piece, rounded)[0])


def _piece(occ: Any, channel: DrillBore, mouth: DrillOutlet) -> DimTags:
    """The journal's cylinder within a wider one around the drilling."""
    wide = _ROOM * (channel.radius_mm + mouth.rounding_mm)
    outward, point = np.array(mouth.outward), np.array(mouth.point_mm)
    deep = min(2 * wide, mouth.surface_mm)
    low = point[2] - 4 * wide
    journal = 3, occ.addCylinder(0, mouth.y_mm, low, 0, 0, 8 * wide, mouth.surface_mm)
    around = 3, occ.addCylinder(*(point - deep * outward), *((deep + 2 * wide) * outward), wide)
    return list(occ.intersect([journal], [around])[0])


def _edges(occ: Any, body: DimTags, channel: DrillBore, mouth: DrillOutlet) -> list[int]:
    """The curves of a body that lie on both the journal and the drilling."""
    import gmsh

    found = []
    for _, face in gmsh.model.getBoundary(body, oriented=False):
        for _, curve in gmsh.model.getBoundary([(2, face)], oriented=False):
            (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
            at = gmsh.model.getValue(1, curve, np.linspace(low, high, 7)[1:-1]).reshape(-1, 3)
            away = channel.distance_mm(*at.T) - channel.radius_mm
            deep = np.hypot(at[:, 0], at[:, 1] - mouth.y_mm) - mouth.surface_mm
            if max(np.abs(away).max(), np.abs(deep).max()) < _ON_EDGE_MM:
                found.append(int(curve))
    return sorted(set(found))
