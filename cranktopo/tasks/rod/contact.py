"""Pressure of rigid pins that touch the bores of the rod: frictionless, no clearance, even over the width.

Such pins touch in proportion to their force, so that one pressure of 1 N serves every state. It has the least
complementary energy of all that push: a quadratic programme without negative pressures (Kalker, 1977).
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
_MIDDLES = (np.arange(_STRIPS) + 0.5) * np.pi / 2 / _STRIPS


def cosine(angle_rad: Array) -> Array:
    """Return the pressure of journals on oil, by convention."""
    return np.maximum(np.cos(angle_rad), 0.0)


def strips() -> list[Pressure]:
    """Return pressures whose sum is even over the pressed half, one for each strip."""
    return [_over_strips(row) for row in np.eye(_STRIPS)]


def _over_strips(values: Array) -> Pressure:
    def pressure(angle_rad: Array) -> Array:
        inside = angle_rad <= np.pi / 2
        return np.asarray(np.interp(angle_rad, _MIDDLES, values) * inside)

    return pressure


@at_work("contact of the pins")
def touching(loads: Array, moved: Array, forces: Array) -> Pressure:
    """Return the pressure of a rigid pin on the strips of a bore.

    Args:
        loads: nodal forces of each strip, carried by the rest of the body, (unknowns, strips).
        moved: displacements under them.
        forces: along the rod of each strip.
    """
    compliance = loads.T @ moved
    root = np.linalg.cholesky((compliance + compliance.T) / 2)
    return _over_strips(nnls(root.T, np.linalg.solve(root, forces))[0])


def contact_deg(pressure: Pressure) -> float:
    """Return the angle from the middle to where a pressure ends."""
    angle = np.linspace(0.0, np.pi / 2, 361)
    return float(np.degrees(angle[pressure(angle) > 0].max()))
