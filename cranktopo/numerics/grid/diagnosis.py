"""Why a solve cannot succeed, or succeeds without meaning: loads on void, missing load paths, mechanisms."""

from __future__ import annotations

from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Mask
from cranktopo.numerics.grid.boundary_conditions import BoundaryConditions
from cranktopo.numerics.grid.conjugate_gradients import System
from cranktopo.numerics.grid.multigrid import project
from cranktopo.numerics.grid.operator import strain_energy_densities
from cranktopo.numerics.grid.partition import WHOLE
from cranktopo.numerics.kept_programs import kept_program

_Across = Literal["corners", "faces"]

# Cells softer than this share of the stiffest are void, there to keep equations regular: half a percent of
# density under SIMP. An answer that rests on them has lost seven digits to rounding and means nothing.
VOID_STIFFNESS_RATIO = 1e-7


def void_energy_share(system: System, u: jax.Array) -> Array:
    """Return the share of the load's work that is strain energy of void (cases,), 0 for a case without work.

    It is the relative change of the compliance with the stiffness of the void: near 0 where material carries
    the load, near 1 where parts move through void as rigid bodies or mechanisms.
    """
    energy, work = (np.asarray(values) for values in void_energy_and_work(system, u))
    return np.asarray(np.where(work > 0, energy / np.where(work > 0, work, 1.0), 0.0))


@kept_program()
def void_energy_and_work(system: System, u: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return twice the strain energy in void cells, and the work of the loads (cases,), over the modulus."""
    moduli = system.moduli
    void = (moduli > 0) & (moduli < VOID_STIFFNESS_RATIO * jnp.max(moduli))

    def energy() -> jax.Array:
        return jnp.sum(
            strain_energy_densities(system.blocks, u) * jnp.where(void, moduli, 0.0), axis=(1, 2, 3)
        )

    work = WHOLE.dot(system.forces, u)
    return jax.lax.cond(jnp.any(void), energy, lambda: jnp.zeros_like(work)), work


def unsupported_load(system: System, threshold: float, across: _Across = "corners") -> tuple[int, str] | None:
    """Return the first load case, and what is wrong, of which some load reaches no support through material.

    Args:
        threshold: cells count as material above this share of the largest modulus.
        across: what cells must share to be joined; one that shares only an edge or a corner is a hinge.
    """
    from scipy.ndimage import label

    moduli = np.asarray(system.moduli)
    material = moduli > threshold * moduli.max()
    labels, _ = label(material, structure=np.ones((3, 3, 3)) if across == "corners" else None)
    for case, forces in enumerate(np.asarray(_free(system.supports, system.forces))):
        found = _unsupported(system.supports, case, forces, labels)
        if found:
            return case, found
    return None


_free = jax.jit(project)


def _unsupported(supports: BoundaryConditions, case: int, forces: Array, labels: NDArray[np.int32]) -> str:
    loaded = np.abs(forces).max(axis=0) > 1e-9 * np.abs(forces).max()
    held = _held_planes(supports, case, forces, loaded.shape)
    sections = [_on_plane(loaded.shape, plane) for plane in _moving_planes(supports, case)]
    alone = loaded.copy()
    for section in sections:
        alone &= ~section
    if np.any(alone & ~_touching(labels > 0)):
        return "its load, or a part of it, acts where there is no material"
    carrying = [_bodies_at(labels, section) for section in sections if np.any(loaded & section)]
    if not all(carrying):
        return "its load acts where there is no material"
    supported = _bodies_at(labels, held)
    for section in (*sections, *sections):  # what joins one section joins all bodies on it
        joined = _bodies_at(labels, section)
        supported |= joined if joined & supported else set()
    groups = [*({body} for body in _bodies_at(labels, alone)), *carrying]
    if not all(group & supported for group in groups):
        return "no material joins its load, or a part of it, to a support"
    return ""


def _touching(cells: Mask) -> Mask:
    nodes = np.zeros(tuple(n + 1 for n in cells.shape), bool)
    nx, ny, nz = cells.shape
    for i, j, k in np.ndindex(2, 2, 2):
        nodes[i : i + nx, j : j + ny, k : k + nz] |= cells
    return nodes


def _bodies_at(labels: NDArray[np.int32], nodes: Mask) -> set[int]:
    nx, ny, nz = labels.shape
    found: set[int] = set()
    for i, j, k in np.ndindex(2, 2, 2):
        found |= set(np.unique(labels[nodes[i : i + nx, j : j + ny, k : k + nz]]).tolist())
    return found - {0}


def _on_plane(shape: tuple[int, ...], plane: int) -> Mask:
    nodes = np.zeros(shape, bool)
    nodes[:, :, plane] = True
    return nodes


def _moving_planes(supports: BoundaryConditions, case: int) -> list[int]:
    basis = np.asarray(supports.basis[case])
    return [plane for plane, side in ((0, 0), (-1, 1)) if np.any(basis[:, side])]


def _held_planes(supports: BoundaryConditions, case: int, forces: Array, shape: tuple[int, ...]) -> Mask:
    """Return nodes on mirrors and sections; a section that carries the load itself does not support it."""
    held = np.zeros(shape, bool)
    held[0] = bool(np.any(np.asarray(supports.free_x0[case]) == 0))
    held[:, :, -1] |= bool(np.any(np.asarray(supports.free_z_end[case]) == 0))
    carrying = [p for p in _moving_planes(supports, case) if np.any(forces[..., p])]
    held[:, :, 0] = 0 not in carrying
    if -1 in carrying:
        held[:, :, -1] = False
    return held
