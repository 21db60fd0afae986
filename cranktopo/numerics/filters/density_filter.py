"""Density filter, the mean of the design variables around a cell, and the projection of what it finds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import count

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.device_arrays import on_device

THRESHOLD = 0.5


@dataclass(frozen=True)
class Projection:
    """Thresholds of the three designs that one filtered density stands for.

    The eroded, thinner design has the stiffness, its threshold is above the nominal one where members must
    not get thin; the volume of the dilated one is limited, below the nominal one where gaps must not get
    narrow.
    Source: F. Wang, B. S. Lazarov, O. Sigmund, On projection methods, SMO 43, 2011.
    """

    nominal: float = THRESHOLD
    eroded: float = THRESHOLD
    dilated: float = THRESHOLD


def projected(density: jax.Array, beta: float | jax.Array, threshold: float = THRESHOLD) -> jax.Array:
    """Return the smoothed Heaviside projection, not below 0, steeper with beta (Wang, 2011, equation 9)."""
    low = jnp.tanh(beta * threshold)
    high = jnp.tanh(beta * (1.0 - threshold))
    step = (low + jnp.tanh(beta * (density - threshold))) / (low + high)
    # Rounding may leave void below 0, of which no fractional power exists; its slope stays.
    return step + jax.lax.stop_gradient(jnp.maximum(step, 0.0) - step)


Shape = tuple[int, ...]
# Sums by Fourier transform are rounded by 1e-15 of the largest one: less than this is nothing.
_NOTHING, _DIGITS = 1e-12, 13


@dataclass(frozen=True)
class ConeFilter:
    """Weighted mean over the designable neighbours; what is outside the design space does not count.

    Attributes:
        design: designable fraction of the cells (nx, ny, nw).
        kernel: cone weights, odd sizes per axis.
        weight: sum of the weights of each cell's designable neighbours, infinite where it has none.

    Source: T. E. Bruns, D. A. Tortorelli, CMAME 190, 2001; B. Bourdin, IJNME 50, 2001.
    """

    design: jax.Array
    kernel: jax.Array
    mirrored_x: bool
    weight: jax.Array
    spectrum: jax.Array

    def __call__(self, x: jax.Array) -> jax.Array:
        """Return the filtered densities (nx, ny, nw) of design variables."""
        mean = _sums(x * self.design, self.spectrum, self.kernel.shape, self.mirrored_x) / self.weight
        # To so many digits, equal neighbours are equal on every machine: what a process makes of ties must
        # not hang on rounding.
        rounded = jnp.round(jnp.clip(mean, 0.0, 1.0), _DIGITS)
        return mean + jax.lax.stop_gradient(rounded - mean)


@partial(jax.jit, static_argnames="mirrored_x")
def cone_filter(design: jax.Array, kernel: jax.Array, mirrored_x: bool) -> ConeFilter:
    """Return the filter of a design space; arguments as the attributes of `ConeFilter`."""
    spectrum = _spectrum(kernel, design.shape, mirrored_x)
    weight = _sums(design, spectrum, kernel.shape, mirrored_x)
    counts = weight > _NOTHING * jnp.sum(kernel)
    return ConeFilter(design, kernel, mirrored_x, jnp.where(counts, weight, jnp.inf), spectrum)


def cone_kernel(steps_mm: tuple[float, float, float], radius_mm: float) -> Array:
    """Return the cone-shaped filter weights max(0, radius - distance) on a grid."""
    axes = []
    for step in steps_mm:
        reach = max(0, int(np.ceil(radius_mm / step)) - 1)
        axes.append(step * np.arange(-reach, reach + 1))
    x, y, z = np.meshgrid(*axes, indexing="ij")
    return np.asarray(np.maximum(0.0, radius_mm - np.sqrt(x**2 + y**2 + z**2)))


def convolved(values: jax.Array, kernel: jax.Array, mirrored_x: bool) -> jax.Array:
    """Return the weighted sums over the neighbours, zero beyond the grid, reflected at a mirror plane.

    By Fourier transform: on fine cells the kernel holds thousands of weights. It is its own mirror image.
    """
    return _sums(values, _spectrum(kernel, values.shape, mirrored_x), kernel.shape, mirrored_x)


@partial(jax.custom_vjp, nondiff_argnums=(2, 3))
def _sums(values: jax.Array, spectrum: jax.Array, kernel: Shape, mirrored_x: bool) -> jax.Array:
    lengths, before = _lengths(values.shape, kernel, mirrored_x), _reflected(kernel, mirrored_x)
    inner = tuple(slice(first, first + n) for first, n in zip((before, 0, 0), values.shape, strict=True))
    if mirrored_x:
        values = jnp.pad(values, ((before, 0), (0, 0), (0, 0)), mode="symmetric")
    found: jax.Array = jnp.fft.irfftn(jnp.fft.rfftn(values, lengths) * spectrum, lengths)
    return found[inner]


def _sums_to_differentiate(
    values: jax.Array, spectrum: jax.Array, kernel: Shape, mirrored_x: bool
) -> tuple[jax.Array, jax.Array]:
    return _sums(values, spectrum, kernel, mirrored_x), spectrum


def _sums_back(
    kernel: Shape, mirrored_x: bool, spectrum: jax.Array, by_sums: jax.Array
) -> tuple[jax.Array, None]:
    """Return the transposed sums: what a cell gives to a neighbour it gets from it."""
    return _sums(by_sums, spectrum, kernel, mirrored_x), None


_sums.defvjp(_sums_to_differentiate, _sums_back)


def _spectrum(kernel: jax.Array, shape: Shape, mirrored_x: bool) -> jax.Array:
    lengths, reach = _lengths(shape, kernel.shape, mirrored_x), [n // 2 for n in kernel.shape]
    after = [(0, length - n) for length, n in zip(lengths, kernel.shape, strict=True)]
    around = jnp.roll(jnp.pad(kernel, after), [-n for n in reach], (0, 1, 2))
    found: jax.Array = jnp.fft.rfftn(around)
    return found


def _lengths(shape: Shape, kernel: Shape, mirrored_x: bool) -> list[int]:
    """Return lengths that transform fast: the zeros between the last value and the first keep both apart."""
    reflected = (_reflected(kernel, mirrored_x), 0, 0)
    return [
        fast_length(max(size + before + n // 2, n))
        for size, n, before in zip(shape, kernel, reflected, strict=True)
    ]


def fast_length(least: int) -> int:
    """Return the next length of real data whose prime factors are 2, 3 and 5, which transforms fast.

    As `scipy.fft.next_fast_len(least, real=True)`, whose package takes a tenth of what a run loads at first.
    """
    return next(length for length in count(least) if 60 ** length.bit_length() % length == 0)


def _reflected(kernel: Shape, mirrored_x: bool) -> int:
    return kernel[0] // 2 if mirrored_x else 0


def boundary_correction(cone: ConeFilter, solid: Array) -> jax.Array:
    """Return the share of a filter's weight around each cell that is designable and not void, (nx, ny, nw).

    Times the filtered density it is the mean over void beyond the design space as well. `solid`, a fraction
    that does not count, reaches as far as the kernel beyond both ends of the last axis (nx, ny, nw + kernel -
    1).
    Source: A. Clausen, E. Andreassen, On filter boundary conditions in topology optimization, SMO 56, 2017.
    """
    reach = cone.kernel.shape[2] // 2
    inner = slice(reach, solid.shape[2] - reach)
    weight = jnp.where(jnp.isinf(cone.weight), 0.0, cone.weight)
    around = convolved(on_device(solid), cone.kernel, cone.mirrored_x)[:, :, inner]
    counted = jnp.sum(cone.kernel) - around
    some = counted > _NOTHING * jnp.sum(cone.kernel)
    return jnp.where(some, weight / jnp.where(some, counted, 1.0), 1.0)


jax.tree_util.register_dataclass(
    ConeFilter, data_fields=["design", "kernel", "weight", "spectrum"], meta_fields=["mirrored_x"]
)
