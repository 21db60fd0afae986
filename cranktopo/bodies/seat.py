"""The zone of a bolted counterweight in which no web is designed: its own space, and its seat in the web.

The seat is the layer of the web along the counterweight's inner face, which is the outline of the web.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from manifold3d import CrossSection, FillRule, JoinType, Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Section, polygon_section
from cranktopo.design.schema import Scene
from cranktopo.design.seat import seat_mm

_OUTLINE, _SIDES = 1001, 1024
"""Points of each side of the outline, dense at its ends; sides of a full circle."""


def seat_z_mm(scene: Scene) -> tuple[float, float] | None:
    """Return the range of a bolted counterweight along the crank axis; None without one."""
    weight = scene.web.counterweight
    return None if weight is None or not weight.bolted else weight.sector(scene).z_mm


def seat_section(scene: Scene, z_mm: float) -> Section | None:
    """Return the zone at a height; None where there is none."""
    ends = seat_z_mm(scene)
    if ends is None or not ends[0] < z_mm < ends[1]:
        return None
    return polygon_section([np.asarray(contour) for contour in _zone(scene).to_polygons()])


def seat_solid(scene: Scene) -> Manifold:
    """Return the zone as a body; empty without a bolted counterweight."""
    ends = seat_z_mm(scene)
    if ends is None:
        return Manifold()
    return _zone(scene).extrude(ends[1] - ends[0]).translate((0.0, 0.0, ends[0]))


def sector_less_web(scene: Scene) -> CrossSection:
    """Return the sector of a counterweight outside the outline of its web; empty without a bolted one."""
    if seat_z_mm(scene) is None:
        return CrossSection()
    return _sector(scene) - CrossSection([_outline_mm(scene)], FillRule.NonZero)


@lru_cache(maxsize=8)
def _zone(scene: Scene) -> CrossSection:
    """Return the sector of the counterweight less what of the web lies deeper than the seat."""
    layer = seat_mm(scene)
    assert layer is not None
    deeper = CrossSection([_outline_mm(scene)], FillRule.NonZero).offset(-layer, JoinType.Round)
    return _sector(scene) - deeper


def _sector(scene: Scene) -> CrossSection:
    weight = scene.web.counterweight
    assert weight is not None
    return CrossSection([weight.sector(scene).polygon_mm(lambda _: _SIDES)], FillRule.NonZero)


def _outline_mm(scene: Scene) -> Array:
    """Return points (n, 2) of the outline, counter-clockwise."""
    web, radius = scene.web, scene.throw.radius_mm
    low, high = web.y_range_mm(radius)
    y = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(0, np.pi, _OUTLINE))
    half = web.half_width_mm(radius, y)
    return np.column_stack([np.r_[half, -half[::-1]], np.r_[y, y[::-1]]])
