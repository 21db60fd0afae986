"""Near-ties are decided by one rule: of candidates that are as good as the best, the first is taken.

Machines differ in the last digits of a number, and a search makes more of that. So a candidate is better only
where it is by more than that share; else the earlier one stays, which is the simpler one or the one at hand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

T = TypeVar("T")
SAME = 1e-3
"""Share by which two values may differ and count as equal. Searches from inputs that differ by rounding end
within 4e-4 of each other in overlap, most of them within 5e-6."""
_ROUNDING = 1e-6


def clearly_more(value: float, other: float) -> bool:
    """Tell whether a value exceeds another one by more than rounding and searches can make of it."""
    return value - other > SAME * abs(other)


def exceeds(value: float, limit: float) -> bool:
    """Tell whether a value exceeds a limit by more than rounding."""
    return value - limit > _ROUNDING * abs(limit)


def first_of_the_best(candidates: Sequence[T], score: Callable[[T], float], within: float | None = None) -> T:
    """Return the first of the candidates, the simpler ones first, whose score nearly reaches the highest one.

    `within` tells how much less than the highest is enough; by default what `clearly_more` allows.
    """
    scores = [score(candidate) for candidate in candidates]
    most = max(scores)
    near = (most - own <= within if within is not None else not clearly_more(most, own) for own in scores)
    return next(candidate for candidate, enough in zip(candidates, near, strict=True) if enough)


def best_first(candidates: Sequence[T], score: Callable[[T], float]) -> list[T]:
    """Return the candidates by falling score; of those as good as each other the earlier one first."""
    left, ordered = list(range(len(candidates))), []
    while left:
        chosen = first_of_the_best(left, lambda place: score(candidates[place]))
        left.remove(chosen)
        ordered.append(candidates[chosen])
    return ordered
