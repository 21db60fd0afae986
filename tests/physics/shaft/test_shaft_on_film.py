"""A shaft in the oil films that carry it: against films of given loads, statics and rigid bearings."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from cranktopo import load_scene, with_values
from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.design.schema import Scene
from cranktopo.numerics.bearing_film.orbit import Orbit
from cranktopo.tasks.film.stage import LoadedBearing, main_bearing, orbits_of
from cranktopo.tasks.shaft.cycle import (
    CycleForces,
    ShaftCycle,
    bent_into_bearings_N_per_mm,
    cycle_forces,
    journal_loads_N,
    journal_tilts,
    loads_on_bearings_N,
    shaft_cycle,
)
from cranktopo.tasks.shaft.on_film import film_offsets_mm
from tests.physics.shaft.test_continuous_shaft import WITH_PIN_MM, beam_throw

FOUR = load_scene("car-diesel")
THROW = beam_throw(WITH_PIN_MM, 3)


@cache
def on_film(scene: Scene) -> tuple[ShaftCycle, ShaftCycle, Array]:
    """The cycle in rigid bearings, that in films, and the offsets of the journals."""
    throws, angles = [THROW] * len(scene.shaft_angles_deg), scene.shaft_angles_deg
    forces: CycleForces = cycle_forces(scene)
    rigid = shaft_cycle(throws, angles, forces, None)
    offset = film_offsets_mm(throws, scene, rigid)
    return rigid, shaft_cycle(throws, angles, forces, None, offset_mm=offset), offset


def under_the_loads_of(cycle: ShaftCycle, scene: Scene) -> list[Orbit]:
    """Orbits of all main journals, each on its own, under the loads that a cycle has."""
    loads, still = loads_on_bearings_N(cycle), np.zeros_like(cycle.angle_deg)
    bearings = [
        LoadedBearing(f"main {n + 1}", main_bearing(scene, n), load[1] + 1j * load[0], still)
        for n, load in enumerate(loads)
    ]
    (found,) = orbits_of([(scene, bearings, cycle.angle_deg)])
    return found


def test_a_tilted_journal_leads_off_as_its_axis_turns() -> None:
    """A point of its axis one unit along z moves by the cross product; turned like a force that pushes it."""
    draw = np.random.default_rng(3)
    angle = np.arange(0.0, 720.0, 30.0)
    motion = draw.uniform(-1e-3, 1e-3, (18, len(angle)))
    moved = np.empty((3, 2, len(angle)))
    for section, state in np.ndindex(3, len(angle)):
        turned = motion[6 * section + 3 : 6 * section + 6, state] * [1.0, 1.0, 0.0]
        moved[section, :, state] = np.cross(turned, [0.0, 0.0, 1.0])[:2]
    pushed = ShaftCycle(angle, motion, -moved, np.zeros((2, 12, len(angle))))
    assert journal_tilts(pushed) == pytest.approx(journal_loads_N(pushed), abs=1e-15)


@pytest.mark.slow
def test_each_journal_runs_as_under_the_load_that_it_has() -> None:
    """Another integrator finds the orbit of each journal alone from the forces of the whole shaft."""
    rigid, film, offset = on_film(FOUR)
    turn = np.exp(-1j * np.radians([about_z_deg(angle) for angle in film.angle_deg]))
    for n, orbit in enumerate(under_the_loads_of(film, FOUR)):
        own = (offset[2 * n + 1] + 1j * offset[2 * n]) * turn / main_bearing(FOUR, n).clearance_mm
        assert np.abs(orbit.eccentricity - own).max() < 5e-3
    alone = under_the_loads_of(rigid, FOUR)[1].eccentricity
    own = (offset[3] + 1j * offset[2]) * turn / main_bearing(FOUR, 1).clearance_mm
    assert np.abs(alone - own).max() > 0.05, "the bearings share the loads otherwise"


def test_forces_and_moments_stay_in_balance() -> None:
    """Films change what each bearing carries, not what all carry, nor its moment."""
    rigid, film, _ = on_film(FOUR)
    size = np.abs(rigid.bearing_N).max()
    assert np.abs(film.bearing_N - rigid.bearing_N).max() > 0.02 * size
    changed = film.bearing_N - rigid.bearing_N
    place = np.arange(len(changed))[:, None, None]
    assert np.abs(changed.sum(axis=0)).max() < 1e-8 * size
    assert np.abs((place * changed).sum(axis=0)).max() < 1e-8 * size


def test_bearings_far_from_rigid_give_way_to_the_bent_shaft() -> None:
    """Energy of a motion of the journals: nothing for a rigid motion, symmetric, never a gain."""
    bent = bent_into_bearings_N_per_mm([THROW] * 4, FOUR.shaft_angles_deg, range(5))
    size = np.abs(bent).max()
    along = np.arange(5.0)
    for column in (np.tile([1.0, 0.0], 5), np.kron(along, [0.0, 1.0])):
        assert np.abs(bent @ column).max() < 1e-8 * size
    assert np.abs(bent - bent.T).max() < 1e-9 * size
    assert np.linalg.eigvalsh((bent + bent.T) / 2).min() > -1e-8 * size


@pytest.mark.slow
def test_little_clearance_is_a_rigid_bearing() -> None:
    rigid, film, _ = on_film(FOUR)
    tight = with_values(FOUR, {"bearings.clearance_mm": 0.004})
    _, near, _ = on_film(tight)
    far = np.abs(film.bearing_N - rigid.bearing_N).max()
    assert np.abs(near.bearing_N - rigid.bearing_N).max() < 0.2 * far


def test_two_bearings_carry_what_statics_says() -> None:
    single = with_values(FOUR, {"engine.cylinders": 1, "engine.firing_order": (1,)})
    rigid, film, _ = on_film(single)
    assert np.abs(film.bearing_N - rigid.bearing_N).max() < 1e-8 * np.abs(rigid.bearing_N).max()
