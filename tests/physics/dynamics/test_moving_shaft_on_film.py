"""The shaft with its mass in oil films: without mass, in films that hardly yield, its energy, begun later."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed
from cranktopo.numerics.bearing_film.in_motion import CarriedShaft, FilmSlopes, moving_journals
from cranktopo.numerics.harmonic_balance import harmonics_of
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft, ShaftHarmonics, moving_cycle
from cranktopo.tasks.dynamics.on_film import check_steady, cycle_on_film, journals_in_film
from cranktopo.tasks.film.stage import main_bearing
from cranktopo.tasks.shaft.cycle import CycleForces, shaft_cycle
from cranktopo.tasks.shaft.on_film import film_offsets_mm
from tests.physics.dynamics.shafts import Array, forces_at, shaft_of
from tests.physics.dynamics.test_moving_shaft import PROPELLER, apart, worked

RPM, CLEARANCE_MM = 2100.0, 0.025


def scene_of(clearance_mm: float = 0.05, viscosity_mPas: float = 9.0, **shaft: Any) -> Scene:
    """The plain Mikron at a speed, in plain bearings, with parts on its shaft."""
    data: dict[str, Any] = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["bearings"] = {"clearance_mm": clearance_mm, "viscosity_mPas": viscosity_mPas}
    return at_speed(scene_from_dict({**data, "shaft": shaft} if shaft else data), RPM)


@cache
def forces(stride: int = 3) -> CycleForces:
    """At every so many of the states, which are one a degree."""
    every = forces_at(scene_of(), RPM)
    curves = {
        one.name: getattr(every, one.name)[..., ::stride]
        for one in fields(every)
        if isinstance(getattr(every, one.name), np.ndarray)
    }
    return replace(every, **curves)


def weighing(shaft: MovingShaft, share: float) -> MovingShaft:
    """The same shaft of a material with a part of its mass, and no loss."""

    def light(body: TurningBody) -> TurningBody:
        return replace(body.times(share), stiffness=body.stiffness)

    throws = {
        id(one): replace(one, damped=replace(one.damped, body=light(one.damped.body))) for one in shaft.throws
    }
    ends = [replace(end, body=light(end.body)) for end in shaft.ends]
    return replace(shaft, throws=tuple(throws[id(one)] for one in shaft.throws), ends=(ends[0], ends[1]))


def offsets_mm(motion: Array) -> Array:
    return np.asarray(motion.reshape(-1, 6, motion.shape[1])[:, :2])


def test_without_mass_it_is_the_shaft_in_its_films() -> None:
    """Against another integrator in time: orbits, least films, forces of sections."""
    scene, every = scene_of(), forces(1)
    shaft = weighing(shaft_of(scene, loss_factor=0.0), 1e-7)
    throws, angles = [one.still for one in shaft.throws], shaft.angles_deg
    rigid = shaft_cycle(throws, angles, every, None)
    expected = shaft_cycle(throws, angles, every, None, offset_mm=film_offsets_mm(throws, scene, rigid))
    found = cycle_on_film(shaft, scene, every)
    ours, theirs = (offsets_mm(one.motion) for one in (found.shaft, expected))
    assert np.abs(ours - theirs).max() < 1e-3 * CLEARANCE_MM
    thin, expected_thin = (
        CLEARANCE_MM - np.hypot(one[:, 0], one[:, 1]).max(axis=1) for one in (ours, theirs)
    )
    assert thin == pytest.approx(expected_thin, rel=2e-3)
    assert apart(found.shaft.throw_N, expected.throw_N) < 2e-4
    assert apart(rigid.throw_N, expected.throw_N) > 0.05


@pytest.mark.slow
def test_in_films_that_hardly_yield_it_vibrates_as_in_rigid_bearings() -> None:
    """A narrow gap: the difference falls with it, and what mass does is far more."""
    shaft = shaft_of(scene_of())
    rigid = moving_cycle(shaft, forces()).shaft.throw_N
    off = [
        apart(cycle_on_film(shaft, scene_of(gap, 2.0), forces()).shaft.throw_N, rigid)
        for gap in (0.024, 0.008)
    ]
    assert off[1] < 0.4 * off[0]
    assert off[1] < 0.02
    light = moving_cycle(weighing(shaft, 1e-7), forces()).shaft.throw_N
    assert apart(light, rigid) > 5 * off[1]


def test_what_the_forces_do_damping_and_films_take() -> None:
    """Force times velocity of each pin by the curves; the films' part from their own velocities.

    A propeller that turns freely, and a damper's ring in its fluid, are no disturbances that grow.
    """
    ring = {
        "kind": "viscous",
        "ring_inertia_kg_m2": 0.02,
        "hub_inertia_kg_m2": 0.004,
        "damping_Nms_per_rad": 5.0,
    }
    scene = scene_of(propeller=PROPELLER, damper=ring)
    shaft = shaft_of(scene)
    found = cycle_on_film(shaft, scene, forces())
    assert found.film_work_J is not None
    assert min(found.film_work_J, found.damping_work_J) > 0.1
    assert worked(shaft, forces(), found) == pytest.approx(found.damping_work_J + found.film_work_J, rel=1e-5)


def test_it_does_not_matter_where_the_cycle_begins_and_which_end_is_first() -> None:
    """Angles counted from elsewhere; throws numbered from the other end, mirrored, no mean torque."""
    scene = scene_of()
    shaft = replace(shaft_of(scene), turns_freely=True)
    still_mean = forces().tangential_N - forces().tangential_N.mean(axis=(0, 1))
    pushed = replace(forces(), tangential_N=still_mean)
    bearings = [main_bearing(scene, number) for number in shaft.borne_by]
    one = journals_in_film(shaft, scene, pushed, ShaftHarmonics(shaft, pushed).on_bearings()).eccentricity

    def again(other: MovingShaft, load: CycleForces, start: Array) -> Array:
        carried = ShaftHarmonics(other, load).on_bearings()
        return moving_journals(
            bearings, load.angular_speed_rad_s, 4 * np.pi, carried, carried, 0.99 * start
        ).eccentricity

    names = ("radial_N", "tangential_N", "radial_aside_N_mm", "tangential_aside_N_mm")
    later = replace(pushed, **{name: np.roll(getattr(pushed, name), -40, axis=1) for name in names})
    ahead = replace(shaft, angles_deg=tuple(angle + 137.3 for angle in shaft.angles_deg))
    moved = np.roll(one, -40, axis=1) * np.exp(1j * np.radians(137.3))
    assert np.abs(again(ahead, later, moved) - moved).max() < 1e-6

    mirror = {name: getattr(pushed, name)[::-1] * (-1 if "aside" in name else 1) for name in names}
    turned = replace(shaft, angles_deg=shaft.angles_deg[::-1])
    mirrored = one[::-1]
    assert np.abs(again(turned, replace(pushed, **mirror), mirrored) - mirrored).max() < 2e-3


def test_journals_that_whirl_are_refused() -> None:
    """Films of journals that hardly anything loads, at a high speed; more load keeps them steady."""
    scene = at_speed(scene_of(), 9000.0)
    shaft, speed = shaft_of(scene), 9000.0 * np.pi / 30
    bearings, states = [main_bearing(scene, number) for number in shaft.borne_by], 240
    turning = np.exp(-1j * 4 * np.pi * np.arange(states) / states)

    def films_under(weight_N: float) -> FilmSlopes:
        rows = np.tile(np.stack([turning.real, turning.imag]) * weight_N, (len(bearings), 1))
        loaded = CarriedShaft(
            harmonics_of(rows), np.zeros((states // 2 + 1, len(rows), len(rows)), dtype=complex)
        )
        start = np.tile(0.3 * turning, (len(bearings), 1))
        return moving_journals(bearings, speed, 4 * np.pi, loaded, loaded, start).slopes

    check_steady(shaft, scene, films_under(5000.0))
    with pytest.raises(
        CranktopoError, match=r"9000 rpm: the journals of the shaft with its mass whirl"
    ) as refused:
        check_steady(shaft, scene, films_under(2.0))
    assert "--bearings rigid or spring" in refused.value.hint
