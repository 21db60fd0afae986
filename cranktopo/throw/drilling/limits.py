"""Values of a drilling's keys that its checks accept, as a refusal tells them."""

from __future__ import annotations

import math
from collections.abc import Callable

Accepts = Callable[[str, float], bool]
"""Tells whether a drilling passes all its checks with another value of a key, such as `to.place_mm`."""
_STEPS, _HALVINGS = 16, 10
"""Of the search for a limit below a refused value: apart, then between two of them."""
_DIGITS = 4


def largest_accepted(accepts: Accepts, key: str, refused: float) -> float | None:
    """Return the largest value below a refused one that is accepted, in four digits; None where none is.

    Other checks may refuse smaller values, too, so that the accepted ones need not reach down to 0.
    """
    return _nearest_accepted(accepts, key, refused, -1)


def least_accepted(accepts: Accepts, key: str, refused: float) -> float | None:
    """Return the least value above a refused one that is accepted, as above, up to twice the refused one."""
    return _nearest_accepted(accepts, key, refused, 1)


def _nearest_accepted(accepts: Accepts, key: str, refused: float, way: int) -> float | None:
    for step in range(1, _STEPS + 1):
        found, beside = (refused * (1 + way * k / _STEPS) for k in (step, step - 1))
        if accepts(key, found):
            break
    else:
        return None
    for _ in range(_HALVINGS):
        middle = (found + beside) / 2
        found, beside = (middle, beside) if accepts(key, middle) else (found, middle)
    rounded = rounded_down if way < 0 else rounded_up
    printed = rounded(found), rounded((1 + way * 0.001) * found)
    return next((value for value in printed if accepts(key, value)), None)


def rounded_down(value: float) -> float:
    """Return a positive value in four digits, to the side of less."""
    return _rounded(value, math.floor)


def rounded_up(value: float) -> float:
    """Return a positive value in four digits, to the side of more."""
    return _rounded(value, math.ceil)


def _rounded(value: float, to_whole: Callable[[float], int]) -> float:
    if value <= 0:
        return value
    places = _DIGITS - 1 - math.floor(math.log10(value))
    return round(to_whole(round(value * 10.0**places, 6)) / 10.0**places, max(places, 0))


def nearest_whole_angle(accepts: Accepts, key: str, refused_deg: float) -> int | None:
    """Return the accepted whole angle that is nearest to a refused one, from -360 to 360; None of none."""
    for step in range(1, 181):
        for angle in (round(refused_deg) - step, round(refused_deg) + step):
            allowed = angle - 360 * (angle > 360) + 360 * (angle < -360)
            if accepts(key, allowed):
                return allowed
    return None
