"""Largest eigenvalue of Jacobi-scaled coarse operators against ARPACK, which iterates to convergence."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator, eigsh

from cranktopo.numerics.grid.galerkin import apply_stencil, assemble_stencil, coarse_map, stencil_diagonal
from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.numerics.grid.partition import WHOLE
from cranktopo.numerics.grid.smoothing import largest_eigenvalues
from cranktopo.numerics.precision import double_precision

LATTICE = Lattice((64, 48, 48), 1.0, 1.0, (1.0,) * 48, 0.3)


def fields() -> dict[str, np.ndarray]:
    """Relative moduli: alike, random cells everywhere, and few of them in a corner of much that is alike."""
    random = np.random.default_rng(3).random(LATTICE.cells)
    corner = np.ones(LATTICE.cells)
    corner[:8, :8, :8] = np.where(random[:8, :8, :8] < 0.3, 1.0, 1e-6)
    return {"uniform": np.ones(LATTICE.cells), "random": random**6, "corner": corner}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name == "uniform")) for name in fields()]
)
def test_bound_is_above_and_near(name: str) -> None:
    """Below it the multigrid cycle is not positive definite; far above it smooths less."""
    with double_precision():
        stencil = jax.jit(lambda c, m: assemble_stencil(c, m, "float32"))(
            coarse_map(LATTICE, (2, 2, 2)), jnp.asarray(fields()[name], jnp.float32)
        )
        root, product = 1 / np.sqrt(np.asarray(stencil_diagonal(stencil), float)), jax.jit(apply_stencil)
        estimate = jax.jit(lambda s, r: largest_eigenvalues([s], [r], [WHOLE])[0])
        bound = float(estimate(stencil, jnp.asarray(root, jnp.float32)))

        def scaled(vector: np.ndarray) -> np.ndarray:
            image = product(stencil, jnp.asarray(root * vector.reshape(root.shape), jnp.float32)[None])[0]
            return (root * np.asarray(image, float)).ravel()

        operator = LinearOperator((root.size, root.size), matvec=scaled)
        start = np.random.default_rng(0).standard_normal(root.size)
        (largest,) = eigsh(operator, 1, which="LA", tol=1e-4, v0=start, return_eigenvectors=False)
    assert 1.0 <= bound / largest < 1.1
