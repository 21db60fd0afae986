"""The shaft in bearings of any kind over the cycle, also with play, and in the oil films that carry it.

With play or films the forces of the bearings follow from where the journals lie: those of rigid bearings, and
what the stiffness of the shaft adds when it is bent into its bearings.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.bodies.crank_ends import SIDES, crank_end
from cranktopo.design.crank_throws import carried
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.bearings import bearing_tilt_spring_Nmm_per_rad, radial_play_mm
from cranktopo.engine.gas import pressure_curve
from cranktopo.numerics.bearing_film.coupled import coupled_orbits
from cranktopo.numerics.ring_contact import sections_in_rings
from cranktopo.tasks.film.stage import main_bearing, plain_bearings
from cranktopo.tasks.shaft.cycle import (
    CycleForces,
    ShaftCycle,
    bent_into_bearings_N_per_mm,
    journal_loads_N,
    shaft_cycle,
)
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow

Support = float | Literal["clearance", "film"] | None
"""Radial stiffness of every main bearing, N/mm; None: rigid; "clearance": rigid with the play of the scene;
"film": the oil of its `[bearings]`."""


def carried_cycle(
    throws: Sequence[LoadedThrow], scene: Scene, forces: CycleForces, support: Support
) -> ShaftCycle:
    """Solve the shaft of a scene at its speed, in those bearings that it has.

    Raises:
        CranktopoError: films without `[bearings]`, or journals that do not become steady.
    """
    angles, borne_by, tilt = scene.shaft_angles_deg, carried(scene), bearing_tilt_spring_Nmm_per_rad(scene)
    stiff = rigid_sections(scene)
    if support is None or isinstance(support, float):
        return shaft_cycle(throws, angles, forces, support, borne_by, None, tilt, stiff)
    rigid = shaft_cycle(throws, angles, forces, None, borne_by, None, tilt, stiff)
    lying = film_offsets_mm if support == "film" else play_offsets_mm
    offset_mm = lying(throws, scene, rigid)
    return shaft_cycle(throws, angles, forces, None, borne_by, offset_mm, tilt, stiff)


def rigid_sections(scene: Scene) -> list[int]:
    """Return the sections that stay rigid: those behind which an end of the crank goes on."""
    ends = zip(SIDES, (0, len(scene.shaft_angles_deg)), strict=True)
    return [section for side, section in ends if crank_end(scene, side)]


def check_film(scene: Scene) -> None:
    """Refuse films that nothing loads or that do not carry; raises CranktopoError."""
    plain_bearings(scene)
    if pressure_curve(scene) is None or not engine_of(scene).speed_rpm:
        raise CranktopoError(
            f"{scene.name}: --bearings film needs pressures [engine.gas] and an engine that turns.",
            hint="Add them, or choose --bearings rigid.",
            code=ExitCode.USAGE,
        )


def film_offsets_mm(throws: Sequence[LoadedThrow], scene: Scene, rigid: ShaftCycle) -> Array:
    """Return x and y of every carried journal in its bearing, in axes that turn with the shaft.

    Shape (2 bearings, states), mm.

    Args:
        rigid: the cycle of the same shaft in rigid bearings.

    Raises:
        CranktopoError: no `[bearings]`, or journals that do not become steady.
    """
    numbers = carried(scene)
    bearings = [main_bearing(scene, number) for number in numbers]
    clearance = np.array([bearing.clearance_mm for bearing in bearings])
    bent = bent_into_bearings(throws, scene)
    held = journal_loads_N(rigid)[list(numbers)]
    states, cycle_rad = held.shape[1], np.radians(engine_of(scene).cycle_deg)

    def load_N(angle_rad: float, eccentricity: Complex) -> Complex:
        place = angle_rad / cycle_rad * states
        low = int(place)
        one, next_one = held[:, low % states], held[:, (low + 1) % states]
        turn = np.exp(1j * np.radians(about_z_deg(np.degrees(angle_rad))))
        force = bent @ _x_and_y(clearance * eccentricity * turn)
        return np.asarray(one + (place - low) * (next_one - one) - (force[1::2] + 1j * force[::2]) / turn)

    speed = angular_speed_rad_s(engine_of(scene).speed_rpm)
    path = coupled_orbits(bearings, speed, load_N, rigid.angle_deg)
    turn = np.exp(1j * np.radians([about_z_deg(angle) for angle in rigid.angle_deg]))[:, None]
    return _x_and_y((clearance * path * turn).T)


def play_offsets_mm(throws: Sequence[LoadedThrow], scene: Scene, rigid: ShaftCycle) -> Array:
    """Return what `film_offsets_mm` does of rigid bearings with play, without friction and oil.

    Raises:
        CranktopoError: no clearance, or a state without an answer.
    """
    numbers, bent = carried(scene), bent_into_bearings(throws, scene)
    held = -rigid.bearing_N[list(numbers)].reshape(2 * len(numbers), -1)
    return sections_in_rings(bent, held, np.full(len(numbers), radial_play_mm(scene)))


def bent_into_bearings(throws: Sequence[LoadedThrow], scene: Scene) -> Array:
    """Return `bent_into_bearings_N_per_mm` of the shaft of a scene."""
    tilt, stiff = bearing_tilt_spring_Nmm_per_rad(scene), rigid_sections(scene)
    return bent_into_bearings_N_per_mm(throws, scene.shaft_angles_deg, carried(scene), tilt, stiff)


def _x_and_y(place: Complex) -> Array:
    """Return imaginary and real part of each row, one below the other."""
    return np.stack([place.imag, place.real], axis=1).reshape(2 * len(place), *place.shape[1:])
