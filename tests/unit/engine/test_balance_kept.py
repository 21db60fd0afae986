"""A search keeps the balance that counterweights are given on purpose, from both sides."""

from __future__ import annotations

import pytest

from cranktopo.design.balance_factor import balance_factor_percent
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.kept import balance_kept
from cranktopo.engine.balance.throw import throw_balance


def asking(share: float, *limits: str, name: str = "car-diesel", minimise: str = "mass") -> Scene:
    scene = with_values(load_scene(name), {"engine.arrangement.balanced_oscillating_share": share})
    return with_goal(scene, minimise=minimise, limits=limits)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_no_farther_from_the_balance_that_is_asked_for_than_it_is(
    share: float, caplog: pytest.LogCaptureFixture
) -> None:
    """By hand: the factor of the original on one side, the share asked for on the other, 2 % of room."""
    caplog.set_level("INFO")
    scene = balance_kept(asking(share))
    goal = goal_of(scene)
    assert goal is not None
    low, high = sorted(limit.value for limit in goal.limits_of("unbalance"))
    own = throw_balance(scene).balance_factor_percent
    assert own is not None
    factors = sorted(balance_factor_percent(scene, one) or 0.0 for one in (low, high))
    assert factors == pytest.approx([min(own, 100 * share) - 2, max(own, 100 * share) + 2], abs=1e-3)
    assert "goal.limits.unbalance from" in caplog.text
    assert not any(limit.percent for limit in goal.limits_of("unbalance"))


@pytest.mark.parametrize(
    "scene",
    [
        with_goal(load_scene("car-diesel"), minimise="mass"),
        asking(0.5, "unbalance none"),
        asking(0.5, "balance_factor >= 40 %"),
        asking(0.5, minimise="unbalance"),
        asking(0.5, name="mikron-iiic"),
        with_values(load_scene("car-diesel"), {"engine.arrangement.balanced_oscillating_share": 0.5}),
    ],
    ids=["no share", "left free", "given", "goal", "no counterweight", "no goal"],
)
def test_where_nothing_is_to_be_kept_or_something_is_said(scene: Scene) -> None:
    assert balance_kept(scene) is scene
