"""Places of the throws, webs, bearings and cylinders of an engine, along the shaft and around it.

Directions count from the engine's plane of symmetry (in line: the cylinders' plane) in the crank's sense of
rotation, at firing top dead centre of the cylinder that fires first; places along the shaft from its middle
toward the takeoff.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.crank_ends import main_journal_places_mm
from cranktopo.design.crank_throws import carried, throw_scenes
from cranktopo.design.engine import Engine
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of


@dataclass(frozen=True)
class EngineLayout:
    """Places and directions; cylinder 1 and its throw first.

    Attributes:
        throw_of: index of each cylinder's throw.
        throw_angle_deg: angle of each throw from the first one: fixed in the shaft.
        pin_deg: angle of each cylinder's part of a split pin ahead of its throw.
        throw_z_mm: plane of each throw's cylinder, in the middle of its rods where it has several.
        axis_deg: direction of each cylinder's axis, from the crank axis to the piston.
        web_places_mm: middle of either web of a throw from the plane of its cylinder; one for each throw
            where these differ.
        journal_z_mm: each main journal, where neighbouring throws meet; one more than throws.
        bearing_z_mm: those of them that sit in a bearing; by default all.
        bay_of: index of the bearing before each throw.
    """

    throw_of: tuple[int, ...]
    throw_angle_deg: Array
    throw_deg: Array
    pin_deg: Array
    throw_z_mm: Array
    axis_deg: Array
    firing_deg: Array
    cylinder_z_mm: Array
    web_places_mm: tuple[float | Array, float | Array]
    journal_z_mm: Array
    bearing_z_mm: Array
    bay_of: tuple[int, ...]

    @property
    def crank_deg(self) -> Array:
        """Direction of each cylinder's part of its crankpin."""
        return np.asarray(self.throw_deg[list(self.throw_of)] + self.pin_deg)

    @property
    def web_z_mm(self) -> Array:
        """Middle of each web, two per throw."""
        return (self.throw_z_mm[:, None] + np.stack(self.web_places_mm, axis=-1)).ravel()

    @property
    def length_mm(self) -> float:
        """Distance of the outer main bearings, mm."""
        return float(self.bearing_z_mm[-1] - self.bearing_z_mm[0])


def engine_layout(scene: Scene) -> EngineLayout:
    """Return the layout of a scene's engine; raises CranktopoError where there is none."""
    engine = engine_of(scene)
    throws, numbers = engine.throws, range(1, engine.cylinders + 1)
    journal_z, throw_z, web_places, rod_offset = _along_shaft(scene, engine)
    bearings = list(carried(scene))
    throw_of = tuple(engine.throw_of(number) for number in numbers)
    axis = np.array([engine.axis_deg(number) for number in numbers]) - engine.bank_angle_deg / 2
    from_middle = np.array([(number - 1) // throws - (engine.rods_per_pin - 1) / 2 for number in numbers])
    first, angle = engine.order[0], np.array(engine.throw_angles_deg)
    pins = np.array([engine.pin_deg(number) for number in numbers])
    return EngineLayout(
        throw_of=throw_of,
        throw_angle_deg=angle,
        throw_deg=(axis[first - 1] - pins[first - 1] + angle - angle[engine.throw_of(first)]) % 360.0,
        pin_deg=pins,
        throw_z_mm=throw_z,
        axis_deg=axis,
        firing_deg=np.array(engine.firing_angles_deg),
        cylinder_z_mm=throw_z[list(throw_of)] + from_middle * rod_offset[list(throw_of)],
        web_places_mm=web_places,
        journal_z_mm=journal_z,
        bearing_z_mm=journal_z[bearings],
        bay_of=tuple(sum(number <= throw for number in bearings) - 1 for throw in range(throws)),
    )


_Places = tuple[float | Array, float | Array]


def _along_shaft(scene: Scene, engine: Engine) -> tuple[Array, Array, _Places, Array]:
    """Places of main journals and throws, of the webs from their throw, and the distance of its rods, mm."""
    throws, every = engine.throws, throw_scenes(scene)
    offset = np.array([throw.rod_offset_mm for throw in every])
    if all(throw is every[0] for throw in every):
        both = halves(every[0])
        pitch = engine.arranged.cylinder_pitch_mm or every[0].pitch_mm
        aside_mm = (both[0].pitch_mm - both[1].pitch_mm) / 4  # of the cylinder, from the middle of the throw
        throw_z = (np.arange(throws, dtype=np.float64) - (throws - 1) / 2) * pitch + aside_mm
        near, far = (_web_place_mm(half) for half in both)
        journal_z = (np.arange(throws + 1, dtype=np.float64) - throws / 2) * pitch
        return journal_z, throw_z, (-near, far), offset
    places = np.array(main_journal_places_mm(scene))
    journal_z = places - places[-1] / 2
    throw_z = journal_z[:-1] + [halves(throw)[0].pitch_mm / 2 for throw in every]
    nears, fars = np.array([[_web_place_mm(half) for half in halves(throw)] for throw in every]).T
    return journal_z, throw_z, (-nears, fars), offset


def _web_place_mm(half: Scene) -> float:
    return (half.throw.crankpin.length_mm + half.web.thickness_mm) / 2


def unit_vectors(angle_deg: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    """Directions as complex numbers: real along the plane of symmetry, imaginary ahead of it."""
    return np.exp(1j * np.radians(angle_deg))
