"""The processor's kernels against the JAX code that other devices run.

Against assembled matrices products are tested in test_element.py and test_galerkin.py.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics.grid.conjugate_gradients import product_and_work, stiffness_product
from cranktopo.numerics.grid.galerkin import apply_stencil
from cranktopo.numerics.grid.lattice import Lattice, layer_blocks
from cranktopo.numerics.grid.multigrid import project
from cranktopo.numerics.grid.operator import (
    add_prolonged,
    apply_stiffness,
    restrict,
    strain_energy_densities,
    strain_energy_density,
)
from cranktopo.numerics.grid.partition import WHOLE
from cranktopo.numerics.grid.smoothing import JacobiScaling, Smoother, SmootherState
from cranktopo.numerics.kernels import catalogue
from cranktopo.numerics.kernels import registry as processor
from cranktopo.numerics.precision import Precision
from tests.studies.parts import lopsided

ROUNDING = {"float32": 2e-6, "float64": 4e-15}
# Rows shorter than a vector, of whole vectors, one longer; and a grid that is shared out to threads.
GRIDS = [(1, 1, 1), (4, 3, 5), (2, 3, 16), (3, 2, 17), (5, 4, 33), (21, 30, 34)]


def _grids(*quick: int) -> list[Any]:
    """Return all grids, of which those of some places are quick."""
    return [
        grid if place in quick else pytest.param(grid, marks=pytest.mark.slow)
        for place, grid in enumerate(GRIDS)
    ]


@pytest.fixture(autouse=True)
def kernels() -> Iterator[None]:
    """Asked for here and not when tests are collected: the answer takes a product."""
    if reason := processor.why_no_kernels():
        pytest.skip(reason)
    yield
    strain_energy_densities.clear_cache()  # else what was traced here without kernels would be used elsewhere


def _with_precision(first: Iterable[Any], *quick: tuple[Any, Precision]) -> list[Any]:
    """Return every pair of a first and a precision, of which some are quick: these compile the longest."""
    pairs = itertools.product(first, ROUNDING)
    return [pair if pair in quick else pytest.param(*pair, marks=pytest.mark.slow) for pair in pairs]


def _system(cells: tuple[int, int, int], precision: Precision) -> tuple[jax.Array, jax.Array, jax.Array]:
    lattice = Lattice(cells, 1.0, 1.2, tuple(1 + 0.1 * (k % 3) for k in range(cells[2])), 0.3)
    rng = np.random.default_rng(cells[2])
    field = rng.standard_normal((2, *lattice.field_shape))
    blocks = jnp.asarray(layer_blocks(lattice), precision)
    return blocks, jnp.asarray(rng.random(cells), precision), jnp.asarray(field, precision)


def _stencil(nodes: tuple[int, int, int], precision: Precision) -> jax.Array:
    """Any numbers: where a neighbour is missing the stencil need not be 0."""
    rng = np.random.default_rng(1)
    return jnp.asarray(rng.standard_normal((*nodes[:2], 14, 3, 3, nodes[2])), precision)


def _smoother(cells: tuple[int, int, int], operator: str, precision: Precision) -> Smoother:
    """Two load cases with steps and supports of their own."""
    blocks, moduli, field = _system(cells, precision)
    _, _, *nodes = field.shape
    rng = np.random.default_rng(2)
    held = [jnp.asarray(rng.integers(0, 2, (2, 3, n)), precision) for n in (nodes[0], nodes[2])]
    steps = JacobiScaling(jnp.asarray(rng.random((3, *nodes)), precision), *held)
    if operator == "stiffness":
        return Smoother(operator, apply_stiffness, (blocks, moduli), steps, WHOLE)
    stencil = _stencil((nodes[0], nodes[1], nodes[2]), precision)
    return Smoother(operator, apply_stencil, (stencil / 27,), steps, WHOLE)


def _smoothed(smoother: Smoother, count: int) -> SmootherState:
    """Corrections before and after something else has changed the field, all traced anew."""
    rng = np.random.default_rng(3)
    residual, change = rng.standard_normal((2, 2, *smoother.scaling.sizes.shape))

    def smooth(residual: jax.Array, change: jax.Array) -> SmootherState:
        before = smoother.before(smoother.start(residual), count)
        return smoother.after(SmootherState(change, before.field + change, before.residual), count)

    precision = smoother.scaling.sizes.dtype
    fields = (jnp.asarray(field, precision) for field in (residual, change))
    return jax.jit(smooth)(*fields)


def _fresh(function: Callable[..., Any], *inputs: Any) -> Any:
    """Result of a function traced anew, after what it depends on was replaced."""
    return jax.jit(lambda *a: function(*a))(*inputs)


def _close(found: jax.Array, expected: jax.Array, precision: Precision) -> None:
    scale = float(jnp.max(jnp.abs(expected)))
    np.testing.assert_allclose(found, expected, atol=ROUNDING[precision] * scale, rtol=0)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("cells", _grids(0, 4))
def test_product_with_the_stiffness(
    cells: tuple[int, int, int], precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = _system(cells, precision)
    found = _fresh(apply_stiffness, *system)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    _close(found, _fresh(apply_stiffness, *system), precision)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("nodes", _grids(0, 4))
def test_product_with_a_stencil(
    nodes: tuple[int, int, int], precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    stencil = _stencil(nodes, precision)
    field = jnp.asarray(np.random.default_rng(2).standard_normal((2, 3, *nodes)), precision)
    found = _fresh(apply_stencil, stencil, field)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    _close(found, _fresh(apply_stencil, stencil, field), precision)


@pytest.mark.parametrize(
    ("operator", "precision"),
    _with_precision(("stiffness", "stencil"), ("stiffness", "float64"), ("stencil", "float32")),
)
@pytest.mark.parametrize("cells", _grids(4))
def test_smoothing(
    cells: tuple[int, int, int],
    operator: str,
    precision: Precision,
    float64: None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    smoother = _smoother(cells, operator, precision)
    found = _smoothed(smoother, 2)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    for one, other in zip(found, _smoothed(smoother, 2), strict=True):
        _close(one, other, precision)


@pytest.mark.parametrize(
    ("cells", "precision"), _with_precision(GRIDS, (GRIDS[1], "float32"), (GRIDS[4], "float64"))
)
def test_strain_energies(
    cells: tuple[int, int, int], precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two fields that differ, summed over cases, and of one field per case."""
    blocks, _, field = _system(cells, precision)
    other = jnp.flip(field, axis=2) + 1
    found = _fresh(strain_energy_density, blocks, other, field)
    each = _fresh(strain_energy_densities, blocks, field)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    strain_energy_densities.clear_cache()
    _close(found, _fresh(strain_energy_density, blocks, other, field), precision)
    _close(each, _fresh(strain_energy_densities, blocks, field), precision)


def test_product_and_work_of_admissible_displacements(float64: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two load cases with other mirrors, sections and springs."""
    _, system = lopsided((8, 12, 36))
    field = np.random.default_rng(4).standard_normal(system.forces.shape)
    field = project(system.supports, jnp.asarray(field))
    image, work = _fresh(product_and_work, system, field)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    expected = _fresh(stiffness_product, system, field)
    _close(image, expected, "float64")
    np.testing.assert_allclose(work, jnp.sum(field * expected, axis=(1, 2, 3, 4)), rtol=1e-13)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize(
    "coarse",
    [
        (2, 2, 2),
        pytest.param((3, 5, 9), marks=pytest.mark.slow),
        pytest.param((4, 3, 17), marks=pytest.mark.slow),
        pytest.param((2, 4, 18), marks=pytest.mark.slow),
        (11, 16, 30),
    ],
)
def test_transfers(
    coarse: tuple[int, int, int], precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(6)
    small = jnp.asarray(rng.standard_normal((2, 3, *coarse)), precision)
    large = jnp.asarray(rng.standard_normal((2, 3, *(2 * n - 1 for n in coarse))), precision)

    def transfers(small: jax.Array, large: jax.Array) -> tuple[jax.Array, ...]:
        return restrict(large, coarse), *add_prolonged(small, large)

    found = _fresh(transfers, small, large)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    for one, other in zip(found, _fresh(transfers, small, large), strict=True):
        _close(one, other, precision)


@pytest.mark.parametrize("operator", ["stiffness", pytest.param("stencil", marks=pytest.mark.slow)])
def test_threads_do_not_change_a_digit(operator: str, float64: None, monkeypatch: pytest.MonkeyPatch) -> None:
    smoother = _smoother(GRIDS[-1], operator, "float64")
    results = []
    for threads in (1, 5):
        monkeypatch.setattr(catalogue, "usable_cores", lambda count=threads: count)
        product = _fresh(smoother.apply, *smoother.arrays, smoother.start(smoother.scaling.sizes).field)
        results.append([np.asarray(field) for field in (product, *_smoothed(smoother, 3))])
    for other in results[1:]:
        assert all(np.array_equal(one, two) for one, two in zip(results[0], other, strict=True))


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_processors_with_shorter_registers(
    precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = _system((5, 4, 33), precision)
    wide = _fresh(apply_stiffness, *system)
    monkeypatch.setattr(processor, "vector_width", lambda _: 4)
    _close(_fresh(apply_stiffness, *system), wide, precision)
