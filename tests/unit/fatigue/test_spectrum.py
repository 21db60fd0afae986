"""Life by a spectrum of speeds: cycles counted by hand, damage in closed form."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from cranktopo import load_scene, with_values
from cranktopo.base.arrays import Array, Index
from cranktopo.design.material import Spectrum
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import LoadHistory, load_history, throw_histories
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.numerics.tetrahedra.stress import SurfaceStress
from cranktopo.tasks.fatigue.criteria import safety_method
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.throw_fatigue import stage
from cranktopo.tasks.throw_fatigue.spectrum import counts_lives, damage, part_lives, rainflow, speed_histories
from cranktopo.tasks.throw_fatigue.stress_model import StressModel
from cranktopo.tasks.throw_fea.targets import Target

SPECTRUM = Spectrum.model_validate({"step": [{"rpm": 2000.0, "share": 1.0}]})
LIMIT_MPA = 100.0


def test_the_cycles_of_the_standards_example() -> None:
    """ASTM E1049, its history repeated: ranges 3, 4, 7 and 9, once each."""
    amplitude, mean = rainflow(np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2]))
    assert sorted(2 * amplitude) == [3.0, 4.0, 7.0, 9.0]
    assert dict(zip(2 * amplitude, mean, strict=True)) == {3.0: -0.5, 4.0: 1.0, 7.0: 0.5, 9.0: 0.5}


def test_a_sine_is_one_cycle_wherever_it_begins() -> None:
    for phase in (0.0, 1.0, 4.0):
        amplitude, mean = rainflow(10 + 50 * np.sin(phase + np.arange(0, 2 * np.pi, 0.02)))
        assert amplitude.max() == pytest.approx(50, rel=1e-3)
        assert mean[amplitude.argmax()] == pytest.approx(10, abs=0.05)
        assert np.sort(amplitude)[:-1] == pytest.approx(0, abs=0.02)


def test_damage_has_both_slopes() -> None:
    assert damage(np.array([1.0, 0.5, 2.0]), SPECTRUM) == pytest.approx([1e-6, 32e-6, 1e-6 / 2**9])


def engine_with(steps: list[dict[str, float]]) -> Scene:
    return with_values(load_scene("mikron-iiic"), {"fatigue.spectrum.step": steps})


def one_node(scene: Scene) -> StressModel:
    """A model of one node that the radial force alone stresses, 1 MPa for 100 N, uniaxially."""
    stress = np.zeros((1, 1, 6))
    stress[0, 0, 0] = 0.01
    found = SurfaceStress(stress, 0 * stress, np.zeros((1, 1)))
    parts = {"pin": np.array([True])}
    images = (SimpleNamespace(signs=np.ones(1)),)
    return cast(StressModel, SimpleNamespace(scene=scene, stress=found, images=images, parts=parts))


def judged(local: LocalStress, nodes: Index) -> Array:
    assert len(nodes) == len(local.amplitude_MPa)
    return np.asarray(LIMIT_MPA / np.maximum(local.amplitude_MPa, 1e-9))


def radial(history: LoadHistory) -> Array:
    return history.radial_N[:, None]


def life(scene: Scene, judge: Any = judged) -> Any:
    speeds = speed_histories(scene, plan_for_stress(scene).enabled)
    return part_lives(one_node(scene), np.ones((1, 1)), judge, radial, speeds)["pin"]


def test_one_speed_is_the_line_itself() -> None:
    """The gas peak once a working cycle; all smaller cycles of the throw with it, counted by hand."""
    scene = engine_with([{"rpm": 2100.0, "share": 7.0}])
    history = throw_histories(scene, plan_for_stress(scene).enabled)[0]
    amplitude = rainflow(0.01 * history.radial_N)[0]
    per_cycle = np.sum((amplitude / LIMIT_MPA) ** np.where(amplitude > LIMIT_MPA, 5, 9)) / 1e6
    found = life(scene)
    assert found.life_hours == pytest.approx(0.3 / (per_cycle * 60 * 2100 / 2), rel=0.01)
    assert found.damage_shares == {"2100": 1.0}
    assert found.throw == "throw 1"


def test_below_the_limit_there_is_no_end() -> None:
    """A tenth more peak pressure exceeds it: then every cycle counts."""
    scene = engine_with([{"rpm": 2100.0, "share": 1.0}])
    throws = throw_histories(scene, plan_for_stress(scene).enabled)
    top = max(rainflow(0.01 * one.radial_N)[0].max() for one in throws)

    def just_enduring(local: LocalStress, nodes: Index) -> Array:
        return np.asarray(1.000001 * top / np.maximum(local.amplitude_MPa, 1e-9))

    assert life(scene, just_enduring).life_hours is None
    assert scene.engine is not None
    peak = scene.engine.gas.peak_pressure_MPa or 0.0
    harder = with_values(scene, {"engine.gas.peak_pressure_MPa": 1.1 * peak})
    assert life(harder, just_enduring).life_hours < 1000


def test_equal_steps_are_one_and_shares_are_relative() -> None:
    one = life(engine_with([{"rpm": 1800.0, "share": 1.0}]))
    two = life(engine_with([{"rpm": 1800.0, "share": 30.0}, {"rpm": 1800.0, "share": 10.0}]))
    assert two.life_hours == pytest.approx(one.life_hours, rel=1e-9)
    fast = life(engine_with([{"rpm": 2400.0, "share": 1.0}]))
    both = life(engine_with([{"rpm": 1800.0, "share": 1.0}, {"rpm": 2400.0, "share": 3.0}]))
    mixed = 0.25 / one.life_hours + 0.75 / fast.life_hours
    assert both.life_hours == pytest.approx(1 / mixed, rel=1e-9)
    assert both.damage_shares["2400"] == pytest.approx(0.75 / fast.life_hours / mixed)


def test_throws_are_the_cycle_of_the_shaft_in_parts() -> None:
    scene = load_scene("mikron-iiic")
    enabled = plan_for_stress(scene).enabled
    joined, parts = load_history(scene, "cycle", enabled), throw_histories(scene, enabled)
    assert len(parts) > 1
    np.testing.assert_array_equal(np.concatenate([part.torque_Nm for part in parts]), joined.torque_Nm)
    assert tuple(label for part in parts for label in part.labels) == joined.labels


def test_a_method_without_cycles_says_so(caplog: pytest.LogCaptureFixture) -> None:
    scene = engine_with([{"rpm": 1800.0, "share": 1.0}])
    caplog.set_level("INFO")
    stage._note_tables(Target("mikron", scene), "findley")
    assert "fatigue.spectrum has no part" in caplog.text
    assert counts_lives(scene, safety_method("lsa"))
    assert not counts_lives(scene, safety_method("m53"))
