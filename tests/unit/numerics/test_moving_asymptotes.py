"""Moving asymptotes on problems whose optimum is known."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics.optimisers.mma import first_asymptotes, mma_step

pytestmark = pytest.mark.usefixtures("float64")
Function = Callable[[jax.Array], jax.Array]


def minimise(
    goal: Function,
    limits: Function,
    start: list[float],
    bounds: tuple[float, float],
    epigraph: list[float] | None = None,
    steps: int = 40,
) -> tuple[np.ndarray, np.ndarray]:
    """The design after so many steps, and the multipliers of the last one."""
    x = jnp.asarray(start)
    box = jnp.full_like(x, bounds[0]), jnp.full_like(x, bounds[1])
    memory, multipliers = first_asymptotes(x), jnp.zeros(0)
    for _ in range(steps):
        values, slopes = limits(x), jax.jacrev(limits)(x)
        flags = jnp.asarray(epigraph) if epigraph else jnp.zeros_like(values)
        taken = mma_step(x, jax.grad(goal)(x), values, slopes, memory, jnp.asarray(1e3), box, flags)
        x, memory, multipliers = taken.x, taken.asymptotes, taken.multipliers
    return np.asarray(x), np.asarray(multipliers)


def test_cantilever_of_five_boxes() -> None:
    """K. Svanberg, 1987, section 6: weight 1.340 at 6.016, 5.309, 4.494, 3.502, 2.153."""
    shares = jnp.asarray([61.0, 37.0, 19.0, 7.0, 1.0])

    def weight(x: jax.Array) -> jax.Array:
        return 0.0624 * jnp.sum(x)

    x, multipliers = minimise(
        weight, lambda x: jnp.stack([jnp.sum(shares / x**3) - 1]), [5.0] * 5, (1.0, 10.0)
    )
    np.testing.assert_allclose(x, [6.016, 5.309, 4.494, 3.502, 2.153], atol=6e-4)
    assert float(weight(jnp.asarray(x))) == pytest.approx(1.340, abs=5e-4)
    # Stationary: all slopes of the Lagrangian vanish at the multiplier found.
    np.testing.assert_allclose(0.0624 - 3 * multipliers[0] * np.asarray(shares) / x**4, 0.0, atol=1e-6)


@pytest.mark.slow
def test_two_bars() -> None:
    """K. Svanberg, 1987, section 5: weight 1.51 at 1.41 and 0.38; one stress limit is active, one is not."""

    def stresses(x: jax.Array) -> jax.Array:
        size = 0.124 * jnp.sqrt(1 + x[1] ** 2)
        one, two = 8 / x[0], 1 / (x[0] * x[1])
        return jnp.stack([size * (one + two) - 1, size * (one - two) - 1])

    x, multipliers = minimise(lambda x: x[0] * jnp.sqrt(1 + x[1] ** 2), stresses, [1.5, 0.5], (0.1, 4.0))
    np.testing.assert_allclose(x, [1.41, 0.38], atol=5e-3)
    assert multipliers[0] > 1.0
    assert multipliers[1] < 1e-6


@pytest.mark.slow
def test_smallest_circle_about_three_points() -> None:
    """The largest of three functions is minimised: the centre is as far from each corner."""
    corners = jnp.asarray([[1.0, 0.0], [-1.0, 0.0], [0.0, 2.0]])
    x, multipliers = minimise(
        lambda x: 0.0 * x[0],
        lambda x: jnp.sum((x - corners) ** 2, axis=1),
        [0.5, 0.3],
        (-3.0, 3.0),
        [1.0] * 3,
    )
    np.testing.assert_allclose(x, [0.0, 0.75], atol=1e-6)
    assert (multipliers > 0.1).all()


def test_a_limit_that_cannot_hold_is_broken_as_little_as_possible() -> None:
    x, _ = minimise(jnp.sum, lambda x: jnp.stack([2.0 - jnp.sum(x)]), [0.2, 0.4, 0.1], (0.0, 0.5))
    np.testing.assert_allclose(x, 0.5, atol=1e-6)


@pytest.mark.slow
def test_many_variables_many_limits() -> None:
    """A linear programme with a known vertex: of every three variables the cheapest carries the load."""
    price = jnp.asarray([1.0, 2.0, 3.0] * 4)
    rows = np.kron(np.eye(4), np.ones((1, 3)))

    x, _ = minimise(lambda x: price @ x, lambda x: 0.7 - jnp.asarray(rows) @ x, [0.5] * 12, (0.0, 1.0))
    np.testing.assert_allclose(x, [0.7, 0.0, 0.0] * 4, atol=1e-4)
