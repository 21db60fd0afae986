"""Limits go to the page as the commands read them: both of a range, in units of the gauge."""

from __future__ import annotations

from typing import Any

from cranktopo.tasks.bench.project import gauge_limits


def told(**limits: Any) -> dict[str, Any]:
    return gauge_limits({"goal": {"minimise": "mass", "limits": limits}})


def test_a_range_is_two_limits_in_points() -> None:
    found = told(balance_factor=[">= 49 %", "<= 51 %"])["balance_factor"]
    assert [(one["sense"], one["value"], one["percent"]) for one in found] == [
        (">=", 49.0, False),
        ("<=", 51.0, False),
    ]


def test_a_limit_has_the_unit_of_its_gauge_and_the_words_of_the_file() -> None:
    """The page took 300 kN m/rad for 300 N m/rad: any web kept it."""
    (torsion,) = told(torsion=">= 300 kN m/rad")["torsion"]
    assert torsion == {"text": ">= 300 kN m/rad", "sense": ">=", "value": 300_000.0, "percent": False}
    assert told(mass="<= 95 %")["mass"][0]["percent"]


def test_what_is_no_limit_is_none() -> None:
    assert told(mass="none", torsion="> 3") == {}
    assert gauge_limits({}) == {}
