"""From design variables to relative moduli: density filter, projection, SIMP.

The design variables live on the cells of the web. The chain is x -> filtered (for a die, without undercuts)
-> projected density (the physical one) -> modulus; every function is differentiable by JAX. Design variables
`x` and the physical `density` have shape (nx, ny, nw) and lie in [0, 1]; `beta`: steepness of the projection.
"""

from __future__ import annotations

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain
from cranktopo.optimise.forging_constraint import parting_index, reachable, without_undercuts

Array = NDArray[np.float64]

PENALTY = 3.0
CONTRAST = 1e-9
THRESHOLD = 0.5


@dataclass(frozen=True)
class Interpolation:
    """Constant data of the density-to-modulus chain.

    Attributes:
        fixed: solid fraction that is not designable (nx, ny, nz).
        design: designable fraction of the cells of the web's layers (nx, ny, nw).
        web_layers: range of z layers that holds the web.
        kernel: cone weights of the density filter, odd sizes per axis.
        mirrored_x: whether the filter reflects at the first x plane.
        parting: x cells on the negative side of a die's parting plane x = 0; None without a die.
    """

    fixed: jax.Array
    design: jax.Array
    web_layers: tuple[int, int]
    kernel: jax.Array
    mirrored_x: bool
    parting: int | None = None

    @property
    def total(self) -> jax.Array:
        """Designable volume in cells."""
        return jnp.sum(self.design)


def build_interpolation(
    domain: Domain, filter_radius_mm: float, open_to_die: NDArray[np.bool_] | None = None
) -> Interpolation:
    """The density-to-modulus chain of a domain; call inside `double_precision()`.

    Args:
        filter_radius_mm: radius of the cone filter, mm; it sets the smallest member.
        open_to_die: for a web from a die, (nx, ny, nw) cells that are no obstacle to it; what lies behind one
            is not designable.
    """
    layers = domain.web_layers
    dx, dy, dz = domain.grid.steps_mm
    steps = float(dx[0]), float(dy[0]), float(dz[layers[0]])
    design = domain.design[:, :, layers[0] : layers[1]]
    parting = None
    if open_to_die is not None:
        parting = parting_index(domain)
        design = design * reachable(open_to_die, parting)
    return Interpolation(
        fixed=jnp.asarray(domain.fixed),
        design=jnp.asarray(design),
        web_layers=layers,
        kernel=jnp.asarray(cone_kernel(steps, filter_radius_mm)),
        mirrored_x=domain.mirrored_x,
        parting=parting,
    )


def cone_kernel(steps_mm: tuple[float, float, float], radius_mm: float) -> Array:
    """Cone-shaped filter weights max(0, radius - distance) on a grid.

    Source: T. E. Bruns, D. A. Tortorelli, CMAME 190, 2001; B. Bourdin, IJNME 50, 2001.
    """
    axes = []
    for step in steps_mm:
        reach = max(0, int(np.ceil(radius_mm / step)) - 1)
        axes.append(step * np.arange(-reach, reach + 1))
    x, y, z = np.meshgrid(*axes, indexing="ij")
    return np.asarray(np.maximum(0.0, radius_mm - np.sqrt(x**2 + y**2 + z**2)))


def filtered(data: Interpolation, x: jax.Array) -> jax.Array:
    """Filtered densities: weighted mean over the designable neighbours."""
    weight = _convolve(data, data.design)
    return _convolve(data, x * data.design) / jnp.where(weight > 0, weight, 1.0)


def smooth_density(data: Interpolation, x: jax.Array) -> jax.Array:
    """Filtered density, without undercuts along x where there is a die; its iso-surface bounds the web."""
    smooth = filtered(data, x)
    return smooth if data.parting is None else without_undercuts(smooth, data.design > 0, data.parting)


def projected(density: jax.Array, beta: float | jax.Array) -> jax.Array:
    """Smoothed Heaviside projection; steeper with beta.

    Source: F. Wang, B. S. Lazarov, O. Sigmund, On projection methods, SMO 43, 2011, equation 9.
    """
    low = jnp.tanh(beta * THRESHOLD)
    high = jnp.tanh(beta * (1.0 - THRESHOLD))
    return (low + jnp.tanh(beta * (density - THRESHOLD))) / (low + high)


def physical_density(data: Interpolation, x: jax.Array, beta: float | jax.Array) -> jax.Array:
    """Physical density (nx, ny, nw) of the web's layers, 0 outside the design space."""
    return projected(smooth_density(data, x), beta) * (data.design > 0)


def relative_moduli(data: Interpolation, density: jax.Array) -> jax.Array:
    """Relative moduli (nx, ny, nz) of all cells (modified SIMP).

    Source: M. P. Bendsoe, O. Sigmund, Topology Optimization, 2003; O. Sigmund, SMO 33, 2007.
    """
    web = data.design * (CONTRAST + density**PENALTY * (1.0 - CONTRAST))
    return data.fixed.at[:, :, data.web_layers[0] : data.web_layers[1]].add(web)


def solid_fraction(data: Interpolation, density: jax.Array) -> jax.Array:
    """Solid fraction (nx, ny, nz) of all cells, which carries the mass."""
    return data.fixed.at[:, :, data.web_layers[0] : data.web_layers[1]].add(data.design * density)


def volume_fraction(data: Interpolation, density: jax.Array) -> jax.Array:
    """Share of the designable volume that is solid."""
    return jnp.sum(data.design * density) / data.total


def greyness(data: Interpolation, density: jax.Array) -> jax.Array:
    """Measure of non-discreteness, 0 for a black-and-white design, 1 for density one half everywhere.

    Source: O. Sigmund, Morphology-based black and white filters, SMO 33, 2007.
    """
    return jnp.sum(data.design * 4.0 * density * (1.0 - density)) / data.total


def _convolve(data: Interpolation, values: jax.Array) -> jax.Array:
    reach = [(n // 2, n // 2) for n in data.kernel.shape]
    if data.mirrored_x:
        values = jnp.pad(values, ((reach[0][0], 0), (0, 0), (0, 0)), mode="symmetric")
        reach[0] = (0, reach[0][1])
    padded = jnp.pad(values, reach)
    return jax.lax.conv_general_dilated(padded[None, None], data.kernel[None, None], (1, 1, 1), "VALID")[0, 0]


jax.tree_util.register_dataclass(
    Interpolation,
    data_fields=["fixed", "design", "kernel"],
    meta_fields=["web_layers", "mirrored_x", "parting"],
)
