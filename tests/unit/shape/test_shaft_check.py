"""A web whose search judged a throw alone is judged in its shaft once: what is worse there stands first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebLoads
from cranktopo.tasks.web_shape import shaft_check as module
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.page import page_headline
from cranktopo.tasks.web_shape.result import ShaftCheck, ShapeResult
from cranktopo.tasks.web_shape.run import shape_goal
from cranktopo.tasks.web_shape.shaft_check import ShaftsBeside
from cranktopo.tasks.web_shape.text import shape_summary
from tests.shaft_stand_in import told_webs
from tests.shape_stand_in import LESS_SAFE_IN_SHAFT
from tests.unit.shape.test_least_place import shaped

ALONE = WebLoads(())
LESS = "LESS SAFE IN ITS SHAFT: 1.086 (web 8, journal fillet), -14.3 +-2.0 % against the original's 1.267"


def scene_of(*limits: str, **changes: dict[str, Any]) -> Scene:
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True, exclude={"published"})
    for table, keys in changes.items():
        data[table] = data.get(table, {}) | keys
    return with_goal(scene_from_dict(data), minimise="mass", limits=limits)


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Scene, float]]:
    """Shafts that were solved: the original's has 1.45, that of a thicker web 1.4."""
    asked: list[tuple[Scene, float]] = []

    def shaft(scene: Scene, fraction: float) -> Any:
        asked.append((scene, fraction))
        return told_webs((1.5, 1.45) if scene.web.thickness_mm == 19.0 else (1.4, 1.6))

    monkeypatch.setattr(module, "webs_in_shaft", shaft)
    return asked


def checked(scene: Scene, loads: Any = "extremes") -> tuple[ShaftCheck | None, str]:
    web = scene.model_copy(update={"web": scene.web.model_copy(update={"thickness_mm": 20.0})})
    shafts = ShaftsBeside(scene, shape_goal(scene), ShapeSettings(loads=loads), StageMemory())
    shafts.begin(web)
    return shafts.judged()


@pytest.mark.parametrize(
    ("limit", "required"), [("fatigue_safety >= 90 %", 0.9 * 1.45), ("fatigue_safety >= 1.3", 1.3)]
)
def test_both_webs_are_judged_in_the_shaft_on_meshes_alike(
    limit: str, required: float, solved: list[tuple[Scene, float]]
) -> None:
    found, why = checked(scene_of(limit, engine={"misfire": [2]}))
    assert found is not None
    assert not why
    assert (found.original, found.result, found.web, found.part) == (1.45, 1.4, 1, "pin_fillet")
    assert found.required == pytest.approx(required)
    assert found.speeds_rpm == (700.0, 2800.0)
    assert [fraction for _, fraction in solved] == [found.fillet_fraction] * 2
    assert all(one.effects.continuous_shaft == "on" for one, _ in solved)
    assert not any(one.engine and one.engine.misfire for one, _ in solved)


def test_the_shaft_with_the_original_may_be_solved_beside_the_search(
    solved: list[tuple[Scene, float]],
) -> None:
    """Once, and not at all by a work that was continued; nothing waits for it before it is asked for."""
    scene = scene_of()
    web = scene.model_copy(update={"web": scene.web.model_copy(update={"thickness_mm": 20.0})})
    work = StageMemory()
    shafts = ShaftsBeside(scene, shape_goal(scene), ShapeSettings(), work)
    shafts.begin_original()
    shafts.begin(web)
    found, _ = shafts.judged()
    assert sorted(one.web.thickness_mm for one, _ in solved) == [19.0, 20.0]
    again = ShaftsBeside(scene, shape_goal(scene), ShapeSettings(), work)
    again.begin_original()
    again.begin(web)
    assert again.judged() == (found, "")
    assert len(solved) == 2


NOTHING: list[tuple[dict[str, Any], Any, str]] = [
    ({"effects": {"continuous_shaft": "off"}}, "extremes", "effects.continuous_shaft is off, 'auto' judges"),
    ({"supports": {"bending": "clamped"}}, "extremes", "supports.bending is 'clamped'"),
    ({"engine": {"max_gas_force_N": 3e4}}, "extremes", "the largest gas force or torque is given"),
    ({"engine": {"cylinders": 1, "firing_order": [1]}}, "extremes", ""),
    ({}, ALONE, ""),
]


@pytest.mark.parametrize(("changes", "loads", "why"), NOTHING)
def test_where_nothing_of_the_shaft_is_solved_it_is_said_why(
    changes: dict[str, Any], loads: Any, why: str, solved: list[tuple[Scene, float]]
) -> None:
    """A single throw has no shaft, and a search with the loads of the shaft has its own word."""
    found, said = checked(scene_of(**changes), loads)
    assert found is None
    assert not solved
    assert said.startswith(why)
    assert bool(said) is bool(why)


@pytest.mark.parametrize(
    ("limits", "why"),
    [(("stress <= 90 %",), "the stress is one of a throw alone"), ((), "")],
)
def test_a_search_without_a_safety_solves_nothing(
    limits: tuple[str, ...], why: str, solved: list[tuple[Scene, float]]
) -> None:
    assert checked(scene_of("fatigue_safety none", *limits)) == (None, why)
    assert not solved


def test_a_shaft_that_fails_costs_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: Any) -> None:
        raise CranktopoError("no mesh", code=code)

    monkeypatch.setattr(module, "webs_in_shaft", failing)
    code = ExitCode.NOT_CONVERGED
    assert checked(scene_of()) == (None, "no mesh")
    code = ExitCode.INTERRUPTED
    with pytest.raises(CranktopoError, match="no mesh"):
        checked(scene_of())


def judged(result: float, required: float | None = None, alone: float = 1.0) -> ShapeResult:
    """A web that keeps its safety as a throw alone, and has these in its shaft."""
    found = shaped()
    data = found.as_json()
    data["values"]["result"]["fatigue_safety"] = alone
    data["shaft_check"] = {**LESS_SAFE_IN_SHAFT, "result": result, "required": required}
    return ShapeResult.of_json(data, "shape.json")


def test_a_web_that_is_less_safe_in_its_shaft_says_so_first() -> None:
    found = judged(1.086)
    first, *more = shape_summary(found, Path("out dir")).splitlines()
    assert first.startswith(f"{LESS}; effects.continuous_shaft = 'on' makes a web for its shaft. Of a throw")
    assert page_headline(found).startswith(LESS)
    finer = "by finer elements: cranktopo shaft 'out dir/web.toml' --method lsa --speeds 700:2800:5"
    assert finer in more


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (judged(1.23), "-2.9 +-2.0 % against the original's 1.267"),
        (judged(1.25), ""),
        (judged(1.25, required=1.4), "below the limit of 1.400"),
        (judged(1.25, required=1.31), ""),
        (judged(1.2, required=1.267), "the original's 1.267; effects"),
        (judged(1.25, alone=1.4), "below the 1.400 of its throw alone"),
        (judged(1.25, alone=1.31), ""),
    ],
)
def test_what_counts_as_less_safe(found: ShapeResult, words: str) -> None:
    """2 % against the original on a mesh alike; 5 % against what comes from finer meshes."""
    summary = shape_summary(found, Path("o"))
    assert summary.startswith("LESS SAFE IN ITS SHAFT: 1.2" if words else "Every limit holds")
    assert words in summary.splitlines()[0]
    assert "in its shaft, on all bearings from 700 to 2,800 rpm, least fatigue safety" in summary
    assert ("by finer elements" in summary) is bool(words)


def test_a_web_that_was_not_judged_in_its_shaft_says_why() -> None:
    found = shaped().model_copy(update={"shaft_unjudged": "effects.continuous_shaft is off"})
    assert shape_summary(found, Path("o")).splitlines()[1] == (
        "not judged in its shaft: effects.continuous_shaft is off"
    )
