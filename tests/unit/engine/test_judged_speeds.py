"""Speeds at which a shaft on all its bearings is judged, and that commands ask for them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.judged_speeds import rated_speeds, speeds_of_range
from cranktopo.tasks.fatigue import shaft_stress
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.shape.each_web import loaded_shaft

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
