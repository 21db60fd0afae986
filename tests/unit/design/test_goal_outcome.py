"""What became of a goal: required, reached, holds, active."""

from __future__ import annotations

import json

import pytest

from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.outcome import GoalOutcome, goal_outcome, limit_outcome
from cranktopo.report.goal_table import (
    evaluated_changes,
    goal_line,
    limits_table,
    unknown_limits,
    violated_limits,
)
from cranktopo.report.result_table import terminal

ORIGINAL = {"mass": 1.6, "torsion": 140e3, "unbalance": 35.0}


@pytest.mark.parametrize(
    ("limit", "reached", "original", "required", "holds", "active"),
    [
        (Limit("torsion", ">=", 110.0, percent=True), 154e3, 140e3, 154e3, True, True),
        (Limit("torsion", ">=", 110.0, percent=True), 153.4e3, 140e3, 154e3, True, True),  # 0.4 % short
        (Limit("torsion", ">=", 110.0, percent=True), 153e3, 140e3, 154e3, False, True),  # 0.6 % short
        (Limit("torsion", ">=", 110.0, percent=True), 160e3, 140e3, 154e3, True, False),
        (Limit("mass", "<=", 1.5), 1.49, 1.6, 1.5, True, True),
        (Limit("mass", "<=", 1.5), 1.40, 1.6, 1.5, True, False),
        (Limit("mass", "<=", 1.5), 1.52, 1.6, 1.5, False, True),
        (Limit("unbalance", ">=", 0.0), -0.1, 35.0, 0.0, True, True),  # 0.3 % of the original's
        (Limit("unbalance", ">=", 0.0), -1.0, 35.0, 0.0, False, True),
        (Limit("unbalance", "<=", -3.0), -2.9, 35.0, -3.0, False, True),
        (Limit("fatigue_safety", ">=", 100.0, percent=True), None, None, None, None, False),
        (Limit("fatigue_safety", ">=", 1.5), None, None, 1.5, None, False),
    ],
)
def test_a_limit_holds_within_half_a_percent_and_is_active_within_one(
    limit: Limit,
    reached: float | None,
    original: float | None,
    required: float | None,
    holds: bool | None,
    active: bool,
) -> None:
    name = limit.quantity
    found = limit_outcome(
        limit,
        {} if reached is None else {name: reached},
        {} if original is None else {name: original},
    )
    assert found.required == pytest.approx(required)
    assert (found.holds, found.active) == (holds, active)


def test_a_written_limit_is_another_number_in_each_model() -> None:
    share, in_unit = Limit("torsion", ">=", 90.0, percent=True), Limit("mass", "<=", 1.5)
    assert share.constraint({"torsion": 140e3}) == Constraint("torsion", ">=", 126e3)
    assert share.constraint({"torsion": 130e3}) == Constraint("torsion", ">=", 117e3)
    assert share.constraint({"mass": 1.6}) is None
    assert in_unit.constraint({}) == in_unit.constraint({"mass": 1.6}) == Constraint("mass", "<=", 1.5)


def test_a_limit_of_zero_is_measured_by_the_original() -> None:
    level = Limit("unbalance", "<=", 0.0).constraint({"unbalance": 40.0})
    assert level is not None
    assert level.violation(2.0) == pytest.approx(0.05)


def test_what_is_missing_of_a_limit_that_counts_as_kept_is_told() -> None:
    goal = Goal(
        "minimise", "mass", (Limit("torsion", ">=", 110.0, percent=True), Limit("unbalance", "<=", 30.0))
    )
    found = goal_outcome(goal, {"mass": 1.4, "torsion": 153.4e3, "unbalance": 29.9}, ORIGINAL)
    table = terminal(limits_table(GoalOutcome.of_json(found.as_json(), "a file")))
    assert "yes, 0.39 % short" in table
    assert "yes, by less than 1 %" in table


def test_a_percentage_of_its_own_is_not_told_in_percent_of_the_original() -> None:
    own, of_original = Limit("balance_factor", ">=", 48.0), Limit("balance_factor", ">=", 96.0, percent=True)
    told = limit_outcome(own, {"balance_factor": 47.9}, {"balance_factor": 50.0})
    assert (told.required, told.reached, told.required_percent, told.reached_percent) == (
        48.0,
        47.9,
        None,
        None,
    )
    share = limit_outcome(of_original, {"balance_factor": 47.9}, {"balance_factor": 50.0})
    assert (share.required_percent, share.reached_percent) == (96.0, pytest.approx(95.8))


def test_the_metrics_have_the_contract_keys_and_both_percentages() -> None:
    limits = (Limit("torsion", ">=", 110.0, percent=True), Limit("unbalance", "<=", 30.0))
    goal = Goal("minimise", "mass", (*limits, Limit("fatigue_safety", ">=", 100.0, True, assumed=True)))
    found = goal_outcome(goal, {"mass": 1.4, "torsion": 147e3, "unbalance": 28.0}, ORIGINAL)
    told = found.as_json()
    assert told["minimise"] == "mass"
    assert told["reached_percent"] == pytest.approx(87.5)
    torsion, unbalance, safety = told["limits"]
    assert {"quantity", "required", "reached", "unit", "holds", "active"} <= torsion.keys()
    assert (torsion["required"], torsion["unit"]) == (pytest.approx(154e3), "N m/rad")
    assert (torsion["required_percent"], torsion["reached_percent"]) == (110.0, pytest.approx(105.0))
    assert unbalance["required_percent"] == pytest.approx(100 * 30 / 35)
    assert (torsion["holds"], unbalance["holds"], safety["holds"]) == (False, True, None)
    assert goal_line(found) == "least mass: 1.4 kg, 87.5 % of the original web"
    assert violated_limits(found) == ["torsion >= 154,000 N m/rad: reached 147,000 N m/rad"]
    lines = terminal(limits_table(found)).splitlines()
    assert lines[3].split() == [
        *("torsion", ">=", "154,000", "N", "m/rad", "147,000", "N", "m/rad"),
        *("110.0", "105.0", "NO"),
    ]
    assert lines[5].split()[:4] == ["fatigue_safety", ">=", "100", "%"]
    assert lines[5].endswith("unknown")


def test_cells_and_evaluation_are_told_by_one_measure() -> None:
    """A share of the original is another number in either model: only percents stand beside each other."""
    goal = Goal(
        "minimise", "mass", (Limit("torsion", ">=", 98.0, True), Limit("fatigue_safety", ">=", 95.0, True))
    )
    how = {"fillets": False, "element_size_mm": 4.2, "error_estimate_percent": {"torsion": 0.3}, "rounds": ()}
    cells = goal_outcome(goal, {"mass": 1.4, "torsion": 136e3}, ORIGINAL)
    finer = {**ORIGINAL, "torsion": 130e3}
    found = cells.with_evaluation(goal_outcome(goal, {"mass": 1.4, "torsion": 128e3}, finer), **how)
    row = terminal(limits_table(found)).splitlines()[-2]
    assert row.startswith("torsion >= 98 %  ")
    assert row.split()[-4:] == ["N", "m/rad", "98.5", "yes"] or row.split()[-1].startswith("%")
    assert unknown_limits(found) == ["fatigue_safety >= 95 %"]
    assert evaluated_changes(found) == "by the evaluation torsion -1.5 %"
    missed = cells.with_evaluation(goal_outcome(goal, {"mass": 1.4, "torsion": 117e3}, finer), **how)
    assert violated_limits(missed) == ["torsion >= 98 %: reached 90.0 %"]


def test_a_share_of_a_negative_unbalance_is_told_by_its_value() -> None:
    """-100.4 kg mm keeps "<= 100 %" of -71.3 kg mm, which reads as if it were 140 %."""
    goal = Goal("minimise", "mass", (Limit("unbalance", "<=", 100.0, percent=True, assumed=True),))
    how = {"fillets": False, "element_size_mm": 4.2, "error_estimate_percent": {}, "rounds": ()}
    cells = goal_outcome(goal, {"mass": 1.4, "unbalance": -99.42}, {"mass": 1.6, "unbalance": -71.49})
    better = {"mass": 1.6, "unbalance": -71.27}
    found = cells.with_evaluation(goal_outcome(goal, {"mass": 1.4, "unbalance": -100.4}, better), **how)
    (row,) = limits_table(found).rows
    assert (row["limit"], row["required_percent"], row["holds"]) == ("unbalance <= -71.27 kg mm", None, "yes")
    broken = cells.with_evaluation(goal_outcome(goal, {"mass": 1.4, "unbalance": -60.0}, better), **how)
    assert violated_limits(broken) == ["unbalance <= -71.27 kg mm: reached -60 kg mm"]


def test_percent_of_a_balanced_original_is_none() -> None:
    goal = Goal("minimise", "mass", (Limit("unbalance", "<=", 30.0),))
    (limit,) = goal_outcome(goal, {"unbalance": 3.0}, {"unbalance": 0.0}).limits
    assert limit.reached_percent is None
    assert limit.holds is True


def test_an_outcome_is_read_back_as_it_was_written_and_its_order_is_that_of_the_metrics() -> None:
    goal = Goal("maximise", "torsion", (Limit("mass", "<=", 1.5), Limit("fatigue_safety", ">=", 1.2)))
    cells = goal_outcome(goal, {"torsion": 150e3, "mass": 1.4}, ORIGINAL)
    how = {"fillets": False, "element_size_mm": 4.2, "error_estimate_percent": {"torsion": 0.3}, "rounds": ()}
    better = goal_outcome(goal, {"torsion": 151e3, "mass": 1.52}, ORIGINAL)
    for found in (cells, cells.with_evaluation(better, **how), cells.without_evaluation("no mesh")):
        text = json.dumps(found.as_json())
        assert json.dumps(GoalOutcome.of_json(json.loads(text), "goal").as_json()) == text
        assert text.startswith('{"maximise": "torsion", "reached": 150000.0')
    mass, safety = cells.with_evaluation(better, **how).limits
    assert (mass.holds, mass.reached, safety.holds) == (False, 1.4, None)
    assert mass.evaluation is not None
    assert mass.evaluation.reached == 1.52
