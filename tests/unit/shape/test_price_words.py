"""Prices of limits, rules and bounds in words, as they stand on the page and in the terminal."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.report.plot import picture
from cranktopo.report.report_file import html, markdown_text
from cranktopo.runs.manifest import new_manifest
from cranktopo.tasks.web_shape.page import (
    curves,
    draw_goal,
    draw_worst_limit,
    page_headline,
    quantity_fact,
    shape_page,
)
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.text import (
    multiplier_table,
    multiplier_text,
    shape_headline,
    shape_summary,
    stress_loads,
)
from tests.page_text import typed
from tests.unit.shape.shape_results import goal, invented_data

TOLD: dict[str, Any] = {"worst_case_percent": {"tolerance": 0.5}, "seconds": {"total": 1.0}}
"""Keys that a summary asks for."""


@pytest.fixture
def data() -> dict[str, Any]:
    return invented_data()


def _found(data: dict[str, Any]) -> ShapeResult:
    return ShapeResult.of_json(data, "shape.json")


def test_a_price_that_shows_no_digit_is_none(data: dict[str, Any]) -> None:
    data["prices"][0]["goal_percent_per_percent"] = 0.004
    data["rule_prices"][1]["goal_percent_per_unit"] = 0.004
    told = multiplier_text(_found(data))
    assert told[0] == "1 % more torsion costs nothing: this limit does not decide"
    assert not [line for line in told if "0.00 %" in line]


def _limit(quantity: str, sense: str, required: float, reached: float, holds: bool) -> dict[str, Any]:
    told = {"quantity": quantity, "sense": sense, "required": required, "reached": reached, "holds": holds}
    shares = {"required_percent": 100.0, "reached_percent": 100 * reached / required}
    return {**told, **shares, "unit": "", "active": True, "assumed": False}


@pytest.mark.parametrize(("original", "said"), [(1.2, True), (1.1, False)])
def test_a_missed_limit_that_the_original_keeps(data: dict[str, Any], original: float, said: bool) -> None:
    """Then there is a web that keeps all of them, which is said before the reason of the end."""
    limits = [_limit("fatigue_safety", ">=", 1.2, 1.18, False), _limit("mass", "<=", 2.0, 1.8, True)]
    data["goal"] = {**goal(minimise="mass"), "limits": limits}
    before, after = {"mass": 2.0, "fatigue_safety": original}, {"fatigue_safety": 1.18}
    data |= {"values": {"original": before, "result": after}, **TOLD}
    told = shape_summary(_found(data), Path("run")).splitlines()
    assert ("the original web keeps every limit" in told[:2]) == said


def test_where_the_balance_went_stands_below_the_verdict(data: dict[str, Any]) -> None:
    data |= {"balance": "the balance factor is 51 %", **TOLD}
    assert shape_summary(_found(data), Path("run")).splitlines()[1] == "the balance factor is 51 %"


def test_where_the_balance_went_is_first_on_the_page(data: dict[str, Any]) -> None:
    values = {"original": {"balance_factor": 50.2}, "result": {"balance_factor": 69.4}}
    found = _found(data | {"balance": "it moved", "values": values, "change_percent": {"mass": -1.0}})
    said = "Balance factor 69.4 % of the oscillating mass instead of 50.2 %. Every limit holds: mass -1.0 %"
    assert page_headline(found).startswith(said)


def test_a_limit_that_is_just_missed_is_no_zero(data: dict[str, Any]) -> None:
    data["change_percent"] = {"mass": -4.7, "torsion": -0.034}
    assert "mass -4.7 %, torsion -0.03 +-0.04 %" in shape_headline(_found(data)), "within its error"


def test_limits_cost_and_rules_give_in_words(data: dict[str, Any]) -> None:
    assert multiplier_text(_found(data)) == [
        "1 % more torsion costs 0.31 % mass",
        "1 % less unbalance costs 0.05 % mass",
        "1 % more fatigue safety costs nothing: this limit does not decide",
        "1 degree of 'least slot.draft' would give 0.20 % less mass",
        "1 mm of 'wall between both bores, 5 mm' would give 0.02 % less mass",
    ]
    told = [f"{row['a_move_of']} {row['the_goal']}" for row in multiplier_table(_found(data)).rows]
    assert told == multiplier_text(_found(data))


@pytest.mark.parametrize(
    ("original", "result", "said"),
    [
        (
            0.95,
            0.98,
            " IT FAILS by fatigue: the safety of 0.980 is below 1, as the original does with 0.950.",
        ),
        (1.2, 0.98, " IT FAILS by fatigue: the safety of 0.980 is below 1."),
        (0.95, 1.02, "original web."),
    ],
)
def test_a_web_that_fails_by_fatigue_says_so_though_every_limit_holds(
    data: dict[str, Any], original: float, result: float, said: str
) -> None:
    values = {"original": {"fatigue_safety": original}, "result": {"fatigue_safety": result}}
    change = {"fatigue_safety": 100 * (result / original - 1)}
    found = _found(data | {"values": values, "change_percent": change})
    assert shape_headline(found).startswith("Every limit holds: ")
    assert shape_headline(found).endswith(said)
    fact = quantity_fact(found, "fatigue_safety")
    assert (fact.status == "bad", "it fails" in fact.note) == (result < 1, result < 1)


def test_the_load_states_of_a_cycle_are_named_with_what_they_tell(data: dict[str, Any]) -> None:
    both = {"original": {}, "result": {"stress": 300.0, "fatigue_safety": 1.5}}
    for values, told in (
        (both, "fatigue safety and largest von Mises stress over every angle of the cycle"),
        (
            {"original": {}, "result": {"stress": 300.0}},
            "largest von Mises stress over every angle of the cycle",
        ),
    ):
        assert stress_loads(_found(data | {"values": values, "loads": "cycle"})) == told
    joined = stress_loads(_found(data | {"values": both, "loads": "extremes"}))
    assert joined == "fatigue safety and largest von Mises stress over the extremes of the loads joined"
    none = {"original": {}, "result": {"mass": 1.0}}
    assert stress_loads(_found(data | {"values": none, "loads": "extremes"})) == ""


@pytest.mark.parametrize(
    ("loads", "words"),
    [
        ("extremes", "over the extremes of the loads joined"),
        ("cycle", "over every angle of the cycle"),
        ("shaft", "over every angle of the cycle in the shaft on all its bearings"),
    ],
)
def test_summary_and_page_name_the_load_states_of_a_safety(
    data: dict[str, Any], loads: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Joined extremes, the default, were named by shape.json alone: 0.642 beside 0.793 over the cycle."""
    values = {"original": {"mass": 2.0, "fatigue_safety": 0.7}, "result": {"fatigue_safety": 0.642}}
    changed = {"values": values, "change_percent": {"fatigue_safety": -8.0}, "loads": loads, "rounds": []}
    found = _found(data | changed | {"goal_on_cells": {"minimise": "mass"}} | TOLD)
    assert f"\nfatigue safety {words}\n" in shape_summary(found, Path("run"))
    assert quantity_fact(found, "fatigue_safety").note.endswith(f"{words}; below 1: it fails")
    monkeypatch.setattr("cranktopo.tasks.web_shape.page.gallery_picture", lambda *_: None)
    manifest = new_manifest(run="out", design="", command=(), scene={}, options={}, inputs={})
    page = shape_page(found, manifest, load_scene("mikron-iiic-plain"), ())
    page = replace(page, scene3d=None)
    for written in (typed(html(page)), markdown_text(page, "pictures")):
        assert f"fatigue safety {words}" in written


def test_prices_of_a_poor_fit_are_not_told(data: dict[str, Any]) -> None:
    """With 67 % explained, 3.10 % mass per percent of bending was told, and a gain per mm of a wall."""
    bending, far = _limit("bending", ">=", 761.5, 760.9, True), _limit("unbalance", "<=", -37.4, -38.6, True)
    data["goal"] = {**goal(minimise="mass"), "limits": [bending, far | {"active": False}]}
    data["prices"] = [
        {"quantity": "bending", "sense": ">=", "goal_percent_per_percent": 3.105},
        {"quantity": "unbalance", "sense": "<=", "goal_percent_per_percent": 0.111},
    ]
    lines = multiplier_text(_found(data | {"prices_remainder_percent": 33.16}))
    assert lines[:2] == [
        "1 % more bending has no price known: the prices explain too little",
        "unbalance lower by 1 % of its limit costs nothing: this limit does not decide",
    ]
    assert len(lines) == 3
    assert "prices explain 67 %" in lines[-1]
    found = _found(data | {"prices_remainder_percent": 29.9})
    known = [price.known(found.goal.limits, 29.9) for price in found.prices]
    assert known == [3.105, 0.0]


def test_a_missed_limit_has_no_price(data: dict[str, Any]) -> None:
    data["goal"] = {**goal(minimise="mass"), "limits": [_limit("bending", ">=", 761.5, 700.0, False)]}
    data["prices"] = [{"quantity": "bending", "sense": ">=", "goal_percent_per_percent": 3.105}]
    found = _found(data)
    assert found.prices[0].known(found.goal.limits, 4.0) is None
    assert multiplier_text(found)[0] == "1 % more bending has no price known: this limit is missed"


def test_a_limit_that_is_missed_is_not_told_as_one_that_does_not_decide(data: dict[str, Any]) -> None:
    limit = {"quantity": "fatigue_safety", "sense": ">=", "required": 2.0, "reached": 1.9, "unit": ""}
    limit |= {"required_percent": 100.0, "reached_percent": 95.0, "active": True, "assumed": True}
    missed, held = (
        multiplier_text(
            _found(data | {"goal": goal(minimise="mass") | {"limits": [limit | {"holds": holds}]}})
        )
        for holds in (False, True)
    )
    assert "1 % more fatigue safety has no price known: this limit is missed" in missed
    assert "1 % more fatigue safety costs nothing: the other limits and rules decide before it" in held


@pytest.mark.parametrize(
    ("quantity", "sense", "active", "rest", "effect"),
    [
        ("fatigue_safety", ">=", True, 81.8, "has no price known: the prices explain too little"),
        ("fatigue_safety", ">=", True, 4.0, "costs nothing: the other limits and rules decide before it"),
        ("fatigue_safety", ">=", False, 81.8, "costs nothing: this limit does not decide"),
        ("twist", "<=", True, 81.8, "has no price known: the prices explain too little"),
    ],
)
def test_a_price_of_zero_of_a_poor_fit_is_not_told_as_known(
    data: dict[str, Any], quantity: str, sense: str, active: bool, rest: float, effect: str
) -> None:
    """A limit of the twist is one of the torsional stiffness in the search."""
    limit = {"quantity": quantity, "sense": sense, "required": 2.0, "reached": 2.01, "unit": ""}
    limit |= {"required_percent": 100.0, "reached_percent": 100.5, "assumed": True, "holds": True}
    known = {"quantity": "torsion" if quantity == "twist" else quantity, "sense": ">="}
    told = goal(minimise="mass") | {"limits": [limit | {"active": active}]}
    changed = {"goal": told, "prices_remainder_percent": rest}
    for price in (0.0, None) if "no price" in effect else (0.0,):
        prices = [{**known, "goal_percent_per_percent": price}]
        found = _found(data | changed | {"prices": prices})
        named = known["quantity"].replace("_", " ")
        assert multiplier_text(found)[0] == f"1 % more {named} {effect}"
        assert multiplier_table(found).rows[0]["the_goal"] == effect
        assert found.prices[0].known(found.goal.limits, rest) == (None if "no price" in effect else 0.0)


def test_a_search_that_misses_a_limit_says_how_to_go_on(data: dict[str, Any], tmp_path: Path) -> None:
    limit = {
        "quantity": "mass",
        "sense": "<=",
        "required": 2.0,
        "reached": 2.1,
        "unit": "kg",
        "assumed": False,
    }
    limit |= {"required_percent": 100.0, "reached_percent": 105.0, "active": True}
    ended, lines = {"seconds": {"total": 1.0}, "worst_case_percent": {"tolerance": 0.5}}, {}
    for holds in (False, True):
        told = goal(maximise="bending") | {"limits": [limit | {"holds": holds}]}
        found = _found(data | {"goal": told, "unfinished": not holds} | ended)
        lines[holds] = shape_summary(found, tmp_path / "a b")
    assert f"\ngo on from this web: cranktopo shape '{tmp_path}/a b'\n" in lines[False]
    assert "go on" not in lines[True]


def test_a_search_that_is_at_its_end_does_not_ask_for_the_same_again(data: dict[str, Any]) -> None:
    """A second run from the web of the first ended alike, with the same advice."""
    limits = [_limit("fatigue_safety", ">=", 1.2, 1.18, False)]
    data["goal"] = {**goal(minimise="mass"), "limits": limits}
    for original, kept in ((1.2, True), (1.1, False)):
        before, after = {"mass": 2.0, "fatigue_safety": original}, {"fatigue_safety": 1.18}
        data |= {"values": {"original": before, "result": after}, "unfinished": False, **TOLD}
        told = shape_summary(_found(data), Path("run"))
        assert "go on" not in told
        assert "\nfinishes come no nearer: loosen a limit" in told
        assert ("no web on the way did: keep the original" in told) == kept


def _window(data: dict[str, Any], least: float, greatest: float, active: str) -> list[str]:
    """Return the words for both sides of a balance factor of 49 to 51 %, one of them active."""
    limits = [
        _limit("balance_factor", sense, bound, 49.5, True) | {"active": sense == active}
        for sense, bound in ((">=", 49.0), ("<=", 51.0))
    ]
    prices = [
        {"quantity": "balance_factor", "sense": sense, "goal_percent_per_percent": cost}
        for sense, cost in ((">=", least), ("<=", greatest))
    ]
    data |= {"goal": {**goal(minimise="mass"), "limits": limits}, "prices": prices}
    return multiplier_text(_found(data))[:2]


def test_a_limit_of_a_negative_unbalance_moves_up_or_down(data: dict[str, Any]) -> None:
    """1 % more than -72.6 kg mm may be -73.4 or -71.9."""
    limits = [_limit("unbalance", sense, -72.6, -72.6, True) for sense in (">=", "<=")]
    for limit, way in zip(limits, ("higher", "lower"), strict=True):
        price = {"quantity": "unbalance", "sense": limit["sense"], "goal_percent_per_percent": 0.11}
        told = data | {"goal": {**goal(minimise="mass"), "limits": [limit]}, "prices": [price]}
        assert multiplier_text(_found(told))[0] == f"unbalance {way} by 1 % of its limit costs 0.11 % mass"


def test_both_sides_of_a_limit_are_told_apart(data: dict[str, Any]) -> None:
    more = "a least balance factor of 49.49 % in place of 49 %"
    less = "a greatest balance factor of 50.49 % in place of 51 %"
    assert _window(data, 0.05, 0.0, ">=") == [
        f"{more} costs 0.05 % mass",
        f"{less} does not decide: the least does",
    ]
    near = "costs nothing: the other limits and rules decide before it"
    assert _window(data, 0.0, 0.0, ">=") == [f"{more} {near}", f"{less} does not decide: the least is nearer"]
    assert _window(data, 0.0, 0.2, "<=") == [
        f"{more} does not decide: the greatest does",
        f"{less} costs 0.20 % mass",
    ]
    for price in (0.0, 0.2):
        assert _window(data, 0.0, price, "") == [
            f"{more} costs nothing: this limit does not decide",
            f"{less} costs nothing: this limit does not decide",
        ]


def test_a_goal_that_is_made_high_is_told_as_more_and_a_poor_balance_is_said(data: dict[str, Any]) -> None:
    told = multiplier_text(
        _found(data | {"goal": goal(maximise="torsion_per_mass"), "prices_remainder_percent": 28.0})
    )
    assert told[0] == "1 % more torsion costs 0.31 % torsion per mass"
    assert told[3] == "1 degree of 'least slot.draft' would give 0.20 % more torsion per mass"
    poor = multiplier_text(_found(data | {"prices_remainder_percent": 45.0}))
    assert "prices explain 55 %" in poor[-1]


def test_the_convergence_shows_goal_and_worst_limit_of_every_web(data: dict[str, Any]) -> None:
    drawn, limit = (
        picture("a", "a", draw, _found(data)).figure.axes[0] for draw in (draw_goal, draw_worst_limit)
    )
    assert np.asarray(drawn.lines[0].get_ydata()) == pytest.approx([90.0, 87.5])
    assert np.asarray(limit.lines[0].get_ydata()) == pytest.approx([0.4, 0.0])
    assert [tick.get_text() for tick in drawn.get_xticklabels()] == ["cells", "finish 1"]


def test_two_webs_are_no_curve(data: dict[str, Any]) -> None:
    assert curves(_found(data)) == ()
    assert len(curves(_found(data | {"rounds": [*data["rounds"], *data["rounds"]]}))) == 2
