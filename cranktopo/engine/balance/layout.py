"""Where the throws, webs, bearings and cylinders of an engine are, along the shaft and around it.

Directions count from the engine's plane of symmetry (in line: the cylinders' plane) in the crank's sense of
rotation, at firing top dead centre of the cylinder that fires first; places along the shaft from its middle
toward the takeoff.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of


@dataclass(frozen=True)
class EngineLayout:
    """Places and directions; cylinder 1 and its throw first.

    Attributes:
        throw_of: index of each cylinder's throw.
        throw_angle_deg: angle of each throw from the first one: fixed in the shaft.
        throw_z_mm: plane of each throw's cylinder, between its two rods where it has two.
        axis_deg: direction of each cylinder's axis, from the crank axis to the piston.
        web_places_mm: middle of either web of a throw from the plane of its cylinder.
        bearing_z_mm: each main bearing, one more than throws, where neighbouring throws meet.
    """

    throw_of: tuple[int, ...]
    throw_angle_deg: Array
    throw_deg: Array
    throw_z_mm: Array
    axis_deg: Array
    firing_deg: Array
    cylinder_z_mm: Array
    web_places_mm: tuple[float, float]
    bearing_z_mm: Array

    @property
    def web_z_mm(self) -> Array:
        """Middle of each web, two per throw."""
        return (self.throw_z_mm[:, None] + np.array(self.web_places_mm)).ravel()

    @property
    def length_mm(self) -> float:
        """Distance of the outer main bearings, mm."""
        return float(self.bearing_z_mm[-1] - self.bearing_z_mm[0])


def engine_layout(scene: Scene) -> EngineLayout:
    """Return the layout of a scene's engine; raises CranktopoError where there is none."""
    engine, both = engine_of(scene), halves(scene)
    arranged, throws, numbers = engine.arranged, engine.throws, range(1, engine.cylinders + 1)
    pitch = arranged.cylinder_pitch_mm or scene.pitch_mm
    aside_mm = (both[0].pitch_mm - both[1].pitch_mm) / 4  # of the cylinder, from the middle of the throw
    throw_z = (np.arange(throws, dtype=np.float64) - (throws - 1) / 2) * pitch + aside_mm
    near_mm, far_mm = ((half.throw.crankpin.length_mm + half.web.thickness_mm) / 2 for half in both)
    throw_of = tuple(engine.throw_of(number) for number in numbers)
    axis = np.array([engine.axis_deg(number) for number in numbers]) - engine.bank_angle_deg / 2
    side = np.array([1.0 if number > throws else -1.0 for number in numbers])
    first, angle = engine.order[0], np.array(engine.throw_angles_deg)
    return EngineLayout(
        throw_of=throw_of,
        throw_angle_deg=angle,
        throw_deg=(axis[first - 1] + angle - angle[engine.throw_of(first)]) % 360.0,
        throw_z_mm=throw_z,
        axis_deg=axis,
        firing_deg=np.array(engine.firing_angles_deg),
        cylinder_z_mm=throw_z[list(throw_of)] + side * scene.rod_offset_mm / 2,
        web_places_mm=(-near_mm, far_mm),
        bearing_z_mm=(np.arange(throws + 1, dtype=np.float64) - throws / 2) * pitch,
    )


def unit_vectors(angle_deg: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    """Directions as complex numbers: real along the plane of symmetry, imaginary ahead of it."""
    return np.exp(1j * np.radians(angle_deg))
