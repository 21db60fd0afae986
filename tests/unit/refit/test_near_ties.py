"""Numbers that differ by rounding lead to the same stations, features, start and best step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.near_ties import SAME, best_first, clearly_more, exceeds, first_of_the_best
from cranktopo.design.schema import Scene
from cranktopo.tasks.iterate.result import LoopStep, best_step, verdict
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import fit_problem
from cranktopo.tasks.refit.search import Fit, FitProblem, voxel_fill
from cranktopo.tasks.refit.select import select
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.unit.refit.remodel_cases import PARTS, body_of, known_scene

SCORES = 1e-9
"""Relative size of what machines differ by in a score."""
LIMITS = ManufacturingLimits(max_stations=5)


def shaken(values: np.ndarray, seed: int, size: float = SCORES) -> np.ndarray:
    """Values with a relative error that differs from machine to machine."""
    return np.asarray(values * (1 + size * np.random.default_rng(seed).uniform(-1, 1, np.shape(values))))


@pytest.fixture(scope="module")
def body(mikron: Scene) -> Manifold:
    return body_of(known_scene(mikron, Layout(7, PARTS[:2])), 2.0)


@pytest.fixture(scope="module")
def problem(mikron: Scene, body: Manifold) -> FitProblem:
    return fit_problem(body, mikron, LIMITS, 5.0)


@pytest.mark.parametrize(
    ("scores", "first", "order"),
    [
        ([0.85, 0.85, 0.85], 0, [0, 1, 2]),
        ([0.84, 0.85, 0.85], 1, [1, 2, 0]),
        ([0.8501, 0.85, 0.8502], 0, [0, 1, 2]),
        ([0.85, 0.85 * (1 + 3 * SAME), 0.8], 1, [1, 0, 2]),
        ([-2.0, -2.0, 0.0], 2, [2, 0, 1]),
    ],
)
def test_of_equals_the_first_is_taken_whatever_the_rounding(
    scores: list[float], first: int, order: list[int]
) -> None:
    for seed in range(50):
        found = shaken(np.array(scores), seed)
        assert first_of_the_best(range(3), lambda i, own=found: own[i]) == first
        assert best_first(range(3), lambda i, own=found: own[i]) == order


def test_what_is_clearly_more() -> None:
    assert not clearly_more(100.09, 100.0)
    assert clearly_more(100.11, 100.0)
    assert clearly_more(-1.0, -1.1)
    assert not exceeds(7.6 * (1 + 1e-9), 7.6)
    assert exceeds(7.601, 7.6)


def test_bodies_that_differ_by_rounding_have_the_same_cells(mikron: Scene, body: Manifold) -> None:
    moved = body.warp_batch(lambda points: shaken(points, 1, 1e-12))
    assert np.any(moved.to_mesh64().vert_properties != body.to_mesh64().vert_properties)
    one, other = voxel_fill(body, mikron, 2.0), voxel_fill(moved, mikron, 2.0)
    for name, value in vars(one).items():
        assert np.array_equal(value, getattr(other, name)), name


def test_a_plane_through_the_middle_of_cells_fills_none_for_the_most_part(problem: FitProblem) -> None:
    for size in (0.0, 1e-12):
        half = np.full(problem.target.filled.shape, 0.5)
        assert not replace(problem.target, filled=shaken(half, 1, size)).solid.any()


def test_guesses_of_features_do_not_turn_on_rounding(mikron: Scene, problem: FitProblem) -> None:
    """Heights and widths are whole cells, so that what is one cell less is a tie."""
    for part in (FittedBevel("journal"), FittedBevel("pin"), FittedSlot()):
        guesses = []
        for seed in range(10):
            cells = problem.target
            moved = replace(cells, x_mm=shaken(cells.x_mm, seed, 1e-14), y_mm=shaken(cells.y_mm, seed, 1e-14))
            guesses.append(part.guess(moved, mikron, LIMITS))
        for guess in guesses[1:]:
            assert (guess is None) == (guesses[0] is None)
            assert guess is None or guess == pytest.approx(guesses[0], abs=1e-9)


@pytest.mark.slow
def test_stations_and_features_stay(problem: FitProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    found, trials = select(problem)
    exact = Fit.overlap
    draws = np.random.default_rng(2)

    def overlap(self: Fit, values: np.ndarray, width_mm: float) -> float:
        return exact(self, values, width_mm) * (1 + SCORES * draws.uniform(-1, 1))

    monkeypatch.setattr(Fit, "overlap", overlap)
    filled = shaken(problem.target.filled, 3, 1e-12)
    again, others = select(replace(problem, target=replace(problem.target, filled=filled)))
    assert again.layout == found.layout
    assert [(trial.step, trial.kept) for trial in others] == [(trial.step, trial.kept) for trial in trials]


def step(number: int, torsion: float, mass: float = 1.5, transition: float = 12.0) -> LoopStep:
    return LoopStep(
        number=number,
        throw_kg=mass,
        web_kg=mass / 3,
        torsion_Nm_per_rad=torsion,
        bending_N_per_mm=240.0,
        torsion_error_percent=0.4,
        bending_error_percent=0.6,
        transition_mm=transition,
        overlap_percent=95.0,
        removed_percent=10.0,
        seconds=1.0,
    )


def test_the_loop_ends_at_the_same_step_and_calls_the_same_best() -> None:
    """Steps with the values of the original or of each other, but for rounding."""
    for seed in range(50):
        mass, torsion, transition = (
            shaken(np.array(values), seed).tolist()
            for values in ([1.6, 1.6, 1.6, 1.6], [1600.0, 1700.0, 1700.0, 1700.0], [7.6, 7.6, 7.6, 7.6])
        )
        steps = [step(i, torsion[i], mass[i], transition[i]) for i in range(4)]
        assert verdict(steps[:2], 7.6) == "better"
        assert verdict(steps[:3], 7.6) == "no gain"
        best = best_step(steps, 7.6)
        assert best is not None
        assert best.number == 1
