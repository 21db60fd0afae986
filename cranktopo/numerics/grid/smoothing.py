"""Fourth-kind Chebyshev-Jacobi smoothing, a step at a time: by a kernel on the processor, elsewhere by JAX.

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
from cranktopo.numerics.grid.partition import Partition
from cranktopo.numerics.kernels.registry import by_kernel, coupled


class SmootherState(NamedTuple):
    """Fields (cases, 3, nodes...) between two steps.

    Attributes:
        correction: part of `field` whose forces `residual` does not know of yet.
    """

    correction: jax.Array
    field: jax.Array
    residual: jax.Array


class JacobiScaling(NamedTuple):
    """Jacobi scaling of a level, and where components move on their own.

    Attributes:
        sizes: inverse diagonal over the largest eigenvalue of the Jacobi-scaled operator (3, nodes...).
        along_x, along_z: (cases, 3, nodes) 0 where a component is held, else 1.
    """

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
        return by_kernel(self._by_kernel, self._by_product, self.arrays, state, self.scaling, weights)

    def _by_kernel(
        self, arrays: Sequence[jax.Array], state: SmootherState, scaling: JacobiScaling, weights: jax.Array
    ) -> SmootherState:
        return SmootherState(*coupled(self.name, "smoothing", [*arrays, *state, *scaling, weights]))

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
    """Return the weights of the last correction and of a Jacobi step in correction `number` + 1."""
    return jnp.stack([jnp.maximum(2 * number - 1, 0), 8 * number + 4]) / (2 * number + 3)
