"""Many motions of a point in the plane at once, each with steps of its own: a stiff method in arrays.

RODAS3, a Rosenbrock method of order 3 with an estimate of order 2, L-stable and stiffly accurate
(A. Sandu et al., Benchmarking Stiff ODE Solvers for Atmospheric Chemistry Problems II, Atmos. Environ. 31,
1997). A library integrates one motion at a time, and Python would then be most of the work.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cranktopo.base.arrays import Array, Complex, Index

Slope = Callable[[Array, Complex, Index], Complex]
"""Velocity at times, in steps of the grid, of points, of the motions with these numbers."""

_FASTEST, _SLOWEST, _SAFE = 5.0, 0.2, 0.9
_LEAST = 1e-9
"""Least step, over one of the grid; below it rounding decides, and the step is taken as it is."""
_DIFFERENCE, _LATER = 1e-7, 1e-3
"""Distances of finite differences: in the plane, and in time over a step."""


def motions(
    slope: Slope, start: Complex, steps: int, tolerance: float, length: Array | None = None
) -> tuple[Complex, Array]:
    """Return the places of all motions at the points of a grid of times, and the length of the next steps.

    The places have shape (steps + 1, motions).

    Args:
        slope: may have kinks at the points of the grid, where every motion stops.
        tolerance: largest estimated error of a step.
        length: of the first step of each motion; by default one of the grid.
    """
    path = np.empty((steps + 1, len(start)), dtype=complex)
    path[0] = start
    place, at = np.zeros(len(start)), start.astype(complex)
    length = np.ones(len(start)) if length is None else length.copy()
    active = np.arange(len(start))
    while active.size:
        now, goal = place[active], np.floor(place[active]) + 1
        step = np.minimum(length[active], goal - now)
        moved, error = _rodas3(slope, now, at[active], step, active)
        good = (error <= tolerance) | (step <= _LEAST)
        change = np.clip(_SAFE * np.cbrt(tolerance / np.maximum(error, 1e-30)), _SLOWEST, _FASTEST)
        # A step cut short at the grid tells no limit.
        kept = np.where(good & (change >= 1), length[active], 0.0)
        length[active] = np.maximum(step * change, kept)
        ended = good & (step == goal - now)
        done = active[good]
        at[done] = moved[good]
        place[done] = np.where(ended[good], goal[good], (now + step)[good])
        there = active[ended]
        path[place[there].astype(np.intp), there] = at[there]
        active = active[place[active] < steps]
    return path, length


def _rodas3(slope: Slope, now: Array, at: Complex, step: Array, one: Index) -> tuple[Complex, Array]:
    """Return where a step of each motion ends, and the estimate of its error.

    Differences lie away from the origin, and to both sides of that: so they turn and mirror with the motion.
    """
    out = np.exp(1j * np.angle(at))
    near, side = _DIFFERENCE * out, 1j * _DIFFERENCE * out
    beside = np.concatenate([at, at + near, at + side, at - side, at])
    times = np.concatenate([now, now, now, now, now + _LATER * step])
    first, outer, left, right, later = slope(times, beside, np.concatenate([one] * 5)).reshape(5, -1)
    by_out, by_side = (outer - first) / _DIFFERENCE, (left - right) / (2 * _DIFFERENCE)
    solve = _stage(2 / step, out.conj() * (by_out - 1j * by_side) / 2, out * (by_out + 1j * by_side) / 2)
    rise = (later - first) / _LATER  # by time, times the step
    u1 = solve(first + rise / 2)
    u2 = solve(first + 4 * u1 / step + 1.5 * rise)
    near = at + 2 * u1
    u3 = solve(slope(now + step, near, one) + (u1 - u2) / step)
    near = near + u3
    u4 = solve(slope(now + step, near, one) + (u1 - u2 - 8 / 3 * u3) / step)
    return near + u4, np.abs(u4)


def _stage(own: Array, plain: Complex, conjugate: Complex) -> Callable[[Complex], Complex]:
    """Return the solver of own u - J u = right, where J u is plain u + conjugate u*: any plane Jacobian."""
    rest = own - plain
    determinant = (rest.conj() * rest).real - (conjugate.conj() * conjugate).real
    by_right, by_mirrored = rest.conj() / determinant, conjugate / determinant

    def solve(right: Complex) -> Complex:
        return np.asarray(by_right * right + by_mirrored * right.conj())

    return solve
