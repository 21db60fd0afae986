"""Stability of a shaft that vibrates steadily in its oil films: what a small disturbance is after a cycle.

Of the steady cycle the films are linear with coefficients that repeat (Floquet). The shaft is that of
`turning_body` by all its unknowns; the loss of its material, which has no time, becomes the viscous damping
that takes as much of each free vibration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex
from cranktopo.numerics.bearing_film.in_motion import FilmSlopes
from cranktopo.numerics.harmonic_balance import DampedBody
from cranktopo.numerics.turning_body import modes_at_rest

_LATE = 0.51
"""Part of a step at which forces are equal: what jumps in a step dies, and order 12 loses a third a cycle."""


@dataclass(frozen=True)
class ShaftSteps:
    """A shaft in steps of time, forces equal late in each; its unknowns times the square roots of their mass.

    Attributes:
        scale: of the unknowns, (n,).
        late_s: time in a step at which forces are equal.
        inverse: velocities there by forces, (n, n).
        joined: motions of the journals, (n, journals).
        by_load, seen: velocities of all unknowns, and of the journals, by forces of these.
    """

    scale: Array
    step_s: float
    late_s: float
    inverse: Array
    joined: Array
    by_load: Array
    seen: Array
    _by_speed: Array
    _by_place: Array

    @classmethod
    def of(cls, body: DampedBody, speed_rad_s: float, journals: NDArray[np.intp], step_s: float) -> Self:
        """Return the steps of a body; for the arguments see `multipliers`."""
        own, late_s = body.body, _LATE * step_s
        scale = 1 / np.sqrt(np.diag(own.mass))
        still = own.stiffness - speed_rad_s**2 * (own.lateral - own.stiffening)
        through = body.viscous + 2 * speed_rad_s * own.coriolis + _viscous_loss(body)
        mass, damping, stiffness = (one * np.outer(scale, scale) for one in (own.mass, through, still))
        joined = np.zeros((len(mass), len(journals)))
        joined[journals, np.arange(len(journals))] = scale[journals]
        inverse = np.asarray(np.linalg.inv(mass / late_s + damping + late_s * stiffness), dtype=np.float64)
        by_load, by_motion = inverse @ joined, (inverse @ mass / late_s, inverse @ stiffness)
        return cls(scale, step_s, late_s, inverse, joined, by_load, joined.T @ by_load, *by_motion)

    def free(self, moved: Array, velocity: Array) -> Array:
        """Return the velocities late in a step from some motions on, without forces."""
        return np.asarray(self._by_speed @ velocity - self._by_place @ moved)

    def after(self, moved: Array, velocity: Array, late: Array) -> tuple[Array, Array]:
        """Return motions and velocities after a step, from those before it and the velocities late in it."""
        return moved + self.step_s * late, (late - (1 - _LATE) * velocity) / _LATE


def multipliers(
    body: DampedBody, speed_rad_s: float, journals: NDArray[np.intp], films: FilmSlopes, step_s: float
) -> Complex:
    """Return by what each disturbance has grown after a cycle, the largest first; above 1 one grows.

    Args:
        body: the shaft, all that holds it but the films in its stiffness.
        speed_rad_s: right-handed about z.
        journals: rows of the unknowns that are the motions of the journals, as those of the films follow.
        films: at even steps over the cycle.
    """
    steps = ShaftSteps.of(body, speed_rad_s, journals, step_s)
    joined, count = steps.joined, len(body.loss)
    moved, velocity = np.eye(count, 2 * count), np.eye(count, 2 * count, k=count)
    for place, load in zip(_late(films.by_place), _late(films.by_load), strict=True):
        free = steps.free(moved, velocity)
        led = np.eye(len(journals)) - steps.late_s * place
        force = np.linalg.solve(led @ steps.seen + load, led @ (joined.T @ free) - place @ (joined.T @ moved))
        moved, velocity = steps.after(moved, velocity, free - steps.by_load @ force)
    found: Complex = np.asarray(np.linalg.eigvals(np.vstack([moved, velocity])), dtype=complex)
    return found[np.argsort(-np.abs(found))]


def _late(blocks: Array) -> Array:
    """Return matrices over all journals at the time in every step at which forces are equal."""
    states, bearings = blocks.shape[:2]
    whole = np.zeros((states, bearings, 2, bearings, 2))
    which = np.arange(bearings)
    between = (1 - _LATE) * blocks + _LATE * np.roll(blocks, -1, axis=0)
    whole[:, which, :, which, :] = np.moveaxis(between, 1, 0)
    return whole.reshape(states, 2 * bearings, 2 * bearings)


def _viscous_loss(body: DampedBody) -> Array:
    """Return the viscous damping that takes of each free vibration at rest what the loss takes of it."""
    if not body.loss.any():
        return np.zeros_like(body.loss)
    modes = modes_at_rest(body.body)
    swinging = modes.shape[:, modes.rigid :]
    taken = (swinging * (body.loss @ swinging)).sum(axis=0) / (2 * np.pi * modes.frequency_Hz[modes.rigid :])
    across = body.body.mass @ swinging
    return np.asarray((across * taken) @ across.T)
