"""A web without a limit of the balance says where the balance of its engine went."""

from __future__ import annotations

import pytest

from cranktopo.design.goal.balance_moved import balance_moved
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene

BEFORE, AFTER = {"balance_factor": 50.0, "unbalance": -34.9}, {"balance_factor": 84.0, "unbalance": -45.8}


def differences_from(scene: Scene, now: dict[str, float], before: dict[str, float]) -> str:
    moved = balance_moved(scene, now, before)
    return moved.told if moved else ""


def test_a_balance_that_moved_is_told() -> None:
    told = differences_from(load_scene("industrial-gas"), AFTER, BEFORE)
    assert "the balance factor is 84 % of the oscillating mass, the original web has 50 %" in told
    assert "unbalance -45.8 and -34.9 kg mm" in told
    assert told.endswith("a lighter counterweight would do, or with a goal --limit 'balance_factor <= 52 %'")


@pytest.mark.parametrize(
    ("limits", "held"),
    [
        (("balance_factor <= 52 %",), "rise"),
        (("unbalance >= -36 kg mm",), "rise"),
        (("balance_factor >= 48 %",), "fall"),
        (("unbalance <= -30 kg mm",), "fall"),
        ((), "fall"),  # by default the unbalance stays at most as it is, which bars no rise
    ],
)
def test_a_limit_holds_it_on_its_own_side(limits: tuple[str, ...], held: str) -> None:
    scene = with_goal(load_scene("industrial-gas"), minimise="mass", limits=limits)
    rise, fall = differences_from(scene, AFTER, BEFORE), differences_from(scene, BEFORE, AFTER)
    assert (rise == "") == (held == "rise")
    assert (fall == "") == (held == "fall")
    assert "heavier" not in rise
    assert "lighter" not in fall


def test_nothing_is_told_of_small_changes_or_webs_without_counterweights() -> None:
    assert balance_moved(load_scene("industrial-gas"), {**BEFORE, "balance_factor": 51.0}, BEFORE) is None
    assert balance_moved(load_scene("mikron-iiic"), AFTER, BEFORE) is None
    goal = with_goal(load_scene("industrial-gas"), maximise="balance_factor")
    assert balance_moved(goal, AFTER, BEFORE) is None
