"""A response for the stress of a density: the p-norm of the von Mises stresses of the web's cells.

Source: C. Le, J. Norato, T. Bruns, C. Ha, D. Tortorelli, Stress-based topology optimization for continua, SMO
41, 2010: stresses of the solid times the square root of the density, so that void has none, in a p-norm. It
steers a density away from peaks; the stress of stepped cells is no result.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp

from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.responses import Design, Response

# The modulus is the cube of the density.
_ROOT_OF_DENSITY = 1 / 6
_LEAST = 1e-12


def stress_norm(model: ThrowModel, layers: tuple[int, int], power: float = 8.0) -> Response:
    """Return power mean of the von Mises stress in the middle of the web's cells over all load cases, MPa.

    Args:
        layers: first and past-the-last z layer of the web.
        power: the higher, the closer to the largest stress.
    """
    first, last = layers

    def value(design: Design) -> jax.Array:
        moduli = design.moduli[:, :, first:last]
        strain = middle_strain(model.lattice, design.displacements, layers)
        stress = von_mises_MPa(strain, model.modulus_MPa, model.lattice.poisson)
        relaxed = stress * jnp.maximum(moduli, _LEAST) ** _ROOT_OF_DENSITY
        filled = (moduli > 0).astype(relaxed.dtype)
        # The largest is taken out, so that no power overflows.
        largest = jax.lax.stop_gradient(jnp.max(relaxed))
        mean = jnp.sum(filled * (relaxed / largest) ** power) / jnp.sum(filled) / len(relaxed)
        return largest * mean ** (1 / power)

    return Response("stress", "MPa", value, reads_displacements=True)


def middle_strain(lattice: Lattice, u: jax.Array, layers: tuple[int, int]) -> jax.Array:
    """Return the strain (cases, 3, 3, nx, ny, n) in the middle of the cells of some layers.

    Args:
        u: displacements (cases, 3, nodes...), mm.
    """
    first, last = layers
    part = u[..., first : last + 1]
    steps = [jnp.asarray(step) for step in (lattice.dx_mm, lattice.dy_mm, lattice.dz_mm[first:last])]
    derivatives = []
    for axis, step in enumerate(steps):
        derivative = jnp.diff(part, axis=2 + axis) / step
        for other in {0, 1, 2} - {axis}:
            size = derivative.shape[2 + other]
            near = jax.lax.slice_in_dim(derivative, 0, size - 1, axis=2 + other)
            derivative = (near + jax.lax.slice_in_dim(derivative, 1, size, axis=2 + other)) / 2
        derivatives.append(derivative)
    gradient = jnp.stack(derivatives, axis=2)
    return (gradient + jnp.swapaxes(gradient, 1, 2)) / 2


def von_mises_MPa(strain: jax.Array, modulus_MPa: float, poisson: float) -> jax.Array:
    """Return the von Mises stress (cases, ...) of an isotropic solid, from strain (cases, 3, 3, ...).

    The mean stress drops out, so that the shear modulus is all that counts.
    """
    shear_MPa = modulus_MPa / (1 + poisson) / 2
    mean = jnp.trace(strain, axis1=1, axis2=2) / 3
    identity = jnp.eye(3).reshape(1, 3, 3, *(1,) * (strain.ndim - 3))
    deviator = strain - mean[:, None, None] * identity
    return 2 * shear_MPa * jnp.sqrt(1.5 * jnp.sum(deviator**2, axis=(1, 2)) + _LEAST**2)
