"""Density filter: each cell takes the mean of the design variables around it, nearer ones counting more."""

from __future__ import annotations

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ConeFilter:
    """Weighted mean over the designable neighbours; what is outside the design space does not count.

    Attributes:
        design: designable fraction of the cells of the web's layers (nx, ny, nw).
        kernel: cone weights, odd sizes per axis.
        mirrored_x: whether the filter reflects at the first x plane.

    Source: T. E. Bruns, D. A. Tortorelli, CMAME 190, 2001; B. Bourdin, IJNME 50, 2001.
    """

    design: jax.Array
    kernel: jax.Array
    mirrored_x: bool

    def __call__(self, x: jax.Array) -> jax.Array:
        """Filtered densities (nx, ny, nw) of design variables."""
        weight = convolved(self.design, self.kernel, self.mirrored_x)
        values = convolved(x * self.design, self.kernel, self.mirrored_x)
        return values / jnp.where(weight > 0, weight, 1.0)


def cone_kernel(steps_mm: tuple[float, float, float], radius_mm: float) -> Array:
    """Cone-shaped filter weights max(0, radius - distance) on a grid."""
    axes = []
    for step in steps_mm:
        reach = max(0, int(np.ceil(radius_mm / step)) - 1)
        axes.append(step * np.arange(-reach, reach + 1))
    x, y, z = np.meshgrid(*axes, indexing="ij")
    return np.asarray(np.maximum(0.0, radius_mm - np.sqrt(x**2 + y**2 + z**2)))


def convolved(values: jax.Array, kernel: jax.Array, mirrored_x: bool) -> jax.Array:
    """Weighted sums over the neighbours, zero beyond the grid, reflected at a mirror plane."""
    reach = [(n // 2, n // 2) for n in kernel.shape]
    if mirrored_x:
        values = jnp.pad(values, ((reach[0][0], 0), (0, 0), (0, 0)), mode="symmetric")
        reach[0] = (0, reach[0][1])
    padded = jnp.pad(values, reach)
    return jax.lax.conv_general_dilated(padded[None, None], kernel[None, None], (1, 1, 1), "VALID")[0, 0]


def share_within(plain: ConeFilter, solid: Array) -> jax.Array:
    """Share of a filter's weight around each cell that is designable and not void, (nx, ny, nw).

    Times the filtered density it is the mean over void beyond the design space as well.

    Args:
        solid: fraction of the cells that is solid in any case and does not count, as far as the kernel goes
            beyond both ends of the last axis (nx, ny, nw + kernel - 1).

    Source: A. Clausen, E. Andreassen, On filter boundary conditions in topology optimization, SMO 56, 2017.
    """
    reach = plain.kernel.shape[2] // 2
    inner = slice(reach, solid.shape[2] - reach)
    weight = convolved(plain.design, plain.kernel, plain.mirrored_x)
    around = convolved(jnp.asarray(solid), plain.kernel, plain.mirrored_x)[:, :, inner]
    counted = jnp.sum(plain.kernel) - around
    return jnp.where(counted > 0, weight / jnp.where(counted > 0, counted, 1.0), 1.0)


jax.tree_util.register_dataclass(ConeFilter, data_fields=["design", "kernel"], meta_fields=["mirrored_x"])
