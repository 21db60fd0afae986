"""Filter, projection, optimality criteria and state: properties that hold for any design."""

from __future__ import annotations

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.ndimage

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import cone_kernel, convolved, projected
from cranktopo.numerics.precision import double_precision
from cranktopo.runs.checkpoint import load_checkpoint, save_checkpoint
from cranktopo.tasks.density.material import (
    CONTRAST,
    MaterialInterpolation,
    build_interpolation,
    greyness,
    physical_density,
    relative_moduli,
    volume_fraction,
)
from cranktopo.tasks.density.proposals import falling_root, update
from cranktopo.tasks.density.state import Record, State, from_checkpoint, to_checkpoint


@pytest.fixture
def density_chain(float64: None, mikron: Scene) -> MaterialInterpolation:
    return build_interpolation(build_domain(mikron, 4.0), 8.0)


def random_design(density_chain: MaterialInterpolation, seed: int = 0) -> jnp.ndarray:
    return jnp.asarray(np.random.default_rng(seed).random(density_chain.design_fraction.shape))


def test_cone_weights() -> None:
    kernel = cone_kernel((1.0, 2.0, 1.0), 2.5)
    assert kernel.shape == (5, 3, 5)
    assert kernel[2, 1, 2] == 2.5
    assert kernel[3, 1, 2] == 1.5
    assert kernel[2, 2, 2] == 0.5
    assert kernel[0, 0, 0] == 0.0


@pytest.mark.parametrize("mirrored", [False, True])
def test_sums_over_neighbours(float64: None, mirrored: bool) -> None:
    """Against a direct sum, cell by cell, on a grid that is narrower than the kernel along one axis."""
    values = np.random.default_rng(5).random((9, 12, 4))
    kernel = cone_kernel((1.0, 1.2, 0.8), 3.5)
    found = convolved(jnp.asarray(values), jnp.asarray(kernel), mirrored)
    whole = np.concatenate([values[::-1], values]) if mirrored else values
    expected = scipy.ndimage.correlate(whole, kernel, mode="constant")[-len(values) :]
    np.testing.assert_allclose(found, expected, atol=1e-12 * kernel.sum())


@pytest.mark.parametrize("mirrored", [False, True])
def test_derivative_of_sums_over_neighbours(float64: None, mirrored: bool) -> None:
    """The work of a change of values with what sums are worth, from either end."""
    change, worth = np.random.default_rng(6).random((2, 9, 12, 4))
    kernel = jnp.asarray(cone_kernel((1.0, 1.2, 0.8), 3.5))
    sums, back = jax.vjp(lambda values: convolved(values, kernel, mirrored), jnp.asarray(change))
    (by_values,) = back(jnp.asarray(worth))
    assert np.vdot(by_values, change) == pytest.approx(np.vdot(worth, sums), rel=1e-12)


def test_filter_keeps_constants_and_bounds(density_chain: MaterialInterpolation) -> None:
    inside = np.asarray(density_chain.design_fraction) > 0
    constant = density_chain.density_filter(jnp.full(density_chain.design_fraction.shape, 0.37))
    np.testing.assert_allclose(np.asarray(constant)[inside], 0.37, rtol=1e-12)
    smooth = np.asarray(density_chain.density_filter(random_design(density_chain)))[inside]
    assert smooth.min() >= 0.0
    assert smooth.max() <= 1.0
    assert smooth.std() < 0.5 * np.asarray(random_design(density_chain))[inside].std()


def test_filter_of_the_quarter_is_that_of_the_half(float64: None, mikron: Scene) -> None:
    """Reflection at x = 0, on a field that is not symmetric in y or z."""
    quarter = build_interpolation(build_domain(mikron, 4.0), 8.0)
    half = build_interpolation(build_domain(mikron, 4.0, extent="half"), 8.0)
    x = np.asarray(random_design(quarter))
    mirrored = np.zeros(half.design_fraction.shape)
    n = x.shape[0]
    mirrored[:n], mirrored[n : 2 * n] = x[::-1], x
    result = np.asarray(half.density_filter(jnp.asarray(mirrored)))[n : 2 * n]
    inside = np.asarray(quarter.design_fraction) > 0
    np.testing.assert_allclose(
        result[inside], np.asarray(quarter.density_filter(jnp.asarray(x)))[inside], rtol=1e-12
    )


def test_projection_is_a_step_in_the_limit(float64: None) -> None:
    density = jnp.asarray([0.0, 0.2, 0.49, 0.5, 0.51, 1.0])
    np.testing.assert_allclose(projected(density, 1e-6), density, atol=1e-9)
    np.testing.assert_allclose(projected(density, 1e4), [0, 0, 0, 0.5, 1, 1], atol=1e-9)


def test_projected_void_has_powers_and_slopes(float64: None) -> None:
    """Rounding would leave it at -1e-17, whose power 1.5 is no number; its own slope is kept."""

    def powers(density: jax.Array, beta: float) -> jax.Array:
        return jnp.sum(projected(density, beta) ** 1.5)

    density = jnp.linspace(0, 1e-15, 64)
    for beta in (1.0, 4.0, 8.0, 16.0):
        value, slopes = jax.jit(jax.value_and_grad(powers))(density, beta)
        assert float(jax.jit(projected)(density, beta).min()) >= 0
        assert np.isfinite(value)
        assert np.isfinite(slopes).all()
        steep = jax.jit(jax.grad(lambda x, b: jnp.sum(projected(x, b))))(density, beta)
        expected = beta / np.cosh(beta / 2) ** 2 / (2 * np.tanh(beta / 2))
        np.testing.assert_allclose(steep, expected, rtol=1e-6)


def test_moduli_of_full_and_empty_designs(density_chain: MaterialInterpolation) -> None:
    first, last = density_chain.web_layers
    full = relative_moduli(density_chain, jnp.ones(density_chain.design_fraction.shape))
    empty = relative_moduli(density_chain, jnp.zeros(density_chain.design_fraction.shape))
    np.testing.assert_allclose(full[:, :, first:last], density_chain.design_fraction, rtol=1e-12)
    np.testing.assert_allclose(empty[:, :, first:last], CONTRAST * density_chain.design_fraction, rtol=1e-12)
    assert float(
        volume_fraction(density_chain, jnp.ones(density_chain.design_fraction.shape))
    ) == pytest.approx(1.0)
    assert float(
        greyness(density_chain, jnp.full(density_chain.design_fraction.shape, 0.5))
    ) == pytest.approx(1.0)


@pytest.mark.parametrize("beta", [1.0, 16.0])
def test_update_meets_the_volume_and_moves_towards_stiffness(
    density_chain: MaterialInterpolation, beta: float
) -> None:
    x = jnp.full(density_chain.design_fraction.shape, 0.4)
    by_moduli = -jnp.asarray(np.random.default_rng(3).random(density_chain.passive_fraction.shape))
    target, move = jnp.asarray(0.4), jnp.asarray(0.2)
    new = update(density_chain, x, jnp.asarray(beta), by_moduli, target, move)
    volume = volume_fraction(density_chain, physical_density(density_chain, new, beta))
    assert float(volume) == pytest.approx(0.4, abs=1e-6)
    assert float(jnp.abs(new - x).max()) <= 0.2 + 1e-12
    change = relative_moduli(density_chain, physical_density(density_chain, new, beta)) - relative_moduli(
        density_chain, physical_density(density_chain, x, beta)
    )
    assert float(jnp.sum(by_moduli * change)) < 0.0


def test_state_survives_a_checkpoint_bit_for_bit(tmp_path_factory: pytest.TempPathFactory) -> None:
    rng = np.random.default_rng(5)
    record = Record(
        1, 1.0, 1.0 / 3.0, (0.1, 2e-17), 0.3, 0.9, 0.2, 12, 0.123456789, "a slower method took over"
    )
    state = State(
        x=rng.random((3, 4, 5)),
        evaluated=rng.random((3, 4, 5)),
        displacements=rng.standard_normal((2, 3, 4, 5, 6)) * 1e-9,
        beta=4.0,
        stage_start=7,
        initial_N_mm=(1.0 / 7.0, 3.0),
        history=(record, replace(record, iteration=2, objective=0.1 + 0.2)),
    )
    path = tmp_path_factory.mktemp("checkpoint") / "checkpoint" / "state.npz"
    save_checkpoint(path, *to_checkpoint(state))
    saved = load_checkpoint(path)
    back = from_checkpoint(saved.arrays, saved.state)
    for name in ("x", "evaluated", "displacements"):
        assert getattr(back, name).tobytes() == getattr(state, name).tobytes()

    assert back.history == state.history
    assert (back.beta, back.stage_start, back.initial_N_mm) == (4.0, 7, (1.0 / 7.0, 3.0))


@pytest.mark.parametrize("root", [-3.7, 0.0, 2.0])
@pytest.mark.parametrize("first", [-39.9, -0.3, 9.9])
def test_root_of_a_falling_function_with_a_kink(root: float, first: float) -> None:
    with double_precision():

        def kinked(v: jax.Array) -> jax.Array:
            return jnp.where(v < root, 5.0 * (root - v), jnp.tanh(root - v))

        found = falling_root(kinked, jnp.asarray(-40.0), jnp.asarray(10.0), jnp.asarray(first))
    assert float(found) == pytest.approx(root, abs=1e-9)


def test_root_takes_few_evaluations() -> None:
    """Each is a density filter. Bisection would take 39."""
    seen = []

    def flattening(v: jax.Array) -> jax.Array:
        jax.debug.callback(lambda v: seen.append(float(v)), v)
        return 1 / (1 + jnp.exp(v)) - 0.3

    with double_precision():
        found = falling_root(flattening, jnp.asarray(-40.0), jnp.asarray(10.0), jnp.asarray(0.5))
        jax.effects_barrier()
    assert float(found) == pytest.approx(np.log(0.7 / 0.3), abs=1e-9)
    assert len(seen) <= 8


def test_without_a_root_the_nearer_end_is_taken() -> None:
    with double_precision():
        ends = jnp.asarray(-1.0), jnp.asarray(1.0), jnp.asarray(0.1)
        assert float(falling_root(lambda v: 3.0 - v, *ends)) == 1.0
        assert float(falling_root(lambda v: -3.0 - v, *ends)) == -1.0


def test_uniform_designs_stay_exactly_uniform(density_chain: MaterialInterpolation) -> None:
    """Ties are exact, whatever the order of the sums."""
    inside = np.asarray(density_chain.design_fraction) > 0
    filtered = np.asarray(density_chain.density_filter(jnp.full(density_chain.design_fraction.shape, 0.3)))[
        inside
    ]
    assert np.unique(filtered).tolist() == [0.3]
