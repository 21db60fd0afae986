"""The Pareto front of finished points, and the picks that most users want."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from cranktopo.tasks.sweep.result import PointResult

Rows = Sequence[PointResult]
OBJECTIVES: Mapping[str, int] = {
    "mass_kg": -1,
    "torsion_Nm_per_rad": 1,
    "bending_N_per_mm": 1,
    "fatigue_safety": 1,
}
"""What the front is about, as far as all points tell it: less is better (-1) or more is (+1)."""
_DIGITS = 4
"""Values that agree in so many digits are equal: another machine's mesh may differ in the fifth."""


def front_of(rows: Rows, objectives: Mapping[str, int] | None = None) -> tuple[list[str], list[str]]:
    """Ids of the points that no other point beats, in the order of the rows, and the quantities compared.

    A point is beaten by one that is better in a quantity and no worse in the others, all rounded to
    `_DIGITS` digits; of points that are equal in all of them the first counts.

    Args:
        rows: finished points.
        objectives: quantities and their better direction; by default those of `OBJECTIVES` that all tell.
    """
    known = {
        name: sign
        for name, sign in (objectives or OBJECTIVES).items()
        if rows and all(_finite(row.number(name)) for row in rows)
    }
    if not known:
        return [], []
    scores = [tuple(sign * rounded(row.number(name)) for name, sign in known.items()) for row in rows]
    first = {score: place for place, score in reversed(list(enumerate(scores)))}
    front = [score for score in first if not any(_beats(other, score) for other in first)]
    return [rows[place].id for place in sorted(first[score] for score in front)], list(known)


def picks_of(rows: Rows, original: PointResult | None) -> dict[str, str]:
    """Ids of the points that most users look for; of equal ones the first.

    Args:
        original: what `lightest that is no softer` refers to.
    """
    stiff = [row for row in rows if original is not None and _no_softer(row, original)]
    best = {
        "lightest that is no softer": _best(stiff, "mass_kg", -1),
        "stiffest in torsion per mass": _best(rows, "torsion_per_mass_Nm_per_rad_kg", 1),
        "stiffest in bending per mass": _best(rows, "bending_per_mass_N_per_mm_kg", 1),
        "safest": _best(rows, "fatigue_safety", 1),
    }
    return {name: found for name, found in best.items() if found is not None}


def rounded(value: float) -> float:
    """Return a value to `_DIGITS` digits."""
    return float(f"{value:.{_DIGITS}g}")


def _no_softer(row: PointResult, original: PointResult) -> bool:
    names = ("torsion_Nm_per_rad", "bending_N_per_mm")
    if not all(_finite(one.number(name)) for one in (row, original) for name in names):
        return False
    return all(rounded(row.number(name)) >= rounded(original.number(name)) for name in names)


def _best(rows: Rows, name: str, sign: int) -> str | None:
    known = [row for row in rows if _finite(row.number(name))]
    if not known:
        return None
    return max(known, key=lambda row: sign * rounded(row.number(name))).id


def _beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one != other and all(a >= b for a, b in zip(one, other, strict=True))


def _finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
