"""What shape.json holds, of an invented web."""

from __future__ import annotations

from typing import Any

from tests.told_evaluation import told_evaluation


def invented_data() -> dict[str, Any]:
    """What shape.json holds, of an invented web."""
    return {
        "goal": goal(minimise="mass"),
        "prices": [
            {"quantity": "torsion", "sense": ">=", "goal_percent_per_percent": 0.312},
            {"quantity": "unbalance", "sense": "<=", "goal_percent_per_percent": 0.05},
            {"quantity": "fatigue_safety", "sense": ">=", "goal_percent_per_percent": 0.0},
        ],
        "rule_prices": [
            {"name": "wall between both bores, 5 mm", "unit": "mm", "goal_percent_per_unit": 0.021},
            {"name": "least slot.draft", "unit": "deg", "goal_percent_per_unit": 0.2},
            {"name": "room of the envelope", "unit": "mm", "goal_percent_per_unit": 1e-7},
        ],
        "prices_remainder_percent": 4.0,
        "values": {"original": {"mass": 2.0}, "result": {}},
        "rounds": [
            {"values": {"mass": 1.8}, "excess_percent": [0.026, 0.4, 0.0047]},
            {"values": {"mass": 1.75}, "excess_percent": [-0.2, -3.0, 0.0]},
        ],
        "best_round": 1,
        "design": "invented",
        "status": "converged",
        "stop_reason": "",
        "original": told_evaluation(),
        "result": told_evaluation(),
        "change_percent": {},
        "parameters": [],
        "worst_case_percent": {},
        "goal_on_cells": {},
        "trials": [],
        "iterations": 2,
        "evaluations": 2,
        "seconds": {},
    }


def goal(**goal: str) -> dict[str, Any]:
    return {**goal, "reached": None, "original": None, "unit": "", "reached_percent": None, "limits": []}
