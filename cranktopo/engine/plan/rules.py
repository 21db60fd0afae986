"""Rules of the effects: inertia, structure, and what a goal asks for.

A load case matters by the strain energy that it puts into the throw: that is what the optimiser minimises.
An inertia matters by what it changes in the peak radial force on the web, a feature of the structure by what
it changes in the stiffness of the throw. A goal takes the load cases that it and its limits are read off.
"""

from __future__ import annotations

import math
from collections.abc import Collection

from cranktopo.base.errors import invalid
from cranktopo.base.units import NMM_PER_NM, signed_percent
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.halves import difference, halves, of_halves
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.cost import Cost
from cranktopo.engine.plan.effect import Effect, Estimate
from cranktopo.engine.plan.load_rules import wants_safety
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.engine.states import governing
from cranktopo.engine.throw_compliance import (
    journal_torsion_modulus_mm3,
    throw_compliance,
    web_lever_mm,
    web_section_modulus_mm3,
)

_NEGLIGIBLE = 1e-9
"""Unbalance over mass times throw radius that is nothing but rounding."""


def _unproven(goal: Goal) -> str:
    found = (QUANTITIES[limit.quantity].unproven for limit in goal.limits)
    return "; ".join(dict.fromkeys(why for why in found if why))


def bound(context: PlanningContext) -> Estimate:
    """Return what no web of the envelope can beat: wanted beside every result that it can be told of."""
    absent = "the scene has no [envelope]" if context.scene.envelope is None else ""
    if context.goal is not None and QUANTITIES[context.goal.quantity].unproven:
        absent = f"nothing is proven about {QUANTITIES[context.goal.quantity].label}"
    elif context.goal is not None and context.goal.held_by_elements_alone:
        absent = f"{_unproven(context.goal)}, and no limit asks for a stiffness"
    return Estimate(
        None,
        "",
        "how far a result is from the best possible web",
        Cost() if absent else context.costing.bound(),
        absent=absent,
        needed="" if absent else "it tells when to stop",
        impossible=absent,
    )


def check_goal_cases(context: PlanningContext, goal: Goal, cases: Collection[str]) -> None:
    """Check that a load case is on and that no limit is in percent of nothing."""
    if not cases:
        raise invalid(
            f"goal.{goal.sense}",
            goal.quantity,
            "no load case is on: neither goal nor limits speak of a stiffness",
            "Limit torsion or bending.",
        )
    original = context.balance.throw_unbalance_kg_mm
    size = context.balance.mass_kg * context.scene.throw.radius_mm
    for limit in goal.limits_of("unbalance"):
        as_it_is = limit.value == 100  # which has a meaning whatever the sign
        if limit.percent and not as_it_is and original < _NEGLIGIBLE * size:
            raise invalid(
                "goal.limits.unbalance",
                limit.condition,
                f"percent of the original's unbalance, which is {original:.3g} kg mm",
                "Give the limit in kg mm.",
            )


def bearing_compliance(context: PlanningContext) -> Estimate:
    """Two bearing springs in series with the bending stiffness of the throw (beam formula).

    It is on where a support is "spring": the supports of the scene decide what its stiffness has in it.
    """
    scene = context.scene
    spring = bearing_spring_N_per_mm(scene)
    if spring is None:
        absent = "the scene gives neither bearing_spring_N_per_mm, bearing_clearance_mm nor roller_bearing"
        changes = "bearings are rigid; the best shape stays, springs are in series with it"
        return Estimate(None, "", changes, absent=absent, impossible=absent)
    own = context.compliance.bending_mm_per_N
    percent = 100 * (1 / (2 * spring)) / (own + 1 / (2 * spring))
    because = f"springs of {spring:,.0f} N/mm lower the bending stiffness by {percent:.3g} %"
    supports = scene.supports
    if "spring" not in (supports.torsion, supports.bending):
        absent = f"supports.bending = '{supports.bending}' has no spring in it; 'spring' would take it in"
        return Estimate(percent, because, "nothing", absent=absent, impossible=absent)
    needed, changes = "a support is 'spring'", "nothing: the best shape stays, springs are in series"
    if supports.bending == "spring":
        stiffer = signed_percent(100 * (1 / (2 * spring)) / own)
        changes = f"reported bending stiffness {stiffer}; the best shape stays, springs are in series"
    return Estimate(percent, because, changes, needed=needed, indispensable=needed)


def fillets(context: PlanningContext) -> Estimate:
    """Rings at the ends of the journals: they shorten journals and web in the beam and torsion formulae.

    They cost nothing: for stiffness alone a sharp ring needs more elements than a fillet.
    """
    if not context.scene.throw.has_fillets:
        return Estimate(0.0, "", "nothing", absent="no fillet in the scene")
    sharp, rounded = context.compliance, throw_compliance(context.scene)
    torsion = 100 * (sharp.torsion_rad_per_Nmm / rounded.torsion_rad_per_Nmm - 1)
    bending = 100 * (sharp.bending_mm_per_N / rounded.bending_mm_per_N - 1)
    because = f"bending stiffness {signed_percent(bending)}, torsional {signed_percent(torsion)}"
    switch = context.scene.effects.fatigue
    needed = (
        "fatigue needs them" if switch == "on" or (switch == "auto" and not _fatigue_absent(context)) else ""
    )
    return Estimate(
        max(torsion, bending),
        because,
        f"bending stiffness {signed_percent(-bending)}, torsional {signed_percent(-torsion)}, no stress",
        needed=needed,
    )


def bores(context: PlanningContext) -> Estimate:
    """Hollow against solid journal and pin: torsion formula, and mass of the throw in closed form."""
    throw = context.scene.throw
    if throw.main_journal.bore_diameter_mm == 0 and throw.crankpin.bore_diameter_mm == 0:
        return Estimate(0.0, "", "nothing", absent="no bore in the scene")
    hollow = throw_compliance(context.scene).torsion_rad_per_Nmm
    plain = strip_features(context.scene, "bores")
    stiffer = 100 * (hollow / throw_compliance(plain).torsion_rad_per_Nmm - 1)
    heavier = 100 * (throw_balance(plain).mass_kg / context.balance.mass_kg - 1)
    because = f"solid journals would be {stiffer:.3g} % stiffer in torsion, the throw {heavier:.3g} % heavier"
    changes = f"torsional stiffness {signed_percent(stiffer)}, mass {signed_percent(heavier)}"
    return Estimate(max(stiffer, heavier), because, changes)


def lateral_symmetry(context: PlanningContext) -> Estimate:
    """The plane x = 0 as a mirror: exact when geometry is symmetric, each case being even or odd in x."""
    cost = context.costing.mirror()
    if context.asymmetry:
        why = f"{context.asymmetry} is not symmetric in x"
        return Estimate(None, "", "nothing", cost, absent=why, impossible=why)
    because = (
        "web and envelope are symmetric in x and every load case is even or odd: half the cells, same answer"
    )
    return Estimate(0.0, because, "nothing but time", cost, needed=because)


def whole_throw(context: PlanningContext) -> tuple[Effect, ...]:
    """Both halves in one model, which nobody can switch: no row where they are alike and half is enough."""
    key = difference(context.scene)
    if not key:
        return ()
    first_mm3, second_mm3 = of_halves(context.scene, half_throw_volume_mm3)
    volume = first_mm3 + second_mm3
    because = (
        f"{key} makes the halves differ, so that the mid-pin plane is no mirror; "
        f"{100 * second_mm3 / volume:.3g} % of the volume lies beyond it"
    )
    effect = Effect(
        name="whole_throw",
        state="on",
        reason=because,
        estimate_percent=None,
        cost=context.costing.whole_throw(volume),
        changes="nothing would be right: half of the throw says nothing of the other",
    )
    return (effect,)


def manufacturing_constraint(context: PlanningContext) -> Estimate:
    """Return a die, a mould or a mill; what it costs is the difference between two optimisations."""
    settings = context.scene.optimise
    process, along_x = settings.process, settings.parting == "lateral"
    changes = "the shape may have undercuts and closed hollows"
    why = {
        "milled": "a mill must reach every void from a web face or a side",
        "cast": f"the halves of a mould must leave along {'x' if along_x else 'z'}",
    }.get(process, f"a die that parts in {'the plane x = 0' if along_x else 'mid-web'} must release the web")
    if process != "free":
        return Estimate(None, why, changes, needed=f"optimise.process is {process}")
    return Estimate(None, "", changes, absent=f"optimise.process is {process}: no die to release from")


def fatigue(context: PlanningContext) -> Estimate:
    """Nominal stress amplitude of web bending and pin torsion over the fatigue strength in bending.

    Loads are the extremes that fatigue judges, of both signs over the cycle, and the pull at overspeed; the
    slow speed that fatigue judges is among them.

    Nominal stresses of IACS UR M53: bending moment at the web's mid-plane over B W^2 / 6, torque over the
    pin's modulus; concentration in the fillets (factors of 2 to 3) comes on top.
    """
    absent = _fatigue_absent(context)
    changes = "no safety against fatigue"
    if absent:
        # Two of the methods need nothing but the tensile strength; this estimate needs more.
        possible = context.scene.material.ultimate_MPa is not None and context.tells_stress
        impossible = "" if possible else absent
        return Estimate(None, "", changes, context.costing.fatigue(), absent=absent, impossible=impossible)
    force, torque = context.amplitudes
    webs = halves(context.scene)
    bend = force / 2 * max(web_lever_mm(half) / web_section_modulus_mm3(half) for half in webs)
    shear = torque * NMM_PER_NM / journal_torsion_modulus_mm3(context.scene.throw.crankpin)
    stress = math.hypot(bend, math.sqrt(3) * shear)
    strength = context.scene.material.fatigue_bending_MPa or math.inf
    percent = 100 * stress / strength
    because = f"nominal amplitude {stress:.0f} MPa is {percent:.3g} % of the strength {strength:g} MPa"
    needed = wants_safety(context.goal)
    return Estimate(percent, because, changes, context.costing.fatigue(), needed=needed)


def _fatigue_absent(context: PlanningContext) -> str:
    if not context.tells_stress:
        return "unit loads give no stress level"
    if context.scene.material.fatigue_bending_MPa is None:
        return "material.fatigue_bending_MPa is not given"
    return ""


def reciprocating_inertia(context: PlanningContext) -> Estimate:
    """Inertia of piston group and upper part of the rod, at the angle of the peak force."""
    return _inertia(context, "reciprocating_inertia", "piston and rod's upper end")


def rotating_rod_mass(context: PlanningContext) -> Estimate:
    """Centrifugal force of the rod's big end on the pin."""
    return _inertia(context, "rotating_rod_mass", "rod's big end")


def _inertia(context: PlanningContext, name: str, what: str) -> Estimate:
    engine = context.scene.engine
    if engine is None or (engine.gas is None and engine.max_gas_force_N is None):
        return Estimate(None, "", "nothing", absent="no gas force in the scene to compare with")
    if engine.max_gas_force_N is not None:
        absent = "engine.max_gas_force_N is taken as it is"
        return Estimate(None, "", "the pull at overspeed", absent=absent)
    full = context.state("bending").case.radial_N
    other = governing(context.states_without(name), "bending").case.radial_N
    percent = 100 * abs(other - full) / abs(full)
    because = f"{what}: peak radial force {full:,.0f} N with it, {other:,.0f} N without"
    changes = f"radial force {other:,.0f} N in place of {full:,.0f} N"
    if other * full > 0:
        changes = f"radial force {signed_percent(100 * (other - full) / full)}"
    return Estimate(percent, because, changes)
