"""Largest eigenvalues of Jacobi-scaled stencils."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import jax.numpy as jnp

from cranktopo.numerics.grid.galerkin import apply_stencil
from cranktopo.numerics.grid.partition import Partition

_STEPS = 12
_State = tuple[jax.Array, jax.Array, jax.Array]
"""The vector before, the present one, and what couples them."""


def largest_eigenvalues(
    stencils: Sequence[jax.Array], roots: Sequence[jax.Array], partitions: Sequence[Partition]
) -> Sequence[jax.Array]:
    """Estimate of each from Lanczos steps: the Ritz value plus its residual.

    A power iteration fell below it on grids above a million cells, where the mode that has it is small beside
    the grid: the cycle was then not positive definite.

    Source: Y. Zhou, R.-C. Li, Bounding the spectrum of large Hermitian matrices, Linear Algebra Appl. 435,
    2011, bound (11).

    Args:
        roots: root of the inverse diagonal, 0 in void.
        partitions: of the grids, one for each stencil or more.
    """
    found = [_steps(*one) for one in zip(stencils, roots, partitions, strict=False)]
    if not found:
        return ()
    diagonals, sides = (jnp.stack(values).astype(jnp.float64) for values in zip(*found, strict=True))
    return tuple(jax.lax.map(_bound, (diagonals, sides)))  # one program for all


def _steps(stencil: jax.Array, root: jax.Array, partition: Partition) -> tuple[jax.Array, jax.Array]:
    """Return tridiagonal matrix of Lanczos steps: its diagonal, and what couples each step to the next."""
    waves = jnp.sin(partition.node_numbers(root.shape).astype(stencil.dtype) * 12.9898)[None]
    waves = waves * (root > 0)

    def dot(a: jax.Array, b: jax.Array) -> jax.Array:
        return partition.dot(a, b)[0]

    def step(state: _State, _: None) -> tuple[_State, tuple[jax.Array, jax.Array]]:
        before, vector, length = state
        product = partition.add_interfaces(apply_stencil(stencil, root * vector))
        image = root * product - length * before
        diagonal = dot(image, vector)
        image = image - diagonal * vector
        following = jnp.sqrt(dot(image, image))
        return (vector, _scaled(image, following), following), (diagonal, following)

    first = _scaled(waves, jnp.sqrt(dot(waves, waves)))
    start = jnp.zeros_like(first), first, jnp.zeros((), stencil.dtype)
    return jax.lax.scan(step, start, length=_STEPS)[1]


def _bound(matrix: tuple[jax.Array, jax.Array]) -> jax.Array:
    """Return the largest eigenvalue of a tridiagonal matrix and what the next step would couple to it."""
    diagonal, sides = matrix
    inner = jnp.diag(sides[:-1], 1)
    values, vectors = jnp.linalg.eigh(jnp.diag(diagonal) + inner + inner.T)
    return values[-1] + sides[-1] * jnp.abs(vectors[-1, -1])


def _scaled(field: jax.Array, length: jax.Array) -> jax.Array:
    return field / jnp.where(length > 0, length, 1)
