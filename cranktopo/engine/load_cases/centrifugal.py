"""The throw's own body force at the highest speed, and the pull of rods and pistons then.

Where the body force is off, that pull is an extreme of the radial force. It is taken with gas and without:
gas adds to the pull at bottom dead centre, and in a V, W or radial to that of the other cylinders.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from cranktopo.base.near_ties import clearly_more
from cranktopo.design.engine import Engine
from cranktopo.design.halves import halves
from cranktopo.design.load_kinds import MAIN_KINDS
from cranktopo.engine.analysis import Extreme
from cranktopo.engine.extreme_state import ExtremeState, ThrowLoads, place_of
from cranktopo.engine.forces import INERTIA_EFFECTS, RodsOnPin, rods_on_pins
from cranktopo.engine.gas import STEP_DEG
from cranktopo.engine.kinematics import exact_motion, force_ratios
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import LoadFacts
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.effect import Estimate
from cranktopo.engine.plan.load_rules import PlannedLoadType, by_size_or_goal


def _states(throw: ThrowLoads) -> tuple[ExtremeState, ...]:
    """The largest outward force on the pin at the highest speed, as its rods pull it."""
    pull, source = _largest_pull(throw)
    case = LoadCase(name="bending", kind="bending", radial_N=pull.value, source=source)
    if "centrifugal" in throw.enabled:
        speed, own_N = throw.top.engine.speed_rpm, throw.top.rotating.throw_N
        way = "inward" if own_N < 0 else "outward"
        source += f", with {abs(own_N):.0f} N of the throw itself {way}"
        case = LoadCase(
            name="centrifugal", kind="centrifugal", radial_N=pull.value, speed_rpm=speed, source=source
        )
    if not (case.size or case.has_body_force):
        return ()
    return (ExtremeState("overspeed_inertia", case, pull.deg),)


def _largest_pull(throw: ThrowLoads) -> tuple[Extreme, str]:
    """Return the largest outward force at the highest speed and where it is from, with gas or without.

    At the engine's own speed the pull with gas is an extreme of the radial force already; the centrifugal
    load has no other.
    """
    without, source = _pull_without_gas(throw)
    top, given = throw.top, throw.top.engine.max_gas_force_N
    counts = top is not throw.analysis or "centrifugal" in throw.enabled
    if not counts or given is not None or top.cycle is None:
        return without, source
    gas = top.cycle.extreme("web_force_N")[1]
    if not clearly_more(-gas.value, -without.value):
        return without, source
    return gas, f"largest pull on the web, with gas, at {place_of(top, gas)}"


def _pull_without_gas(throw: ThrowLoads) -> tuple[Extreme, str]:
    """Inertia alone: the rods pull the pin outward, one alone at top dead centre."""
    engine = throw.top.engine
    pins, radius = rods_on_pins(throw.scene, engine), throw.scene.throw.radius_mm
    kg, deg = _pulling_kg(engine, radius, pins, throw.enabled & INERTIA_EFFECTS)
    every = {1: "piston and rod at top dead centre", 2: "both pistons and rods of a pin"}
    pulling = every.get(engine.rods_per_pin, "all pistons and rods of a pin")
    source = f"inertia of {pulling} without gas force, {engine.speed_rpm:g} rpm"
    deg = deg % 360.0 + (360.0 if engine.strokes == 4 else 0.0)
    return Extreme(-kg * throw.top.rotating.r_w2_m_s2 + 0.0, deg), source


@lru_cache(maxsize=32)
def _pulling_kg(
    engine: Engine, radius: float, pins: tuple[RodsOnPin, ...], enabled: frozenset[str]
) -> tuple[float, float]:
    """Mass on the pin that would pull as much as rods and pistons at their worst, and the crank angle."""
    angle = np.arange(0.0, engine.cycle_deg, STEP_DEG)
    length = engine.rod_length_mm
    one = np.full_like(angle, engine.rod_rotating_kg * ("rotating_rod_mass" in enabled)) + 0j
    if "reciprocating_inertia" in enabled:
        moving = exact_motion(np.radians(angle), radius, length).acceleration_ratio
        ratios = force_ratios(np.radians(angle), radius, length)
        one += engine.reciprocating_kg * moving * (ratios.radial - 1j * ratios.tangential)
    curves = [rods.superpose(one, angle, engine.cycle_deg).real for rods in pins]
    curve = max(curves, key=lambda kg: float(kg.max()))
    return float(curve.max()), float(angle[int(curve.argmax())])


def _energy_Nmm(facts: LoadFacts) -> float:
    return facts.centrifugal_Nmm(*facts.centrifugal_N, fastened=False)


def _estimate(context: PlanningContext) -> Estimate:
    """Pull of pistons and rods at overspeed and of the crankpin on the pin, of each web in its mid-plane."""
    if context.scene.engine is None or context.top_speed_rpm == 0:
        return Estimate(0.0, "the throw does not turn", "nothing", absent="no speed in the scene")
    if context.for_stress and not context.unit_loads:
        return _own_stress(context)
    speed, (pin, webs) = context.top_speed_rpm, context.centrifugal_N
    forces = (
        f"outward {pin:,.0f} N on the pin, rods and pistons at their worst among them, and {webs:,.0f} N in "
        f"the mid-planes of the webs at {speed:g} rpm{_left_out(context)}"
    )
    return by_size_or_goal(context, LOAD_TYPE, forces)


def _left_out(context: PlanningContext) -> str:
    """Tell what of the pull cells leave out, and how much of it."""
    pull = context.fastened_N
    weights = [half.web.counterweight for half in halves(context.scene)]
    bolted = any(weight is not None and weight.bolted for weight in weights)
    plugs = any(weight is not None and weight.plug for weight in weights)
    named = [name for name, there in (("bolted counterweights", bolted), ("plugs", plugs)) if there]
    if not named:
        return ""
    way = "away from" if pull < 0 else "towards"
    return f"; {abs(pull):,.0f} N {way} the pin by {' and '.join(named)} act on meshes, not on cells"


def _own_stress(context: PlanningContext) -> Estimate:
    """Stress by the throw's own centrifugal load over that of the largest load: the root of their energies.

    Rods and pistons are left out: their pull is part of the radial force.
    """
    (pin, webs), speed = context.own_centrifugal_N, context.top_speed_rpm
    energy = context.centrifugal_Nmm(pin, webs)
    dominant = max(MAIN_KINDS, key=lambda name: context.energy_Nmm[name])
    percent = 100 * math.sqrt(energy / context.energy_Nmm[dominant])
    because = (
        f"outward {pin:,.0f} N of the crankpin and {webs:,.0f} N of the webs at {speed:g} rpm: "
        f"stress about {percent:.3g} % of {dominant}'s"
    )
    return Estimate(percent, because, f"stress about {percent:.3g} %", context.costing.load_case())


LOAD_TYPE = PlannedLoadType(
    "centrifugal",
    "overspeed_inertia",
    "speed_rpm",
    "centrifugal force",
    _states,
    _energy_Nmm,
    estimate=_estimate,
)
