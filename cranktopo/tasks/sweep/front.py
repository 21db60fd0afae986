"""The Pareto front of finished points, and the picks that most users want."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from cranktopo.tasks.sweep.points import SweepPoint
from cranktopo.tasks.sweep.result import DONE, ERRORS, PointResult
from cranktopo.tasks.throw_fea.error_bound import difference_bound_percent

Rows = Sequence[PointResult]
OBJECTIVES: Mapping[str, int] = {
    "mass_kg": -1,
    "torsion_Nm_per_rad": 1,
    "bending_N_per_mm": 1,
    "fatigue_safety": 1,
}
"""Quantities of the front, as far as all points tell them: less is better (-1) or more is (+1)."""
_DIGITS = 4
"""Values that agree in so many digits are equal: another machine's mesh may differ in the fifth."""


def front_of(rows: Rows) -> tuple[list[str], list[str]]:
    """Return the ids of points that no other one beats, in the order of the rows, and what was compared.

    A point is beaten by one that is better in a quantity and no worse in the others, all rounded to
    `_DIGITS` digits; of points that are equal in all of them the first counts.
    """
    known = {
        name: sign
        for name, sign in OBJECTIVES.items()
        if rows and all(_finite(row.number(name)) for row in rows)
    }
    if not known:
        return [], []
    scores = [tuple(sign * _rounded(row.number(name)) for name, sign in known.items()) for row in rows]
    first = {score: place for place, score in reversed(list(enumerate(scores)))}
    front = [score for score in first if not any(_beats(other, score) for other in first)]
    return [rows[place].id for place in sorted(first[score] for score in front)], list(known)


_CONDITIONS = (
    "engine.speed_rpm",
    "engine.overspeed_rpm",
    "engine.gas.",
    "engine.max_gas_force_N",
    "engine.max_torque_Nm",
    "engine.min_torque_Nm",
)
"""Keys, or their beginnings, of speed and load: the crank has to bear all of them, none is a choice."""


def conditions_of(keys: Iterable[str]) -> list[str]:
    """Return those of the keys that vary which are operating conditions."""
    return [key for key in keys if key.startswith(_CONDITIONS)]


def choices_of(rows: Rows) -> list[PointResult]:
    """Return the points that a designer can choose between: of a web that at the condition of least safety.

    None where only conditions vary, or where every condition has a web of its own, made for it alone.
    """
    conditions = set(conditions_of(key for row in rows for key in row.varied))
    if not conditions:
        return list(rows)
    groups: dict[str, list[PointResult]] = {}
    for row in rows:
        varied = {key: value for key, value in row.varied.items() if key not in conditions}
        groups.setdefault(str((row.design, row.stage, varied)), []).append(row)
    if len(groups) == 1 or any(row.stage not in _OF_ONE_WEB for row in rows):
        return []
    return [min(group, key=_safety) for group in groups.values()]


def _safety(row: PointResult) -> float:
    safety = row.number("fatigue_safety")
    return safety if _finite(safety) else math.inf


_OF_ONE_WEB = ("evaluate", "fatigue")
"""Stages that judge the web of the scene; others find one."""


def picks_of(rows: Rows, original: PointResult | None) -> dict[str, str]:
    """Return the ids of the points that most users look for; of equal ones the first."""
    stiff = [row for row in rows if original is not None and _no_softer(row, original)]
    best = {
        "lightest that is no softer": _best(stiff, "mass_kg", -1),
        "stiffest in torsion per mass": _best(rows, "torsion_per_mass_Nm_per_rad_kg", 1),
        "stiffest in bending per mass": _best(rows, "bending_per_mass_N_per_mm_kg", 1),
        "safest": _best(rows, "fatigue_safety", 1),
    }
    return {name: found for name, found in best.items() if found is not None}


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _no_softer(row: PointResult, original: PointResult) -> bool:
    names = ("torsion_Nm_per_rad", "bending_N_per_mm")
    if not all(_finite(one.number(name)) for one in (row, original) for name in names):
        return False
    return all(_rounded(row.number(name)) >= _rounded(original.number(name)) for name in names)


def _best(rows: Rows, name: str, sign: int) -> str | None:
    known = [row for row in rows if _finite(row.number(name))]
    return max(known, key=lambda row: sign * _rounded(row.number(name))).id if known else None


def _beats(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one != other and all(a >= b for a, b in zip(one, other, strict=True))


def _finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


_Looks = Sequence[tuple[SweepPoint, PointResult]]
"""Every point as it is computed at full accuracy, with the result of its coarse first look."""
_TOLD_APART_PERCENT = 0.2
"""Twice the largest step of the four digits by which the front tells values apart."""
_OF_TRIANGLES = "optimise"
"""The stage whose bodies are surfaces, which meshes replace each in its own way."""


def worth_refining(looks: _Looks, full: Mapping[str, PointResult], original: PointResult) -> list[SweepPoint]:
    """Return points that may be on the front at full accuracy and lack it, those that matter most first.

    A point is left out where another one beats it by more than the bound of the error of their difference,
    and by more than differences were seen to change between the first look and full accuracy. What has no
    numbers in the first look may have them at full accuracy.
    """
    rows = [row.model_copy(update={"id": point.id}) for point, row in looks if row.status == DONE]
    choices = choices_of(rows)
    if rows and not choices:  # nothing is chosen, so that all are told alike
        return [point for point, _ in looks if point.id not in full]
    rows, seen = choices, _seen_percent(looks, full)
    front, objectives = front_of(rows)
    leading = [row for row in rows if row.id in set(front)]
    kept = (row.id for row in rows if not any(_surely_beats(one, row, objectives, seen) for one in leading))
    picks = picks_of(leading, original).values()
    unknown = (point.id for point, row in looks if row.status != DONE)
    order = dict.fromkeys([*picks, *front, *kept, *unknown])
    points = {point.id: point for point, _ in looks}
    return [points[one] for one in order if one not in full]


def _surely_beats(
    one: PointResult, other: PointResult, objectives: Sequence[str], seen: Mapping[str, float]
) -> bool:
    """Tell whether a point is for certain no worse in any quantity, and better in one, at full accuracy."""
    leads = [
        OBJECTIVES[name] * 100 * (one.number(name) / other.number(name) - 1)
        - _margin_percent(one, other, name, seen)
        for name in objectives
    ]
    return min(leads) >= 0 and max(leads) >= _TOLD_APART_PERCENT


def _margin_percent(one: PointResult, other: PointResult, name: str, seen: Mapping[str, float]) -> float:
    """Return what the relative difference between two first looks may be wrong by."""
    if name not in ERRORS:
        return seen[name]
    errors = (row.number(ERRORS[name]) for row in (one, other))
    triangles = _OF_TRIANGLES in (one.stage, other.stage)
    return max(difference_bound_percent(*errors, triangles=triangles), seen[name])


def _seen_percent(looks: _Looks, full: Mapping[str, PointResult]) -> dict[str, float]:
    """Return how much the points that have both accuracies changed in relation to each other, by quantity."""
    both = [(row, full[point.id]) for point, row in looks if point.id in full]
    solved = [pair for pair in both if all(row.status == DONE for row in pair)]
    found = {}
    for name in OBJECTIVES:
        values = [(coarse.number(name), fine.number(name)) for coarse, fine in solved]
        changes = [100 * (fine / coarse - 1) for coarse, fine in values if None not in (coarse, fine)]
        found[name] = max(changes, default=0.0) - min(changes, default=0.0)
    return found
