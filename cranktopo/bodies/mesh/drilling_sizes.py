"""Element sizes at oil drillings: as fine as their radius along them, finer at their outlets."""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling import DrillBore, DrillOutlet, drill_bores

_GROWTH = 0.5
"""Growth of the element size per mm of distance."""
_ALONG, _OUTLET = 1.0, 0.5
"""Element size along a drilling and at its outlets over its radius."""


def drilling_size_terms(scene: Scene, size: float, fraction: float | None, full: bool) -> list[str]:
    """Formulae of the largest element size in x, y and z, mm; none where there is no drilling.

    Args:
        size: general element size.
        fraction: element size on a rounded outlet over its radius; None for what stiffness needs.
        full: of the full throw, both of its halves.
    """
    terms = []
    heights = ("z", f"({scene.pitch_mm!r}-z)")[: 1 + full]
    for z, half in zip(heights, halves(scene), strict=False):
        for channel in drill_bores(half):
            terms.append(_along(channel, size, z))
            terms += [_at(mouth, channel, size, fraction, z) for mouth in channel.mouths]
    return terms


def drilling_size_mm(scene: Scene, size: float, points_mm: Array) -> Array:
    """Largest element size at points (n, 3) of the half throw, mm, for stiffness."""
    result = np.full(len(points_mm), size)
    for channel in drill_bores(scene):
        start, direction = np.array(channel.mouths[0].point_mm), channel.direction
        away = np.linalg.norm(np.cross(points_mm - start, direction), axis=1)
        result = np.minimum(result, _fine(size, _ALONG * channel.radius_mm) + _GROWTH * away)
        for mouth in channel.mouths:
            away = np.maximum(
                np.linalg.norm(points_mm - np.array(mouth.point_mm), axis=1) - _rim(channel, mouth), 0.0
            )
            result = np.minimum(result, _fine(size, _OUTLET * channel.radius_mm) + _GROWTH * away)
    return result


def _fine(size: float, wanted: float) -> float:
    return min(size, wanted)


def _rim(channel: DrillBore, mouth: DrillOutlet) -> float:
    """Radius around an outlet that is meshed finely."""
    return channel.radius_mm + mouth.rounding_mm


def _along(channel: DrillBore, size: float, height: str) -> str:
    (px, py, pz), (dx, dy, dz) = channel.mouths[0].point_mm, channel.direction.tolist()
    x, y, z = f"(x-({px!r}))", f"(y-({py!r}))", f"({height}-({pz!r}))"
    cross = f"({y}*({dz!r})-{z}*({dy!r}))^2+({z}*({dx!r})-{x}*({dz!r}))^2+({x}*({dy!r})-{y}*({dx!r}))^2"
    return f"{_fine(size, _ALONG * channel.radius_mm)!r}+{_GROWTH!r}*Sqrt({cross})"


def _at(mouth: DrillOutlet, channel: DrillBore, size: float, fraction: float | None, z: str) -> str:
    px, py, pz = mouth.point_mm
    notch = mouth.rounding_mm or channel.radius_mm
    finest = _fine(size, _OUTLET * channel.radius_mm if fraction is None else fraction * notch)
    distance = f"Sqrt((x-({px!r}))^2+(y-({py!r}))^2+({z}-({pz!r}))^2)"
    return f"{finest!r}+{_GROWTH!r}*Max(0,{distance}-{_rim(channel, mouth)!r})"
