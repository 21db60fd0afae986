"""Prices and steps by linear programmes, against closed forms and against the programme solved again."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.numerics.optimisers.gradient_search import multipliers
from cranktopo.numerics.optimisers.linear_programmes import Penalties, linear_multipliers, linear_steps

MASS = np.array([0.624, 0.958])
BALANCE = np.array([[-2.945, -8.321]])
"""Percent by a degree of a counterweight's angle and a millimetre of its radius; balance is a lower limit."""
FREE = np.full(2, np.inf)
NO_RULES = np.zeros(0), np.zeros((0, 2))


def test_the_price_of_a_bound_keeps_a_limit_that_has_a_little_room() -> None:
    """A degree less takes 0.62 % of mass away, of which the radius that balances it gives back 0.34 %."""
    limits, bounds = (np.array([-0.01]), BALANCE), (np.array([0.0, np.inf]), FREE)
    found = linear_multipliers(MASS, limits, NO_RULES, bounds, 1.0)
    assert found.bounds[0] == pytest.approx(0.624 - 0.958 * 2.945 / 8.321)
    assert found.limits[0] == pytest.approx(0.958 / 8.321)
    assert found.remainder == pytest.approx(0.0, abs=1e-12)
    bare = multipliers(MASS, limits, NO_RULES, bounds)
    assert bare.bounds[0] == pytest.approx(0.624)  # where the limit is left out


def test_prices_are_what_the_optimum_changes_by() -> None:
    """Each constraint loosened a little and the programme solved again."""
    from scipy.optimize import linprog

    rng = np.random.default_rng(3)
    goal, slopes, rules = rng.normal(size=6), rng.normal(size=(3, 6)), rng.normal(size=(2, 6))
    room, low = np.array([0.0, 0.2, 0.0]), np.array([0.0, 9.0, 0.0, 9.0, 9.0, 9.0])

    def least(more: Array) -> float:
        found = linprog(
            goal,
            A_ub=np.vstack([slopes, rules]),
            b_ub=np.concatenate([room, [0.0, 0.0]]) + more[:5],
            bounds=np.column_stack([-np.minimum(low, 1.0) - more[5:], np.ones(6)]),
        )
        return float(found.fun)

    paid = linear_multipliers(goal, (-room, slopes), (np.zeros(2), rules), (low, np.full(6, 9.0)), 1.0)
    gains = [(least(np.zeros(11)) - least(1e-6 * unit)) / 1e-6 for unit in np.eye(11)]
    assert [*paid.limits, *paid.rules] == pytest.approx(gains[:5], abs=1e-6)
    assert np.maximum(paid.bounds, 0.0) == pytest.approx(np.where(low == 0, gains[5:], 0.0), abs=1e-6)
    assert max(gains[:5]) > 0.1


def test_what_is_violated_may_not_become_worse() -> None:
    paid = linear_multipliers(MASS, (np.array([0.02]), BALANCE), NO_RULES, (np.zeros(2), FREE), 1.0)
    assert np.isfinite(paid.limits).all()
    assert paid.remainder == pytest.approx(0.0, abs=1e-12)


def disc(at: Array) -> tuple[Array, Array]:
    """Return the excess over a disc of radius 1."""
    return np.array([at @ at - 1.0]), 2 * at[None]


def wants(bound: float) -> tuple[Array, Array]:
    """Return bound and slopes of x + y >= bound."""
    return np.array([bound]), np.array([[-1.0, -1.0]])


@pytest.mark.parametrize(
    ("wanted", "end"),
    [(1.0, (1.0, 0.0)), (1.2, (0.974166, 0.225834)), (3.0, (11 / 219.01**0.5, 9.9 / 219.01**0.5))],
)
def test_steps_end_at_the_best_that_keeps_the_limits_or_the_nearest_to_them(
    wanted: float, end: tuple[float, float]
) -> None:
    """Most x - 0.1 y in a disc with x + y >= a bound: where both meet; beyond, by the price of 10."""
    bound, slopes = wants(wanted)
    found = linear_steps(
        np.array([-1.0, 0.1]),
        lambda at: (bound + slopes @ at, slopes),
        disc,
        (np.full(2, -3.0), np.full(2, 3.0)),
        np.zeros(2),
        Penalties(10.0, 100.0),
    )
    assert found == pytest.approx(end, abs=2e-3)
    assert disc(found)[0][0] < 1e-3
