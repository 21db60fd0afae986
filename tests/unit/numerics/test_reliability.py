"""First-order reliability against closed forms and random draws."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.reliability import first_order


def test_a_plane_is_exact() -> None:
    slopes = np.array([2.0, -1.0, 0.5])
    found = first_order(lambda u: float(3.0 + slopes @ u), 3)
    assert found.index == pytest.approx(3.0 / np.linalg.norm(slopes), rel=1e-9)
    assert found.shares == pytest.approx(slopes**2 / (slopes @ slopes), rel=1e-6)
    assert found.failure_probability == pytest.approx(0.5 * math.erfc(found.index / math.sqrt(2)), rel=1e-12)


def test_what_fails_in_the_mean_has_a_negative_index() -> None:
    found = first_order(lambda u: float(u[0] - 1.0), 1)
    assert found.index == pytest.approx(-1.0)
    assert found.failure_probability == pytest.approx(0.8413447, rel=1e-6)


def test_the_nearest_point_of_a_sphere() -> None:
    """A sphere about a point off the origin: the distance to it is known."""
    centre = np.array([0.4, -0.3])
    found = first_order(lambda u: float(9.0 - (u - centre) @ (u - centre)), 2)
    assert found.index == pytest.approx(3.0 - 0.5, rel=1e-6)


def test_strength_and_load_by_random_draws() -> None:
    """Normal strength and load in a margin that is not linear: curved little, so within a few percent."""

    def margin(u: Array) -> Array:
        return np.log((1.5 + 0.15 * u[0]) / (1.0 + 0.1 * u[1] + 0.005 * u[1] ** 2))

    draws = np.random.default_rng(5).standard_normal((2, 2_000_000))
    failed = float(np.mean(margin(draws) < 0))
    assert first_order(lambda u: float(margin(u)), 2).failure_probability == pytest.approx(failed, rel=0.05)


def test_a_margin_of_nothing_is_refused() -> None:
    with pytest.raises(CranktopoError, match="no point of failure"):
        first_order(lambda _: 1.0, 2)
