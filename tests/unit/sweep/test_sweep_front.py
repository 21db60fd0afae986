"""The Pareto front, its near-ties, and the picks."""

from __future__ import annotations

import itertools
import random

from cranktopo.tasks.sweep.front import choices_of, front_of, picks_of
from cranktopo.tasks.sweep.result import PointResult
from cranktopo.tasks.sweep.text import point_words
from tests.sweep_cases import point_result


def row(name: str, mass_kg: float, torsion: float, bending: float = 1.0, **more: float) -> PointResult:
    ratio = {"torsion_per_mass_Nm_per_rad_kg": torsion / mass_kg}
    known = {"mass_kg": mass_kg, "torsion_Nm_per_rad": torsion, "bending_N_per_mm": bending}
    return point_result(name, **known, **ratio, **more)


def test_front_is_that_of_the_definition() -> None:
    """Against every pair, on numbers with few values so that there are ties."""
    draw = random.Random(3)
    rows = [row(str(n), *(draw.randint(1, 9) for _ in range(3))) for n in range(80)]
    names = ("torsion_Nm_per_rad", "bending_N_per_mm")
    values = {r.id: (-r.number("mass_kg"), *(r.number(name) for name in names)) for r in rows}
    beaten = {
        b
        for a, b in itertools.permutations(values, 2)
        if values[a] != values[b] and all(x >= y for x, y in zip(values[a], values[b], strict=True))
    }
    first = {value: name for name, value in reversed(values.items())}
    expected = [name for name in values if name not in beaten and first[values[name]] == name]
    assert front_of(rows) == (expected, ["mass_kg", "torsion_Nm_per_rad", "bending_N_per_mm"])


def test_of_points_that_differ_in_the_fifth_digit_the_first_counts() -> None:
    near = [row("a", 1.50001, 140002.0), row("b", 1.5, 140001.0), row("c", 1.49, 139000.0)]
    assert front_of(near)[0] == ["a", "c"]
    assert front_of(near[1::-1])[0] == ["b"]


def test_safety_counts_where_every_point_tells_it() -> None:
    rows = [row("a", 1.0, 2.0, fatigue_safety=1.1), row("b", 1.1, 1.9, fatigue_safety=1.3)]
    assert front_of(rows)[0] == ["a", "b"]
    rows[1] = row("b", 1.1, 1.9)
    assert front_of(rows)[0] == ["a"]
    assert front_of([]) == ([], [])


def test_picks() -> None:
    original = row("o", 1.5, 100.0, 50.0)
    rows = [
        row("light", 1.0, 99.0, 60.0, fatigue_safety=1.2),
        row("fit", 1.3, 100.001, 50.0, fatigue_safety=1.0),
        row("same", 1.3, 101.0, 51.0, fatigue_safety=1.0),
        row("stiff", 1.6, 190.0, 90.0, fatigue_safety=1.1),
    ]
    assert picks_of(rows, original) == {
        "lightest that is no softer": "fit",
        "stiffest in torsion per mass": "stiff",
        "safest": "light",
    }
    assert "lightest that is no softer" not in picks_of(rows, None)


def test_points_of_several_designs_are_told_with_their_design() -> None:
    rows = [point_result(name, design=name, varied={"web.width_mm": 50.0}) for name in ("one", "other")]
    assert point_words(rows, rows[1]) == "other, web.width_mm = 50"
    assert point_words(rows[:1], rows[0]) == "web.width_mm = 50"
    bare = point_result("one", design="one")
    assert point_words([bare], bare) == "one"


def speed(
    name: str, rpm: float, safety: float, width_mm: float = 50.0, stage: str = "fatigue"
) -> PointResult:
    varied = {"engine.speed_rpm": rpm, "web.width_mm": width_mm}
    return row(name, width_mm / 10, 2.0, fatigue_safety=safety).model_copy(
        update={"varied": varied, "stage": stage}
    )


def test_a_speed_is_no_choice() -> None:
    """Every web counts by the speed of its least safety; a sweep over speed alone has nothing to pick."""
    rows = [speed("a", 1000, 1.4), speed("b", 2000, 1.1), speed("c", 3000, 1.2)]
    assert choices_of(rows) == []
    wide = [speed("d", 1000, 1.5, 60.0), speed("e", 2000, 1.6, 60.0), speed("f", 3000, 1.3, 60.0)]
    chosen = choices_of([*rows, *wide])
    assert [one.id for one in chosen] == ["b", "f"]
    assert picks_of(chosen, None)["safest"] == "f"
    plain = [one.model_copy(update={"varied": {"web.width_mm": 50.0}}) for one in rows]
    assert choices_of(plain) == plain


def test_of_webs_that_are_made_for_one_speed_each_none_is_picked() -> None:
    rows = [
        speed(f"{rpm}{width}", rpm, 1.0, width, "shape") for rpm in (1000, 2000) for width in (50.0, 60.0)
    ]
    assert choices_of(rows) == []
