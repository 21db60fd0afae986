"""Bolts of a counterweight in their places: thread holes in the web, holes and seats of heads beside it.

Their axes run along the throw. The thread begins at the joint, which is the outline of the web; the head sits
below the grip of its `[[bolted_joint]]`, in a hole from the rim.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.bolt import BoltedJoint
from cranktopo.design.schema import Scene
from cranktopo.throw.primitives import Cylinder

RUN_OUT_PITCHES = 4.0
"""Depth of a core hole beyond its thread over the pitch; its floor is flat."""
_WIDER = 1.2
"""Diameter of the hole of a head over that of its bearing face."""
_SAMPLES, _HALVINGS = 801, 50


@dataclass(frozen=True)
class BoltHole:
    """Holes of one bolt: along y at (x, z), mm; heights are places along the throw.

    Attributes:
        key: its table in the scene.
        joint_mm: where its axis leaves the web.
    """

    key: str
    joint: BoltedJoint
    x_mm: float
    z_mm: float
    joint_mm: float

    @property
    def seat_mm(self) -> float:
        """Place of the seat of its head, a grip below the joint."""
        return self.joint_mm - self.joint.grip_mm

    @property
    def thread_mm(self) -> float:
        """Place of the end of the thread in the web."""
        return self.joint_mm + self.joint.engaged_mm

    @property
    def floor_mm(self) -> float:
        """Place of the floor of the core hole."""
        return self.thread_mm + RUN_OUT_PITCHES * self.joint.nominal.pitch_mm

    @property
    def head_end_mm(self) -> float:
        """Place of the outer end of its head, as high as its thread is wide (ISO 4762)."""
        return self.seat_mm - self.joint.nominal.diameter_mm

    def at(self, joint_mm: float) -> BoltHole:
        """Return it at another joint."""
        return replace(self, joint_mm=joint_mm)

    @property
    def core_radius_mm(self) -> float:
        """Radius of the core hole, in which the thread is cut."""
        return self.joint.nominal.nut_core_diameter_mm / 2

    @property
    def hole_radius_mm(self) -> float:
        """Radius of the hole through the counterweight."""
        return self.joint.hole_mm / 2

    @property
    def head_radius_mm(self) -> float:
        """Radius of the hole of its head."""
        return _WIDER * self.joint.head_mm / 2

    def thread_tool(self, far_mm: float) -> Cylinder:
        """Return what is drilled out of the web, from `far_mm` below the crank axis on."""
        return self._along(-far_mm, self.floor_mm, self.core_radius_mm)

    def weight_tools(self, far_mm: float) -> tuple[Cylinder, Cylinder]:
        """Return what is drilled out of the counterweight: hole, and hole of the head from `far_mm` on."""
        return (
            self._along(self.seat_mm, 0.0, self.hole_radius_mm),
            self._along(-far_mm, self.seat_mm, self.head_radius_mm),
        )

    def wall_mm(self, radius_mm: Array | float, y_mm: Array, around: int) -> Array:
        """Return points (3, n) at radii about its axis, all around at each height along the throw."""
        turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
        places = np.meshgrid(turn, y_mm, radius_mm)
        turn, y, radius = (grid.ravel() for grid in places)
        return np.stack([self.x_mm + radius * np.cos(turn), y, self.z_mm + radius * np.sin(turn)])

    def _along(self, low_mm: float, high_mm: float, radius_mm: float) -> Cylinder:
        return Cylinder((self.x_mm, low_mm, self.z_mm), (0.0, high_mm - low_mm, 0.0), radius_mm)


@lru_cache(maxsize=32)
def bolt_holes(scene: Scene) -> tuple[BoltHole, ...]:
    """Return the placed bolts of a half throw's counterweight; empty without any, or where it is no own part.

    Heights of the joint are those of the scene's outline, which a search may move.
    """
    weight = scene.web.counterweight
    if weight is None or not weight.bolted:
        return ()
    middle = sum(weight.sector(scene).z_mm) / 2

    def joint_mm(x: float) -> float:
        return float(lower_end_mm(scene, np.array([x]))[0])

    return tuple(
        BoltHole(f"bolted_joint[{number}]", joint, x, middle + z, joint_mm(x))
        for number, joint in enumerate(scene.bolted_joint)
        for x, z in joint.places_mm
        if joint.holds == "web.counterweight"
    )


def lower_end_mm(scene: Scene, x_mm: Array) -> Array:
    """Return where lines along the throw at places across it leave the outline of the web at its lower end.

    NaN where they miss the outline below the crank axis.
    """
    web, radius = scene.web, scene.throw.radius_mm
    y = np.linspace(web.y_range_mm(radius)[0], 0.0, _SAMPLES)
    reaches = web.half_width_mm(radius, y) >= np.abs(x_mm)[..., None]
    first = reaches.argmax(axis=-1)
    high, low = y[first], y[np.maximum(first - 1, 0)]
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        held = web.half_width_mm(radius, middle) >= np.abs(x_mm)
        low, high = np.where(held, low, middle), np.where(held, middle, high)
    return np.where(reaches.any(axis=-1), high, np.nan)


def far_mm(scene: Scene) -> float:
    """Return a distance below the crank axis that lies beyond web and counterweight."""
    weight = scene.web.counterweight
    low, _ = scene.web.y_range_mm(scene.throw.radius_mm)
    return 1.5 * max(-low, weight.outer_radius_mm if weight else 0.0)
