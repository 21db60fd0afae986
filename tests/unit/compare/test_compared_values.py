"""Values of a comparison: stars, differences below their error, pitch."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.compare.cards import best_facts
from cranktopo.tasks.compare.page import _changes
from cranktopo.tasks.compare.printed import comparison_text
from cranktopo.tasks.compare.result import Entry, compare
from cranktopo.tasks.compare.stage import balanced_kg_mm, pitch_lines
from cranktopo.tasks.compare.text import star_lines
from cranktopo.tasks.throw_fatigue.mesh_quality import MeshChecks
from cranktopo.tasks.throw_fatigue.result import JudgedAs
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fatigue.verdicts import Summary, verdicts
from cranktopo.tasks.throw_fea.quantities import SAFETY, TORSION, UNBALANCE
from cranktopo.tasks.throw_fea.targets import Target, resolve_target
from tests.cli.test_comparison_report import NAMES, NO_FATIGUE, evaluated, invented


def test_the_next_best_takes_the_star_too() -> None:
    """The best of three is 0.1 % above the next, whose bound is larger by 0.2 %."""
    entries = [
        Entry(evaluated(name, torsion, error))
        for name, torsion, error in (("a", 90e3, 0.1), ("b", 100e3, 0.3), ("c", 100.1e3, 0.1))
    ]
    comparison = compare(entries, "a")
    assert comparison.best(TORSION) is None
    assert [comparison.differ(2, row, TORSION) for row in (0, 1)] == [True, False]
    assert compare([entries[0], entries[2]], "a").best(TORSION) == 1


def test_a_headline_tells_no_change_below_its_error() -> None:
    """0.1 % between two webs whose difference is known to 0.15 %, and 0.1 % that is known to 0.045 %."""
    for error, told in ((1.0, False), (0.3, True)):
        near = [Entry(evaluated(name, torsion, error)) for name, torsion in (("a", 100e3), ("b", 99.9e3))]
        assert (TORSION in _changes(compare(near, "a"), 1)) == told


@pytest.mark.parametrize(("other", "best"), [(1.319, None), (1.281, None), (1.34, 1), (1.26, 0)])
def test_safeties_within_two_percent_are_level(other: float, best: int | None) -> None:
    """The worst node moves as much from mesh to mesh."""
    targets = [resolve_target(name) for name in NAMES]
    entries = [
        Entry(invented(target), None, safety) for target, safety in zip(targets, (1.3, other), strict=True)
    ]
    fatigue = FatigueComparison((1.3, other), (), NO_FATIGUE)
    assert compare(entries, NAMES[0], fatigue).best(SAFETY) == best


@pytest.mark.parametrize(("jumps", "best"), [((2.7, 2.7), None), ((1.0, 0.5), 1), ((0.0, 2.7), 1)])
def test_safeties_within_the_errors_of_both_are_level(jumps: tuple[float, float], best: int | None) -> None:
    """0.739 against 0.715, 3.4 % apart: the table has the error of the change, the card no best one."""
    entries = [
        Entry(invented(resolve_target(name)), None, safety)
        for name, safety in zip(NAMES, (0.715, 0.739), strict=True)
    ]
    summaries = tuple(
        Summary(entry.name, 1.0, entry.safety or 0.0, coarse=False, error_percent=jump)
        for entry, jump in zip(entries, jumps, strict=True)
    )
    found = compare(entries, NAMES[0], FatigueComparison((0.715, 0.739), (), NO_FATIGUE, summaries=summaries))
    assert found.best(SAFETY) == best
    rows = list(csv.DictReader(io.StringIO(comparison_text(found, "csv"))))
    error = float(rows[1]["safety_change_error_percent"])
    assert error == pytest.approx(max(2.0, sum(jumps)) * 0.739 / 0.715)
    (card,) = (fact for fact in best_facts(found) if fact.label == "Safest against fatigue")
    assert (card.value == "no clear best") == (best is None)


def test_stars_by_what_is_wanted() -> None:
    """The unbalance nearest to that of a balanced throw, not the algebraic least."""
    base, lighter, over = (
        replace(invented(resolve_target(NAMES[0])), target=name, unbalance_kg_mm=unbalance)
        for name, unbalance in (("base", 35.0), ("lighter", 2.0), ("over", -40.0))
    )
    found = compare([Entry(base), Entry(lighter), Entry(over)], "base")
    assert found.best(UNBALANCE) == 1
    assert star_lines(found) == []
    balanced = replace(found, balanced_kg_mm=-30.0)
    assert balanced.best(UNBALANCE) == 2
    assert "nearest to -30 kg mm" in star_lines(balanced)[0]
    scene = load_scene("mikron-iiic-plain")
    balance = throw_balance(scene)
    assert balanced_kg_mm(scene) == balance.throw_unbalance_kg_mm - balance.rotating_unbalance_kg_mm
    assert balanced_kg_mm(scene) < 0, "the rods of an engine are on the pin"
    assert balanced_kg_mm(with_goal(scene, minimise="unbalance")) == 0.0


def test_a_longer_throw_is_said_and_how_to_keep_the_pitch() -> None:
    base = load_scene("mikron-iiic-plain")
    thicker = with_values(base, {"web.thickness_mm": 29.0})
    (line,) = pitch_lines([Target("base", base), Target("thick", thicker)], 0)
    assert line.startswith("thick: pitch 134 mm, base has 114 mm: the engine is longer.")
    assert line.endswith("throw.main_journal.length_mm or throw.crankpin.length_mm by -20 mm.")
    kept = with_values(thicker, {"throw.main_journal.length_mm": 20.0})
    assert pitch_lines([Target("base", base), Target("kept", kept)], 0) == []


def test_both_worlds_stand_beside_each_other() -> None:
    """Columns of a throw alone and in its shaft where they are known; none where nothing tells them."""
    targets = [resolve_target(name) for name in NAMES]
    worlds: list[dict[JudgedAs, float]] = [
        {"throw_alone": 1.2, "continuous_shaft": 1.5},
        {"throw_alone": 1.14, "continuous_shaft": 1.65},
    ]
    entries = [
        Entry(invented(target), None, both["throw_alone"], safety_as=both)
        for target, both in zip(targets, worlds, strict=True)
    ]
    fatigue = FatigueComparison((1.2, 1.14), (), NO_FATIGUE)
    rows = list(csv.DictReader(io.StringIO(comparison_text(compare(entries, NAMES[0], fatigue), "csv"))))
    assert [row["safety_throw_alone"] for row in rows] == ["1.2", "1.14"]
    assert [row["safety_continuous_shaft"] for row in rows] == ["1.5", "1.65"]
    assert float(rows[1]["safety_continuous_shaft_percent"]) == pytest.approx(110.0)
    assert float(rows[1]["safety_throw_alone_percent"]) == pytest.approx(95.0)
    off = [replace(entry, safety_as={}) for entry in entries]
    assert "throw_alone" not in comparison_text(compare(off, NAMES[0], fatigue), "csv")


def test_the_change_in_both_worlds_is_said() -> None:
    """A web that gains in its shaft what it loses alone."""

    def judged(name: str, alone: float, shaft: float) -> Any:
        quality = MeshChecks(1.0, 1.0)
        model = SimpleNamespace(name=name, throw_kg=1.0, quality=quality, kinds=())
        found = object.__new__(FatigueField)
        told = {"model": model, "method": "lsa", "critical": SimpleNamespace(safety=alone)}
        told["safety_as"] = {"throw_alone": alone, "continuous_shaft": shaft}
        for key, value in told.items():
            object.__setattr__(found, key, value)
        return found

    lines = verdicts([judged("base", 1.2, 1.5), judged("new", 1.14, 1.65)], 0)
    assert lines[1] == (
        "new: -5.0 % safety of a throw alone (1.140 against 1.200), +10.0 % safety in its shaft (1.650 "
        "against 1.500)."
    )
