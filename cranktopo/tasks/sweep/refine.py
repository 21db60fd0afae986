"""Full accuracy where it counts: which points of a coarse first look may be on the front after all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cranktopo.tasks.fea.error_bound import difference_bound_percent
from cranktopo.tasks.sweep.front import OBJECTIVES, front_of, picks_of
from cranktopo.tasks.sweep.points import SweepPoint
from cranktopo.tasks.sweep.result import DONE, PointResult

_Looks = Sequence[tuple[SweepPoint, PointResult]]
"""Every point as it is computed at full accuracy, with the result of its coarse first look."""
_ERRORS = {"torsion_Nm_per_rad": "torsion_error_percent", "bending_N_per_mm": "bending_error_percent"}
_TOLD_APART_PERCENT = 0.2
"""Twice the largest step of the four digits by which the front tells values apart."""
_OF_TRIANGLES = "optimise"
"""The stage whose bodies are surfaces, which meshes replace each in its own way."""


def worth_refining(looks: _Looks, full: Mapping[str, PointResult], original: PointResult) -> list[SweepPoint]:
    """Points without full accuracy that may be on the front with it, those that matter most first.

    A point is left out where another one beats it by more than the bound of the error of their difference, or
    by more than differences were seen to change between the first look and full accuracy. What has no numbers
    in the first look may have them at full accuracy.

    Args:
        full: results at full accuracy that are there already, by id.
        original: what picks refer to.
    """
    rows = [row.model_copy(update={"id": point.id}) for point, row in looks if row.status == DONE]
    seen = _seen_percent(looks, full)
    front, objectives = front_of(rows)
    leading = [row for row in rows if row.id in set(front)]
    kept = (row.id for row in rows if not any(_beats(one, row, objectives, seen) for one in leading))
    picks = picks_of(leading, original).values()
    unknown = (point.id for point, row in looks if row.status != DONE)
    order = dict.fromkeys([*picks, *front, *kept, *unknown])
    points = {point.id: point for point, _ in looks}
    return [points[one] for one in order if one not in full]


def _beats(
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
    if name not in _ERRORS:
        return seen.get(name, 0.0)
    triangles = _OF_TRIANGLES in (one.stage, other.stage)
    bound = difference_bound_percent(
        *(row.number(_ERRORS[name]) for row in (one, other)), triangles=triangles
    )
    return max(bound, seen.get(name, 0.0))


def _seen_percent(looks: _Looks, full: Mapping[str, PointResult]) -> dict[str, float]:
    """Return how much the points that have both accuracies changed in relation to each other, by quantity."""
    both = [(row, full[point.id]) for point, row in looks if point.id in full]
    found = {}
    for name in OBJECTIVES:
        changes = list(_changes_percent(both, name))
        found[name] = max(changes, default=0.0) - min(changes, default=0.0)
    return found


def _changes_percent(both: Sequence[tuple[PointResult, PointResult]], name: str) -> Iterator[float]:
    for coarse, fine in both:
        values = [row.number(name) for row in (coarse, fine) if row.status == DONE]
        if len(values) == 2 and None not in values:
            yield 100 * (values[1] / values[0] - 1)
