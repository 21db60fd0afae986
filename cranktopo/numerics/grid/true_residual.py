"""The residual where rounding hides it: a body that moves much further than it bends.

The product of the stiffness with displacements is rounded in proportion to the displacements; forces follow
from their differences. Where soft parts or soft supports let stiff ones travel, that rounding is as large as
the residual of a good solution. Here every cell is seen from one of its own corners, so that only what its
corners differ by is rounded.
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.numerics.grid.boundary_conditions import add_section, section_coordinates
from cranktopo.numerics.grid.conjugate_gradients import CgResult, System
from cranktopo.numerics.grid.lattice import CORNERS, parity_sum_of
from cranktopo.numerics.grid.multigrid import project
from cranktopo.numerics.grid.operator import stiffness_diagonal
from cranktopo.numerics.grid.slab_product import add_slabs
from cranktopo.numerics.kept_programs import kept_program

# Where the bound of rounding is above this share of a residual, it is measured again. What rounding adds is
# 0.22 to 0.3 of its bound, and adds like a hypotenuse: below, it makes up 2 % at most.
_CLEAR = 0.7
_SIGNS = np.prod(np.where(CORNERS[None] == 1, 2 * CORNERS[:, None] - 1, 1), axis=2).astype(float)
"""Sign of every corner in every sum over a cell: (corners, sums)."""


def measured_again(system: System, result: CgResult) -> CgResult:
    """Return the result with residuals that rounding does not hide; the same where it hides none."""
    recursive = result.relative_residual
    if not np.any(np.asarray(rounding(system, result.displacements)) > _CLEAR * np.asarray(recursive)):
        return result
    return result._replace(relative_residual=fine_residual(system, result.displacements))


@kept_program()
def rounding(system: System, u: jax.Array) -> jax.Array:
    """Return what rounding of every displacement leaves out of balance, over the loads (cases,).

    No displacements in float64 have a much smaller residual, however they are found.
    """
    diagonal = stiffness_diagonal(system.blocks, system.moduli)
    free = project(system.supports, system.forces)
    return float(np.finfo(np.float64).eps) * _norm(diagonal * jnp.abs(u)) / _loads(free)


@jax.jit
def fine_residual(system: System, u: jax.Array) -> jax.Array:
    """Return the relative residuals (cases,) from the differences of displacements within each cell."""
    supports = system.supports
    springs = jnp.einsum("bmn,bn->bm", supports.springs, section_coordinates(supports, u))
    inner = add_section(supports, _product(system, u), springs)
    return _norm(project(supports, system.forces - inner)) / _loads(project(supports, system.forces))


def _product(system: System, u: jax.Array) -> jax.Array:
    def part(start: int | jax.Array, depth: int) -> jax.Array:
        moduli = jax.lax.dynamic_slice_in_dim(system.moduli, start, depth)
        return _forces_of_slab(
            system.blocks, moduli, jax.lax.dynamic_slice_in_dim(u, start, depth + 1, axis=2)
        )

    return add_slabs(jnp.zeros_like(u), system.moduli.shape[0], part, axis=2)


def _forces_of_slab(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """Return the nodal forces of a slab; rigid translations cancel before anything is added."""
    corners = [_at_corner(field, corner) for corner in CORNERS]
    moved = jnp.stack([corner - corners[0] for corner in corners])
    sums = jnp.einsum("aw,abcxyz->wcbxyz", _SIGNS, moved)
    forces = jnp.zeros_like(sums)
    for p, c in np.ndindex(8, 3):
        of_class = sum(blocks[p, c, d] * sums[parity_sum_of(p, d), d] for d in range(3))
        forces = forces.at[parity_sum_of(p, c), c].set(moduli * of_class)
    at_corners = jnp.einsum("aw,wcbxyz->abcxyz", _SIGNS, forces)
    return sum(
        (_from_corner(part, corner) for part, corner in zip(at_corners, CORNERS, strict=True)),
        start=jnp.zeros_like(field),
    )


def _at_corner(field: jax.Array, corner: np.ndarray) -> jax.Array:
    for axis, step in enumerate(corner):
        count = field.shape[2 + axis] - 1
        field = jax.lax.slice_in_dim(field, int(step), int(step) + count, axis=2 + axis)
    return field


def _from_corner(cells: jax.Array, corner: np.ndarray) -> jax.Array:
    return jnp.pad(cells, ((0, 0), (0, 0), *((int(step), 1 - int(step)) for step in corner)))


def _norm(field: jax.Array) -> jax.Array:
    return jnp.sqrt(jnp.sum(field * field, axis=(1, 2, 3, 4)))


def _loads(free: jax.Array) -> jax.Array:
    norm = _norm(free)
    return jnp.where(norm > 0, norm, 1.0)
