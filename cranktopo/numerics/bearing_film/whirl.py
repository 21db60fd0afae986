"""Stability of a shaft that vibrates steadily in its oil films: what a small disturbance is after a cycle.

Of the steady cycle the films are linear with coefficients that repeat (Floquet). The shaft is that of
`turning_body` by all its unknowns; the loss of its material, which has no time, becomes the viscous damping
that takes as much of each free vibration.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex
from cranktopo.numerics.bearing_film.in_motion import FilmSlopes
from cranktopo.numerics.harmonic_balance import DampedBody
from cranktopo.numerics.turning_body import modes_at_rest

_LATE = 0.51
"""Part of a step at which forces are equal: what jumps in a step dies, and order 12 loses a third a cycle."""


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
    own = body.body
    scale = 1 / np.sqrt(np.diag(own.mass))
    still = own.stiffness - speed_rad_s**2 * (own.lateral - own.stiffening)
    through = body.viscous + 2 * speed_rad_s * own.coriolis + viscous_loss(body)
    mass, damping, stiffness = (one * np.outer(scale, scale) for one in (own.mass, through, still))
    joined = np.zeros((len(mass), len(journals)))
    joined[journals, np.arange(len(journals))] = scale[journals]
    late_s = _LATE * step_s
    inverse = np.linalg.inv(mass / late_s + damping + late_s * stiffness)
    by_speed, by_place, by_load = inverse @ mass / late_s, inverse @ stiffness, inverse @ joined
    seen = joined.T @ by_load
    moved = np.eye(len(mass), 2 * len(mass))
    velocity = np.eye(len(mass), 2 * len(mass), k=len(mass))
    for place, load in zip(_late(films.by_place), _late(films.by_load), strict=True):
        free = by_speed @ velocity - by_place @ moved
        led = np.eye(len(journals)) - late_s * place
        force = np.linalg.solve(led @ seen + load, led @ (joined.T @ free) - place @ (joined.T @ moved))
        now = free - by_load @ force
        moved, velocity = moved + step_s * now, (now - (1 - _LATE) * velocity) / _LATE
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


def viscous_loss(body: DampedBody) -> Array:
    """Return the viscous damping that takes of each free vibration at rest what the loss takes of it."""
    if not body.loss.any():
        return np.zeros_like(body.loss)
    modes = modes_at_rest(body.body)
    swinging = modes.shape[:, modes.rigid :]
    taken = (swinging * (body.loss @ swinging)).sum(axis=0) / (2 * np.pi * modes.frequency_Hz[modes.rigid :])
    across = body.body.mass @ swinging
    return np.asarray((across * taken) @ across.T)
