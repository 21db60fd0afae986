"""Manufacturing of a density: forging in a die, casting and milling, with draft if wanted.

Die halves leave along +x and -x, or through the body's faces along +z and -z. What lies outward of a void
would hold them back, so each cell takes a smooth minimum over the cells between it and the parting plane.
Sums only grow outward: the result is monotone whatever the sharpness, and stays 1 where all cells are solid.

With a draft angle the solid shrinks outward: a layer must lie within the one before it, eroded by tan(draft)
times the distance between them. On densities that is -f_n >= tan(draft) |grad_t f| (n outward, t in the
layer), which the Godunov scheme of the eikonal equation keeps exactly from layer to layer.

Moulds and mills reach every void from outside, along one of a few directions: a void cell counts as reached
where all cells between it and the outside are void; for a tool with a radius, where the tool's whole
cross-section gets there. The void is what any direction reaches, the rest is solid: nothing closed is left.
A mould of two halves is two opposite directions, its parting surface free: each line along them holds one
piece of solid. Per direction the tool's centre may be where a smooth minimum of the void over its
cross-section, and over all layers outward, says so; the cross-section around the centres is cut, a true
maximum over them, as over the directions. So what is cut is an exact union of cross-sections swept from
outside, at every threshold. Draft as in the die, on the void.

Sources: A. R. Gersborg, C. S. Andreasen, An explicit parameterization for casting constraints in gradient
driven topology optimization, SMO 44, 2011 (idea of the die); the Kreisselmeier-Steinhauser function (DFVLR
report, 1979), shifted so that full density stays full (smooth minimum); X. Qian, Undercut and overhang angle
control in topology optimization, IJNME 111, 2017 (slope condition); E. Rouy, A. Tourin, SIAM J. Numer. Anal.
29, 1992 (scheme); M. Langelaar, Topology optimization for multi-axis machining, CMAME 351, 2019 (access).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

SHARPNESS = 60.0
_NO_DRAFT = (0.0, 0.0)
Parting = tuple[int, int]
"""Cells along the axis up to which the negative half of a die reaches, and from which the positive one does:
the same number, or one layer that belongs to both where the parting plane lies in the middle of it."""


@dataclass(frozen=True)
class ForgingConstraint:
    """Two die halves that part in a plane across `axis`, 0 or 2.

    Attributes:
        free: designable cells (nx, ny, nw); the others are no obstacle.
        kept: minimum density, 1 where material must be; None where there is none.
        draft_slope: tan(draft) times the cell's edge along the axis over its edge along each other axis.
    """

    free: jax.Array
    kept: jax.Array | None
    axis: int
    parting: Parting
    draft_slope: tuple[float, float] = _NO_DRAFT

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
    density: jax.Array, free: jax.Array, parting: Parting, draft_slope: tuple[float, float] = _NO_DRAFT
) -> jax.Array:
    """Return the density, at most the given one where free, that never grows away from the parting."""
    ks_terms, (end, start) = jnp.where(free, _ks_term(density), 0.0), parting
    left, right = (
        _running_smooth_min(ks_terms[:end][::-1], draft_slope)[::-1],
        _running_smooth_min(ks_terms[start:], draft_slope),
    )
    return jnp.concatenate([left, right[end - start :]])


def _running_smooth_min(ks_terms: jax.Array, draft_slope: tuple[float, float]) -> jax.Array:
    """Return the smooth minimum over the layers (first axis) up to each; with draft over eroded ones."""
    if not any(draft_slope):
        return _smooth_minimum(jnp.cumsum(ks_terms, axis=0))

    def layer(before: jax.Array, own: jax.Array) -> tuple[jax.Array, jax.Array]:
        found = _smooth_minimum(own + _ks_term(eroded(before, draft_slope)))
        return found, found

    return jax.lax.scan(layer, jnp.ones(ks_terms.shape[1:]), ks_terms)[1]


def _ks_term(density: jax.Array) -> jax.Array:
    """Return what a density adds to the sum in a smooth minimum: nothing where it is full."""
    return jnp.exp(-SHARPNESS * density) - jnp.exp(-SHARPNESS)


def _smooth_minimum(ks_terms: jax.Array) -> jax.Array:
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


Offsets = tuple[tuple[int, int], ...]
ONE_CELL: Offsets = ((0, 0),)


@dataclass(frozen=True)
class Direction:
    """A way in from outside along an axis, inward +1 or -1; the tool's section is in cells across it."""

    axis: int
    inward: int
    section: Offsets = ONE_CELL
    draft_slope: tuple[float, float] = _NO_DRAFT


@dataclass(frozen=True)
class ToolAccess:
    """Access of tools, or of the halves of a mould, to a density.

    Attributes:
        free: designable cells (nx, ny, nw).
        air: 1 where there is nothing to begin with, 0 where solid stands or in a designable cell; `margin`
            cells larger than the body at both ends of each axis.
    """

    free: jax.Array
    air: jax.Array
    margin: tuple[int, int, int]
    mirrored_x: bool
    directions: tuple[Direction, ...]

    def __call__(self, smooth: jax.Array) -> jax.Array:
        """Return the density of what is left (nx, ny, nw), at most 1."""
        open_ = self.air + self._padded(jnp.where(self.free, 1.0 - smooth, 0.0))
        reached = jnp.stack([_reached(open_, direction) for direction in self.directions])
        inner = tuple(slice(n, n + size) for n, size in zip(self.margin, smooth.shape, strict=True))
        return 1.0 - jnp.max(reached, axis=0)[inner]

    def _padded(self, void: jax.Array) -> jax.Array:
        (x, y, z), mirrored = self.margin, self.mirrored_x
        if mirrored:
            void = jnp.pad(void, ((x, 0), (0, 0), (0, 0)), mode="symmetric")
        return jnp.pad(void, ((0 if mirrored else x, x), (y, y), (z, z)))


def _reached(open_: jax.Array, direction: Direction) -> jax.Array:
    moved = jnp.moveaxis(open_, direction.axis, 0)
    moved = moved if direction.inward > 0 else moved[::-1]
    centres = _running_smooth_min(_summed(_ks_term(moved), direction.section), direction.draft_slope)
    cut = dilate(centres, direction.section)
    return jnp.moveaxis(cut if direction.inward > 0 else cut[::-1], 0, direction.axis)


def _summed(ks_terms: jax.Array, section: Offsets) -> jax.Array:
    if section == ONE_CELL:
        return ks_terms
    return _over(section, jnp.add, jnp.zeros_like(ks_terms), ks_terms)


@partial(jax.custom_vjp, nondiff_argnums=(1,))
def dilate(values: jax.Array, section: Offsets) -> jax.Array:
    """Return maximum over the cross-section in each layer (first axis); equal ones share the derivative."""
    return _over(section, jnp.maximum, values, values)


def _dilate_forward(values: jax.Array, section: Offsets) -> tuple[jax.Array, tuple[jax.Array, jax.Array]]:
    found = dilate(values, section)
    return found, (values, found)


def _dilate_backward(
    section: Offsets, kept: tuple[jax.Array, jax.Array], by_found: jax.Array
) -> tuple[jax.Array]:
    values, found = kept
    none = jnp.zeros_like(values)
    hits = _over(section, lambda count, own: count + (own == found), none, values)
    back = tuple((-a, -b) for a, b in section)

    def shared(total: jax.Array, largest: jax.Array, share: jax.Array) -> jax.Array:
        return total + jnp.where(largest == values, share, 0.0)

    return (_over(back, shared, none, found, by_found / hits),)


dilate.defvjp(_dilate_forward, _dilate_backward)


def _over(
    section: Offsets, step: Callable[..., jax.Array], start: jax.Array, *fields: jax.Array
) -> jax.Array:
    """Return `step` of the last result and of fields at one offset after another; fields are 0 beyond edges.

    A loop: written out, XLA compiles it for seconds, and its derivative runs ten times longer.
    """
    reach = max(max(abs(a), abs(b)) for a, b in section)
    around = [jnp.pad(field, ((0, 0), (reach, reach), (reach, reach))) for field in fields]

    def at_offset(result: jax.Array, corner: jax.Array) -> tuple[jax.Array, None]:
        own = (jax.lax.dynamic_slice(field, (0, corner[0], corner[1]), start.shape) for field in around)
        return step(result, *own), None

    return jax.lax.scan(at_offset, start, jnp.asarray(section) + reach)[0]


jax.tree_util.register_dataclass(
    ToolAccess, data_fields=["free", "air"], meta_fields=["margin", "mirrored_x", "directions"]
)
