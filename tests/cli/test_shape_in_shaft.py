"""`cranktopo shape` where the effect `continuous_shaft` is on: loads of the search, and the last word."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebLoads
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.web_shape import evaluated_web, in_shaft, run, shaft_check
from cranktopo.tasks.web_shape.evaluated_web import Judging, web_safety
from cranktopo.tasks.web_shape.in_shaft import search_in_shaft
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.result import SafetyInShaft, ShapeResult
from cranktopo.tasks.web_shape.run import shape_design, shape_goal, shape_settings
from cranktopo.tasks.web_shape.text import shape_summary
from tests.shaft_stand_in import told_shaft, told_webs

SAFETIES = (1.5, 1.9, 1.6, 1.9, 1.9, 1.9, 1.9, 1.45)
"""Of eight webs: the first and the third have less than a tenth more than the last, which has least."""


class AskedError(CranktopoError):
    pass


def mikron(state: str, *limits: str, bearings: tuple[int, ...] = ()) -> Scene:
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["effects"]["continuous_shaft"] = state
    if bearings:
        data["crank"] = {"bearings": bearings}
    return with_goal(scene_from_dict(data), minimise="mass", limits=limits or ("fatigue_safety >= 1.4",))


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[Scene]:
    """Shafts that were solved; a throw alone under their loads is 2 % less safe."""
    asked: list[Scene] = []

    def shaft(scene: Scene, fraction: float) -> Any:
        asked.append(scene)
        return told_shaft(SAFETIES)

    monkeypatch.setattr(in_shaft, "loaded_shaft", shaft)
    monkeypatch.setattr(evaluated_web, "web_safety", lambda *_: 0.98 * min(SAFETIES))
    return asked


def loads_of(scene: Scene) -> WebLoads:
    found = search_in_shaft(scene, shape_goal(scene), ShapeSettings(), StageMemory())
    assert found is not None
    return found.loads


def test_the_loads_are_those_of_the_webs_that_may_decide(solved: list[Scene]) -> None:
    """Radial forces are numbers of webs there: 1, 8; with 3 left out, a tenth above the least."""
    histories = loads_of(mikron("on")).histories
    assert [one.radial_N[0] for one in histories] == pytest.approx([0.98 * web for web in (1, 8)])
    assert [one.torque_Nm[0] for one in histories] == pytest.approx([0.98 * safety for safety in (1.5, 1.45)])
    assert [one.angular_speed_rad_s[0] for one in histories] == pytest.approx([np.sqrt(0.98)] * 2)
    (asked,) = solved
    assert asked.effects.continuous_shaft == "on"


def test_by_the_plan_alone_the_throw_alone_counts_too(solved: list[Scene]) -> None:
    """Two throws between bearings have it on by `auto`; no web is then less safe than `fatigue` tells."""
    scene = mikron("auto", bearings=(0, 2, 4))
    assert "continuous_shaft" in plan_for_stress(scene).enabled
    first, last, near, far, *overspeed = loads_of(scene).histories
    assert [one.radial_N[0] for one in (first, last)] == pytest.approx([0.98, 8 * 0.98])
    assert len(overspeed) == 2
    assert not np.any([near.moment_Nm, near.side_moment_Nm])
    assert np.array_equal(near.torque_Nm, -far.torque_Nm)
    assert np.array_equal(near.radial_N, far.radial_N)
    assert near.radial_N.max() > 2e4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("state", "limits", "said"),
    [
        ("off", (), ""),
        ("auto", (), ""),
        ("on", ("fatigue_safety none",), ""),
        ("on", ("stress <= 300 MPa",), "the stress is one of a throw alone"),
    ],
)
def test_where_it_is_off_nothing_is_solved_for_it(
    state: str,
    limits: tuple[str, ...],
    said: str,
    solved: list[Scene],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    def search(scene: Scene, goal: Any, settings: ShapeSettings, *_: Any) -> None:
        assert settings.loads == "extremes"
        raise AskedError("the search")

    monkeypatch.setattr(run, "optimise_shape", search)
    notes: list[str] = []
    scene = mikron(state, *limits)
    with pytest.raises(AskedError, match="the search"), redirected(notes.append):
        shape_design(scene, shape_settings(scene), tmp_path / "out")
    assert not solved
    told = [line for line in notes if "continuous_shaft" in line]
    assert bool(told) is bool(said)
    assert all(said in line for line in told)


@pytest.mark.slow
def test_the_search_has_the_loads_and_a_resumed_one_too(
    solved: list[Scene], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """They are kept with the run, which remembers what the user asked for."""
    asked: list[Any] = []

    def search(scene: Scene, goal: Any, settings: ShapeSettings, *_: Any) -> None:
        asked.append(settings.loads)
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "optimise_shape", search)
    scene, folder = mikron("on"), tmp_path / "out"
    with pytest.raises(CranktopoError, match="interrupted"):
        shape_design(scene, shape_settings(scene), folder)
    with pytest.raises(CranktopoError, match="interrupted"):
        run.resume_shape(folder)
    first, again = asked
    assert isinstance(first, WebLoads)
    assert len(solved) == 1
    assert [one.labels for one in again.histories] == [one.labels for one in first.histories]
    assert again.histories[1].radial_N == pytest.approx(first.histories[1].radial_N)


@pytest.mark.parametrize(("required", "held"), [(None, True), (1.45, True), (1.455, True), (1.47, False)])
def test_the_shaft_with_the_best_web_has_the_last_word(
    required: float | None, held: bool, solved: list[Scene]
) -> None:
    scene = mikron("on")
    if required is None:
        wanted = with_goal(load_scene("mikron-iiic"), maximise="fatigue_safety")
    else:
        wanted = mikron("on", f"fatigue_safety >= {required}")
    found = search_in_shaft(scene, shape_goal(scene), ShapeSettings(), StageMemory())
    assert found is not None
    judged = found.judged(scene, shape_goal(wanted), StageMemory())
    assert judged == SafetyInShaft(original=1.45, result=1.45, required=required, web=8, part="pin_fillet")
    assert judged.held is held


@pytest.mark.slow
def test_a_search_of_a_throw_alone_ends_with_its_web_in_the_shaft(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A whole search on coarse meshes; only the shaft is told, in which the web that was found is unsafe."""
    own = with_goal(load_scene("mikron-iiic-plain"), minimise="mass")
    told = {own.web: told_webs((1.5, 1.45))}
    monkeypatch.setattr(
        shaft_check, "webs_in_shaft", lambda scene, _: told.get(scene.web, told_webs((1.5, 0.9)))
    )
    settings = ShapeSettings(
        cell_mm=9.0, mesh_mm=16.0, rounds=1, element_size_mm=14.0, fillet_fraction=0.5, features=False
    )
    done = shape_design(own, settings, tmp_path / "out")
    assert done.result.shaft_check is not None
    assert (done.result.shaft_check.original, done.result.shaft_check.result) == (1.45, 0.9)
    assert ShapeResult.read(done.folder / "shape.json").shaft_check == done.result.shaft_check
    assert shape_summary(done.result, done.folder).startswith("LESS SAFE IN ITS SHAFT: 0.900 (web 2, pin fil")
    assert done.result.seconds["shaft"] < done.result.seconds["judge"]


@pytest.mark.slow
def test_the_designs_own_web_has_the_safety_of_its_shaft() -> None:
    """Two throws between bearings, where a throw alone bends a third as much: by elements of each way."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data |= {"crank": {"bearings": [0, 2, 4]}}
    scene = with_goal(scene_from_dict(data), minimise="mass", limits=("fatigue_safety >= 100 %",))
    assert "continuous_shaft" in plan_for_stress(scene).enabled
    settings = ShapeSettings(fillet_fraction=2.0)
    found = search_in_shaft(scene, shape_goal(scene), settings, StageMemory())
    assert found is not None
    under = web_safety(scene, Judging(found.loads, settings.fillet_fraction))
    assert under == pytest.approx(found.shaft.figures.safety, rel=1e-6)
    assert under < 0.6 * web_safety(scene, Judging("cycle", settings.fillet_fraction))
