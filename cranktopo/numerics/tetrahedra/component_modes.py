"""Fields by which an elastic body with a few moved sections vibrates: static ones, and steps beyond them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.turning_body import TurningBody

_DEPENDENT = 1e-7
"""Share of a field's length below which it adds nothing to those before it."""


def inertial_fields(
    solve: Callable[[Array], Array], mass: sp.csr_matrix, start: Array, steps: int
) -> list[Array]:
    """Return what the inertia of fields adds to them, step by step, with the moved sections held.

    Each step is the displacement under the inertia forces of the one before (block Krylov subspace; R. R.
    Craig, A. L. Hale, J. Guidance 11, 1988, 562-570). Fields are orthonormal in the mass.

    Args:
        solve: from nodal forces (unknowns, k) to displacements of the held body.
        mass: of the nodes, tonne.
        start: static fields of the motions of the sections, (unknowns, m).
    """
    found: list[Array] = []
    before = start
    for _ in range(steps):
        before = _orthonormal(solve(weighted(mass, before)), mass, found)
        found.append(before)
    return found


def weighted(mass: sp.csr_matrix, fields: Array) -> Array:
    """Return the mass of the nodes times fields (unknowns, k)."""
    return np.asarray((mass @ fields.reshape(mass.shape[0], -1)).reshape(fields.shape))


def _orthonormal(fields: Array, mass: sp.csr_matrix, others: list[Array]) -> Array:
    """Return an orthonormal basis of what fields have beyond others; fields without any are left out."""
    lengths = np.sqrt(np.einsum("nk,nk->k", fields, weighted(mass, fields)))
    fields = fields / lengths
    for _ in range(2):  # twice, against rounding
        for other in others:
            fields = fields - other @ (other.T @ weighted(mass, fields))
    sizes, axes = np.linalg.eigh(fields.T @ weighted(mass, fields))
    kept = sizes > _DEPENDENT**2
    return np.asarray(fields @ (axes[:, kept] / np.sqrt(sizes[kept])))


def reduced(model: Elasticity, mass: sp.csr_matrix, fields: Array) -> TurningBody:
    """Return the matrices of a body over fields (unknowns, k), without what its own stress stiffens."""
    x, y, z = (fields[axis::3] for axis in range(3))
    heavy = [mass @ part for part in (x, y, z)]
    across = x.T @ heavy[0] + y.T @ heavy[1]
    return TurningBody(
        stiffness=fields.T @ (model.stiffness @ fields),
        mass=across + z.T @ heavy[2],
        coriolis=y.T @ heavy[0] - x.T @ heavy[1],
        lateral=across,
        stiffening=np.zeros_like(across),
    )
