"""The processor's kernels against the JAX code that other devices run.

Against assembled matrices products are tested in test_element.py and test_galerkin.py.
"""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.fem import galerkin
from cranktopo.fem.galerkin import apply_stencil
from cranktopo.fem.kernels import processor
from cranktopo.fem.lattice import Lattice, layer_blocks
from cranktopo.fem.operator import apply_stiffness
from cranktopo.fem.precision import Precision

ROUNDING = {"float32": 2e-6, "float64": 4e-15}
# Rows shorter than a vector, of whole vectors, one longer; and a grid that is shared out to threads.
GRIDS = [(1, 1, 1), (4, 3, 5), (2, 3, 16), (3, 2, 17), (5, 4, 33), (21, 30, 34)]

pytestmark = pytest.mark.skipif(not processor.kernels_usable(), reason="no kernels on this system")


def _system(cells: tuple[int, int, int], precision: Precision) -> tuple[jax.Array, jax.Array, jax.Array]:
    lattice = Lattice(cells, 1.0, 1.2, tuple(1 + 0.1 * (k % 3) for k in range(cells[2])), 0.3)
    rng = np.random.default_rng(cells[2])
    field = rng.standard_normal((2, *lattice.field_shape))
    blocks = jnp.asarray(layer_blocks(lattice), precision)
    return blocks, jnp.asarray(rng.random(cells), precision), jnp.asarray(field, precision)


def _fresh(function: Callable[..., jax.Array], *inputs: jax.Array) -> jax.Array:
    """Result of a function traced anew, after what it depends on was replaced."""
    return jax.jit(lambda *a: function(*a))(*inputs)


def _close(found: jax.Array, expected: jax.Array, precision: Precision) -> None:
    scale = float(jnp.max(jnp.abs(expected)))
    np.testing.assert_allclose(found, expected, atol=ROUNDING[precision] * scale, rtol=0)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("cells", GRIDS)
def test_product_with_the_stiffness(
    cells: tuple[int, int, int], precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = _system(cells, precision)
    found = _fresh(apply_stiffness, *system)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    _close(found, _fresh(apply_stiffness, *system), precision)


@pytest.mark.parametrize("precision", ["float32", "float64"])
@pytest.mark.parametrize("nodes", GRIDS)
def test_product_with_a_stencil(
    nodes: tuple[int, int, int], precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Any numbers: where a neighbour is missing the stencil need not be 0.
    rng = np.random.default_rng(1)
    stencil = jnp.asarray(
        rng.standard_normal((galerkin.LEAD + nodes[0], nodes[1], 14, 3, 3, nodes[2])), precision
    )
    field = jnp.asarray(rng.standard_normal((2, 3, *nodes)), precision)
    found = _fresh(apply_stencil, stencil, field)
    monkeypatch.setattr(processor, "kernels_usable", lambda: False)
    _close(found, _fresh(apply_stencil, stencil, field), precision)


def test_threads_do_not_change_a_digit(float64: None, monkeypatch: pytest.MonkeyPatch) -> None:
    system = _system(GRIDS[-1], "float64")
    results = []
    for threads in (1, 2, 5):
        monkeypatch.setattr(processor, "usable_cores", lambda count=threads: count)
        results.append(np.asarray(_fresh(apply_stiffness, *system)))
    assert all(np.array_equal(results[0], other) for other in results[1:])


@pytest.mark.parametrize("precision", ["float32", "float64"])
def test_processors_with_shorter_registers(
    precision: Precision, float64: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = _system((5, 4, 33), precision)
    wide = _fresh(apply_stiffness, *system)
    monkeypatch.setattr(processor, "_width", lambda _: 4)
    _close(_fresh(apply_stiffness, *system), wide, precision)
