"""A run without a limit of the balance says where the balance of an engine went."""

from __future__ import annotations

import pytest

from cranktopo.design.goal.wanted import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.tasks.optimise.metrics import balance_notices

BEFORE, AFTER = {"balance_factor": 50.0, "unbalance": -34.9}, {"balance_factor": 84.0, "unbalance": -45.8}


def test_a_balance_that_moved_is_told() -> None:
    (told,) = balance_notices(load_scene("industrial-gas"), AFTER, BEFORE)
    assert "the balance factor is 84 % of the oscillating mass, the original web has 50 %" in told
    assert "unbalance -45.8 and -34.9 kg mm" in told


@pytest.mark.parametrize("limit", ["balance_factor >= 48 %", "unbalance <= -30 kg mm"])
def test_what_a_limit_holds_is_no_news(limit: str) -> None:
    scene = with_goal(load_scene("industrial-gas"), minimise="mass", limits=(limit,))
    assert balance_notices(scene, AFTER, BEFORE) == []


def test_nothing_is_told_of_small_changes_or_webs_without_counterweights() -> None:
    assert balance_notices(load_scene("industrial-gas"), {**BEFORE, "balance_factor": 51.0}, BEFORE) == []
    assert balance_notices(load_scene("mikron-iiic"), AFTER, BEFORE) == []
