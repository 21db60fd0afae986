"""From design variables to relative moduli: the chain of density filter, manufacturing, projection, SIMP.

The design variables live on the cells of the web. The chain is x -> filtered -> what a process can make
-> projected density (the physical one) -> modulus. Filter, process and projection are exchangeable blocks;
every function is differentiable by JAX. Design variables `x` and the physical `density` have shape
(nx, ny, nw) and lie in [0, 1]; `beta`: steepness of the projection.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.cells.domain import Domain
from cranktopo.numerics.device_arrays import on_device
from cranktopo.numerics.filters.density_filter import Projection, cone_filter, cone_kernel, projected

Block = Callable[[jax.Array], jax.Array]
"""A differentiable map of fields (nx, ny, nw), registered as a JAX pytree: a dataclass with `__call__`."""
_PENALTY = 3.0
PLAIN = Projection()
CONTRAST = 1e-9


@dataclass(frozen=True)
class MaterialInterpolation:
    """Constant data of the density-to-modulus chain.

    Attributes:
        passive_fraction: solid fraction that is not designable (nx, ny, nz).
        design_fraction: designable fraction of the cells of the web's layers (nx, ny, nw).
        process: from a smooth density to the nearest one that can be made; None where anything can.
        boundary_correction: share of the smooth density that the eroded design has, below 1 at walls of the
            design space (nx, ny, nw); None where walls do not erode it.
    """

    passive_fraction: jax.Array
    design_fraction: jax.Array
    web_layers: tuple[int, int]
    density_filter: Block
    process: Block | None = None
    projection: Projection = PLAIN
    penalty: float = _PENALTY
    boundary_correction: jax.Array | None = None

    @property
    def total(self) -> jax.Array:
        """Designable volume in cells."""
        return jnp.sum(self.design_fraction)


def build_interpolation(
    domain: Domain, filter_radius_mm: float, design: NDArray[np.float64] | None = None
) -> MaterialInterpolation:
    """Return the density-to-modulus chain of a domain, for a web that any process may make.

    Call it inside `double_precision()`. `design` (nx, ny, nw) is designable, by default what the domain has.
    """
    first, last = domain.web_layers
    free = on_device(domain.design_fraction[:, :, first:last] if design is None else design)
    kernel = on_device(cone_kernel(web_cell_mm(domain), filter_radius_mm))
    return MaterialInterpolation(
        passive_fraction=on_device(domain.passive_fraction),
        design_fraction=free,
        web_layers=(first, last),
        density_filter=cone_filter(free, kernel, domain.mirrored_x),
    )


def web_cell_mm(domain: Domain) -> tuple[float, float, float]:
    """Return the edges of the cells of the web's layers, mm."""
    dx, dy, dz = domain.grid.steps_mm
    return float(dx[0]), float(dy[0]), float(dz[domain.web_layers[0]])


def smooth_density(data: MaterialInterpolation, x: jax.Array) -> jax.Array:
    """Return the filtered density that the process can make; its iso-surface bounds the web."""
    smooth = data.density_filter(x)
    return smooth if data.process is None else data.process(smooth)


def physical_density(data: MaterialInterpolation, x: jax.Array, beta: float | jax.Array) -> jax.Array:
    """Return the physical density (nx, ny, nw) of the web's layers, 0 outside the design space."""
    return _projected(data, smooth_density(data, x), beta, data.projection.nominal)


def eroded_density(data: MaterialInterpolation, x: jax.Array, beta: float | jax.Array) -> jax.Array:
    """Return thinner design whose stiffness counts: the physical density unless members have a least size."""
    smooth = smooth_density(data, x)
    seen = smooth if data.boundary_correction is None else smooth * data.boundary_correction
    return _projected(data, seen, beta, data.projection.eroded)


def dilated_density(data: MaterialInterpolation, x: jax.Array, beta: float | jax.Array) -> jax.Array:
    """Return the thicker design whose volume grows: the physical density unless gaps have a least size."""
    return _projected(data, smooth_density(data, x), beta, data.projection.dilated)


def _projected(
    data: MaterialInterpolation, smooth: jax.Array, beta: float | jax.Array, threshold: float
) -> jax.Array:
    return projected(smooth, beta, threshold) * (data.design_fraction > 0)


def relative_moduli(data: MaterialInterpolation, density: jax.Array) -> jax.Array:
    """Return the relative moduli (nx, ny, nz) of all cells (modified SIMP).

    Source: M. P. Bendsoe, O. Sigmund, Topology Optimization, 2003; O. Sigmund, SMO 33, 2007.
    """
    web = data.design_fraction * (CONTRAST + density**data.penalty * (1.0 - CONTRAST))
    return data.passive_fraction.at[:, :, data.web_layers[0] : data.web_layers[1]].add(web)


def solid_fraction(data: MaterialInterpolation, density: jax.Array) -> jax.Array:
    """Return the solid fraction (nx, ny, nz) of all cells, which carries the mass."""
    return data.passive_fraction.at[:, :, data.web_layers[0] : data.web_layers[1]].add(
        data.design_fraction * density
    )


def volume_fraction(data: MaterialInterpolation, density: jax.Array) -> jax.Array:
    """Share of the designable volume that is solid."""
    return jnp.sum(data.design_fraction * density) / data.total


def greyness(data: MaterialInterpolation, density: jax.Array) -> jax.Array:
    """Measure of non-discreteness, 0 for a black-and-white design, 1 for density one half everywhere.

    Source: O. Sigmund, Morphology-based black and white filters, SMO 33, 2007.
    """
    return jnp.sum(data.design_fraction * 4.0 * density * (1.0 - density)) / data.total


jax.tree_util.register_dataclass(
    MaterialInterpolation,
    data_fields=["passive_fraction", "design_fraction", "density_filter", "process", "boundary_correction"],
    meta_fields=["web_layers", "projection", "penalty"],
)
