"""The zero of a function between two places, for what every command computes on its way to a design.

SciPy has the same, but loading its optimisers takes a third of a second: as long as all that a plan computes.
"""

from __future__ import annotations

from collections.abc import Callable
from sys import float_info

_STEPS = 500


def root(function: Callable[[float], float], low: float, high: float, tolerance: float) -> float:
    """Return where a continuous function is zero between two places where its signs differ.

    Interpolation where it converges, else halving: R. P. Brent, Algorithms for Minimization Without
    Derivatives, 1973, chapter 4. The place is known to the tolerance or to rounding, and is SciPy's to the
    last digit.

    Raises:
        ValueError: both signs are the same.
    """
    last, best = low, high
    at_last, at_best = function(last), function(best)
    if at_last * at_best > 0:
        raise ValueError(f"no change of sign between {low!r} and {high!r}")
    if at_last == 0:
        return last
    other, at_other, step = last, at_last, best - last
    before = step
    for _ in range(_STEPS):
        if at_last != 0 and (at_last < 0) != (at_best < 0):
            other, at_other, step = last, at_last, best - last
            before = step
        if abs(at_other) < abs(at_best):
            last, best, other = best, other, best
            at_last, at_best, at_other = at_best, at_other, at_best
        least = (tolerance + 4 * float_info.epsilon * abs(best)) / 2
        half = (other - best) / 2
        if at_best == 0 or abs(half) < least:
            break
        tried = half
        if abs(before) > least and abs(at_best) < abs(at_last):
            tried = _interpolated((last, best, other), (at_last, at_best, at_other))
        safe = 2 * abs(tried) < min(abs(before), 3 * abs(half) - least)
        before, step = (step, tried) if safe else (half, half)
        last, at_last = best, at_best
        best += step if abs(step) > least else (least if half > 0 else -least)
        at_best = function(best)
    return best


def _interpolated(places: tuple[float, float, float], values: tuple[float, float, float]) -> float:
    """Return the step from the second place to where a line or an inverse parabola is zero."""
    (last, best, other), (at_last, at_best, at_other) = places, values
    if last == other:
        return -at_best * (best - last) / (at_best - at_last)
    from_last, from_other = (at_last - at_best) / (last - best), (at_other - at_best) / (other - best)
    turned = at_other * from_other - at_last * from_last
    return -at_best * turned / (from_other * from_last * (at_other - at_last))
