"""The zone of a bolted counterweight in which no web is designed: its own space, and its seat in the web.

The seat is the layer of the web along the counterweight's inner face, which is the outline of the web.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from manifold3d import CrossSection, FillRule, JoinType, Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.notes import warn
from cranktopo.base.spans import Section, holds, polygon_section
from cranktopo.design.bolt_holes import BoltHole, bolt_holes
from cranktopo.design.schema import Scene
from cranktopo.design.seat import seat_mm
from cranktopo.throw.counterweight.checks import within
from cranktopo.throw.fitted import CLEAR_MM

_STEP_MM, _HEIGHTS, _AROUND = 0.5, 15, 24
"""Distance of the points at which cuts of a seat are looked for; heights; points around a thread."""
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


def seat_cuts(scene: Scene) -> tuple[str, ...]:
    """Return the keys of features of the web that cut the seat of its counterweight, or threads of its bolts.

    Found at points of the seat, half a millimetre apart; bores and recesses of journals are no features.
    """
    ends = seat_z_mm(scene)
    if ends is None:
        return ()
    threads = [_thread_points(bolt) for bolt in bolt_holes(scene)]
    at = np.concatenate([_seat_points(scene, ends), *threads], axis=1)
    cuts = (
        (path, body)
        for path, feature in scene.web.features()
        for body in feature.bodies(scene, path)
        if not body.adds
    )
    return tuple(dict.fromkeys(path for path, body in cuts if within(body, at).any()))


def cut_seat_text(scene: Scene) -> str:
    """Return a warning about features that cut the seat, a design's own or a result's; empty without any."""
    cuts = seat_cuts(scene)
    if not cuts:
        return ""
    return f"{scene.name}: {', '.join(cuts)} cut the seat of web.counterweight, which is bolted to the web"


def warn_of_cut_seat(scene: Scene) -> None:
    """Warn of features of a design that is about to be written and that cut the seat."""
    if text := cut_seat_text(scene):
        warn(text)


def _seat_points(scene: Scene, ends: tuple[float, float]) -> Array:
    """Return points (3, n) inside the seat, clear of its surfaces by what those of a web may move."""
    seat = _zone(scene) ^ CrossSection([_outline_mm(scene)], FillRule.NonZero)
    inner = seat.offset(-CLEAR_MM, JoinType.Round).to_polygons()
    low_x, low_y, high_x, high_y = seat.bounds()
    x, y = (np.arange(low, high, _STEP_MM) for low, high in ((low_x, high_x), (low_y, high_y)))
    held = holds(polygon_section([np.asarray(one) for one in inner])(y, y), x[:, None])
    flat = np.stack([np.broadcast_to(x[:, None], held.shape)[held], np.broadcast_to(y, held.shape)[held]])
    z = np.linspace(ends[0] + CLEAR_MM, ends[1] - CLEAR_MM, _HEIGHTS)
    return np.vstack([np.repeat(flat, z.size, axis=1), np.tile(z, flat.shape[1])])


def _thread_points(bolt: BoltHole) -> Array:
    """Return points (3, n) of the axis of a thread and of its wall."""
    radii = np.array([0.0, bolt.joint.nominal.diameter_mm / 2])
    return bolt.wall_mm(radii, np.arange(bolt.joint_mm, bolt.floor_mm, _STEP_MM), _AROUND)


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
