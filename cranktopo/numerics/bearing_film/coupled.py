"""Journals of one shaft in their oil films: how each lies in its bearing decides what the others carry.

The shaft follows the films without mass: at every moment forces of films and of the bent shaft are equal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import solver_error
from cranktopo.numerics.bearing_film.orbit import LEAST_SHARE, Films, JournalBearing

_TOLERANCE = 1e-6
"""Of the eccentricities, a step."""
_CYCLES = 40
_SAME = 1e-3
"""Part of the least film by which it may differ from that of the cycle before."""
_CLOSED = 1e-3
"""Distance, over the clearance, of begin and end of a cycle."""
_TURNING = 0.5
"""Mean angular speed of journal and bearing over that of the shaft."""


def coupled_orbits(
    bearings: Sequence[JournalBearing],
    speed_rad_s: float,
    load_N: Callable[[float, Complex], Complex],
    angle_deg: Array,
) -> Complex:
    """Return the eccentricities over the radial clearance in the steady cycle, (states, bearings).

    Args:
        load_N: of each journal at an angle of the shaft, rad, and eccentricities; toward where the journal
            moves, in a frame that stands still, where the shaft turns from the real to the imaginary axis.
        angle_deg: even steps over one cycle of the shaft, from 0, the end left out.

    Raises:
        CranktopoError: a cycle that does not become steady.
    """
    from scipy.integrate import solve_ivp

    count, step = len(bearings), math.radians(angle_deg[1] - angle_deg[0])
    films = Films.of(bearings, np.full(count, speed_rad_s))
    which = np.arange(count)

    def slope(angle_rad: float, place: Array) -> Array:
        eccentricity = place[:count] + 1j * place[count:]
        load = load_N(angle_rad, eccentricity)
        change = films.squeeze(eccentricity, load, which) + 1j * _TURNING * eccentricity
        return np.concatenate([change.real, change.imag])

    at, least = np.r_[np.full(count, 0.5), np.zeros(count)], np.inf
    angles = step * np.arange(len(angle_deg) + 1)
    for _ in range(_CYCLES):
        steps = {"max_step": step, "rtol": _TOLERANCE, "atol": _TOLERANCE}
        found = solve_ivp(slope, (0.0, angles[-1]), at, method="LSODA", t_eval=angles, **steps)
        if not found.success:
            raise solver_error(f"oil film: {found.message}", "Take rigid bearings, or a larger clearance.")
        path = found.y[:count].T + 1j * found.y[count:].T
        before, least = least, np.maximum(1 - np.abs(path).max(axis=0), LEAST_SHARE)
        at = found.y[:, -1]
        if (np.abs(least - before) <= _SAME * least).all() and (np.abs(path[0] - path[-1]) < _CLOSED).all():
            return path[:-1]
    raise solver_error(
        f"oil film: the journals of the shaft are not steady after {_CYCLES} cycles.",
        "Check loads, clearance and viscosity, or take rigid bearings.",
    )
