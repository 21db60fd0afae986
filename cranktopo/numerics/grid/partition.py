"""Parts of the structured grid, one for each device.

The grid is cut along z into parts of equal depth. Neighbouring parts both keep the plane of nodes between
them, the interface. Sums over cells, such as nodal forces, are complete there after `add_interfaces`; sums
over nodes count an interface once. The methods are called inside `jax.shard_map` over the axis `AXIS`, on the
arrays of one part. With one part they change nothing and work everywhere. Nodal arrays have z last.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import jax
import jax.numpy as jnp

AXIS = "z"


@jax.tree_util.register_static
@dataclass(frozen=True)
class Partition:
    """Partition of a grid among devices; multigrid levels beyond `levels` are whole on every device."""

    parts: int = 1
    levels: int = 0

    def at_level(self, level: int) -> Partition:
        """Return the partition of the arrays of a level."""
        return self if level < self.levels else WHOLE

    def at_first_plane(self) -> bool | jax.Array:
        """Tell whether this part has the first plane of the grid."""
        return self.parts == 1 or jax.lax.axis_index(AXIS) == 0

    def at_last_plane(self) -> bool | jax.Array:
        """Tell whether this part has the last plane of the grid."""
        return self.parts == 1 or jax.lax.axis_index(AXIS) == self.parts - 1

    def add_interfaces(self, nodal: jax.Array) -> jax.Array:
        """Return the sums of what both neighbours found on an interface, on both."""
        if self.parts == 1:
            return nodal
        below = jax.lax.ppermute(nodal[..., -1], AXIS, [(part, part + 1) for part in range(self.parts - 1)])
        return nodal.at[..., 0].add(below).at[..., -1].add(self._from_above(nodal))

    def copy_interfaces(self, nodal: jax.Array) -> jax.Array:
        """Return the values of an interface as the part above has them, on both: rounding lets them drift."""
        if self.parts == 1:
            return nodal
        return nodal.at[..., -1].set(jnp.where(self.at_last_plane(), nodal[..., -1], self._from_above(nodal)))

    def halve_interfaces(self, nodal: jax.Array) -> jax.Array:
        """Share complete values out, so that sums of them are complete after `add_interfaces`."""
        if self.parts == 1:
            return nodal
        first, last = self.at_first_plane(), self.at_last_plane()
        halved = nodal.at[..., 0].multiply(jnp.where(first, 1.0, 0.5))
        return halved.at[..., -1].multiply(jnp.where(last, 1.0, 0.5))

    def dot(self, a: jax.Array, b: jax.Array) -> jax.Array:
        """Return the scalar product of two fields (cases, 3, nodes...), per case."""
        terms = a * b
        if self.parts > 1:
            terms = terms.at[..., -1].multiply(self.at_last_plane())
        return self.sum_parts(jnp.sum(terms, axis=(1, 2, 3, 4)))

    def sum_parts(self, numbers: jax.Array) -> jax.Array:
        """Sum of the parts' numbers, on all."""
        return jax.lax.psum(numbers, AXIS) if self.parts > 1 else numbers

    def largest(self, number: jax.Array) -> jax.Array:
        """Return the largest of the parts' numbers, on all."""
        return jax.lax.pmax(number, AXIS) if self.parts > 1 else number

    def whole_cells(self, cells: jax.Array) -> jax.Array:
        """Return the field of all parts' cells, on all."""
        if self.parts == 1:
            return cells
        return jax.lax.all_gather(cells, AXIS, axis=cells.ndim - 1, tiled=True)

    def whole_nodes(self, nodal: jax.Array) -> jax.Array:
        """Return the field of all parts' nodes, on all."""
        if self.parts == 1:
            return nodal
        end = jax.lax.all_gather(nodal[..., -1], AXIS)[-1]
        return jnp.concatenate([self.whole_cells(nodal[..., :-1]), end[..., None]], axis=-1)

    def own_nodes(self, whole: jax.Array) -> jax.Array:
        """Return the this part of a whole field."""
        if self.parts == 1:
            return whole
        layers = (whole.shape[-1] - 1) // self.parts
        start = jax.lax.axis_index(AXIS) * layers
        return jax.lax.dynamic_slice_in_dim(whole, start, layers + 1, axis=whole.ndim - 1)

    def node_numbers(self, shape: tuple[int, ...]) -> jax.Array:
        """Return the number of every entry of a part's nodal array in the whole one, counted along memory."""
        *outer, planes = shape
        layers = planes - 1
        start = 0 if self.parts == 1 else jax.lax.axis_index(AXIS) * layers
        rows = jnp.arange(math.prod(outer)).reshape(*outer, 1)
        return rows * (layers * self.parts + 1) + start + jnp.arange(planes)

    def _from_above(self, nodal: jax.Array) -> jax.Array:
        return jax.lax.ppermute(nodal[..., 0], AXIS, [(part + 1, part) for part in range(self.parts - 1)])


WHOLE = Partition()
