"""Stress histories of one point for tests, as sinusoids whose planes are known without any search."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array


def turns(step_deg: float = 1.0) -> Array:
    return np.radians(np.arange(0.0, 360.0, step_deg))


def sinusoid(phasors: Sequence[complex], mean: Sequence[float] = (0.0,) * 6, step_deg: float = 1.0) -> Array:
    """One point whose six components (xx, yy, zz, xy, yz, zx) are sinusoids, shape (1, states, 6)."""
    wave = np.real(np.exp(1j * turns(step_deg))[:, None] * np.asarray(phasors))
    return np.asarray((wave + np.asarray(mean))[None])


def bending_torsion(normal: float, shear: float, lag_deg: float = 0.0, step_deg: float = 1.0) -> Array:
    lag = np.exp(-1j * np.radians(lag_deg))
    return sinusoid([normal, 0, 0, shear * lag, 0, 0], step_deg=step_deg)


def tensor(six: Array) -> Array:
    """Components (..., 6) as symmetric matrices (..., 3, 3)."""
    return np.asarray(six[..., [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(*six.shape[:-1], 3, 3))


def rotated(history: Array, turn: Array) -> Array:
    matrix = turn @ tensor(history) @ turn.T
    return np.asarray(matrix[..., (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)])


def random_turn(rng: np.random.Generator) -> Array:
    return np.asarray(np.linalg.qr(rng.normal(size=(3, 3)))[0])


def findley_by_phasors(phasors: Sequence[complex], mean: Sequence[float], k: float, normals: Array) -> Array:
    """tau_a + k sigma_n of a sinusoid on each plane: the shear stress runs on an ellipse of known axes."""
    swing, middle = tensor(np.asarray(phasors)), tensor(np.asarray(mean))
    traction = normals @ swing
    normal = np.einsum("pi,pi->p", traction, normals)
    shear = traction - normal[:, None] * normals
    power = (np.abs(shear) ** 2).sum(axis=1)
    axis = np.sqrt((power + np.abs((shear**2).sum(axis=1))) / 2)
    largest = np.abs(normal) + np.einsum("pi,ij,pj->p", normals, middle, normals)
    return np.asarray(axis + k * largest)


def every_plane(step_deg: float) -> Array:
    """Normals over a half sphere at even angles, (planes, 3)."""
    around = np.radians(np.arange(0.0, 360.0, step_deg))
    up = np.radians(np.arange(0.0, 90.0 + step_deg / 2, step_deg))
    a, u = np.meshgrid(around, up)
    found = np.stack([np.cos(a) * np.sin(u), np.sin(a) * np.sin(u), np.cos(u)], axis=-1)
    return np.asarray(found.reshape(-1, 3))
