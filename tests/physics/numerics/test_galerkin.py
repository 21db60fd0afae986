"""Coarse operators against P^T K P: interpolation and the fine product are the independent halves."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics.grid.galerkin import (
    apply_stencil,
    assemble_dense,
    assemble_stencil,
    coarse_cells,
    coarse_map,
    stencil_diagonal,
)
from cranktopo.numerics.grid.lattice import Lattice, layer_blocks
from cranktopo.numerics.grid.operator import apply_stiffness, prolong, restrict
from cranktopo.numerics.precision import double_precision

LATTICE = Lattice((4, 6, 8), 1.0, 1.3, (0.7, 0.7, 1.0, 1.0, 1.0, 1.4, 1.4, 0.9), 0.3)
COARSE_NODES = (3, 4, 5)
# Compiled as one program, as in the solver: operation by operation takes much longer.
PRODUCT = jax.jit(apply_stencil)


def stencil_of(coarse, moduli):
    """Assembled in float64."""
    return jax.jit(lambda c, m: assemble_stencil(c, m, "float64"))(coarse, moduli)


@pytest.fixture
def problem():
    rng = np.random.default_rng(5)
    with double_precision():
        moduli = jnp.asarray(rng.random(LATTICE.cells) ** 3)
        coarse = coarse_map(LATTICE, (2, 2, 2))
        yield moduli, coarse, jnp.asarray(rng.standard_normal((2, 3, *COARSE_NODES)))


def test_stencil_product_is_restricted_fine_product(problem):
    moduli, coarse, field = problem

    @jax.jit
    def coarse_product(moduli, field):
        fine = apply_stiffness(jnp.asarray(layer_blocks(LATTICE)), moduli, prolong(field, LATTICE.nodes))
        return restrict(fine, COARSE_NODES)

    expected = coarse_product(moduli, field)
    np.testing.assert_allclose(PRODUCT(stencil_of(coarse, moduli), field), expected, atol=1e-12)


def test_stencil_and_dense_matrix_agree(problem):
    moduli, coarse, field = problem
    dense, stencil = assemble_dense(coarse_cells(coarse, moduli)), stencil_of(coarse, moduli)
    expected = (field.reshape(2, -1) @ dense.T).reshape(field.shape)
    np.testing.assert_allclose(PRODUCT(stencil, field), expected, atol=1e-12)
    np.testing.assert_allclose(stencil_diagonal(stencil).ravel(), jnp.diagonal(dense), rtol=1e-12)
