"""The bound beside a result, in words and as a picture."""

from __future__ import annotations

from typing import Any

from cranktopo.report.figures.bound_scale import bound_picture
from cranktopo.report.tables.bound_text import bound_line, bound_table

BOUND = {"quantity": "mass", "value": 1.29, "percent_of_original": 81.4, "model": {"cell_mm": 3.0}}


def data(bound: Any) -> dict[str, Any]:
    return {"goal": {"minimise": "mass", "reached_percent": 89.3}, "bound": bound}


def test_a_result_beside_its_bound() -> None:
    told = data(BOUND)
    assert bound_line(told).startswith(
        "mass -10.7 % of at most -18.6 %, which no web of the envelope can beat"
    )
    assert [(row["web"], row["percent"]) for row in bound_table(told).rows] == [
        ("original", 100.0),
        ("result", 89.3),
        ("bound", 81.4),
    ]
    assert "result 89.3 %, bound 81.4 %" in bound_picture(bound_table(told)).alt


def test_where_there_is_no_bound() -> None:
    assert bound_line(data(None)) == ""
    assert bound_line(data({"none": "dimensions of the throw are free"})).startswith("no bound: dimensions")
    assert "no web of the envelope keeps" in bound_line(data({**BOUND, "value": None}))
