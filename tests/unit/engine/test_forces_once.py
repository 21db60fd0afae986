"""What a moved web leaves as it is, is computed once: forces of rods, torques, throws that stand alone."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Cycle, analyse
from cranktopo.engine.continuous_beam import PinLoads, Spans, bend_spans
from cranktopo.engine.cylinders import cylinders
from cranktopo.engine.forces import INERTIA_EFFECTS


def _cycle(scene: Scene) -> Cycle:
    found = analyse(scene).cycle
    assert found is not None
    return found


def test_another_web_leaves_forces_and_torques_as_they_are_but_not_those_of_its_mass() -> None:
    """On the bench each move of a web computed all curves over the cycle eleven times."""
    scene = load_scene("industrial-gas")
    wider = scene.model_copy(update={"web": scene.web.model_copy(update={"width_mm": 175.0})})
    longer = scene.model_copy(update={"throw": scene.throw.model_copy(update={"radius_mm": 96.0})})
    own, other, third = (_cycle(one) for one in (scene, wider, longer))
    assert other.torque is own.torque
    assert other.forces.web_force_N is own.forces.web_force_N
    assert third.torque is not own.torque
    assert not np.array_equal(other.forces.main_journal_force_N, own.forces.main_journal_force_N)
    for shared in (own.torque.passed_on_Nm, own.forces.rod_force_N):
        with pytest.raises(ValueError, match="read-only"):
            shared[0] = 0.0


def test_effects_that_no_force_depends_on_share_them() -> None:
    scene = load_scene("mikron-iiic")
    own = cylinders(scene)
    assert cylinders(scene, INERTIA_EFFECTS | {"bending", "centrifugal"}) is own
    assert cylinders(scene, frozenset({"rotating_rod_mass"})) is not own


def test_throws_that_stand_alone_are_bent_at_once_as_one_by_one() -> None:
    draw = np.random.default_rng(5)
    force, couple = (draw.normal(size=(4, 6)) + 1j * draw.normal(size=(4, 6)) for _ in range(2))
    loads, spans = (
        PinLoads(1e4 * force, 1e5 * couple, 2e3j * np.ones((4, 1))),
        Spans(3e11, 150.0, [31.0, 40.0]),
    )
    moments, ends_N = bend_spans(spans, loads.of_one_throw, dict.fromkeys((0, 1)))
    moments, ends_N = moments.reshape(2, 4, 6), ends_N.reshape(2, 4, 6)
    for n in range(4):
        one = PinLoads(*(values[n : n + 1] for values in (loads.force_N, loads.couple_Nmm, loads.turning_N)))
        alone, reactions_N = bend_spans(spans, one, dict.fromkeys((0, 1)))
        np.testing.assert_allclose(moments[:, n], alone[0], rtol=1e-12)
        np.testing.assert_allclose(ends_N[:, n], reactions_N, rtol=1e-12)
