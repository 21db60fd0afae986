"""Why a solve cannot succeed: loads on nothing and loads that no material carries to a support."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.fem.conjugate_gradients import System
from cranktopo.fem.supports import Supports

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def unsupported_load(system: System, threshold: float) -> tuple[int, str] | None:
    """The first load case whose load does not reach a support through the material.

    Args:
        system: the equations.
        threshold: cells count as material above this share of the largest modulus.

    Returns:
        Index of the case and what is wrong, or None when every load reaches a held plane.
    """
    from scipy.ndimage import label

    moduli = np.asarray(system.moduli)
    material = moduli > threshold * moduli.max()
    labels, _ = label(material, structure=np.ones((3, 3, 3)))
    for case, forces in enumerate(np.asarray(system.forces)):
        loaded = np.abs(forces).max(axis=0) > 1e-9 * np.abs(forces).max()
        if not np.any(forces):
            continue
        bodies = _bodies_at(labels, loaded)
        if not bodies:
            return case, "its load acts where there is no material"
        held = _held_planes(system.supports, case, forces, loaded.shape)
        if not bodies & _bodies_at(labels, held):
            return case, "no material joins its load to a support"
    return None


def _bodies_at(labels: NDArray[np.int32], nodes: Mask) -> set[int]:
    """Labels of the bodies that have a cell at one of the nodes."""
    nx, ny, nz = labels.shape
    found: set[int] = set()
    for i in (0, 1):
        for j in (0, 1):
            for k in (0, 1):
                found |= set(np.unique(labels[nodes[i : i + nx, j : j + ny, k : k + nz]]).tolist())
    return found - {0}


def _held_planes(supports: Supports, case: int, forces: Array, shape: tuple[int, ...]) -> Mask:
    """Nodes on mirrors and sections; a section that carries the load itself does not support it."""
    held = np.zeros(shape, bool)
    held[0] = bool(np.any(np.asarray(supports.free_x0[case]) == 0))
    held[:, :, -1] |= bool(np.any(np.asarray(supports.free_z_end[case]) == 0))
    basis = np.asarray(supports.basis[case])
    for plane, side in ((0, 0), (-1, 1)):
        moves = bool(np.any(basis[:, side]))
        carries = moves and bool(np.any(forces[..., plane]))
        if plane == 0:
            held[:, :, 0] = not carries
        elif carries:
            held[:, :, -1] = False
    return held
