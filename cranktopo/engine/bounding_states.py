"""Few states of a cycle between which every sum of its loads ranges nearly as over all of them."""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array, Index

SHORTFALL = 0.01
"""Part of its range over the cycle that a sum of loads may lack over the states that are kept."""
_DIRECTIONS = 2000
"""Sums that are looked at, spread evenly; between two of them a sum may lack up to 0.5 % more."""
_FLAT = 1e-9
"""Spread of loads, over the largest one, below which they are sums of the others."""
_TINY = float(np.finfo(float).tiny)


def bounding_states(loads: Array) -> Index:
    """Return the numbers of the states (states, loads) over which no sum of up to three loads lacks more.

    The sum that lacks most has both of its ends added, until none lacks more than `SHORTFALL`.
    """
    even = _even(loads)
    sums = even @ _directions(even.shape[1])  # (states, directions)
    whole, ends = np.ptp(sums, axis=0), np.stack([sums.argmin(axis=0), sums.argmax(axis=0)])
    low, high = np.full_like(whole, np.inf), np.full_like(whole, -np.inf)
    kept = {0}
    lacks = np.where(whole > 0, 1.0, 0.0)
    while (lacks > SHORTFALL).any():
        for state in map(int, ends[:, int(lacks.argmax())]):
            kept.add(state)
            low, high = np.minimum(low, sums[state]), np.maximum(high, sums[state])
        lacks = np.where(whole > 0, 1 - (high - low) / np.maximum(whole, _TINY), 0.0)
    return np.array(sorted(kept))


def _even(loads: Array) -> Array:
    """Return the loads in axes along which all vary alike, without those along which they do not vary."""
    spread = np.ptp(loads, axis=0)
    scaled = (loads - loads.mean(axis=0)) / np.where(spread > 0, spread, 1.0)
    axes, sizes, _ = np.linalg.svd(scaled, full_matrices=False)
    return np.asarray(axes[:, sizes > _FLAT * max(float(sizes[0]), _TINY)])


def _directions(count: int) -> Array:
    """Return unit vectors in space, a plane or a line, (count, directions); of opposite ones one each."""
    number = np.arange(_DIRECTIONS) + 0.5
    up, turn = number / _DIRECTIONS, number * math.pi * (3 - math.sqrt(5))
    flat = np.sqrt(1 - up**2)
    found = np.stack([flat * np.cos(turn), flat * np.sin(turn), up])[:count]
    return np.asarray(found / np.maximum(np.linalg.norm(found, axis=0), _TINY))
