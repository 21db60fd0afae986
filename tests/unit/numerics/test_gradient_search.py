"""Sequential quadratic programming: limits that contradict each other, numbers that differ in last bits."""

from __future__ import annotations

from collections.abc import Callable

import nlopt
import numpy as np
import pytest
from scipy.optimize import rosen, rosen_der

from cranktopo.base.arrays import Array
from cranktopo.numerics.optimisers.gradient_search import Constraints, Objective, minimise, minimise_violation

HARD = 0.8
"""Most sum of both numbers, a rule that is not to be broken."""


def objective(at: Array) -> tuple[float, Array]:
    return float(((at - 3.0) ** 2).sum()), 2 * (at - 3.0)


def constraints(at: Array) -> tuple[Array, Array]:
    """Return x >= 1, 1 <= y and x + y <= 0.8: with x and y below 1, both of the first are missed."""
    return np.array([1 - at[0], 1 - at[1] ** 2, at.sum() - HARD]), np.array(
        [[-1.0, 0.0], [0.0, -2 * at[1]], [1.0, 1.0]]
    )


def searched(most: float, missable: int = 2) -> Array:
    bounds = np.zeros(2), np.full(2, most)
    return minimise_violation(objective, constraints, missable, 100.0, bounds, np.zeros(2), 1e-7, 200)


def test_the_worst_violation_is_the_least() -> None:
    """1 - x = 1 - y2 on x + y = 0.8: y = (sqrt(4.2) - 1) / 2, whatever the objective says."""
    y = (np.sqrt(1 + 4 * HARD) - 1) / 2
    assert searched(1.0) == pytest.approx([y**2, y], abs=1e-5)


def test_the_rest_holds_where_bounds_decide() -> None:
    """Below 0.3 the first is missed by 0.7 at least, the second by more: both numbers go to the bound."""
    assert searched(0.3) == pytest.approx([0.3, 0.3], abs=1e-6)


def test_the_objective_decides_where_all_hold() -> None:
    """Without the sum the constraints hold from 1 on: the free optimum at 3 is found."""

    def two(at: Array) -> tuple[Array, Array]:
        found, slopes = constraints(at)
        return found[:2], slopes[:2]

    bounds = np.zeros(2), np.full(2, 5.0)
    found = minimise_violation(objective, two, 2, 100.0, bounds, np.array([0.5, 0.5]), 1e-7, 200)
    assert found == pytest.approx([3.0, 3.0], abs=1e-5)


@pytest.mark.parametrize("seed", range(5))
def test_the_last_bits_do_not_lead_a_search_elsewhere(seed: int) -> None:
    """A valley that bends, beside a limit: sums that differ by 1e-13 from one computer to another."""
    there = minimise(*_bending_valley(None), (np.full(6, -2.0), np.full(6, 2.0)), np.full(6, -1.0), 1e-6, 60)
    noise = np.random.default_rng(seed)
    here = minimise(*_bending_valley(noise), (np.full(6, -2.0), np.full(6, 2.0)), np.full(6, -1.0), 1e-6, 60)
    assert (here == there).all()


def _bending_valley(noise: np.random.Generator | None) -> tuple[Objective, Constraints]:
    """Return Rosenbrock's function of many variables, and a ball that leaves its lowest place out."""

    def seen(numbers: Array) -> Array:
        return numbers if noise is None else numbers * (1 + 1e-13 * noise.standard_normal(numbers.shape))

    def height(at: Array) -> tuple[float, Array]:
        return float(seen(np.array([rosen(at)]))[0]), seen(rosen_der(at))

    def ball(at: Array) -> tuple[Array, Array]:
        return seen(np.array([at @ at - 4.0])), seen(2 * at[None])

    return height, ball


def squares(values: Array) -> tuple[float, Array]:
    return float(1e3 * (values**2).sum()), 2e3 * values


def test_slopes_that_least_squares_cannot_take_end_a_search_without_an_error() -> None:
    """Slopes that differ by eleven powers of ten: by its last bits a processor takes a step, or none."""
    slopes = np.array([[-0.00011], [54000.0], [-47.0], [-14.0], [-2.5e6], [-0.0009]])
    offsets = np.array([-2.5e-06, 35000.0, -0.11, 28.0, -52.0, -3800.0])

    def rules(values: Array) -> tuple[Array, Array]:
        return slopes @ values + offsets, slopes

    bounds = np.full(1, -5.0), np.full(1, 5.0)
    (found,) = minimise(squares, rules, bounds, np.full(1, 2.0), 1e-3, 50)
    assert -5.0 <= found <= 2.0


def test_a_search_whose_method_fails_ends_where_it_began(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object) -> None:
        raise nlopt.runtime_error("nlopt failure")  # as its least squares do: `iterate` of a diesel

    monkeypatch.setattr(nlopt.opt, "optimize", failing)
    bounds = np.full(2, -5.0), np.full(2, 5.0)
    assert minimise(squares, constraints, bounds, np.array([2.0, 1.0]), 1e-3, 50).tolist() == [2.0, 1.0]


def test_errors_of_the_functions_end_a_search() -> None:
    def broken(values: Array) -> tuple[float, Array]:
        raise RuntimeError("no memory")

    bounds = np.zeros(1), np.ones(1)
    with pytest.raises(RuntimeError, match="no memory"):
        minimise(broken, lambda v: (v - 1, np.eye(1)), bounds, np.zeros(1), 1e-3, 5)


def test_slopes_are_found_where_they_are_asked_for_alone() -> None:
    """A narrow valley: its line searches look at values; the design is that of slopes found every time."""
    places, asked = [], []

    def late(values: Array) -> tuple[float, Callable[[], Array]]:
        places.append(values.tobytes())
        value, slopes = _bending_valley(None)[0](values)
        return value, lambda: asked.append(1) or slopes

    bounds = np.full(6, -2.0), np.full(6, 2.0)
    _, rules = _bending_valley(None)
    found = minimise(late, lambda v: (rules(v)[0], lambda: rules(v)[1]), bounds, np.full(6, -1.0), 1e-6, 60)
    at_once = minimise(*_bending_valley(None), bounds, np.full(6, -1.0), 1e-6, 60)
    assert found.tolist() == at_once.tolist()
    assert 0 < len(asked) < len(places)
