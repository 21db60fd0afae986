"""Errors, Pareto front, recommendations, tables, stored studies and choices, from levels made by hand."""

from __future__ import annotations

import json
import mmap
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.machine import Machine, forget_peak_memory, peak_memory_MiB, this_machine
from cranktopo.base.notes import redirected
from cranktopo.bodies.memory import estimated_cells
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.accuracy.optimiser_levels import choose_cells
from cranktopo.tasks.accuracy.page import (
    accuracy_page,
    level_tables,
    limit_lines,
    recommendation_table,
    study_pictures,
)
from cranktopo.tasks.accuracy.stage import cheapest, pareto_front
from cranktopo.tasks.accuracy.study import Study, run_studies
from cranktopo.tasks.optimise.page import accuracy_section
from cranktopo.tasks.throw_fea import levels, studies
from cranktopo.tasks.throw_fea.levels import LEVELS, ErrorTarget, evaluate_to, first_level
from cranktopo.tasks.throw_fea.studies import (
    BENDING,
    EVALUATION,
    OPTIMISER,
    TORSION,
    Level,
    PlannedLevel,
    StoredStudy,
    StudyName,
    StudyResult,
    key_of,
    load_study,
    store_study,
)
from cranktopo.tasks.throw_fea.targets import Target
from tests.run_metrics import load_of, run_metrics

MACHINE = Machine("a processor", 2, 0.1)


def level(study: StudyName, family: str, size: float, seconds: float, **found: Any) -> Level:
    settings = {"size": size, **found.pop("settings", {})}
    model = found.pop("model", {})
    values = {TORSION: found["torsion"], BENDING: found["bending"]} if "torsion" in found else {}
    name = f"{family} {size:g}"
    return Level(study, name, family, settings, size, 1000, seconds, 200.0, values, 0.3, 0.5, model)


def mesh_level(steps: int, seconds: float, graded: bool = True, shift: float = 0.0) -> Level:
    """The limit is 100 in torsion, order 2, and 50 in bending, order 1."""
    size = 4.0 * 1.5**steps
    settings = {"steps": steps, "graded": graded, "order": 2}
    torsion, bending = 100 + 0.1 * size**2 + shift, 50 + 0.2 * size + shift
    family = "graded" if graded else "uniform"
    return level(EVALUATION, family, size, seconds, torsion=torsion, bending=bending, settings=settings)


def study(*levels: Level, interrupted: bool = False) -> Study:
    return Study("by-hand", 30.0, 20.0, MACHINE, levels, ("evaluation, a mesh: failed",), interrupted)


def solved() -> tuple[Level, ...]:
    own = {"settings": {"iterations": 30, "cells": 8000, "load_cases": 2}}
    return (
        mesh_level(2, 3.0, graded=False, shift=2.0),
        mesh_level(2, 4.0),
        mesh_level(1, 8.0),
        mesh_level(0, 16.0),
        mesh_level(1, 17.0, graded=False, shift=1.0),
        level(OPTIMISER, "cells", 3.0, 9.0, torsion=98.0, bending=51.0, model={TORSION: 99.0}, **own),
        level(OPTIMISER, "cells", 2.4, 18.0, torsion=99.0, bending=50.5, model={TORSION: 99.5}, **own),
        level(OPTIMISER, "10 iterations", 3.0, 5.0, **own),
    )


@pytest.fixture
def front() -> StudyResult:
    return pareto_front(study(*solved()))


def test_errors_are_against_the_extrapolated_value(front: StudyResult) -> None:
    limits = front.limits[EVALUATION]
    assert limits[TORSION].value == pytest.approx(100.0, rel=1e-6)
    assert limits[TORSION].order == pytest.approx(2.0, abs=1e-5)
    assert limits[BENDING].value == pytest.approx(50.0, rel=1e-6)
    last = front.rungs[3]
    assert last.errors_percent[TORSION] == pytest.approx(1.6, rel=1e-4)
    assert last.errors_percent[BENDING] == pytest.approx(1.6, rel=1e-4)
    assert last.orders == {TORSION: pytest.approx(2.0, abs=1e-5), BENDING: pytest.approx(1.0, abs=1e-5)}
    assert front.rungs[1].orders == {}


def test_levels_that_no_cheaper_one_beats_are_efficient(front: StudyResult) -> None:
    meshes = [found for found in front.rungs if found.ladder == EVALUATION]
    assert [found.efficient for found in meshes] == [True, True, True, True, False]


def test_recommendation_is_the_cheapest_whose_error_is_surely_below(front: StudyResult) -> None:
    finest = front.rungs[3]
    assert finest.error_percent is not None
    assert finest.bound_percent is not None
    assert finest.bound_percent > finest.error_percent
    chosen = cheapest(front.rungs, EVALUATION, finest.bound_percent + 1e-9)
    assert chosen is finest
    assert cheapest(front.rungs, EVALUATION, finest.error_percent) is None
    loose = cheapest(front.rungs, EVALUATION, 50.0)
    assert loose is front.rungs[0]


def test_a_limit_and_a_choice_keep_to_the_bound_of_the_mesh() -> None:
    """A study never claims a mesh to be worse than `evaluate` does, nor a limit outside its bound."""
    bounds = {TORSION: 0.5, BENDING: 1.0}
    meshes = (mesh_level(2, 4.0), mesh_level(1, 8.0), replace(mesh_level(0, 16.0), own_bounds_percent=bounds))
    plain, found = (pareto_front(study(*meshes[:2], last)) for last in (mesh_level(0, 16.0), meshes[2]))
    fine = meshes[2].values[BENDING]
    assert plain.limits[EVALUATION][BENDING].value == pytest.approx(50.0)
    assert found.limits[EVALUATION][BENDING].value == pytest.approx(0.99 * fine)
    assert (plain.rungs[2].bound_percent or 0.0) > 1.0
    assert found.rungs[2].bound_percent == 1.0
    assert first_level(ErrorTarget(percent=1.0), StoredStudy("by-hand", 1.0, found), triangles=False) == 2
    assert cheapest(found.rungs, EVALUATION, 1.0) == found.rungs[2]
    assert dict(level_tables(found))["Body-fitted evaluation"].cell(2, "own_bound_percent") == "1.00"


def test_the_optimiser_is_held_to_its_shape_and_to_its_own_number(front: StudyResult) -> None:
    first = front.rungs[5]
    assert first.model_errors_percent == {TORSION: pytest.approx(100 / 98)}
    assert first.error_percent == pytest.approx(max(abs(e) for e in first.errors_percent.values()))
    assert first.uncertainty_percent == pytest.approx(
        max(limit.uncertainty_percent for limit in front.limits[OPTIMISER].values())
    )
    sure = replace(solved()[5], band_percent=50.0)
    assert pareto_front(study(sure, solved()[6])).rungs[0].uncertainty_percent == 50.0
    empty = front.rungs[7]
    assert (empty.error_percent, empty.efficient, empty.errors_percent) == (None, False, {})


def test_json_and_pages(front: StudyResult) -> None:
    result = front
    assert json.loads(json.dumps(result.as_json(), allow_nan=False)) == result.as_json()
    assert {r.ladder for r in result.recommendations} == {"judge", "optimiser"}
    tables = dict(level_tables(result))
    assert list(tables) == ["Body-fitted evaluation", "Optimiser"]
    assert tables["Body-fitted evaluation"].cell(0, "level") == "uniform 9*"
    assert tables["Body-fitted evaluation"].cell(4, "level") == "uniform 6"
    assert recommendation_table(result).cell(3, "cheapest_level") == "none within this budget"
    assert limit_lines(result)[0].startswith("body-fitted evaluation, extrapolated: torsion 0.1 kN m/rad +-")
    page = accuracy_page(result, "today")
    assert "8 levels in 20 of 30 s" in page.headline
    axes = study_pictures(result)[0].figure.axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    joined = next(line for line in axes.lines if line.get_label() == "body-fitted evaluation, Pareto front")
    assert list(joined.get_xdata()) == [3.0, 4.0, 8.0, 16.0]


def test_the_report_of_a_run_shows_its_studies(front: StudyResult) -> None:
    cases = {"torsion": {"error_estimate_percent": 1.33}, "centrifugal": {}}
    others = {"compliance_N_mm": 1.0, "support": "free"}
    known = {name: {**case, **others, "load": load_of(name)} for name, case in cases.items()}
    metrics = run_metrics(load_cases=known)
    plain, full = (accuracy_section(metrics, studies, "one") for studies in (None, front))
    assert {"what": "error estimate, torsion", "value": "1.3 %"} in plain.tables[0][1].rows
    assert [title for title, _ in full.tables] == [
        "This run",
        "Body-fitted evaluation",
        "Optimiser",
        "Cheapest level",
    ]
    assert plain.pictures == (), "one number is no plot"
    assert "'cranktopo accuracy one'" in plain.text
    assert len(full.pictures) == 1


def test_names_of_levels_stand_where_no_level_is(front: StudyResult) -> None:
    (plot,) = study_pictures(front)
    axes = plot.figure.axes[0]
    plot.figure.canvas.draw()
    inner = axes.get_window_extent()
    points = np.concatenate([axes.transData.transform(line.get_xydata()) for line in axes.lines])
    assert len(axes.texts) >= 3
    for text in axes.texts:
        box = text.get_window_extent()
        assert not any(box.padded(2).contains(*point) for point in points), text.get_text()
        assert inner.x0 <= box.x0


def test_one_level_has_no_error_and_no_plot() -> None:
    result = pareto_front(study(mesh_level(2, 3.0)))
    page = accuracy_page(result, "today")
    assert page.sections[0].pictures == ()
    assert page.facts[0].value == "no accuracy reached"
    assert limit_lines(result) == ["body-fitted evaluation, extrapolated: nothing, fewer than two levels"]
    assert result.rungs[0].error_percent is None


class Clock:
    """A wall clock that only solving a level moves."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 0.0
        monkeypatch.setattr("cranktopo.tasks.accuracy.study.time.perf_counter", lambda: self.now)

    def planned(self, results: list[Level | BaseException]) -> list[PlannedLevel]:
        """Levels of cost 1, 2, 4 ... that take 4 s per unit of cost."""

        def solve(result: Level | BaseException, seconds: float) -> Level:
            self.now += seconds
            if isinstance(result, BaseException):
                raise result
            return result

        return [
            PlannedLevel(f"level {n}", 2.0**n, partial(solve, result, 4 * 2.0**n))
            for n, result in enumerate(results)
        ]


def run(
    monkeypatch: pytest.MonkeyPatch, scene: Scene, budget_s: float, results: list[Level | BaseException]
) -> tuple[Study, list[str]]:
    clock, lines = Clock(monkeypatch), list[str]()
    planned = {EVALUATION: clock.planned(results)}
    monkeypatch.setattr("cranktopo.tasks.accuracy.study.planned_studies", lambda target: planned)
    monkeypatch.setattr("cranktopo.tasks.accuracy.study.this_machine", lambda: MACHINE)
    with redirected(lines.append):
        return run_studies(Target("mikron", scene), budget_s), lines


def test_a_study_ends_before_the_level_that_would_not_fit(
    monkeypatch: pytest.MonkeyPatch, mikron: Scene
) -> None:
    """Levels of 4, 8 and 16 s: the third needs a budget of 28; a failed one says nothing of the speed."""
    three = [mesh_level(2, 3.0), CranktopoError("no mesh."), mesh_level(0, 16.0)]
    short, lines = run(monkeypatch, mikron, 27.0, [*three])
    assert [found.size_mm for found in short.levels] == [9.0]
    assert short.failures == ("body-fitted evaluation, level 1: no mesh.",)
    assert lines == [
        "[------------] 0 of 27 s: body-fitted evaluation, level 0",
        "[#-----------] 4 of 27 s: body-fitted evaluation, level 1, about 8 s",
        "[#####-------] 12 of 27 s: body-fitted evaluation, level 2 takes about 16 s, "
        "more than is left of its 27 s: give a larger budget",
    ]
    full, lines = run(monkeypatch, mikron, 28.0, [*three])
    assert [found.size_mm for found in full.levels] == [9.0, 4.0]
    assert lines[2].endswith("level 2, about 16 s")


def test_an_interruption_keeps_what_is_done(monkeypatch: pytest.MonkeyPatch, mikron: Scene) -> None:
    done = [mesh_level(2, 0.1), mesh_level(1, 0.1)]
    found, _ = run(monkeypatch, mikron, 60.0, [*done, KeyboardInterrupt()])
    assert found.interrupted
    assert list(found.levels) == done
    assert "interrupted after" in accuracy_page(pareto_front(found), "").headline


@pytest.fixture
def cache(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(studies, "this_machine", lambda: replace(MACHINE, reference_s=0.2))


def test_a_study_is_kept_with_the_speed_of_its_machine(cache: None, front: StudyResult) -> None:
    result = front
    assert load_study("by-hand", EVALUATION) is None
    assert store_study("by-hand", result) == studies.studies_path()
    found, other = load_study("by-hand", EVALUATION), load_study("another", EVALUATION)
    assert found is not None
    assert other is not None
    assert (found.slowdown, found.result) == (pytest.approx(2.0), result)
    assert other.design == "by-hand"
    store_study("newer", result)
    newest = load_study("another", EVALUATION)
    assert newest is not None
    assert newest.design == "newer"
    for name in ("by-hand", "newer"):
        store_study(name, result.model_copy(update={"machine": replace(MACHINE, cores=64)}))
    assert load_study("by-hand", EVALUATION) is None, "times of another machine say nothing"


def test_only_a_study_of_the_same_kind_is_loaded(cache: None, front: StudyResult, mikron: Scene) -> None:
    """A surface is only evaluated; so is a design whose budget ended before the optimiser's turn."""
    evaluated = pareto_front(study(mesh_level(2, 3.0), mesh_level(1, 8.0)))
    store_study("web", evaluated)
    assert load_study(mikron.name, OPTIMISER) is None
    store_study("by-hand", front)
    store_study(mikron.name, evaluated)
    for wanted in (mikron.name, "another"):
        found = load_study(wanted, OPTIMISER)
        assert found is not None
        assert found.design == "by-hand"
        assert "measured on by-hand" in str(choose_cells(mikron, 5.0, None, found))
    own, newest = load_study(mikron.name, EVALUATION), load_study("another", EVALUATION)
    assert own is not None
    assert newest is not None
    assert (own.design, newest.design) == (mikron.name, mikron.name)


def test_surfaces_are_kept_under_their_path(mikron: Scene, tmp_path: Path) -> None:
    run, other = (Target("web", mikron, tmp_path / folder / "web" / "web.stl") for folder in ("a", "b"))
    assert key_of(Target("web", mikron)) == "web"
    assert len({key_of(run), key_of(other), "web"}) == 3


def test_a_damaged_file_holds_nothing(cache: None, front: StudyResult) -> None:
    store_study("by-hand", front)
    studies.studies_path().write_text('{"schema_version": 2, "designs": 3}', encoding="utf-8")
    assert load_study("by-hand", EVALUATION) is None


def test_the_first_level_follows_from_what_was_measured(front: StudyResult) -> None:
    """Steps 2, 1, 0: 4 + (3 not measured), 8 + 4, 16 + 8 s here, twice as much on the slower machine."""
    known = StoredStudy("by-hand", 2.0, front)
    bound = front.rungs[2].bound_percent
    assert bound is not None
    assert first_level(ErrorTarget(percent=bound + 0.01), known, triangles=True) == 1
    assert first_level(ErrorTarget(budget_s=25.0), known, triangles=True) == 1
    assert first_level(ErrorTarget(budget_s=49.0), known, triangles=True) == 2
    assert first_level(ErrorTarget(budget_s=1.0), known, triangles=True) == 0
    assert first_level(ErrorTarget(percent=bound + 0.01, budget_s=1.0), known, triangles=True) == 0
    assert first_level(ErrorTarget(percent=1.0), None, triangles=True) == 2
    assert first_level(ErrorTarget(percent=0.001), None, triangles=True) == len(LEVELS) - 1
    assert first_level(ErrorTarget(budget_s=1000.0), None, triangles=True) == 0


class FakeEvaluation:
    """A bound of 0.3 size^2, and a mesh that takes 1.9 times as long as the coarser one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now, self.sizes = 0.0, [0.0]
        self.sizes.clear()
        monkeypatch.setattr(levels.time, "perf_counter", lambda: self.now)
        monkeypatch.setattr(levels, "evaluate_on_mesh", self.mesh)
        monkeypatch.setattr(levels, "evaluation", self.evaluation)

    def mesh(self, target: Target, size: float, **_: Any) -> Any:
        seconds = 1000 * size**-1.583  # 1.9 per factor 1.5
        self.now += seconds
        self.sizes.append(size)
        return type("MeshResult", (), {"size": size, "seconds": seconds})

    @staticmethod
    def evaluation(fine: Any, coarse: Any, seconds: float) -> Any:
        assert coarse is None, "an exact solid"
        found = {"error_percent": 0.3 * fine.size**2, "size": fine.size, "seconds": seconds}
        return type("Evaluation", (), found)


def test_evaluation_refines_to_the_accuracy_and_no_further(
    monkeypatch: pytest.MonkeyPatch, mikron: Scene
) -> None:
    fake = FakeEvaluation(monkeypatch)
    found, reached = evaluate_to(Target("mikron", mikron), ErrorTarget(percent=1.2))
    assert reached
    assert found.error_percent <= 1.2
    assert fake.sizes == sorted(set(fake.sizes), reverse=True), "no mesh twice"
    before = fake.evaluation(type("J", (), {"size": fake.sizes[-2]}), None, 0.0)
    assert before.error_percent > 1.2


@pytest.mark.parametrize("budget", [30.0, 100.0, 300.0])
def test_evaluation_keeps_within_its_budget(
    monkeypatch: pytest.MonkeyPatch, mikron: Scene, budget: float
) -> None:
    fake = FakeEvaluation(monkeypatch)
    found, reached = evaluate_to(Target("mikron", mikron), ErrorTarget(budget_s=budget))
    cheapest = len(fake.sizes) == 1
    assert reached
    assert found.size == min(fake.sizes)
    assert cheapest or fake.now <= budget
    assert fake.now * 3.3 > budget, "the next mesh would not have fitted"
    _, reached = evaluate_to(Target("mikron", mikron), ErrorTarget(percent=1e-6, budget_s=budget))
    assert not reached


def test_measured_times_replace_the_rough_ones(mikron: Scene, front: StudyResult) -> None:
    known = StoredStudy("by-hand", 2.0, front)
    guess, found = (choose_cells(mikron, 5.0, None, k) for k in (None, known))
    assert guess.cell_mm == found.cell_mm
    assert "measured on by-hand" in str(found)
    # 18 s for 16 000 cells times cases, in proportion beyond, twice as slow now, 0.5 s of compilation.
    work = 2 * estimated_cells(mikron, found.cell_mm, quarter=True)
    assert found.seconds == pytest.approx(2 * (18 * work / 16000 + 0.5), rel=1e-6)
    # Twice the solves, 20 iterations more than 30, and four evaluations of 16 s and 8 s.
    asked = {"goal": {"minimise": "mass"}, "optimise": {"min_member_mm": 8.0}}
    scene = scene_from_dict(mikron.model_dump(mode="json", exclude_none=True) | asked, mikron.name)
    full = choose_cells(scene, 5.0, None, known)
    expected = 2 * (18 * (5 / 3) * 2 * work / 16000 + 0.5 + 4 * 24)
    assert full.seconds == pytest.approx(expected, rel=1e-6)


def test_memory_and_speed_are_measured() -> None:
    import numpy as np

    forget_peak_memory()
    before = peak_memory_MiB()
    block = mmap.mmap(-1, 40 * 2**20)  # an array might take memory that the process has, but does not use
    np.frombuffer(block, np.uint8)[:] = 1
    assert peak_memory_MiB() > before + 0.9 * 40
    assert this_machine().reference_s > 0
