"""Cells that keep an accuracy or a budget, as walls and memory allow."""

from __future__ import annotations

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.accuracy.optimiser_levels import choose_cells, optimiser_models


def test_cells_for_an_accuracy_or_a_budget(mikron: Scene) -> None:
    coarse, fine = choose_cells(mikron, 10.0, None), choose_cells(mikron, 2.0, None)
    assert coarse.cell_mm > fine.cell_mm
    assert coarse.error_percent <= 10.0
    assert fine.error_percent <= 2.0
    assert "run cranktopo accuracy" in str(coarse)
    within = choose_cells(mikron, None, coarse.seconds + 1e-6)
    assert within.cell_mm == pytest.approx(coarse.cell_mm)
    both = choose_cells(mikron, 10.0, 1e6)
    assert both == coarse
    with pytest.raises(CranktopoError, match="takes about"):
        choose_cells(mikron, 2.0, coarse.seconds + 1.0)
    with pytest.raises(CranktopoError, match="coarsest cells"):
        choose_cells(mikron, None, 0.1)
    with pytest.raises(CranktopoError, match="evaluate RUN"):
        choose_cells(mikron, 1e-4, None)


def test_evaluations_and_the_eroded_design_take_time(mikron: Scene) -> None:
    """40 s of four evaluations and 20 more iterations than 35; the 20 s of compiling stay what they are."""

    def seconds(goal: dict[str, str] | None = None, **settings: object) -> float:
        data = mikron.model_dump(mode="json", exclude_none=True) | ({"goal": goal} if goal else {})
        scene = scene_from_dict(data, mikron.name).with_optimise(**settings)
        return choose_cells(scene, 10.0, None).seconds - 13.0

    plain, least = seconds(), {"minimise": "mass"}
    assert seconds(min_gap_mm=8.0) == pytest.approx(2 * plain)
    assert seconds(least, limits_by_evaluation=False) == pytest.approx(plain)
    assert seconds(least) == pytest.approx(plain * 55 / 35 + 60)
    assert seconds(least, max_iterations=40) == pytest.approx(plain * 40 / 35 + 60)


def throw_with(scene: Scene, bore_mm: float) -> Scene:
    """The throw with a main journal of another bore, and so of another wall."""
    journal = scene.throw.main_journal.model_copy(update={"bore_diameter_mm": bore_mm})
    return scene.model_copy(update={"throw": scene.throw.model_copy(update={"main_journal": journal})})


@pytest.mark.parametrize("wanted", [(5.0, None), (None, 60.0)], ids=["accuracy", "budget"])
def test_a_wall_thinner_than_any_cells_is_named(mikron: Scene, wanted: tuple[float, float]) -> None:
    words = r"resolution_mm = 1\.5: too coarse: the thinnest journal wall is 0\.25 mm.*at most 0\.125 mm"
    with pytest.raises(CranktopoError, match=words):
        choose_cells(throw_with(mikron, 41.5), *wanted)


@pytest.mark.parametrize("wanted", [(5.0, None), (None, 60.0)], ids=["accuracy", "budget"])
def test_a_memory_too_small_for_any_cells_is_named(
    mikron: Scene, wanted: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cranktopo.tasks.accuracy.optimiser_levels.available_memory_MiB", lambda: 1251.0)
    with pytest.raises(CranktopoError, match=r"resolution_mm = 3\.77.*: too fine: .* GiB available"):
        choose_cells(mikron, *wanted)


def test_the_optimisers_study_ends_where_walls_end_it(mikron: Scene) -> None:
    """The finest cells are 1.5 mm over 2 to the power 8/3: they fit twice into 0.5 mm, not into 0.25 mm."""
    usual, single, none = (optimiser_models(throw_with(mikron, bore)) for bore in (24.0, 41.0, 41.5))
    assert [model.label for model in usual[:4]] == ["", "", "", "10 iterations"]
    assert [(model.label, model.cell_mm) for model in single] == [("", pytest.approx(1.5 * 2 ** (-8 / 3)))]
    assert none == ()
