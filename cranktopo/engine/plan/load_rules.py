"""Rules of the effects that are loads.

A load case matters by the strain energy that it puts into the throw: that is what the optimiser minimises.
An inertia matters by what it changes in the peak radial force on the web.
"""

from __future__ import annotations

from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.load_case import LOAD_TYPES, MAIN_KINDS, LoadKind
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.estimate import Estimate
from cranktopo.engine.plan.goal_rules import as_wanted
from cranktopo.engine.states import extreme_states


def quasi_static(kind: LoadKind, context: PlanningContext) -> Estimate:
    """Estimate a load on pin or journals by the closed-form strain energy that it causes."""
    load = LOAD_TYPES[kind]
    size = getattr(context.state(kind).case, load.load)
    amount = f"{size:,.1f} N m" if load.load == "torque_Nm" else f"{size:,.0f} N"
    return _case(context, kind, f"{load.label} {amount}")


def centrifugal(context: PlanningContext) -> Estimate:
    """Pull of piston and rod at overspeed and centrifugal force of the throw, as if all acted on the pin."""
    if context.scene.engine is None or context.top_speed_rpm == 0:
        return Estimate(0.0, "the throw does not turn", "nothing", absent="no speed in the scene")
    speed = context.top_speed_rpm
    throw, pull = context.rotating(speed).throw_N, context.overspeed_pull_N
    weight = context.scene.web.counterweight
    left_out = (
        ", the bolted counterweight's own pull left out" if weight is not None and weight.bolted else ""
    )
    forces = f"throw {throw:,.0f} N and rod {pull:,.0f} N at {speed:g} rpm{left_out}"
    return _case(context, "centrifugal", forces)


def reciprocating_inertia(context: PlanningContext) -> Estimate:
    """Inertia of piston group and upper part of the rod, at the angle of the peak force."""
    return _inertia(context, "reciprocating_inertia", "piston and rod's upper end")


def rotating_rod_mass(context: PlanningContext) -> Estimate:
    """Centrifugal force of the rod's big end on the pin."""
    return _inertia(context, "rotating_rod_mass", "rod's big end")


def _case(context: PlanningContext, kind: LoadKind, load: str) -> Estimate:
    found = _by_size(context, kind, load)
    return found if context.goal is None else as_wanted(found, context.goal, kind)


def _by_size(context: PlanningContext, kind: LoadKind, load: str) -> Estimate:
    cost, changes = context.costing.load_case(), f"no {kind} in the objective"
    if context.unit_loads:
        why = "unit loads cannot be compared"
        needed, absent = (why, "") if kind in MAIN_KINDS else ("", why)
        return Estimate(None, load, changes, cost, absent=absent, needed=needed)
    energy = context.energy_Nmm
    dominant = max(MAIN_KINDS, key=lambda name: energy[name])
    percent = 100 * energy[kind] / energy[dominant] if energy[dominant] else 0.0
    because = f"{load}: strain energy {percent:.3g} % of {dominant}'s"
    if kind == dominant:
        because = f"{load}: the largest strain energy ({energy[kind] / 1000:.3g} J)"
    weightless = getattr(context.scene.optimise.weights, kind) == 0
    absent = f"optimise.weights.{kind} is 0" if weightless else ""
    changes += f" ({percent:.3g} % of the largest energy)"
    return Estimate(percent, because, changes, cost, absent=absent)


def _inertia(context: PlanningContext, name: str, what: str) -> Estimate:
    engine = context.scene.engine
    if engine is None or (engine.gas is None and engine.max_gas_force_N is None):
        return Estimate(None, "", "nothing", absent="no gas force in the scene to compare with")
    if engine.max_gas_force_N is not None:
        absent = "engine.max_gas_force_N is taken as it is"
        return Estimate(None, "", "the pull at overspeed", absent=absent)
    full = context.state("bending").case.radial_N
    without = extreme_states(context.scene, INERTIA_EFFECTS - {name})
    other = next(s for s in without if s.name == "max_radial").case.radial_N
    percent = 100 * abs(other - full) / abs(full)
    because = f"{what}: peak radial force {full:,.0f} N with it, {other:,.0f} N without"
    changes = f"radial force {100 * (other - full) / abs(full):+.2g} %"
    return Estimate(percent, because, changes)
