"""Casting and milling: every void is reached from outside, along one of a few directions.

For each direction a void cell counts as reached where all cells between it and the outside are void; for a
tool with a radius, where the tool's whole cross-section gets there. The void is what any direction reaches,
the rest is solid: nothing closed is left, whatever the design variables.

A mould of two halves is two opposite directions, its parting surface free: each line along them holds one
piece of solid. A die (`forging_constraint`) has its parting surface in a plane instead.

Per direction: the tool's centre may be where a smooth minimum of the void over its cross-section, and over
all layers outward, says so (Kreisselmeier-Steinhauser, DFVLR report, 1979); the cross-section around the
centres is cut, a true maximum over them, as over the directions. So what is cut is an exact union of
cross-sections swept from outside, at every threshold. Draft as in the die, on the void.

Source of the idea: M. Langelaar, Topology optimization for multi-axis machining, CMAME 351, 2019, 226-252.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp

from cranktopo.numerics.filters.forging import NO_DRAFT, ks_term, running_smooth_min

Offsets = tuple[tuple[int, int], ...]
ONE_CELL: Offsets = ((0, 0),)


@dataclass(frozen=True)
class Direction:
    """A way in from outside.

    Attributes:
        axis: along which it leads.
        inward: +1 or -1, the sign of its motion along the axis.
        section: cells of the tool's cross-section about its centre, along the two other axes.
        draft_slope: of the draft, as for a die.
    """

    axis: int
    inward: int
    section: Offsets = ONE_CELL
    draft_slope: tuple[float, float] = NO_DRAFT


@dataclass(frozen=True)
class ToolAccess:
    """Access of tools, or of the halves of a mould, to a density.

    Attributes:
        free: designable cells (nx, ny, nw).
        air: 1 where there is nothing to begin with, 0 where solid stands or in a designable cell;
            `margin` cells larger than the body at both ends of each axis.
        margin: cells around the body that tools pass through.
        mirrored_x: whether the first x plane is a mirror.
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
    """Return how far a direction clears each cell: 0 solid, 1 void."""
    moved = jnp.moveaxis(open_, direction.axis, 0)
    moved = moved if direction.inward > 0 else moved[::-1]
    centres = running_smooth_min(_summed(ks_term(moved), direction.section), direction.draft_slope)
    cut = dilate(centres, direction.section)
    return jnp.moveaxis(cut if direction.inward > 0 else cut[::-1], 0, direction.axis)


def _summed(ks_terms: jax.Array, section: Offsets) -> jax.Array:
    """Return the sums over the cross-section in each layer; nothing stands beyond the margin."""
    if section == ONE_CELL:
        return ks_terms
    return sum((_shifted(ks_terms, offset) for offset in section), jnp.zeros_like(ks_terms))


@partial(jax.custom_vjp, nondiff_argnums=(1,))
def dilate(values: jax.Array, section: Offsets) -> jax.Array:
    """Return maximum over the cross-section in each layer (first axis); equal ones share the derivative."""
    found = values
    for offset in section:
        found = jnp.maximum(found, _shifted(values, offset))
    return found


def _dilate_forward(values: jax.Array, section: Offsets) -> tuple[jax.Array, tuple[jax.Array, jax.Array]]:
    found = dilate(values, section)
    return found, (values, found)


def _dilate_backward(
    section: Offsets, kept: tuple[jax.Array, jax.Array], by_found: jax.Array
) -> tuple[jax.Array]:
    values, found = kept
    hits = sum((_shifted(values, offset) == found for offset in section), jnp.zeros(found.shape, int))
    share = by_found / hits
    parts = ((_shifted(values, offset) == found) * share for offset in section)
    back = (_shifted(part, (-a, -b)) for part, (a, b) in zip(parts, section, strict=True))
    return (sum(back, jnp.zeros_like(values)),)


dilate.defvjp(_dilate_forward, _dilate_backward)


def _shifted(values: jax.Array, offset: tuple[int, int]) -> jax.Array:
    """Return each cell's value at an offset within its layer; 0 beyond the edges."""
    a, b = offset
    pads = ((0, 0), (max(0, -a), max(0, a)), (max(0, -b), max(0, b)))
    padded = jnp.pad(values, pads)
    rows = jax.lax.slice_in_dim(padded, max(0, a), max(0, a) + values.shape[1], axis=1)
    return jax.lax.slice_in_dim(rows, max(0, b), max(0, b) + values.shape[2], axis=2)


jax.tree_util.register_dataclass(
    ToolAccess, data_fields=["free", "air"], meta_fields=["margin", "mirrored_x", "directions"]
)
