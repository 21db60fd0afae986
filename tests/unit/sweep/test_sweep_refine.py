"""Which points of a coarse first look are worth full accuracy: none of the front is left out."""

from __future__ import annotations

import random
from typing import Any

from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.front import front_of, worth_refining
from cranktopo.tasks.sweep.points import SweepPoint
from cranktopo.tasks.sweep.result import PointResult
from tests.sweep_cases import point_result

ERRORS = {"torsion_error_percent": 1.0, "bending_error_percent": 1.2}


def row(mass_kg: float, torsion: float, bending: float, **more: Any) -> PointResult:
    known = {"mass_kg": mass_kg, "torsion_Nm_per_rad": torsion, "bending_N_per_mm": bending}
    return point_result("of the look", **{**known, **ERRORS, **more})


def look(name: str, result: PointResult) -> tuple[SweepPoint, PointResult]:
    return SweepPoint(name, name, "evaluate", {}, "mikron-iiic-plain", {}, Fineness()), result


def names(
    looks: list[tuple[SweepPoint, PointResult]], full: dict[str, PointResult] | None = None
) -> list[str]:
    return [point.id for point in worth_refining(looks, full or {}, row(1.6, 100.0, 100.0))]


def test_only_what_is_beaten_by_more_than_the_bound_is_left_out() -> None:
    """Like meshes: the bound of a difference is 0.15 of the mean of both bounds, 0.15 and 0.18 %."""
    leader = look("leader", row(1.0, 100.0, 100.0))
    near = look("near", row(1.1, 99.9, 99.9))
    far = look("far", row(1.1, 99.8, 99.8))
    assert names([leader, near, far]) == ["leader", "near"]
    unequal = look("far", row(1.1, 99.8, 99.8, torsion_error_percent=0.5))
    assert names([leader, unequal]) == ["leader", "far"], "unequal bounds say less of a difference"
    surface = look("far", row(1.1, 99.1, 98.9, stage="optimise"))
    assert names([leader, surface]) == ["leader", "far"], "each surface is meshed in its own way"


def test_what_differences_were_seen_to_change_by_counts_too() -> None:
    """Optimised on finer cells one point got 1 % lighter, the other 2 % heavier: 3 % tell nothing apart."""
    looks = [look("a", row(1.0, 100.0, 100.0)), look("b", row(1.2, 120.0, 120.0))]
    looks += [look("close", row(1.02, 99.0, 99.0)), look("beaten", row(1.04, 99.0, 99.0))]
    assert names(looks) == ["a", "b"]
    full = {"a": row(0.99, 100.0, 100.0), "b": row(1.224, 120.0, 120.0)}
    assert names(looks, full) == ["close"]


def test_what_has_no_numbers_yet_is_tried_and_what_is_known_is_not() -> None:
    failed = look("failed", point_result("f", status="failed"))
    assert names([look("a", row(1.0, 100.0, 100.0)), failed]) == ["a", "failed"]
    assert names([failed], {"failed": point_result("f", status="failed")}) == []


def test_the_front_of_all_points_is_among_them() -> None:
    """Errors of random size within the bound of a difference, on points that lie close to each other."""
    draw = random.Random(7)
    saved = 0
    for _ in range(40):
        looks, fine = [], []
        for number in range(60):
            mass, torsion, bending = draw.uniform(1, 1.1), draw.uniform(100, 102), draw.uniform(100, 102)
            looks.append(look(str(number), row(mass, torsion, bending)))
            errors = [draw.uniform(1.0, 1.0014) for _ in range(2)]
            exact = row(mass, torsion / errors[0], bending / errors[1])
            fine.append(exact.model_copy(update={"id": str(number)}))
        kept = names(looks)
        assert set(front_of(fine)[0]) <= set(kept)
        saved += 60 - len(kept)
    assert saved > 40 * 20
