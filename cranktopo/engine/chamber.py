"""Room of the gas in a cylinder: above one piston, or between two opposed pistons of two cranks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.root import root
from cranktopo.design.schema import Scene
from cranktopo.engine.kinematics import ExactMotion, exact_motion

_TOLERANCE_DEG = 1e-10


@dataclass(frozen=True)
class Piston:
    """A piston by its crank mechanism; `lead_deg` is the angle of its crank ahead of the one looked at."""

    radius_mm: float
    rod_length_mm: float
    lead_deg: float = 0.0


@dataclass(frozen=True)
class Chamber:
    """The room of the gas; crank angles count from the inner dead centre of the first piston.

    Attributes:
        dead_centre_deg: crank angle of the least room, 0 above one piston.
        least_mm: what both pistons are away from their inner dead centres then.
        stroke_mm: by how much their distance changes over a turn.
    """

    pistons: tuple[Piston, ...]
    dead_centre_deg: float
    least_mm: float
    stroke_mm: float

    def volume(self, angle_deg: Array, compression_ratio: float) -> Array:
        """Return the volume over the least one at angles after the least one."""
        way = _way_mm(self.pistons, angle_deg + self.dead_centre_deg)
        return 1.0 + (compression_ratio - 1.0) / self.stroke_mm * (way - self.least_mm)

    def volume_rate(self, angle_deg: Array, compression_ratio: float) -> Array:
        """Return the derivative of the volume per rad."""
        rate = _rate_mm(self.pistons, angle_deg + self.dead_centre_deg)
        return (compression_ratio - 1.0) / self.stroke_mm * rate


def chamber_of(scene: Scene) -> Chamber:
    """Return the room of the gas in each cylinder of a scene's engine."""
    engine = scene.engine
    assert engine is not None
    own = Piston(scene.throw.radius_mm, engine.rod_length_mm)
    other = engine.opposed
    if other is None:
        return chamber(own)
    radius, length = other.radius_mm or own.radius_mm, other.rod_length_mm or own.rod_length_mm
    return chamber(own, Piston(radius, length, other.lead_deg))


@lru_cache(maxsize=32)
def chamber(*pistons: Piston) -> Chamber:
    """Return the room of one piston or of two opposed ones; the first one's crank gives the angles.

    The room is least and largest between the dead centres of both pistons.
    """
    inner, outer = _still_deg(pistons, 0.0), _still_deg(pistons, 180.0)
    least, most = _way_mm(pistons, np.array([inner, outer]))
    return Chamber(pistons, inner, float(least), float(most - least))


def _still_deg(pistons: tuple[Piston, ...], own_deg: float) -> float:
    """Return the crank angle near a dead centre of the first piston where the room stays as it is."""
    lead = pistons[-1].lead_deg
    if not lead:
        return own_deg

    def rate(angle_deg: float) -> float:
        return float(_rate_mm(pistons, np.array([angle_deg]))[0])

    low, high = sorted((own_deg, own_deg - lead))
    return root(rate, low, high, _TOLERANCE_DEG)


def _way_mm(pistons: tuple[Piston, ...], angle_deg: Array) -> Array:
    """Return the sum of the pistons' paths from their inner dead centres."""
    way = np.zeros_like(angle_deg)
    for motion in _motions(pistons, angle_deg):
        way = way + motion.displacement_mm
    return way


def _rate_mm(pistons: tuple[Piston, ...], angle_deg: Array) -> Array:
    """Return the derivative of that sum per rad."""
    rate = np.zeros_like(angle_deg)
    for motion in _motions(pistons, angle_deg):
        rate = rate + motion.radius_mm * motion.velocity_ratio
    return rate


def _motions(pistons: tuple[Piston, ...], angle_deg: Array) -> Iterator[ExactMotion]:
    for one in pistons:
        yield exact_motion(np.radians(angle_deg + one.lead_deg), one.radius_mm, one.rod_length_mm)
