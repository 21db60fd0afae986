"""What displacements prove about every web: its compliances are not below a linear function of its densities.

For a web with the stiffness K the compliance is the largest value of 2 l(v) - v' K v over all admissible
displacements v, so any v gives a lower bound, whether it solves anything or not. K is linear in the
densities.
"""

from __future__ import annotations

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.grid.boundary_conditions import section_coordinates
from cranktopo.numerics.grid.lattice import layer_blocks
from cranktopo.numerics.grid.operator import strain_energy_densities
from cranktopo.tasks.bound.webs import AdmissibleDensities
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.model import ThrowModel

ROUNDING = 128 * float(np.finfo(np.float64).eps)
"""Above the rounding, over the sum of the terms' sizes, of an energy from the displacements of eight corners,
of a pairwise sum of up to 1e9 terms, and of displacements on a rigid section."""


@dataclass(frozen=True)
class Energies:
    """Of every web with densities rho: compliances >= constant - sum of gains * rho.

    Attributes:
        constant: (cases,), N mm.
        gains: energies of full cells (cases, nx, ny, nw), N mm; not negative.
    """

    constant: Array
    gains: Array


def energies(model: ThrowModel, webs: AdmissibleDensities, u: jax.Array) -> Energies:
    """What displacements (cases, 3, nodes...), mm, prove; rounding is on the safe side.

    Args:
        u: within the supports, as every solve leaves them.
    """
    blocks = layer_blocks(model.lattice)
    factor = model.modulus_MPa / model.share
    cells = factor * (
        np.asarray(strain_energy_densities(jnp.asarray(blocks), u))
        + ROUNDING * np.asarray(_sizes(jnp.asarray(np.abs(blocks).sum(axis=0)), u))
    )
    web = cells[..., webs.layers] * webs.design
    soft = webs.fixed * cells
    works = factor * np.asarray(model.forces) * np.asarray(u)
    springs = factor * _spring_energies(model, u)
    sides = (1, 2, 3)
    parts = np.stack([soft.sum(axis=sides), CONTRAST * web.sum(axis=sides), springs])
    sizes = 2 * np.abs(works).sum(axis=(1, 2, 3, 4)) + np.abs(parts).sum(axis=0)
    constant = 2 * works.sum(axis=(1, 2, 3, 4)) - parts.sum(axis=0) - ROUNDING * sizes
    return Energies(constant, (1 - CONTRAST) * web)


def _spring_energies(model: ThrowModel, u: jax.Array) -> Array:
    at = np.asarray(_at_sections(model.supports, u))
    return np.asarray(np.einsum("bm,bmn,bn->b", at, np.asarray(model.supports.springs), at))


@jax.jit
def _sizes(blocks: jax.Array, u: jax.Array) -> jax.Array:
    """Sum of the sizes of all terms in the energy of each cell (cases, nx, ny, nz)."""

    def of_case(v: jax.Array) -> jax.Array:
        corners = jnp.abs(v)
        for axis in range(1, 4):
            size = corners.shape[axis]
            near = jax.lax.slice_in_dim(corners, 0, size - 1, axis=axis)
            corners = near + jax.lax.slice_in_dim(corners, 1, size, axis=axis)
        return jnp.einsum("cxyz,cdz,dxyz->xyz", corners, blocks, corners)

    sizes: jax.Array = jax.lax.map(of_case, u)
    return sizes


_at_sections = jax.jit(section_coordinates)
