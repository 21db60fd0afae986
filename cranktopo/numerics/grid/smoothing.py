"""Fourth-kind Chebyshev-Jacobi smoothing, a step at a time, and the largest eigenvalues that it needs.

Source: J. Lottes, Optimal polynomial smoothers for multigrid V-cycles, Numer. Linear Algebra Appl. 30, 2023,
algorithm 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp

from cranktopo.numerics.grid.boundary_conditions import BoundaryConditions, interior_factors
from cranktopo.numerics.grid.galerkin import apply_stencil
from cranktopo.numerics.grid.partition import Partition
from cranktopo.numerics.kernels.registry import apply_operator, kernel_or_jax

_STEPS = 12
_State = tuple[jax.Array, jax.Array, jax.Array]
"""The vector before, the present one, and what couples them."""


def largest_eigenvalues(
    stencils: Sequence[jax.Array], roots: Sequence[jax.Array], partitions: Sequence[Partition]
) -> Sequence[jax.Array]:
    """Estimate the largest eigenvalues of Jacobi-scaled stencils: Ritz values of Lanczos steps + residuals.

    A power iteration fell below it on grids above a million cells, where the mode that has it is small beside
    the grid: the cycle was then not positive definite. `roots` are those of inverse diagonals, 0 in void.
    Source: Y. Zhou, R.-C. Li, Bounding the spectrum of large Hermitian matrices, Linear Algebra Appl. 435,
    2011, bound (11).
    """
    found = [_steps(*one) for one in zip(stencils, roots, partitions, strict=False)]
    if not found:
        return ()
    diagonals, sides = (jnp.stack(values).astype(jnp.float64) for values in zip(*found, strict=True))
    return tuple(jax.lax.map(_bound, (diagonals, sides)))  # one program for all


def _steps(stencil: jax.Array, root: jax.Array, partition: Partition) -> tuple[jax.Array, jax.Array]:
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


class SmootherState(NamedTuple):
    """Fields (cases, 3, nodes...) between two steps; the residual lacks the correction's forces."""

    correction: jax.Array
    field: jax.Array
    residual: jax.Array


class JacobiScaling(NamedTuple):
    """Inverse diagonal over largest eigenvalue (3, nodes...), factors (cases, 3, nodes) 0 where held."""

    sizes: jax.Array
    along_x: jax.Array
    along_z: jax.Array

    def __call__(self, residual: jax.Array) -> jax.Array:
        """Return the correction by one Jacobi step."""
        masks = self.along_x[:, :, :, None, None] * self.along_z[:, :, None, None, :]
        return masks * self.sizes * residual


@dataclass(frozen=True)
class Smoother:
    """The operator of a level, and how it is smoothed with it.

    Attributes:
        name: of the operator among the kernels.
        apply: product of `arrays` with a field, not yet complete on the interfaces of a partition.
    """

    name: str
    apply: Callable[..., jax.Array]
    arrays: Sequence[jax.Array]
    scaling: JacobiScaling
    partition: Partition

    def start(self, residual: jax.Array) -> SmootherState:
        """Begin from a field of zeros."""
        first = 4 / 3 * self.scaling(residual)
        return SmootherState(first, first, residual)

    def before(self, state: SmootherState, count: int | jax.Array) -> SmootherState:
        """Apply so many corrections in all, the first one in the state; the last residual knows of them."""
        return self._sweeps(state, count, 1, count)

    def after(self, state: SmootherState, count: int | jax.Array) -> SmootherState:
        """Apply so many corrections more."""
        return self._sweeps(state, count, 0, count + 1)

    def _sweeps(
        self, state: SmootherState, count: int | jax.Array, first: int, end: int | jax.Array
    ) -> SmootherState:
        """Apply so many products, from a number of the recursion on; from `end` on only residuals change."""

        def sweep(index: jax.Array, state: SmootherState) -> SmootherState:
            number = index + first
            return self._step(state, jnp.where(number < end, _weights(number), 0.0))

        return jax.lax.fori_loop(0, count, sweep, state)

    def _step(self, state: SmootherState, weights: jax.Array) -> SmootherState:
        weights = weights.astype(state.field.dtype)
        if self.partition.parts > 1:
            return self._by_product(self.arrays, state, self.scaling, weights)
        return kernel_or_jax(self._by_kernel, self._by_product, self.arrays, state, self.scaling, weights)

    def _by_kernel(
        self, arrays: Sequence[jax.Array], state: SmootherState, scaling: JacobiScaling, weights: jax.Array
    ) -> SmootherState:
        return SmootherState(*apply_operator(self.name, "smoothing", [*arrays, *state, *scaling, weights]))

    def _by_product(
        self, arrays: Sequence[jax.Array], state: SmootherState, scaling: JacobiScaling, weights: jax.Array
    ) -> SmootherState:
        keep, fresh = weights
        forces = self.partition.add_interfaces(self.apply(*arrays, state.correction))
        residual = state.residual - forces
        correction = keep * state.correction + fresh * scaling(residual)
        return SmootherState(correction, state.field + correction, residual)


def jacobi_scaling(sizes: jax.Array, supports: BoundaryConditions) -> JacobiScaling:
    """Return the Jacobi scaling of a level under the supports of every case."""
    _, nx, ny, nz = sizes.shape
    along_x, along_z = interior_factors(supports, (nx, ny, nz))
    return JacobiScaling(sizes, along_x.astype(sizes.dtype), along_z.astype(sizes.dtype))


def _weights(number: jax.Array) -> jax.Array:
    return jnp.stack([jnp.maximum(2 * number - 1, 0), 8 * number + 4]) / (2 * number + 3)
