"""Smallest enclosing balls against closed forms and a general optimiser."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from cranktopo.base.arrays import Array
from cranktopo.numerics.enclosing_balls import enclosing_balls


def by_optimiser(points: Array) -> float:
    """Radius by SLSQP: least height above all paraboloids about the points."""
    start = np.append(points.mean(axis=0), 10.0)
    holds = {"type": "ineq", "fun": lambda x: x[-1] - ((points - x[:-1]) ** 2).sum(axis=1)}
    found = minimize(
        lambda x: x[-1], start, constraints=[holds], method="SLSQP", options={"ftol": 1e-14, "maxiter": 500}
    )
    return float(np.sqrt(found.x[-1]))


@pytest.mark.parametrize("size", [1, 2, 3, 5])
def test_radius_of_random_points_is_the_optimisers(size: int) -> None:
    points = np.random.default_rng(size).normal(size=(20, 60, size))
    centres, radii = enclosing_balls(points)
    assert radii == pytest.approx([by_optimiser(one) for one in points], rel=1e-8)
    assert (np.linalg.norm(points - centres[:, None], axis=2) <= radii[:, None] * (1 + 1e-15)).all()


def test_known_figures() -> None:
    height = np.sqrt(3) / 2
    triangle = np.array([[0, 0], [1, 0], [0.5, height]])
    blunt = np.array([[0, 0], [2, 0], [1, 0.1]])
    point = np.ones((3, 2))
    centres, radii = enclosing_balls(np.stack([triangle, blunt, point]))
    assert radii == pytest.approx([1 / np.sqrt(3), 1.0, 0.0], abs=1e-14)
    assert centres == pytest.approx(np.array([[0.5, height / 3], [1.0, 0.0], [1.0, 1.0]]), abs=1e-14)


def test_flat_sets_and_repeated_points() -> None:
    """A path on a line or a plane of a larger space, traced twice, has the ball of its ends or its circle."""
    turn = np.linspace(0.0, 4 * np.pi, 721)
    line = np.outer(np.cos(turn), [3.0, 0, 4.0, 0, 0])
    circle = np.outer(np.cos(turn), [2.0, 0, 0, 0, 0]) + np.outer(np.sin(turn), [0, 0, 0, 2.0, 0])
    centres, radii = enclosing_balls(np.stack([line, circle]) + 7.0)
    assert radii == pytest.approx([5.0, 2.0], rel=1e-12)
    assert centres == pytest.approx(np.full((2, 5), 7.0), rel=1e-9)
