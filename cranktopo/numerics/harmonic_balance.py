"""Steady vibration of turning bodies under forces that repeat: one linear problem for each harmonic.

In the frame that turns with the shaft at the speed w, right-handed about z, harmonic amplitudes q of
exp(i f t) answer the amplitudes p of the forces by

    (K (1 + i g) - w^2 (L - S) - f^2 M + i f (2 w C + D)) q = p,

matrices as of `turning_body`, g loss factors of the material, D viscous damping in the turning frame. A body
is joined to others by its first unknowns; the others are eliminated, harmonic by harmonic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.numerics.turning_body import TurningBody


@dataclass(frozen=True)
class DampedBody:
    """A turning body and what damps it, over the same unknowns.

    Attributes:
        loss: imaginary part of its stiffness in a harmonic vibration, (n, n).
        viscous: force over velocity in the turning frame, (n, n).
    """

    body: TurningBody
    loss: Array
    viscous: Array

    def dynamic_stiffness(self, frequency_rad_s: Array, speed_rad_s: float) -> Complex:
        """Return forces over displacements at frequencies, (frequencies, n, n); nothing is lost at 0."""
        at, body = np.asarray(frequency_rad_s)[:, None, None], self.body
        still = body.stiffness - speed_rad_s**2 * (body.lateral - body.stiffening)
        through = 2 * speed_rad_s * body.coriolis + self.viscous
        return np.asarray(still - at**2 * body.mass + 1j * (at * through + (at > 0) * self.loss))


def damping_work(frequency_rad_s: Array, motion: Complex, loss: Array, viscous: Array) -> float:
    """Return the work that damping takes over the period of the slowest of all harmonics, N mm.

    Args:
        frequency_rad_s: of the harmonics: 0, and multiples of the slowest in their order.
        motion: their amplitudes as of `harmonics_of`, (n, frequencies).
    """
    lost = _quadratic(loss, motion) + frequency_rad_s * _quadratic(viscous, motion)
    return float(4 * np.pi * (np.arange(len(lost)) * (frequency_rad_s > 0) * lost).sum())


def _quadratic(matrix: Array, motion: Complex) -> Array:
    return np.asarray((motion.conj() * (matrix @ motion)).real.sum(axis=0))


@dataclass(frozen=True)
class CondensedBody:
    """A body over the m unknowns by which it is joined to others, at each of some frequencies.

    Attributes:
        stiffness: dynamic stiffness over these, (frequencies, m, m).
        loads: forces there that do what its unit loads do, (frequencies, m, loads).
        by_motion, by_load: the other unknowns by those motions and by unit loads, (frequencies, others, .).
    """

    stiffness: Complex
    loads: Complex
    by_motion: Complex
    by_load: Complex


def condensed(dynamic: Complex, loads: Array, joined: int) -> CondensedBody:
    """Eliminate all but the first `joined` unknowns of a dynamic stiffness, (frequencies, n, n).

    An unknown that nothing resists, as a ring in a fluid at frequency 0, stays where it is.

    Args:
        loads: unit loads over all unknowns, (n, loads).
    """
    inner, across = dynamic[:, joined:, joined:].copy(), dynamic[:, joined:, :joined]
    frequency, loose = np.nonzero(~inner.any(axis=2))
    inner[frequency, loose, loose] = 1.0
    own = np.broadcast_to(loads[joined:], (len(dynamic), *loads[joined:].shape))
    found = np.linalg.solve(inner, np.concatenate([across, own], axis=2))
    by_motion: Complex = np.asarray(-found[:, :, :joined], dtype=complex)
    by_load: Complex = np.asarray(found[:, :, joined:], dtype=complex)
    lever = dynamic[:, :joined, joined:]
    return CondensedBody(
        np.asarray(dynamic[:, :joined, :joined] + lever @ by_motion),
        np.asarray(loads[:joined] - lever @ by_load),
        by_motion,
        by_load,
    )


def harmonics_of(curves: Array) -> Complex:
    """Return the amplitudes of curves over a cycle, (..., states), from the mean on, (..., harmonics).

    A curve is the mean and twice the real part of the sum of all others; `curves_of` turns them back.
    """
    return np.asarray(np.fft.rfft(curves, axis=-1) / curves.shape[-1])


def curves_of(amplitudes: Complex, states: int) -> Array:
    """Return the curves over a cycle, (..., states), of amplitudes as of `harmonics_of`."""
    return np.asarray(np.fft.irfft(amplitudes * states, n=states, axis=-1))
