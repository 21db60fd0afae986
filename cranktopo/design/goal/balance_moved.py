"""The balance of an engine that is balanced on purpose, where a web moved it and no limit holds it."""

from __future__ import annotations

from collections.abc import Mapping

from cranktopo.base.result import Result
from cranktopo.base.units import plain_number
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Scene

FELT_PERCENT = 2.0
"""Change of the balance factor, of the oscillating mass, that is told."""
_FACTOR, _UNBALANCE = "balance_factor", "unbalance"


class MovedBalance(Result):
    """A balance factor, percent of the oscillating mass, that left the original's, and what would hold it."""

    balance_factor_percent: float
    original_percent: float
    told: str

    @property
    def words(self) -> str:
        """Both factors in words, without the remedy."""
        return balance_words(self.balance_factor_percent, self.original_percent)


def balance_words(now_percent: float, before_percent: float) -> str:
    """Return a balance factor that moved in words."""
    return (
        f"balance factor {plain_number(now_percent, 3)} % of the oscillating mass "
        f"instead of {plain_number(before_percent, 3)} %"
    )


def balance_quantities(unbalance_kg_mm: float, factor_percent: float | None) -> dict[str, float]:
    """Return the balance of a throw by the names of the goal's quantities; the factor where there is one."""
    return {_UNBALANCE: unbalance_kg_mm, **({} if factor_percent is None else {_FACTOR: factor_percent})}


def balance_moved(
    scene: Scene,
    result: Mapping[str, float],
    original: Mapping[str, float],
    reference: str = "the original web",
) -> MovedBalance | None:
    """Return the balance factor of a web where it left the original's on a side without a limit.

    None where the factor is not known, moved by less than is felt, or the engine is not balanced on purpose.

    Args:
        result, original: quantities of both webs by name.
        reference: what the original is called.
    """
    meant = scene.web.counterweight is not None or (
        scene.engine is not None and scene.engine.arranged.balanced_oscillating_share is not None
    )
    if not meant or _FACTOR not in result or _FACTOR not in original:
        return None
    now, before = result[_FACTOR], original[_FACTOR]
    if abs(now - before) < FELT_PERCENT or _held(scene, rose=now > before):
        return None
    bound = f"<= {before + FELT_PERCENT:.0f}" if now > before else f">= {before - FELT_PERCENT:.0f}"
    needed = "lighter" if now > before else "heavier"
    sentence = (
        f"the balance factor is {plain_number(now, 3)} % of the oscillating mass, {reference} has "
        f"{plain_number(before, 3)} % (unbalance {plain_number(result[_UNBALANCE])} and "
        f"{plain_number(original[_UNBALANCE])} kg mm), and no limit holds it there: a {needed} counterweight "
        f"would do, or with a goal --limit '{_FACTOR} {bound} %'"
    )
    return MovedBalance(balance_factor_percent=now, original_percent=before, told=sentence)


def _held(scene: Scene, *, rose: bool) -> bool:
    """Tell whether the goal or a limit keeps the factor from that; an unbalance is its opposite."""
    goal = goal_of(scene)
    if goal is None:
        return False
    sides = {(_FACTOR, "<=" if rose else ">="), (_UNBALANCE, ">=" if rose else "<=")}
    return goal.quantity in (_FACTOR, _UNBALANCE) or any(
        (limit.quantity, limit.sense) in sides for limit in goal.limits
    )
