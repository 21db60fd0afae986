"""Searches of a fit in two processes: the same webs, in the same order, as in one."""

from __future__ import annotations

import pytest
from manifold3d import Manifold

from cranktopo.base import companion
from cranktopo.base.companion import ALONE, Companion
from cranktopo.design.loading import load_scene
from cranktopo.tasks.refit import select
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import fit_problem
from cranktopo.tasks.refit.search import FitProblem, outline_guess
from cranktopo.tasks.refit.select import Candidate, FitTask, fit_from, fits_from
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

STATIONS = (5, 6, 7)


@pytest.fixture(scope="module")
def problem() -> FitProblem:
    scene = load_scene("mikron-iiic-plain")
    start, end = scene.web_z_mm
    square = Manifold.cube((88.0, 106.0, end - start)).translate((-44.0, -29.0, start))
    return fit_problem(square, scene, ManufacturingLimits(), 5.0)


@pytest.fixture(scope="module")
def tasks(problem: FitProblem) -> list[FitTask]:
    return [FitTask(Layout(n), outline_guess(problem, n), f"{n} stations") for n in STATIONS]


def bits(found: Candidate | None) -> tuple[str, bytes, float]:
    assert found is not None
    return found.step, found.values.tobytes(), found.overlap


def test_two_processes_find_the_same_webs(
    problem: FitProblem, tasks: list[FitTask], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second process does the second search: this one is not asked for it."""
    alone = [bits(fit_from(problem, task)) for task in tasks]
    assert [step for step, _, _ in alone] == [f"{n} stations" for n in STATIONS]
    assert [bits(found) for found in fits_from(problem, tasks, ALONE)] == alone
    monkeypatch.setattr(companion, "usable_cores", lambda: 2)
    here: list[str] = []
    search = fit_from
    monkeypatch.setattr(
        select, "fit_from", lambda problem, task: here.append(task.step) or search(problem, task)
    )
    with Companion(("nlopt",)) as beside:
        both = [bits(found) for found in fits_from(problem, tasks, beside)]
    assert both == alone
    assert here == ["5 stations", "7 stations"]
