"""A shaft with play in rigid bearings: a beam with gaps in closed form, statics, and no play."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.bearings import radial_play_mm
from cranktopo.numerics.ring_contact import sections_in_rings
from cranktopo.tasks.shaft.cycle import (
    CycleForces,
    ShaftCycle,
    bent_into_bearings_N_per_mm,
    cycle_forces,
    shaft_cycle,
)
from cranktopo.tasks.shaft.on_film import carried_cycle
from tests.physics.shaft.test_continuous_shaft import WITH_PIN_MM, beam_throw
from tests.physics.shaft.test_evaluation_chain import INERTIA, YOUNGS

FOUR = load_scene("car-diesel")
THROW = beam_throw(WITH_PIN_MM, 3)
SPAN_MM, PLAY_MM = 160.0, 0.02


@pytest.mark.parametrize("direction_deg", [0.0, 137.0])
def test_a_beam_on_three_bearings_lifts_off_and_touches_the_other_side(direction_deg: float) -> None:
    """A force P in the middle of the first of two spans L, in any direction, up to four times what lifts.

    The end of the free span lies P L^3 / (16 EI) off the line through the others. Where that is less than
    twice the play c, it touches nothing: R3 = 0. Else R3 = -(P L^3 / (16 EI) - 2 c) 3 EI / (2 L^3).
    """
    straight = beam_throw([(0.0, 0.0, 0.0), (0.0, 0.0, SPAN_MM / 2), (0.0, 0.0, SPAN_MM)], 1)
    flexural = YOUNGS * INERTIA
    lifts_N = 2 * PLAY_MM * 16 * flexural / SPAN_MM**3
    force_N, turn = lifts_N * np.linspace(0.1, 4.0, 40), np.radians(direction_deg)
    none = np.zeros((2, force_N.size))
    radial, tangential = (
        np.stack([one, none[0]]) for one in (np.cos(turn) * force_N, np.sin(turn) * force_N)
    )
    forces = CycleForces(np.arange(40.0), radial, tangential, none, none, 0.0)
    rigid = shaft_cycle([straight] * 2, (0.0, 0.0), forces, None)
    bent = bent_into_bearings_N_per_mm([straight] * 2, (0.0, 0.0), range(3))
    offset = sections_in_rings(bent, -rigid.bearing_N.reshape(6, -1), np.full(3, PLAY_MM))
    found = shaft_cycle([straight] * 2, (0.0, 0.0), forces, None, offset_mm=offset)
    pushed = np.array([np.sin(turn), -np.cos(turn)])  # tangential +x, radial -y
    along, off = (np.einsum("sit,i->st", one, pushed) for one in (found.bearing_N, offset.reshape(3, 2, -1)))
    lift = force_N * SPAN_MM**3 / (16 * flexural)
    third = np.maximum(lift - 2 * PLAY_MM, 0.0) * 3 * flexural / (2 * SPAN_MM**3)
    expected = np.stack([-force_N / 2 + third, -force_N / 2 - 2 * third, third])
    assert np.abs(along - expected).max() < 1e-8 * force_N.max()
    assert off[:2] == pytest.approx(np.full((2, 40), PLAY_MM))
    assert off[2] == pytest.approx(np.maximum(PLAY_MM - lift, -PLAY_MM), abs=1e-9)
    assert (third == 0).sum() == 10


def with_play(scene: Scene, play_mm: float) -> tuple[ShaftCycle, ShaftCycle]:
    """The cycle of an engine in rigid bearings, without play and with it."""
    assert scene.bearings is not None
    bearings = scene.bearings.model_copy(update={"clearance_mm": 2 * play_mm})
    scene = scene.model_copy(update={"bearings": bearings})
    throws, forces = [THROW] * len(scene.shaft_angles_deg), cycle_forces(scene)
    rigid, loose = (carried_cycle(throws, scene, forces, one) for one in (None, "clearance"))
    return rigid, loose


def test_every_journal_lies_free_or_is_pushed_to_the_middle() -> None:
    """Forces of both shafts have the same resultant and moment, and no bearing pulls."""
    rigid, loose = with_play(FOUR, 0.03)
    place = loose.motion.reshape(5, 6, -1)[:, :2]
    size, force = np.linalg.norm(place, axis=1), np.linalg.norm(loose.bearing_N, axis=1)
    scale = force.max()
    assert size.max() <= 0.03 * (1 + 1e-8)
    assert np.abs(loose.bearing_N + force[:, None] * place / size[:, None]).max() < 1e-7 * scale
    free = size < 0.03 * (1 - 1e-6)
    assert 0.01 < free.mean() < 0.5
    assert force[free].max() < 1e-7 * scale
    along = np.arange(5.0)
    for weights in (np.ones(5), along):
        both = [np.einsum("s,sit->it", weights, one.bearing_N) for one in (rigid, loose)]
        assert np.abs(both[0] - both[1]).max() < 1e-7 * scale
    assert np.abs(loose.bearing_N - rigid.bearing_N).max() > 0.05 * scale


def test_no_play_is_a_rigid_bearing() -> None:
    rigid, loose = with_play(FOUR, 5e-7)
    assert np.abs(loose.bearing_N - rigid.bearing_N).max() < 1e-4 * np.abs(rigid.bearing_N).max()


def test_two_bearings_carry_what_statics_gives() -> None:
    """Of one throw: each journal lies against its bearing where the force of the rigid one points."""
    one = with_values(FOUR, {"engine.cylinders": 1, "engine.firing_order": [1]})
    rigid, loose = with_play(one, 0.03)
    assert np.abs(loose.bearing_N - rigid.bearing_N).max() < 1e-8 * np.abs(rigid.bearing_N).max()
    place = loose.motion.reshape(2, 6, -1)[:, :2]
    expected = -0.03 * rigid.bearing_N / np.linalg.norm(rigid.bearing_N, axis=1, keepdims=True)
    assert np.abs(place - expected).max() < 1e-7


def test_play_is_half_the_clearance_of_the_diameters_or_that_of_the_supports() -> None:
    assert FOUR.bearings is not None
    assert radial_play_mm(FOUR) == FOUR.bearings.clearance_mm / 2
    mikron = load_scene("mikron-iiic-plain")
    supports = mikron.supports.model_copy(update={"bearing_clearance_mm": 0.04})
    assert radial_play_mm(mikron.model_copy(update={"supports": supports})) == 0.04
    with pytest.raises(CranktopoError, match=r"bearings\.clearance_mm is missing"):
        radial_play_mm(mikron)
