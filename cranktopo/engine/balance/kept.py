"""The balance that an engine is given on purpose, kept by a search that would otherwise drift from it."""

from __future__ import annotations

from cranktopo.base.notes import note
from cranktopo.base.units import plain_number
from cranktopo.design.balance_factor import rods_kg_mm, unbalance_at_kg_mm
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance

_ROOM = 0.02
"""Share of the oscillating mass by which the balance may move."""
_OF_BALANCE = "unbalance", "balance_factor"


def balance_kept(scene: Scene) -> Scene:
    """Return the scene whose goal keeps its throw as near to the balance that the engine asks for as it is.

    With `engine.arrangement.balanced_oscillating_share` counterweights are meant to take a share of the
    oscillating mass, no less and no more: the unbalance stays between the original's and the one asked for,
    with 2 % of that mass of room. A share of 0 that is given asks for the rotating masses alone. The scene
    itself is returned without a goal, a counterweight or a given share, and where the goal or a limit speaks
    of the balance. What is assumed is told.
    """
    engine, goal = scene.engine, scene.goal
    if engine is None or goal is None or scene.web.counterweight is None or _is_said(scene):
        return scene
    share, oscillating = engine.arranged.balanced_oscillating_share, rods_kg_mm(scene)[1]
    if share is None or not oscillating:
        return scene
    own, target = throw_balance(scene).throw_unbalance_kg_mm, unbalance_at_kg_mm(scene, 100 * share)
    room = _ROOM * oscillating
    low, high = (f"{end:.6g} kg mm" for end in (min(own, target) - room, max(own, target) + room))
    note(
        f"{scene.name}: assumed: goal.limits.unbalance from {low} to {high}: the balance stays as near as it "
        f"is to the {100 * share:g} % of the oscillating mass that the engine asks for, within "
        f"{plain_number(100 * _ROOM)} %; --limit 'unbalance none' leaves it free"
    )
    return with_goal(scene, limits=[f"unbalance >= {low}", f"unbalance <= {high}"])


def _is_said(scene: Scene) -> bool:
    goal = scene.goal
    assert goal is not None
    return goal.quantity in _OF_BALANCE or any(getattr(goal.limits, name) is not None for name in _OF_BALANCE)
