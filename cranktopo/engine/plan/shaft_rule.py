"""Rule of the continuous shaft: what neighbouring throws do to the bending of the webs, as a beam."""

from __future__ import annotations

from cranktopo.base.units import plain_number
from cranktopo.design.schema import Scene
from cranktopo.engine.continuous_beam import span_bending
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.cost import Cost
from cranktopo.engine.plan.effect import Estimate

_BEAM_ERROR = 0.05
"""Allowed error of the beam; 0.04 was found beside elements, on seven engines and up to four bearings."""


def continuous_shaft(context: PlanningContext) -> Estimate:
    """Bending range of the worst web over that of a throw alone on rigid bearings.

    Where a throw alone is the worse case, it is on the safe side, and `auto` stays with it whatever the size.
    """
    absent = _absent(context.scene)
    if absent:
        return Estimate(None, "", "nothing", absent=absent, impossible=absent)
    found = span_bending(context.scene)
    spring = found.spring_N_per_mm
    held = "rigid bearings" if spring is None else f"bearings of {spring:,.0f} N/mm"
    percent = 100 * (found.largest - 1)
    share = f"{found.least:.2f} to {found.largest:.2f}"
    because = f"bending of the webs {share} of that of a throw alone (beam on {held})"
    safe, not_sure = "a throw alone is on the safe side", "a throw alone is not surely on the safe side"
    is_safe = found.largest < 1 - _BEAM_ERROR
    changes = (
        f"bending of the worst web {_alone_percent(found.largest)} %, "
        f"largest force on a main bearing (no. {found.bearing}) {_alone_percent(found.bearing_share)} %"
    )
    cost = Cost(solves=8.0, seconds=context.costing.fatigue().seconds)
    return Estimate(
        percent, because, changes, cost, absent=safe if is_safe else "", needed="" if is_safe else not_sure
    )


def _alone_percent(share: float) -> str:
    """Return what throws alone have more than the shaft, with its sign."""
    return f"{'+' * (share < 1)}{plain_number(100 * (1 / share - 1), 2)}"


def _absent(scene: Scene) -> str:
    """Reason that nothing can be told of the shaft; empty when it can."""
    engine = scene.engine
    if engine is None or engine.gas is None:
        return "the scene tells no forces over the cycle ([engine.gas])"
    peak_loads = (engine.max_gas_force_N, engine.max_torque_Nm, engine.min_torque_Nm)
    if any(value is not None for value in peak_loads):
        return "the largest gas force or torque is given and taken as it is"
    return "" if engine.throws > 1 else "one throw between two bearings"
