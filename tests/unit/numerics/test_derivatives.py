"""Derivatives by differences and complex steps, against those by hand."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.numerics.optimisers.gradient_search import central_difference, complex_step

AT = np.array([0.4, -1.2, 2.0])


def waves(x: Array) -> Array:
    return np.array([[np.sin(x[0]) * x[1], x[2] ** 2], [x[0] * x[2], np.exp(x[1])]])


def by_hand(x: Array) -> Array:
    return np.array(
        [
            [[np.cos(x[0]) * x[1], np.sin(x[0]), 0.0], [0.0, 0.0, 2 * x[2]]],
            [[x[2], 0.0, x[0]], [0.0, np.exp(x[1]), 0.0]],
        ]
    )


def test_differences_come_near_and_complex_steps_are_exact() -> None:
    assert central_difference(waves, AT, 1e-5) == pytest.approx(by_hand(AT), abs=1e-9)
    assert complex_step(waves, AT) == pytest.approx(by_hand(AT), rel=1e-15)


def test_places_that_are_left_out_have_no_derivative() -> None:
    found = central_difference(waves, AT, 1e-5, [1])
    assert found[..., [0, 2]] == pytest.approx(0.0)
    assert found[..., 1] == pytest.approx(by_hand(AT)[..., 1], abs=1e-9)
    assert central_difference(waves, AT, 1e-5, []) == pytest.approx(np.zeros((2, 2, 3)))


def test_points_are_moved_together() -> None:
    """Of a distance at points (3, n) the gradient at each, (n, 3)."""
    points = np.array([[3.0, 0.0, 1.0], [4.0, 2.0, 2.0], [0.0, 0.0, 2.0]])
    found = central_difference(lambda at: np.linalg.norm(at, axis=0), points, 1e-6)
    assert found == pytest.approx((points / np.linalg.norm(points, axis=0)).T, abs=1e-9)
