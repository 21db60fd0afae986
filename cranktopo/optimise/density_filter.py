"""Density filter: each cell takes the mean of the design variables around it, nearer ones counting more."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.signal import fftconvolve
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Sums by Fourier transform are rounded by 1e-15 of the largest one: less than this is nothing.
_NOTHING, _DIGITS = 1e-12, 13


@dataclass(frozen=True)
class ConeFilter:
    """Weighted mean over the designable neighbours; what is outside the design space does not count.

    Attributes:
        design: designable fraction of the cells of the web's layers (nx, ny, nw).
        kernel: cone weights, odd sizes per axis.
        mirrored_x: whether the filter reflects at the first x plane.
        weight: sum of the weights of each cell's designable neighbours, infinite where it has none.

    Source: T. E. Bruns, D. A. Tortorelli, CMAME 190, 2001; B. Bourdin, IJNME 50, 2001.
    """

    design: jax.Array
    kernel: jax.Array
    mirrored_x: bool
    weight: jax.Array

    def __call__(self, x: jax.Array) -> jax.Array:
        """Filtered densities (nx, ny, nw) of design variables."""
        mean = convolved(x * self.design, self.kernel, self.mirrored_x) / self.weight
        # To so many digits, equal neighbours are equal on every machine: what a process makes of ties must
        # not hang on rounding.
        told = jnp.round(jnp.clip(mean, 0.0, 1.0), _DIGITS)
        return mean + jax.lax.stop_gradient(told - mean)


@partial(jax.jit, static_argnames="mirrored_x")
def cone_filter(design: jax.Array, kernel: jax.Array, mirrored_x: bool) -> ConeFilter:
    """The filter of a design space; arguments as the attributes of `ConeFilter`."""
    weight = convolved(design, kernel, mirrored_x)
    counts = weight > _NOTHING * jnp.sum(kernel)
    return ConeFilter(design, kernel, mirrored_x, jnp.where(counts, weight, jnp.inf))


def cone_kernel(steps_mm: tuple[float, float, float], radius_mm: float) -> Array:
    """Cone-shaped filter weights max(0, radius - distance) on a grid."""
    axes = []
    for step in steps_mm:
        reach = max(0, int(np.ceil(radius_mm / step)) - 1)
        axes.append(step * np.arange(-reach, reach + 1))
    x, y, z = np.meshgrid(*axes, indexing="ij")
    return np.asarray(np.maximum(0.0, radius_mm - np.sqrt(x**2 + y**2 + z**2)))


def convolved(values: jax.Array, kernel: jax.Array, mirrored_x: bool) -> jax.Array:
    """Weighted sums over the neighbours, zero beyond the grid, reflected at a mirror plane.

    The kernel is its own mirror image, so that a convolution is the sum. By Fourier transform: on fine cells
    it holds thousands of weights.
    """
    reach = [(n // 2, n // 2) for n in kernel.shape]
    if mirrored_x:
        values = jnp.pad(values, ((reach[0][0], 0), (0, 0), (0, 0)), mode="symmetric")
        reach[0] = (0, reach[0][1])
    return fftconvolve(jnp.pad(values, reach), kernel, mode="valid")


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
    weight = jnp.where(jnp.isinf(plain.weight), 0.0, plain.weight)
    around = convolved(jnp.asarray(solid), plain.kernel, plain.mirrored_x)[:, :, inner]
    counted = jnp.sum(plain.kernel) - around
    some = counted > _NOTHING * jnp.sum(plain.kernel)
    return jnp.where(some, weight / jnp.where(some, counted, 1.0), 1.0)


jax.tree_util.register_dataclass(
    ConeFilter, data_fields=["design", "kernel", "weight"], meta_fields=["mirrored_x"]
)
