"""The loop's last step: what it asks the shape optimiser, and which of both webs is better."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.runs.directories import RunStore, create_run
from cranktopo.runs.manifest import new_manifest
from cranktopo.tasks.iterate import shape_step
from cranktopo.tasks.iterate.page import iterate_page
from cranktopo.tasks.iterate.result import LoopResult, LoopStep, StepRow, loop_settings
from cranktopo.tasks.iterate.shape_step import ShapeStep
from cranktopo.tasks.iterate.text import shape_line, shape_lines
from cranktopo.tasks.web_shape import run as shape_run
from tests.shape_stand_in import LESS_SAFE_IN_SHAFT, ORIGINAL, ShapeStandIn


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> ShapeStandIn:
    found = ShapeStandIn()
    monkeypatch.setattr(shape_run, "shape_design", found.design)
    monkeypatch.setattr(shape_run, "resume_shape", found.resume)
    monkeypatch.setattr(shape_step, "surface_of", lambda *_: None)
    monkeypatch.setattr(shape_step, "transition_mm", lambda *_: 12.0)
    return found


def loop_run(folder: Path, scene: Scene) -> RunStore:
    return create_run(
        design=scene.name,
        design_toml=toml_text(scene, "design"),
        scene=scene.model_dump(mode="json"),
        options={"iterate": {}},
        command=["cranktopo"],
        out=folder,
    )


def step(mass: float, torsion: float, bending: float) -> LoopStep:
    """A step by its percent of the original."""
    values = (
        ORIGINAL[name] * share / 100
        for name, share in (("mass", mass), ("torsion", torsion), ("bending", bending))
    )
    kg, Nm_per_rad, N_per_mm = values
    return LoopStep(
        number=2,
        throw_kg=kg,
        web_kg=kg / 3,
        torsion_Nm_per_rad=Nm_per_rad,
        bending_N_per_mm=N_per_mm,
        torsion_error_percent=0.4,
        bending_error_percent=0.6,
        transition_mm=12.0,
        overlap_percent=95.0,
        removed_percent=10.0,
        seconds=1.0,
    )


def ended(run: RunStore, scene: Scene, best: LoopStep | None, begun: Scene | None = None) -> ShapeStep:
    settings = loop_settings(scene, element_size_mm=11.0)
    return shape_step.shape_step(run, scene, best, 4, begun, settings)


def test_the_goal_is_the_designs_or_torsion_per_mass(
    tmp_path: Path, mikron: Scene, stand_in: ShapeStandIn
) -> None:
    light = with_goal(mikron, minimise="mass")
    for number, (scene, begun) in enumerate([(mikron, None), (light, mikron)]):
        ended(loop_run(tmp_path / str(number), scene), scene, None, begun)
    goals = [(scene.goal.quantity, given) for scene, _, given in stand_in.asked]
    assert goals == [("torsion_per_mass", None), ("mass", mikron)]
    assert {settings.element_size_mm for _, settings, _ in stand_in.asked} == {11.0}


@pytest.mark.parametrize(
    ("best", "better"),
    [
        (step(100, 115, 101), True),  # 115 % per mass against 118 %
        (step(100, 118.05, 101), True),  # a near-tie is no loss
        (step(100, 119, 101), False),
        (step(100, 119, 99), True),  # a softer web does not keep the limits of the goal
    ],
)
def test_the_better_web_has_clearly_more_and_keeps_the_limits(
    best: LoopStep, better: bool, tmp_path: Path, mikron: Scene, stand_in: ShapeStandIn
) -> None:
    stand_in.percent = {"torsion": 118.0, "bending": 102.0}
    found = ended(loop_run(tmp_path / "loop", mikron), mikron, best)
    assert found.outcome.better_than_best_step is better
    assert found.outcome.best_step_percent == pytest.approx(100 * best.torsion_per_kg / 1000)
    assert tuple(found.outcome.not_judged_of_steps) == ("fatigue_safety",)
    assert found.row is not None
    assert (found.row.number, found.row.throw_kg, found.row.transition_mm) == (4, 1.6, 12.0)
    assert found.row.torsion_Nm_per_rad == pytest.approx(1.18 * 1600)


def test_a_lighter_web_is_better_where_mass_is_the_goal(
    tmp_path: Path, mikron: Scene, stand_in: ShapeStandIn
) -> None:
    scene = with_goal(mikron, minimise="mass")
    stand_in.percent = {"mass": 88.0}
    for number, (mass, better) in enumerate([(95, True), (87, False)]):
        found = ended(loop_run(tmp_path / str(number), scene), scene, step(mass, 110, 101))
        assert found.outcome.better_than_best_step is better
        assert found.outcome.best_step_percent == pytest.approx(mass)


def test_missed_limits_and_failures_do_not_lose_the_loop(
    tmp_path: Path, mikron: Scene, stand_in: ShapeStandIn
) -> None:
    stand_in.percent = {"bending": 99.0}
    missed = ended(loop_run(tmp_path / "missed", mikron), mikron, step(96, 110, 101))
    assert (missed.row, missed.outcome.reason, missed.outcome.better_than_best_step) == (
        None,
        "as it was told",
        False,
    )
    stand_in.error = CranktopoError("no web of this family keeps the limits.")
    run = loop_run(tmp_path / "failed", mikron)
    failed = ended(run, mikron, step(96, 110, 101))
    assert (failed.row, failed.outcome.better_than_best_step) == (None, False)
    assert "keeps the limits" in failed.outcome.reason
    assert failed.outcome.goal.as_json() == {"maximise": "torsion_per_mass"}
    stand_in.error, stand_in.percent = None, {}
    assert ended(run, mikron, None).row is not None, "a failed one is tried again"
    assert stand_in.asked[-1] == run.path / "shape"


def test_an_interrupted_one_is_continued_and_a_done_one_is_read(
    tmp_path: Path, mikron: Scene, stand_in: ShapeStandIn
) -> None:
    run = loop_run(tmp_path / "loop", mikron)
    stand_in.error = CranktopoError("interrupted", code=ExitCode.INTERRUPTED)
    with pytest.raises(CranktopoError, match="interrupted"):
        ended(run, mikron, None)
    stand_in.error = None
    first = ended(run, mikron, None)
    assert stand_in.asked[1:] == [run.path / "shape"]
    assert ended(run, mikron, None) == first
    assert len(stand_in.asked) == 2


def test_a_web_thinner_than_a_step_may_be_is_said_to_be_so() -> None:
    shape = {
        "found": True,
        "reason": "",
        "goal": {
            "minimise": "mass",
            "reached": 1.4,
            "original": 1.59,
            "unit": "kg",
            "reached_percent": 88.0,
            "limits": [],
        },
        "better_than_best_step": True,
        "best_step_percent": 95.0,
        "not_judged_of_steps": [],
    }
    data = {"design": "demo", "stop_reason": "", "best_step": 2, "least_transition_mm": 7.6}
    webs = (step(95, 110, 101).model_copy(update={"transition_mm": mm}) for mm in (5.3, 7.6))
    rows = (StepRow.of(web, web, "shape").as_json() for web in webs)
    thin, thick = (LoopResult.of_json({**data, "shape": shape, "steps": [row]}, "a loop") for row in rows)
    assert shape_line(thin) == (
        "shape: least mass 88.0 % of the original web, every limit holds, 5.3 mm beside a journal "
        "where a step keeps 7.6 mm; better than step 2 with 95.0 %"
    )
    assert "beside a journal" not in shape_line(thick)
    judged = thin.model_copy(update={"shape": thin.shape.model_copy(update={"loads": "cycle"})})
    assert "every limit holds, safety and stress over every angle of the cycle, 5.3 mm" in shape_line(judged)


def test_what_its_web_loses_in_the_shaft_is_said_first(
    tmp_path: Path, mikron: Scene, stand_in: ShapeStandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    stand_in.more = {"shaft_check": LESS_SAFE_IN_SHAFT}
    found = ended(loop_run(tmp_path / "loop", mikron), mikron, step(100, 115, 101))
    data = {"design": "demo", "stop_reason": "", "best_step": 2, "least_transition_mm": 7.6}
    row = StepRow.of(step(100, 115, 101), step(100, 115, 101), "").as_json()
    loop = LoopResult.of_json({**data, "shape": found.outcome.as_json(), "steps": 3 * [row]}, "a loop")
    monkeypatch.setattr("cranktopo.tasks.iterate.page.gallery_picture", lambda *_: None)
    first, reached, last = shape_lines(loop)
    assert first.startswith("shape: LESS SAFE IN ITS SHAFT: 1.086 (web 8, journal fillet), -14.3 +-2.0 %")
    assert reached == shape_line(loop)
    assert last.startswith("shape: in its shaft, on all bearings from 700 to 2,800 rpm")
    manifest = new_manifest(run="out", design="", command=(), scene={}, options={}, inputs={})
    page = iterate_page(loop, manifest, ())
    assert page.headline.startswith("Web of the shape optimisation: LESS SAFE IN ITS SHAFT: 1.086")
