"""Small motions of an elastic body in the frame that turns with it about z: matrices, and free vibrations.

With a speed w, right-handed about z, constant stiffness in that frame, and unknowns q,

    M q'' + 2 w C q' + (K - w^2 (L - S)) q = 0.

C is the Coriolis force, L the centrifugal force of what moves across z, and S the stiffening by the stress of
the steady rotation: of a rigid body that tilts or turns it is what second-order displacements add.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from cranktopo.base.arrays import Array, Complex

_RIGID = 1e-10
"""Square of a frequency over that of the highest below which a motion is one of the body as a whole."""


@dataclass(frozen=True)
class TurningBody:
    """Matrices over the same unknowns, all (n, n); mm, tonne, s, rad.

    Attributes:
        lateral: mass of the motions in x and y alone.
        stiffening: S of the module, over the square of the speed.
    """

    stiffness: Array
    mass: Array
    coriolis: Array
    lateral: Array
    stiffening: Array

    @classmethod
    def of_nothing(cls, count: int) -> Self:
        """Return matrices of zeros."""
        return cls(*(np.zeros((count, count)) for _ in fields(cls)))

    def over(self, motion: Array) -> Self:
        """Return the matrices over other unknowns, whose motion of the own ones is (n, others)."""
        return type(self)(*(motion.T @ matrix @ motion for matrix in self._matrices))

    def __add__(self, other: TurningBody) -> Self:
        """Return the sum of two bodies over the same unknowns."""
        pairs = zip(self._matrices, other._matrices, strict=True)
        return type(self)(*(one + two for one, two in pairs))

    def times(self, factor: float) -> Self:
        """Return so many of the body."""
        return type(self)(*(factor * matrix for matrix in self._matrices))

    @property
    def _matrices(self) -> tuple[Array, ...]:
        return tuple(getattr(self, one.name) for one in fields(self))


def rigid_stiffening(second_moments: Array) -> Array:
    """Return how rotation stiffens a rigid body that turns about its axes (x, y, z), (3, 3).

    Args:
        second_moments: integral of the density times r r^T about a point on the axis, (3, 3).
    """
    plane = np.diag([1.0, 1.0, 0.0]) @ second_moments
    return np.asarray(np.trace(plane) * np.eye(3) - (plane + plane.T) / 2)


@dataclass(frozen=True)
class FreeModes:
    """Free vibrations of a body at rest, slowest first, in the mass orthonormal.

    Attributes:
        frequency_Hz: (modes,); 0 of the first `rigid` ones, motions of the body as a whole.
        shape: (unknowns, modes).
    """

    frequency_Hz: Array
    shape: Array
    rigid: int


def modes_at_rest(body: TurningBody) -> FreeModes:
    """Return all free vibrations of a body that does not turn."""
    from scipy.linalg import eigh

    scale = 1 / np.sqrt(np.diag(body.mass))
    squares, vectors = eigh(body.stiffness * np.outer(scale, scale), body.mass * np.outer(scale, scale))
    rigid = int((squares < _RIGID * squares[-1]).sum())
    squares[:rigid] = 0.0
    return FreeModes(np.sqrt(squares) / (2 * math.pi), scale[:, None] * vectors, rigid)


@dataclass(frozen=True)
class WhirlingModes:
    """Free vibrations at one speed, in the turning frame.

    Attributes:
        frequency_Hz: (modes,).
        shape: complex, over the unknowns of the body, (unknowns, modes).
        whirl: 1 where all motion across the axis circles right-handed about z in the turning frame, -1
            left-handed, 0 where it stays in planes, (modes,).
    """

    frequency_Hz: Array
    shape: Complex
    whirl: Array


def whirling_modes(body: TurningBody, speed_rad_s: float) -> WhirlingModes:
    """Return the free vibrations of a body that turns, slowest first; motions that creep are left out."""
    count = len(body.mass)
    inverse = np.linalg.inv(body.mass)
    held = body.stiffness - speed_rad_s**2 * (body.lateral - body.stiffening)
    state = np.zeros((2 * count, 2 * count))
    state[:count, count:] = np.eye(count)
    state[count:, :count] = -inverse @ held
    state[count:, count:] = -2 * speed_rad_s * inverse @ body.coriolis
    values, vectors = np.linalg.eig(state)
    swinging = np.flatnonzero(values.imag > 1e-6 * np.abs(values).max())
    chosen = swinging[np.argsort(values.imag[swinging], kind="stable")]
    shape: Complex = np.asarray(vectors[:count, chosen], dtype=complex)
    shape = np.asarray(shape / np.sqrt(_quadratic(body.mass, shape).real))
    across, turning = _quadratic(body.lateral, shape).real, _quadratic(body.coriolis, shape).imag
    whirl = np.divide(turning, across, out=np.zeros_like(across), where=across > 0)
    return WhirlingModes(values.imag[chosen] / (2 * math.pi), shape, whirl)


def _quadratic(matrix: Array, shape: Complex) -> Complex:
    """Return s* A s of every column s of shapes, (modes,)."""
    return np.asarray((shape.conj() * (matrix @ shape)).sum(axis=0))
