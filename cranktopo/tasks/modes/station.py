"""Pieces of the shaft as rigid bodies: what a piece does in a mode, and how rotation stiffens it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.component_modes import weighted
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RZ, UX, UY, UZ, body_motions
from cranktopo.numerics.turning_body import TurningBody, rigid_stiffening
from cranktopo.tasks.throw_fea.condense import Lateral

RIGID_OF: dict[Lateral, tuple[int, ...]] = {"even": (1, 2, 3), "odd": (0, 4, 5), "none": tuple(range(6))}
"""Rigid motions that have a lateral symmetry."""


@dataclass(frozen=True)
class Station:
    """A piece of the shaft by the rigid motion that is nearest to its own.

    Attributes:
        z_mm: its place along the crank axis.
        motion: displacement of that place and rotation about it by unknowns, (6, unknowns).
        inertia: over these, (6, 6), tonne, mm.
        part: name of what it belongs to: "throw 2", "output end", "flywheel".
    """

    z_mm: float
    motion: Array
    inertia: Array
    part: str = ""


@dataclass(frozen=True)
class PointMass:
    """A mass at a place (x, y, z), tonne, mm, with more inertia about an axis along z.

    Attributes:
        slides: it does not follow along z, as a rod on its pin.
    """

    mass: float
    place_mm: tuple[float, float, float]
    polar: float = 0.0
    slides: bool = False


@dataclass(frozen=True)
class MassPiece:
    """A piece of a model about the middle of its mass, with what is fastened to it.

    Attributes:
        inertia: over its six rigid motions, (6, 6).
        second_moments: of mass, (3, 3).
    """

    z_mm: float
    mass: sp.csr_matrix
    rigid: Array
    own: Array
    inertia: Array
    second_moments: Array
    parts: int


def piece_of(nodes_mm: Array, mass: sp.csr_matrix, parts: int, fastened: list[PointMass]) -> MassPiece:
    """Return a piece of a model, `parts` times as heavy as its half x >= 0 where that is 2."""
    total = mass.sum()
    z = float((mass @ nodes_mm[2]).sum() / total)
    places = (nodes_mm - np.array([[0.0], [0.0], [z]])).T
    rigid = body_motions(places.T)
    own, second = parts * rigid.T @ weighted(mass, rigid), parts * places.T @ (mass @ places)
    if parts == 2:
        even = np.isin(np.arange(6), RIGID_OF["even"])
        own[even[:, None] != even] = 0.0
        second[0, 1:] = second[1:, 0] = 0.0
    inertia = own.copy()
    for point in fastened:
        place = np.array(point.place_mm) - [0.0, 0.0, z]
        at = body_motions(place[:, None])[: UZ if point.slides else RX]
        inertia += point.mass * at.T @ at
        inertia[RZ, RZ] += point.polar
        second += point.mass * np.outer(place, place) + point.polar / 2 * np.diag([1.0, 1.0, 0.0])
    return MassPiece(z, mass, rigid, own, inertia, second, parts)


def rigid_share(piece: MassPiece, fields: Array, lateral: Lateral) -> Array:
    """Return the rigid motion of a piece that is nearest to fields of a symmetry, (6, fields)."""
    forces = piece.parts * piece.rigid.T @ weighted(piece.mass, fields)
    chosen = list(RIGID_OF[lateral])
    found = np.zeros_like(forces)
    found[chosen] = np.linalg.solve(piece.own[np.ix_(chosen, chosen)], forces[chosen])
    return found


def stiffened(motion: Array, second_moments: Array) -> TurningBody:
    """Return what the rotation stiffens in a piece of that motion."""
    turn = motion[RX:]
    return added(motion.shape[1], stiffening=turn.T @ rigid_stiffening(second_moments) @ turn)


def added(count: int, **matrices: Array) -> TurningBody:
    """Return a body that has some matrices alone."""
    return replace(TurningBody.of_nothing(count), **matrices)


def point_mass(mass: float, motion: Array) -> TurningBody:
    """Return a mass that moves as (x, y) or (x, y, z) of the rows of a motion, tonne."""
    x, y = motion[UX], motion[UY]
    across = mass * (np.outer(x, x) + np.outer(y, y))
    turning = mass * (np.outer(y, x) - np.outer(x, y))
    along = sum((mass * np.outer(row, row) for row in motion[UZ:]), np.zeros_like(across))
    return added(len(x), mass=across + along, lateral=across, coriolis=turning)
