"""The original's fatigue safety is found while the search goes on, once for all."""

from __future__ import annotations

from threading import Event
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.progress import StageMemory
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape import evaluated_web as module
from cranktopo.tasks.web_shape.evaluated_web import evaluated_original


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene("mikron-iiic-plain")


@pytest.fixture(scope="module")
def evaluation(scene: Scene) -> Any:
    return evaluate(Target(scene.name, scene), 12.0)


def test_the_search_need_not_wait_for_the_safety(
    scene: Scene, evaluation: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, let, found, after = Event(), Event(), [], list[list[int]]()

    def safety(*_: Any) -> Any:
        begun.set()
        assert let.wait(600.0)
        found.append(1)
        return SimpleNamespace(critical=SimpleNamespace(safety=1.25, place="pin fillet"))

    monkeypatch.setattr(module, "evaluate", lambda *_: evaluation)
    monkeypatch.setattr(module, "fatigue_field", safety)
    monkeypatch.setattr(module, "safety_remarks", lambda _: ["decided at the overspeed"])
    work = StageMemory()
    web, judged = evaluated_original(
        scene, {"fatigue_safety"}, None, work, then=lambda: after.append(found.copy())
    )
    assert begun.wait(600.0)
    assert web.values["torsion"] > 0
    assert "fatigue_safety" not in web.values
    assert not after
    let.set()
    assert judged().values == {**web.values, "fatigue_safety": 1.25}
    _, again = evaluated_original(scene, {"fatigue_safety"}, None, work)
    assert again().values["fatigue_safety"] == 1.25
    assert again().evaluation.fatigue_remarks == ("decided at the overspeed",), "as a file of it is read"
    assert len(found) == 1
    assert after == [[1]], "what may run beside the search waits for it"


def test_what_the_safety_needs_is_told_before_the_search(
    scene: Scene, evaluation: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "evaluate", lambda *_: evaluation)
    weak = scene.model_copy(update={"material": scene.material.model_copy(update={"ultimate_MPa": None})})
    with pytest.raises(CranktopoError, match="ultimate_MPa"):
        evaluated_original(weak, {"fatigue_safety"}, None, StageMemory())
