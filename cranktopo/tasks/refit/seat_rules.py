"""Rules that keep the seat of a bolted counterweight, and what its bolts need, while a web changes.

Seat and threads follow the outline. They are points inward of it, which no feature may reach.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.bolt_holes import BoltHole, bolt_holes
from cranktopo.design.schema import Scene
from cranktopo.design.seat import seat_mm
from cranktopo.throw.feature import least_shoulder_mm
from cranktopo.throw.fitted import CLEAR_MM, FittedFeature, Named, Rule

_INWARD_MM, _STEP_MM, _HEIGHTS, _AROUND = 0.05, 0.5, 9, 24
"""Distance of the points from the surfaces of the web, and from each other; heights; points about a bolt."""
_SEAT, _THREADS = "seat of the bolted counterweight", "threads of the counterweight's bolts"
_HEADS = "heads of the counterweight's bolts lie below its rim"
_BETWEEN = "heads of the counterweight's bolts stay clear of the web"


class _Places(NamedTuple):
    """Places that must stay at an outline: points (3, n) of seat and threads at x >= 0, and bolts."""

    seat: Array
    threads: Array
    bolts: tuple[BoltHole, ...]


def seat_rules(
    scene: Scene, outline_mm: Array, named: Sequence[tuple[FittedFeature, Named]]
) -> Iterator[Rule]:
    """Yield the rules, mm, of a bolted counterweight: each feature, bores, outline and rim; none without one.

    Args:
        outline_mm: points (n, 2) of the outline's right half, upward.
    """
    weight = scene.web.counterweight
    if weight is None or not weight.bolted:
        return
    places = _places(scene, outline_mm)
    ends = outline_mm[[0, -1], 1]
    for part, values in named:
        for what, (x, y, z) in ((_SEAT, places.seat), (_THREADS, places.threads)):
            if x.size:
                away = part.outside_mm(values, ends, (x, y, z), scene.web_z_mm)
                yield f"the {part.title} does not cut the {what}", CLEAR_MM - float(np.min(away))
    if places.bolts:
        yield f"the bore of the main journal does not cut the {_THREADS}", _in_bore(scene, places.threads)
        x, y, _ = places.threads[:, places.threads[1] > places.threads[1].max() - _STEP_MM / 2]
        yield (
            f"the outline does not cut the {_THREADS}",
            CLEAR_MM + float((x - _half_mm(outline_mm, y)).max()),
        )
        yield from _head_rules(scene, outline_mm, places.bolts)


def _places(scene: Scene, outline_mm: Array) -> _Places:
    bolts = tuple(_moved(bolt, outline_mm) for bolt in bolt_holes(scene) if bolt.x_mm >= 0)
    threads = [_thread(bolt, outline_mm) for bolt in bolts]
    return _Places(_seat(scene, outline_mm), np.concatenate([np.zeros((3, 0)), *threads], axis=1), bolts)


def _seat(scene: Scene, outline_mm: Array) -> Array:
    """Return points of the layer along the counterweight's inner face, on lines across the outline."""
    weight, layer = scene.web.counterweight, seat_mm(scene)
    assert weight is not None
    assert layer is not None
    at, inward = _joint(outline_mm, np.radians(weight.half_angle_deg))
    low, high = weight.sector(scene).z_mm
    depth = np.linspace(_INWARD_MM, layer - _INWARD_MM, max(2, int(np.ceil(layer / _STEP_MM))))
    flat = (at[:, None] + depth[:, None] * inward[:, None]).reshape(-1, 2)
    heights = np.linspace(low + _INWARD_MM, high - _INWARD_MM, _HEIGHTS)
    x, y = (np.repeat(axis, heights.size) for axis in flat.T)
    return np.stack([x, y, np.tile(heights, len(flat))])


def _joint(outline_mm: Array, half_angle: float) -> tuple[Array, Array]:
    """Return points (n, 2) of an outline's lower end within an angle from the line away from the crankpin.

    With unit vectors into the web at them.
    """
    points = outline_mm if outline_mm[0, 0] <= 0 else np.vstack([[0.0, outline_mm[0, 1]], outline_mm])
    turn, reach = np.arctan2(points[:, 0], -points[:, 1]), np.hypot(*points.T)
    at = np.linspace(0.0, half_angle, max(3, int(np.ceil(half_angle * reach.max() / _STEP_MM))))
    radius = np.interp(at, turn, reach)
    joint = np.stack([radius * np.sin(at), -radius * np.cos(at)], axis=1)
    along = np.gradient(joint, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-12)[:, None]
    return joint, np.stack([-along[:, 1], along[:, 0]], axis=1)


def _moved(bolt: BoltHole, outline_mm: Array) -> BoltHole:
    """Return a bolt at the joint that an outline makes."""
    return bolt.at(_lower_end_mm(outline_mm, bolt.x_mm))


def _lower_end_mm(outline_mm: Array, x_mm: float) -> float:
    """Return where a line along the throw leaves an outline at its lower end."""
    x, y = outline_mm[: int(np.argmax(outline_mm[:, 0])) + 1].T
    return float(np.interp(x_mm, np.maximum.accumulate(x), y))


def _thread(bolt: BoltHole, outline_mm: Array) -> Array:
    """Return points of the wall of a thread, where it is closed all around, and of its floor."""
    radius = bolt.joint.nominal.diameter_mm / 2
    low, high = _lower_end_mm(outline_mm, bolt.x_mm + radius) + _INWARD_MM, bolt.floor_mm
    y = np.linspace(min(low, high), high, max(2, int(np.ceil((high - low) / _STEP_MM))))
    return bolt.wall_mm(radius, y, _AROUND)


def _in_bore(scene: Scene, at: Array) -> float:
    bore = scene.throw.main_journal.bore_radius_mm
    return CLEAR_MM + bore - float(np.hypot(at[0], at[1]).min()) if bore else -CLEAR_MM


def _half_mm(outline_mm: Array, y: Array) -> Array:
    x, at = outline_mm.T
    return np.interp(y, at, x)


def _head_rules(scene: Scene, outline_mm: Array, bolts: Sequence[BoltHole]) -> Iterator[Rule]:
    weight, least = scene.web.counterweight, least_shoulder_mm(scene.throw) + CLEAR_MM
    assert weight is not None
    for bolt in bolts:
        out = bolt.head_radius_mm + least
        rim = float(np.sqrt(max(weight.outer_radius_mm**2 - (bolt.x_mm + out) ** 2, 0.0)))
        yield _HEADS, CLEAR_MM - rim - bolt.head_end_mm
        yield _BETWEEN, bolt.seat_mm + least - _lower_end_mm(outline_mm, max(0.0, bolt.x_mm - out))
