"""Pressure of rigid pins that touch the bores of the rod: frictionless, no clearance, even over the width.

Such pins touch in proportion to their force, so that one pressure of 1 N serves every state. It has the least
complementary energy of all that push along the rod and not across it: a quadratic programme without negative
pressures (Kalker, 1977).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import nnls

from cranktopo.base.arrays import Array
from cranktopo.base.notes import at_work

Pressure = Callable[[Array], Array]
"""Pressure over the angle from the middle of the pressed half of a bore, rad; of any size."""
_STRIPS = 12
"""Strips of a quarter of a bore."""
_MIDDLES = (np.arange(-_STRIPS, _STRIPS) + 0.5) * np.pi / 2 / _STRIPS
_WEIGHT = 1e4


def cosine(angle_rad: Array) -> Array:
    """Return the pressure of journals on oil, by convention."""
    return np.maximum(np.cos(angle_rad), 0.0)


def strips(*, alike: bool) -> list[Pressure]:
    """Return pressures whose sum is even over the pressed half, one for each strip.

    Args:
        alike: each is on the strips of both sides.
    """
    return [_over_strips(values) for values in _strips(alike)]


def _strips(alike: bool) -> Array:
    """Values of each pressure in the middles of all strips."""
    side = np.eye(_STRIPS)
    return np.hstack([side[:, ::-1], side]) if alike else np.eye(2 * _STRIPS)


def _over_strips(values: Array) -> Pressure:
    def pressure(angle_rad: Array) -> Array:
        inside = np.abs(angle_rad) <= np.pi / 2
        return np.asarray(np.interp(angle_rad, _MIDDLES, values) * inside)

    return pressure


@at_work("contact of the pins")
def touching(loads: Array, moved: Array, forces: Array) -> Pressure:
    """Return the pressure of a rigid pin on the strips of a bore, without a force across the rod.

    Args:
        loads: nodal forces of each strip, carried by the rest of the body, (unknowns, strips).
        moved: displacements under them.
        forces: along and across the rod of each strip, (2, strips).
    """
    compliance = loads.T @ moved
    root = np.linalg.cholesky((compliance + compliance.T) / 2)
    along, across = forces
    # a row that weighs more than all others keeps the sum of the forces across at zero
    weight = _WEIGHT * np.linalg.norm(root) / np.linalg.norm(along)
    rows = np.vstack([root.T, weight * across])
    values = nnls(rows, np.append(np.linalg.solve(root, along), 0.0))[0]
    return _over_strips(values @ _strips(alike=len(values) == _STRIPS))


def contact_deg(pressure: Pressure) -> float:
    """Return the angle from the middle to where a pressure ends."""
    angle = np.linspace(0.0, np.pi / 2, 361)
    return float(np.degrees(angle[pressure(angle) > 0].max()))
