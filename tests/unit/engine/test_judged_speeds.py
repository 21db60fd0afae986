"""Speeds at which a shaft on all its bearings is judged, and that commands ask for them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed, engine_of
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.judged_histories import histories_of
from cranktopo.engine.judged_speeds import rated_speeds, slow_speed_rpm, speeds_of_range
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.cost import Costing, CostRates
from cranktopo.tasks.throw_fatigue import shaft_stress
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.each_web import loaded_shaft

OVERSPEED_RPM = 6000.0


class AskedError(Exception):
    pass


def fast(**shaft: Any) -> Scene:
    """The Mikron with an overspeed, in its shaft."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["engine"]["overspeed_rpm"] = OVERSPEED_RPM
    data["effects"]["continuous_shaft"] = "on"
    if shaft:
        data["shaft"] = shaft
    return scene_from_dict(data)


def rpm(scenes: tuple[Scene, ...]) -> list[float]:
    return [engine_of(at).speed_rpm for at in scenes]


def test_each_speed_once_and_in_order() -> None:
    assert rpm(rated_speeds(fast(), frozenset())) == [2100.0, OVERSPEED_RPM]
    whole = rpm(speeds_of_range(fast(), frozenset()))
    assert whole == pytest.approx([700.0, 2025.0, 2100.0, 3350.0, 4675.0, 6000.0])
    given = fast(speed_min_rpm=900.0, speed_max_rpm=2900.0)
    assert rpm(speeds_of_range(given, frozenset())) == [900.0, 1400.0, 1900.0, 2100.0, 2400.0, 2900.0, 6000.0]


def mapped(*peaks: tuple[float, float]) -> dict[str, Any]:
    """Pressures over the speed, of the same kind as the Mikron's own."""
    return {
        "map": [{"rpm": rpm, "peak_pressure_MPa": p, "peak_angle_deg": 12.0} for rpm, p in peaks],
        "compression_ratio": 6.0,
    }


@pytest.mark.parametrize(
    ("shaft", "gas", "expected"),
    [
        ({}, None, None),
        ({"speed_min_rpm": 900.0}, None, 900.0),
        ({"speed_min_rpm": 900.0, "barred_rpm": [[800.0, 1000.0]]}, None, None),
        ({"speed_min_rpm": 2100.0}, None, None),
        ({}, mapped((800.0, 5.0), (2100.0, 5.0)), 800.0),
        ({"speed_min_rpm": 900.0}, mapped((800.0, 5.0), (2100.0, 5.0)), 900.0),
        ({}, mapped((800.0, 3.0), (1400.0, 6.0), (2800.0, 5.0)), 1400.0),
        ({"speed_min_rpm": 1500.0}, mapped((800.0, 3.0), (1400.0, 6.0), (2800.0, 5.0)), 1500.0),
    ],
)
def test_the_slower_speed_that_pushes_hardest(
    shaft: dict[str, Any], gas: dict[str, Any] | None, expected: float | None
) -> None:
    """The lowest that the scene states: where its pressure rises with the speed, that of the map's peak."""
    data = fast(**shaft).model_dump(mode="json", exclude_none=True)
    if gas:
        data["engine"]["gas"] = gas
    scene = scene_from_dict(data)
    assert slow_speed_rpm(scene, INERTIA_EFFECTS) == expected
    assert expected is None or expected in rpm(rated_speeds(scene, frozenset()))


@pytest.mark.parametrize("kind", ["extremes", "cycle"])
@pytest.mark.parametrize("vibrating", [False, True])
def test_a_throw_that_stands_alone_is_judged_at_it(kind: HistoryKind, vibrating: bool) -> None:
    """A single diesel of 1000 to 3000 rpm had 1.436; alone at 1000 rpm it has 1.390."""
    scene = fast(speed_min_rpm=900.0, flywheel={"inertia_kg_m2": 0.05})
    enabled = (
        INERTIA_EFFECTS
        | {"bending", "torsion", "centrifugal"}
        | ({"torsional_vibration"} if vibrating else set())
    )
    slow = [one for one in histories_of(scene, kind, enabled) if one.labels[0].endswith(", 900 rpm")]
    bare = enabled - {"torsional_vibration"}
    for one in slow:
        cycle = analyse(at_speed(scene, 900.0), bare).cycle
        assert cycle is not None
        assert one.radial_N.max() == pytest.approx(cycle.extreme("web_force_N")[0].value, rel=1e-3)
        assert one.angular_speed_rad_s == pytest.approx(np.pi * 30)
    assert len(slow) == (1 if kind == "extremes" else 4)
    pushes = [one.radial_N.max() for one in histories_of(scene, kind, enabled)]
    assert max(pushes) == pytest.approx(slow[0].radial_N.max(), rel=1e-9), "no other speed pushes as hard"


@pytest.mark.parametrize("vibrating", [False, True])
def test_the_plan_has_the_amplitudes_of_all_of_them(vibrating: bool) -> None:
    scene = fast(speed_min_rpm=900.0, flywheel={"inertia_kg_m2": 0.05})
    scene = scene.model_copy(update={"engine": engine_of(scene).model_copy(update={"overspeed_rpm": None})})
    enabled = INERTIA_EFFECTS | {"bending", "torsion"} | ({"torsional_vibration"} if vibrating else set())
    judged = histories_of(scene, "extremes", enabled)
    assert len(judged) == 2
    costing = Costing(scene, CostRates(), mirrored=True)
    force, torque = PlanningContext(scene, costing, "", vibrating=vibrating).amplitudes
    assert force == pytest.approx(max(np.ptp(one.radial_N) for one in judged) / 2, rel=1e-9)
    assert torque == pytest.approx(max(np.ptp(one.torque_Nm) for one in judged) / 2, rel=1e-9)
    assert force > np.ptp(judged[0].radial_N) / 2 * (1.0 if vibrating else 1.01)


def test_fatigue_in_the_shaft_judges_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least of all speeds counts, and it is told that it is that of the overspeed."""
    scene, states = fast(), np.zeros((4, 3, 1))
    angles = np.array([0.0, 240.0, 480.0])
    judged: list[tuple[str, ...]] = []

    def loads(throws: Any, scene: Scene, at: Scene, support: Any) -> Any:
        return angles, states + engine_of(at).speed_rpm

    def least(model: Any, of_throws: Any, method: str) -> Any:
        return [{(0, "pin_fillet"): 1e4 / own[:, 0, 0] - throw / 10} for throw, own in enumerate(of_throws)]

    def field(model: Any, method: str, own: Any, labels: tuple[str, ...]) -> Any:
        judged.append(labels)
        return SimpleNamespace(critical=SimpleNamespace(safety=own.max()))

    monkeypatch.setattr(shaft_stress, "solve_shaft_stress", lambda *_: SimpleNamespace(model=None))
    monkeypatch.setattr(shaft_stress, "shaft_loads", loads)
    monkeypatch.setattr(shaft_stress, "least_safeties", least)
    monkeypatch.setattr(shaft_stress, "field_of_states", field)
    monkeypatch.setattr(shaft_stress, "replace", lambda found, on_bearings: found)
    (found,) = shaft_stress.worst_throw(Target("fast", scene), ("lsa",), 2.0)
    assert found.critical.safety == OVERSPEED_RPM
    assert judged == [tuple(f"throw 4, {angle:g} deg, 6000 rpm" for angle in angles)]
    judged.clear()
    shaft_stress.worst_throw(Target("fast", scene), ("findley",), 2.0)
    assert len(judged) == 4 * 6, "planes have no least of a part: every throw at every speed"


@pytest.mark.parametrize(("effect", "count"), [("on", 6), ("auto", 2)])
def test_webs_of_their_own_are_judged_at_them(
    effect: str, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def judged(target: Target, bearings: str, method: str, speeds: list[float], fraction: float) -> Any:
        asked.extend(speeds)
        raise AskedError

    monkeypatch.setattr(loaded_shaft, "judged_shaft", judged)
    scene = fast()
    effects = scene.effects.model_copy(update={"continuous_shaft": effect})
    with pytest.raises(AskedError):
        loaded_shaft.loaded_shaft(scene.model_copy(update={"effects": effects}), 0.3)
    assert len(asked) == count
    assert OVERSPEED_RPM in asked
