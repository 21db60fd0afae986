"""Many motions at once against closed forms: order, stiffness, kinks of the grid, independence."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from cranktopo.base.arrays import Array, Complex, Index
from cranktopo.numerics.planar_motion import motions

TURN = 2 * np.pi / 40
RATES = np.array([0.0, 0.3, 30.0, 3e5])


def pulled(rates: Array, place: Array, at: Complex, one: Index) -> Complex:
    """A point that is pulled to one on a circle, gently or stiffly; it stays on it."""
    circle = np.exp(1j * TURN * place)
    return np.asarray(1j * TURN * circle - rates[one] * (at - circle))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_soft_and_stiff_motions_follow_their_circle(tolerance: float) -> None:
    path, _ = motions(partial(pulled, RATES), np.ones(4, dtype=complex), 40, tolerance)
    circle = np.exp(1j * TURN * np.arange(41))
    assert np.abs(path - circle[:, None]).max() < 40 * tolerance


def test_a_start_off_the_circle_comes_back_by_the_exponential() -> None:
    path, _ = motions(partial(pulled, RATES), np.full(4, 1.5 + 0.2j), 40, 1e-8)
    expected = np.exp(1j * TURN * np.arange(41))[:, None] + (0.5 + 0.2j) * np.exp(
        -RATES * np.arange(41)[:, None]
    )
    assert np.abs(path - expected).max() < 1e-6


def test_a_motion_that_depends_on_its_place_in_both_directions() -> None:
    """z' = conj(z) / 3 grows along x and dies along y: no derivative of a complex function."""

    def slope(place: Array, at: Complex, one: Index) -> Complex:
        return np.asarray(at.conj() / 3)

    path, _ = motions(slope, np.array([1 + 2j]), 6, 1e-9)
    assert path[-1, 0] == pytest.approx(np.exp(2) + 2j * np.exp(-2), rel=1e-6)


def test_a_kink_at_a_point_of_the_grid_costs_no_accuracy() -> None:
    """A slope that is a ramp up and down again, as loads between their angles are."""

    def slope(place: Array, at: Complex, one: Index) -> Complex:
        return np.asarray(np.abs(place % 2 - 1) + 0j)

    path, _ = motions(slope, np.zeros(1, dtype=complex), 10, 1e-3)
    assert path[:, 0] == pytest.approx(0.5 * np.arange(11), abs=1e-9)


def test_each_motion_is_what_it_is_alone() -> None:
    start = np.array([1.0, 1.5, -0.3 + 1j, 2j])
    together, _ = motions(partial(pulled, RATES), start, 40, 1e-5)
    for one in range(4):
        alone, _ = motions(partial(pulled, RATES[one : one + 1]), start[one : one + 1], 40, 1e-5)
        assert np.abs(alone[:, 0] - together[:, one]).max() < 1e-12


def test_two_pieces_are_one_motion_where_the_length_of_the_step_is_handed_on() -> None:
    """As are two halves of a cycle; a step that begins anew would differ by its error."""
    whole, _ = motions(partial(pulled, RATES), np.full(4, 1.5 + 0.2j), 40, 1e-5)

    def later(place: Array, at: Complex, one: Index) -> Complex:
        return pulled(RATES, place + 13, at, one)

    first, length = motions(partial(pulled, RATES), np.full(4, 1.5 + 0.2j), 13, 1e-5)
    second, _ = motions(later, first[-1], 27, 1e-5, length)
    assert np.abs(second - whole[13:]).max() < 1e-12


def test_a_motion_turns_and_mirrors_with_its_slope() -> None:
    """One with a bend along its radius, and across it: differences meet it alike in every frame."""

    def bent(place: Array, at: Complex, one: Index) -> Complex:
        size, way = np.abs(at), np.angle(at)
        inward = np.where(size > 0.8, 3.0, 1.0) * (size - 0.8 - 0.2 * np.cos(TURN * place))
        return np.asarray((0.2j * (1 + np.abs(size - 0.9)) - inward) * np.exp(1j * way))

    start, turn = np.array([0.7 + 0.4j, 0.3 - 0.9j]), np.exp(0.7j)
    base, _ = motions(bent, start, 20, 1e-6)
    turned, _ = motions(lambda p, at, one: turn * bent(p, at / turn, one), turn * start, 20, 1e-6)
    image, _ = motions(lambda p, at, one: bent(p, at.conj(), one).conj(), start.conj(), 20, 1e-6)
    assert np.abs(turned - turn * base).max() < 1e-9  # 1.02e-10 on one processor, less on others
    assert np.abs(image - base.conj()).max() == 0.0
