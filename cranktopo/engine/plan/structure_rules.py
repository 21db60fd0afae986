"""Rules of the effects that belong to the structure: bearings, fillets, bores, symmetry, process, fatigue.

A feature matters by what it changes in the stiffness of the throw.
"""

from __future__ import annotations

import math

from cranktopo.base.units import NMM_PER_NM
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.halves import difference, halves, of_halves
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.plan.beam import throw_compliance, web_section_modulus_mm3
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.effect import Effect
from cranktopo.engine.plan.estimate import Estimate
from cranktopo.engine.plan.goal_rules import wants_safety
from cranktopo.engine.plan.simulated import without
from cranktopo.engine.torsional_stiffness import journal_torsion_modulus_mm3, web_lever_mm


def bearing_compliance(context: PlanningContext) -> Estimate:
    """Two bearing springs in series with the bending stiffness of the throw (beam formula)."""
    scene = context.scene
    spring = bearing_spring_N_per_mm(scene)
    if spring is None:
        absent = "the scene gives neither bearing_spring_N_per_mm, bearing_clearance_mm nor roller_bearing"
        changes = "bearings are rigid; the best shape stays, springs are in series with it"
        return Estimate(None, "", changes, absent=absent, impossible=absent)
    own = context.compliance.bending_mm_per_N
    percent = 100 * (1 / (2 * spring)) / (own + 1 / (2 * spring))
    because = f"springs of {spring:,.0f} N/mm lower the bending stiffness by {percent:.3g} %"
    held = "spring" in (scene.supports.torsion, scene.supports.bending)
    needed = "a support is 'spring'" if held else ""
    stiffer = 100 * (1 / (2 * spring)) / own
    changes = f"reported bending stiffness {stiffer:+.2g} %; the best shape stays, springs are in series"
    return Estimate(percent, because, changes, needed=needed, indispensable=needed)


def fillets(context: PlanningContext) -> Estimate:
    """Rings at the ends of the journals: they shorten journals and web in the beam and torsion formulae.

    They cost nothing: for stiffness alone a sharp ring needs more elements than a fillet.
    """
    throw = context.scene.throw
    if throw.main_journal.fillet_mm == 0 and throw.crankpin.fillet_mm == 0:
        return Estimate(0.0, "", "nothing", absent="no fillet in the scene")
    sharp, rounded = context.compliance, throw_compliance(context.scene)
    torsion = 100 * (sharp.torsion_rad_per_Nmm / rounded.torsion_rad_per_Nmm - 1)
    bending = 100 * (sharp.bending_mm_per_N / rounded.bending_mm_per_N - 1)
    because = f"bending stiffness {bending:+.2g} %, torsional {torsion:+.2g} %"
    wanted = context.scene.effects.fatigue
    needed = (
        "fatigue needs them" if wanted == "on" or (wanted == "auto" and not _fatigue_absent(context)) else ""
    )
    return Estimate(
        max(torsion, bending),
        because,
        f"bending stiffness {-bending:+.2g} %, torsional {-torsion:+.2g} %, no stress",
        needed=needed,
    )


def bores(context: PlanningContext) -> Estimate:
    """Hollow against solid journal and pin: torsion formula, and mass of the throw in closed form."""
    throw = context.scene.throw
    if throw.main_journal.bore_diameter_mm == 0 and throw.crankpin.bore_diameter_mm == 0:
        return Estimate(0.0, "", "nothing", absent="no bore in the scene")
    hollow = throw_compliance(context.scene).torsion_rad_per_Nmm
    plain = without(context.scene, "bores")
    stiffer = 100 * (hollow / throw_compliance(plain).torsion_rad_per_Nmm - 1)
    heavier = 100 * (throw_balance(plain).mass_kg / context.balance.mass_kg - 1)
    because = f"solid journals would be {stiffer:.3g} % stiffer in torsion, the throw {heavier:.3g} % heavier"
    changes = f"torsional stiffness {stiffer:+.2g} %, mass {heavier:+.2g} %"
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
    share = 100 * second_mm3 / volume
    because = (
        f"{key} makes the halves differ, so that the mid-pin plane is no mirror; "
        f"{share:.3g} % of the volume lies beyond it"
    )
    changes = "nothing would be right: half of the throw says nothing of the other"
    return (
        Effect(
            name="whole_throw",
            state="on",
            reason=because,
            estimate_percent=None,
            cost=context.costing.whole_throw(volume),
            changes=changes,
        ),
    )


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

    Nominal stresses of IACS UR M53: bending moment at the web's mid-plane over B W^2 / 6, torque over the
    pin's modulus; concentration in the fillets (factors of 2 to 3) comes on top.
    """
    absent = _fatigue_absent(context)
    changes = "no safety against fatigue"
    if absent:
        # Two of the methods need nothing but the tensile strength; this estimate needs more.
        possible = context.scene.material.ultimate_MPa is not None and not context.unit_loads
        impossible = "" if possible else absent
        return Estimate(None, "", changes, context.costing.fatigue(), absent=absent, impossible=impossible)
    force, torque = _amplitudes(context)
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
    if context.unit_loads:
        return "unit loads give no stress level"
    if context.scene.material.fatigue_bending_MPa is None:
        return "material.fatigue_bending_MPa is not given"
    return ""


def _amplitudes(context: PlanningContext) -> tuple[float, float]:
    """Half the range of the radial force (N) and of the torque (N m) over the extreme states."""
    radial = [state.case.radial_N for state in context.states if state.case.kind == "bending"]
    torque = [state.case.torque_Nm for state in context.states if state.case.kind == "torsion"]
    return _half_range(radial), _half_range(torque)


def _half_range(values: list[float]) -> float:
    return (max(values) - min(0.0, *values)) / 2
