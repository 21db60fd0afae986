"""The value that finer and finer models converge to, how sure it is, and how fast they get there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

MINIMUM_ORDER, MAXIMUM_ORDER = 1.0, 2.2
"""Orders of convergence of a stiffness in the element size: 1.09 at a sharp ring (Williams, 1952), about 2
with fillets, a little above on coarse meshes."""
_TYPICAL_ORDER = 1.3
_SEARCHED = 0.05, 8.0


@dataclass(frozen=True)
class Extrapolation:
    """Limit of a sequence and half the width of the band that holds it; no order where none shows."""

    value: float
    uncertainty_percent: float
    order: float | None

    def error_percent(self, value: float) -> float:
        """Return the error of a value against the limit, %."""
        return 100 * (value / self.value - 1)


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float | None:
    """Return the order p of f + C h^p on three falling sizes; None where the values approach no limit."""
    from scipy.optimize import brentq

    (a, b, c), (first, second, third) = sizes, values
    if (first - second) * (second - third) <= 0:
        return None
    ratio = (first - second) / (second - third)

    def excess(order: float) -> float:
        return (a**order - b**order) / (b**order - c**order) - ratio

    low, high = _SEARCHED
    if excess(low) * excess(high) > 0:
        return None
    return float(brentq(excess, low, high))


def extrapolate(
    sizes: Sequence[float],
    values: Sequence[float],
    expected: tuple[float, float] | None = None,
    bound_percent: float | None = None,
) -> Extrapolation | None:
    """Return the limit of values on falling sizes (Richardson, 1911); None for fewer than two values.

    The band covers the limits that every plausible order would give; where none is observed a typical one
    gives the value, and the band reaches back to the finest value: two values may as well scatter. Where the
    three finest values go to and fro, their scatter is the band.

    Args:
        expected: orders that theory gives. Where another one is observed, or none, the values are not in
            their asymptotic range, and the band is at least `_safe_band`.
        bound_percent: bound of the error of the finest value by other means. The limit lies within it, and
            without an expected order the band is all of it.
    """
    if len(values) < 2:
        return None
    order = observed_order(sizes[-3:], values[-3:]) if len(values) > 2 else None
    found = _by_orders(sizes, values, order)
    asymptotic = expected is None or (order is not None and expected[0] <= order <= expected[1])
    if not asymptotic and bound_percent is None:
        safe = 100 * _safe_band(sizes, values) / abs(found.value)
        found = replace(found, uncertainty_percent=max(found.uncertainty_percent, safe))
    return found if bound_percent is None else _bounded(found, values[-1], bound_percent, asymptotic)


def _by_orders(sizes: Sequence[float], values: Sequence[float], order: float | None) -> Extrapolation:
    fine, step, recent = values[-1], values[-1] - values[-2], values[-3:]
    if len(values) > 2 and (recent[0] - recent[1]) * step >= 0:
        return Extrapolation(fine, 100 * (max(recent) - min(recent)) / abs(fine), None)
    used = min(max(order or _TYPICAL_ORDER, MINIMUM_ORDER), MAXIMUM_ORDER)
    value = fine + step * _richardson_factor(sizes, used)
    ends = [fine + step * _richardson_factor(sizes, p) for p in (MINIMUM_ORDER, MAXIMUM_ORDER)]
    ends += [fine] if order is None else []
    return Extrapolation(value, 100 * max(abs(end - value) for end in ends) / abs(value), order)


_SAFETY, _SECOND_ORDER = 3.0, 2.0


def _safe_band(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Return the band of values whose order is not known, the larger of two.

    The largest difference of the finest three, and the grid convergence index of two grids with its factor of
    safety of 3 (P. J. Roache, J. Fluids Eng. 116, 1994, 405-413), of second order.
    """
    recent = values[-3:]
    index = _SAFETY * abs(values[-1] - values[-2]) * _richardson_factor(sizes, _SECOND_ORDER)
    return max(index, max(recent) - min(recent))


def _bounded(limit: Extrapolation, fine: float, bound_percent: float, asymptotic: bool) -> Extrapolation:
    """Return a limit within the bound of the finest value, with a band that holds what the bound leaves."""
    room = abs(fine) * bound_percent / 100
    value = min(max(limit.value, fine - room), fine + room)
    whole = 100 * (abs(value - fine) + room) / abs(value)
    trusted = asymptotic and value == limit.value
    return Extrapolation(value, min(limit.uncertainty_percent, whole) if trusted else whole, limit.order)


def _richardson_factor(sizes: Sequence[float], order: float) -> float:
    return 1 / (math.pow(sizes[-2] / sizes[-1], order) - 1)
