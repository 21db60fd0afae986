"""Forging constraint: density that never grows away from the die's parting plane, with draft if wanted.

The die halves leave along +x and -x, or through the body's faces along +z and -z. What lies outward of a void
would hold them back, so each cell takes a smooth minimum over the cells between it and the parting plane.
Sums only grow outward: the result is monotone whatever the sharpness, and stays 1 where all cells are solid.

With a draft angle the solid shrinks outward: a layer must lie within the one before it, eroded by tan(draft)
times the distance between them. On densities that is -f_n >= tan(draft) |grad_t f| (n outward, t in the
layer), which the Godunov scheme of the eikonal equation keeps exactly from layer to layer.

Source of the idea: A. R. Gersborg, C. S. Andreasen, An explicit parameterization for casting constraints in
gradient driven topology optimization, SMO 44, 2011. The smooth minimum is the Kreisselmeier-Steinhauser
function (DFVLR report, 1979), shifted so that full density stays full. The slope condition on the gradient
is that of X. Qian, Undercut and overhang angle control in topology optimization, IJNME 111, 2017, the scheme
that of E. Rouy, A. Tourin, SIAM J. Numer. Anal. 29, 1992.
"""

from __future__ import annotations

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

SHARPNESS = 60.0
NO_DRAFT = (0.0, 0.0)
Parting = tuple[int, int]
"""Cells along the axis up to which the negative half of a die reaches, and from which the positive one does:
the same number, or one layer that belongs to both where the parting plane lies in the middle of it."""


@dataclass(frozen=True)
class ForgingConstraint:
    """Two die halves that part in a plane.

    Attributes:
        free: designable cells (nx, ny, nw); the others are no obstacle.
        kept: least density, 1 where material must be; None where there is none.
        axis: along which the halves leave, 0 or 2.
        draft_slope: tan(draft) times the cell's edge along the axis over its edge along each other axis.
    """

    free: jax.Array
    kept: jax.Array | None
    axis: int
    parting: Parting
    draft_slope: tuple[float, float] = NO_DRAFT

    def __call__(self, smooth: jax.Array) -> jax.Array:
        """Return density that the die releases (nx, ny, nw), nowhere above the given one but where kept."""
        raised = smooth if self.kept is None else jnp.maximum(self.kept, smooth)
        density, free = jnp.moveaxis(raised, self.axis, 0), jnp.moveaxis(self.free, self.axis, 0)
        found = without_undercuts(density, free, self.parting, self.draft_slope)
        found = jnp.moveaxis(found, 0, self.axis)
        return found if self.kept is None else jnp.maximum(self.kept, found)


def reachable(open_to_die: NDArray[np.bool_], parting: Parting, axis: int = 0) -> NDArray[np.bool_]:
    """Return cells (nx, ny, nw) with only open cells between them and the parting plane along an axis."""
    moved, (end, start) = np.moveaxis(open_to_die, axis, 0), parting
    left, right = (np.logical_and.accumulate(half) for half in (moved[:end][::-1], moved[start:]))
    return np.moveaxis(np.concatenate([left[::-1], right[end - start :]]), 0, axis)


def without_undercuts(
    density: jax.Array, free: jax.Array, parting: Parting, draft_slope: tuple[float, float] = NO_DRAFT
) -> jax.Array:
    """Return the density that never grows away from the parting plane, along the first axis.

    Returns:
        (nx, ny, nw) in [0, 1], at most `density` where that is designable.
    """
    ks_terms, (end, start) = jnp.where(free, ks_term(density), 0.0), parting
    left, right = (
        running_smooth_min(ks_terms[:end][::-1], draft_slope)[::-1],
        running_smooth_min(ks_terms[start:], draft_slope),
    )
    return jnp.concatenate([left, right[end - start :]])


def running_smooth_min(ks_terms: jax.Array, draft_slope: tuple[float, float]) -> jax.Array:
    """Smooth minimum of densities over the layers up to each one, the first axis; with draft the solid of
    each layer lies within the eroded one before it.
    """
    if not any(draft_slope):
        return _smooth_minimum(jnp.cumsum(ks_terms, axis=0))

    def layer(before: jax.Array, own: jax.Array) -> tuple[jax.Array, jax.Array]:
        found = _smooth_minimum(own + ks_term(eroded(before, draft_slope)))
        return found, found

    return jax.lax.scan(layer, jnp.ones(ks_terms.shape[1:]), ks_terms)[1]


def ks_term(density: jax.Array) -> jax.Array:
    """Return what a density adds to the sum in a smooth minimum: nothing where it is full."""
    return jnp.exp(-SHARPNESS * density) - jnp.exp(-SHARPNESS)


def _smooth_minimum(ks_terms: jax.Array) -> jax.Array:
    """Smooth minimum of densities from the sum of their gaps; at most the true one."""
    return -jnp.log(jnp.minimum(ks_terms + jnp.exp(-SHARPNESS), 1.0)) / SHARPNESS


def eroded(layer: jax.Array, draft_slope: tuple[float, float]) -> jax.Array:
    """Return a layer less its steepest descent over so many cells along each axis; flat beyond its edges."""
    square = jnp.zeros_like(layer)
    for axis, part in enumerate(draft_slope):
        edges = [(1, 1) if axis == other else (0, 0) for other in range(2)]
        padded = jnp.pad(layer, edges, mode="edge")
        before, after = (jax.lax.slice_in_dim(padded, k, k + layer.shape[axis], axis=axis) for k in (0, 2))
        square += (part * jnp.maximum(0.0, layer - jnp.minimum(before, after))) ** 2
    steep = square > 0  # the root has no derivative at 0
    return layer - jnp.where(steep, jnp.sqrt(jnp.where(steep, square, 1.0)), 0.0)


jax.tree_util.register_dataclass(
    ForgingConstraint, data_fields=["free", "kept"], meta_fields=["axis", "parting", "draft_slope"]
)
