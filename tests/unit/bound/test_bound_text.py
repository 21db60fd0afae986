"""The bound beside a result, in words and as a picture."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cranktopo.design.goal.limit import Limit
from cranktopo.tasks.bound.result import BoundStatement, BoundStatements, NoBound
from cranktopo.tasks.bound.text import bound_lines, bound_picture, bound_sections, bound_table
from cranktopo.tasks.bound.webs import limit_on_cells

BOUND = {
    "quantity": "mass",
    "value": 1.29,
    "percent_of_original": 81.4,
    "reached_percent": 89.3,
    "dropped": [],
    "model": {"cell_mm": 3.0, "error_percent": {}},
}
AT_MASS = {**BOUND, "quantity": "torsion", "percent_of_original": 120.0, "at_mass_percent": 90.0}


def test_a_result_beside_its_bound() -> None:
    bound = BoundStatement.of_json(BOUND, "bound")
    (line,) = bound_lines(bound)
    assert line.startswith("mass -10.7 % of at most -18.6 %, which no web of the envelope can beat")
    assert [(row["web"], row["percent"]) for row in bound_table(bound).rows] == [
        ("original", 100.0),
        ("result", 89.3),
        ("bound", 81.4),
    ]
    picture = bound_picture(bound_table(bound), "mass")
    assert "result 89.3 %, bound 81.4 %" in picture.alt
    assert [axes.get_xlabel() for axes in picture.figure.axes] == ["mass, % of the original"]


def test_limits_that_the_proof_leaves_out_stand_beside_it() -> None:
    told = {**BOUND, "dropped": ["fatigue_safety >= 100 %", "balance_factor >= 48 %"]}
    (line,) = bound_lines(BoundStatement.of_json(told, "bound"))
    left_out = "without the limits fatigue_safety >= 100 %, balance_factor >= 48 %"
    assert line.endswith(f"(proven on cells of 3 mm {left_out})")
    (beyond,) = bound_lines(BoundStatement.of_json({**told, "reached_percent": 81.2}, "bound"))
    assert f"cells of 3 mm {left_out} can hold" in beyond


def test_each_statement_is_told() -> None:
    statements = [BOUND, AT_MASS, {**BOUND, "reached_percent": None}]
    data = BoundStatements.of_json({"statements": statements, "stiffest": {}}, "bound")
    mass, torsion = bound_lines(data)
    assert mass.startswith("mass -10.7 %")
    assert torsion.startswith("torsional stiffness -10.7 % of at most +20.0 % at this mass, which no web")
    (section,) = bound_sections(data, "cells")
    assert [picture.name for picture in section.pictures] == ["bound-mass", "bound-torsion"]


def test_where_there_is_no_bound() -> None:
    assert bound_lines(None) == []
    assert bound_lines(NoBound(none="dimensions are free")) == ["no bound: dimensions are free"]
    (section,) = bound_sections(NoBound(none="dimensions are free"), "cells")
    assert section.text == "No bound: dimensions are free."
    (line,) = bound_lines(BoundStatement.of_json({**BOUND, "value": None}, "bound"))
    assert "no web of the envelope keeps" in line


def test_a_result_beyond_the_best_of_the_cells_says_so() -> None:
    """The web is judged by another model than the bound: that the two disagree is told."""
    (line,) = bound_lines(BoundStatement.of_json({**BOUND, "reached_percent": 81.2}, "bound"))
    assert line.startswith("mass -18.8 %: beyond -18.6 %, the best that cells of 3 mm can hold")
    told = [{**AT_MASS, "reached_percent": 120.3}]
    (line,) = bound_lines(BoundStatements.of_json({"statements": told, "stiffest": {}}, "bound"))
    assert line.startswith("torsional stiffness +20.3 % at this mass: beyond +20.0 %")


@pytest.mark.parametrize(
    ("limit", "value"),
    [
        (Limit("unbalance", ">=", -72.63), -72.85),
        (Limit("mass", "<=", 6.7), 6.69),
        (Limit("torsion", ">=", 700.0), 735.0),
        (Limit("unbalance", "<=", 100.0, percent=True), 100.0),
        (Limit("fatigue_safety", ">=", 1.2), 1.2),
    ],
)
def test_a_limit_in_units_is_taken_as_the_cells_have_it(limit: Limit, value: float) -> None:
    cells = {"unbalance": -71.49, "mass": 6.79, "torsion": 735.0}
    judged = {"unbalance": -71.27, "mass": 6.80, "torsion": 700.0, "fatigue_safety": 1.3}
    assert limit_on_cells(limit, cells, judged) == replace(limit, value=pytest.approx(value))
