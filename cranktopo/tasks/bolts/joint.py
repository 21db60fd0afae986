"""One bolted joint: stiffness of bolt and clamped parts, preload, tightening, and what the load leaves of it.

Sources: VDI 2230 part 1 (2015), concentric joints, steps R0 to R13 without sliding; R. Budynas, K. Nisbett,
Shigley's Mechanical Engineering Design, chapter 8, cones of 30 deg, as the second method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from cranktopo.base.units import MM_PER_M, MPA_PER_GPA, NMM_PER_NM
from cranktopo.design.bolt import LOST_TURNS, Bolt, strength
from cranktopo.design.material import Material

BOLT_E_MPA = 205_000.0
"""Young's modulus of bolts, VDI 2230."""
_SHEAR_RATIO = 0.6
"""Shear over tensile strength of bolt and part; VDI 2230 has 0.60 to 0.65 for these bolts and for steel."""
_BENT_BOLT = 0.897
"""Factor on the bolt's thread for its bending, VDI 2230 (5.6); that of the softer nut is `_bent_nut`."""
_TORSION_LEFT = 0.5
"""Share of the torsion of tightening that counts in service, VDI 2230 (5.5)."""
_TORQUE_COEFFICIENT = 0.2
"""K of Shigley's T = K F d, for any condition."""
_SHIGLEY_HEAD, _CONE_TAN = 1.5, 0.5774
"""Shigley's head over the thread's diameter, and the slope of a cone of 30 deg as printed."""


@dataclass(frozen=True)
class JointLoads:
    """Force on one bolt along its axis, positive parting the joint, and what must stay clamped, N."""

    max_N: float
    min_N: float = 0.0
    clamp_N: float = 0.0


def bolt_compliance_mm_per_N(bolt: Bolt, part_E_MPa: float) -> float:
    """Return the elongation of the bolt per newton: head, shank, free thread, engaged thread, nut or hole."""
    nominal = bolt.nominal
    core, full = nominal.core_area_mm2, math.pi / 4 * nominal.diameter_mm**2
    at_shank = bolt.shank_mm / bolt.shank_area_mm2
    at_thread = (bolt.grip_mm - bolt.shank_mm + 0.5 * nominal.diameter_mm) / core
    head = 0.5 * nominal.diameter_mm / full
    nut, nut_E = (0.4, BOLT_E_MPA) if bolt.held_in == "nut" else (0.33, part_E_MPa)
    return (head + at_shank + at_thread) / BOLT_E_MPA + nut * nominal.diameter_mm / (full * nut_E)


def part_compliance_mm_per_N(bolt: Bolt, E_MPa: float) -> float:
    """Return the shortening of the clamped parts per newton: cones of pressure and the sleeve between."""
    head, hole, grip = bolt.head_mm, bolt.hole_mm, bolt.grip_mm
    outer, cones = bolt.member_diameter_mm, 1 if bolt.held_in == "nut" else 2
    if outer is not None and outer <= head:
        return 4 * grip / (E_MPa * math.pi * (outer**2 - hole**2))
    slope = _cone_slope(grip / head, (outer or 100 * head) / head, cones)
    widest = head + cones * grip * slope
    edge = widest if outer is None else min(outer, widest)
    ratio = (head + hole) * (edge - hole) / ((head - hole) * (edge + hole))
    cone = 2 / (cones * hole * slope) * math.log(ratio)
    sleeve = 4 / (edge**2 - hole**2) * (grip - (edge - head) / (cones * slope))
    return (cone + sleeve) / (E_MPa * math.pi)


def _cone_slope(length_ratio: float, width_ratio: float, cones: int) -> float:
    """Return tan phi of the cone of pressure; ratios beyond the rule's range count as its ends."""
    width = math.log(min(width_ratio, 10.0))
    if cones == 1:
        return max(0.362 + 0.032 * math.log(length_ratio / 2) + 0.153 * width, 0.1)
    return max(0.348 + 0.013 * math.log(length_ratio) + 0.193 * width, 0.1)


def assembly_preload_N(bolt: Bolt) -> float:
    """Return the preload at which tension and torsion of tightening take the utilised share of the yield."""
    nominal = bolt.nominal
    lever = nominal.pitch_mm / (math.pi * nominal.pitch_diameter_mm) + 1.155 * bolt.thread_friction
    torsion = 1.5 * nominal.pitch_diameter_mm / bolt.stressed_diameter_mm * lever
    limit = bolt.utilisation * strength(bolt.strength_class, nominal).yield_MPa
    return bolt.stressed_area_mm2 * limit / math.sqrt(1 + 3 * torsion**2)


def largest_preload_N(bolt: Bolt) -> float:
    """Return the largest preload that tightening may leave: that given, or the one by the yield."""
    return bolt.preload_N or assembly_preload_N(bolt)


def mean_preload_N(bolt: Bolt) -> float:
    """Return the middle of the preloads that tightening may leave, before settling."""
    return largest_preload_N(bolt) * (1 + 1 / bolt.tightening_factor) / 2


def tightening_torque_Nm(bolt: Bolt, preload_N: float) -> float:
    """Return the torque that makes a preload."""
    below_head = (bolt.head_mm + bolt.hole_mm) / 4 * bolt.head_friction
    return preload_N * (_thread_lever_mm(bolt) + below_head) / NMM_PER_NM


def _thread_lever_mm(bolt: Bolt) -> float:
    nominal = bolt.nominal
    return 0.16 * nominal.pitch_mm + 0.58 * nominal.pitch_diameter_mm * bolt.thread_friction


@dataclass(frozen=True)
class Vdi:
    """Forces, stresses and safeties of a joint by VDI 2230; largest with the largest preload of the scatter.

    Attributes:
        load_factor: Phi, share of the load that the bolt feels.
        needed_preload_N: needed preload with its scatter, as the largest of it, F_Mmax.
        residual_clamp_N: force left on the split under the largest load with the smallest preload.
        clamp_safety: smallest preload after settling over what load and clamp force need.
        thread_safety: force that strips the engaged thread over that which breaks the bolt in its thread.
    """

    bolt_N_per_mm: float
    parts_N_per_mm: float
    load_factor: float
    preload_N: float
    least_preload_N: float
    needed_preload_N: float
    torque_Nm: float
    settling_loss_N: float
    max_bolt_N: float
    residual_clamp_N: float
    clamp_safety: float | None
    assembly_stress_MPa: float
    working_stress_MPa: float
    yield_safety: float
    amplitude_MPa: float
    endurance_MPa: float
    fatigue_safety: float | None
    head_pressure_MPa: float
    head_pressure_safety: float | None
    thread_safety: float | None


def vdi_2230(bolt: Bolt, loads: JointLoads, material: Material, permitted_MPa: float | None = None) -> Vdi:
    """Return the verification of a joint by VDI 2230."""
    limits, area = strength(bolt.strength_class, bolt.nominal), bolt.stressed_area_mm2
    E = material.E_GPa * MPA_PER_GPA
    own, parts = bolt_compliance_mm_per_N(bolt, E), part_compliance_mm_per_N(bolt, E)
    factor = bolt.load_introduction * parts / (own + parts)
    preload = largest_preload_N(bolt)
    lost = bolt.embedding_um / MM_PER_M / (own + parts)
    least = preload / bolt.tightening_factor - lost
    needed = loads.clamp_N + (1 - factor) * loads.max_N
    largest = preload + max(factor * loads.max_N, 0.0)
    tension = largest / area
    amplitude = factor * (loads.max_N - loads.min_N) / (2 * area)
    endurance = 0.85 * (150 / bolt.nominal.diameter_mm + 45)
    pressure = largest / (math.pi / 4 * (bolt.head_mm**2 - bolt.hole_mm**2))
    torsion = preload * _thread_lever_mm(bolt) / (math.pi * bolt.stressed_diameter_mm**3)
    working = math.hypot(tension, math.sqrt(3) * _TORSION_LEFT * 16 * torsion)
    assembly = math.hypot(preload / area, math.sqrt(3) * 12 * torsion)  # plastic: 12
    permitted = permitted_MPa or material.ultimate_MPa or 0.0
    return Vdi(
        1 / own,
        1 / parts,
        factor,
        preload,
        least,
        bolt.tightening_factor * (needed + lost),
        tightening_torque_Nm(bolt, preload),
        lost,
        largest,
        least - (1 - factor) * loads.max_N,
        _over(least, needed),
        assembly,
        working,
        limits.yield_MPa / working,
        amplitude,
        endurance,
        _over(endurance, amplitude),
        pressure,
        permitted / pressure or None,
        _thread_safety(bolt, material),
    )


def _over(capacity: float, use: float) -> float | None:
    """Return a safety; None where nothing is used."""
    return capacity / use if use > 0 else None


def _thread_safety(bolt: Bolt, material: Material) -> float | None:
    """Return the force that strips bolt or nut thread over that which breaks the bolt in it; VDI 2230 (5.6).

    None where the tensile strength of the part is not known.
    """
    nominal, limits = bolt.nominal, strength(bolt.strength_class, bolt.nominal)
    part_MPa = material.ultimate_MPa if bolt.held_in == "tapped_hole" else limits.ultimate_MPa
    turns = bolt.engaged_mm / nominal.pitch_mm - LOST_TURNS
    if part_MPa is None:
        return None
    flat, slope = nominal.pitch_mm / 2, math.sqrt(3)
    nut_mm2 = (nominal.diameter_mm - nominal.pitch_diameter_mm) / slope + flat
    nut_mm2 *= math.pi * nominal.diameter_mm * turns
    core = nominal.nut_core_diameter_mm
    bolt_mm2 = math.pi * core * turns * (flat + (nominal.pitch_diameter_mm - core) / slope)
    nut_N = _SHEAR_RATIO * part_MPa * nut_mm2
    bolt_N = _SHEAR_RATIO * limits.ultimate_MPa * bolt_mm2
    held_N = min(nut_N * _bent_nut(nut_N / bolt_N), bolt_N * _BENT_BOLT)
    return held_N / (limits.ultimate_MPa * nominal.stress_area_mm2)


def _bent_nut(ratio: float) -> float:
    """Return C3 for the strength of the nut's thread over that of the bolt's."""
    ratio = min(max(ratio, 0.4), 1.0)
    return 0.728 + 1.769 * ratio - 2.896 * ratio**2 + 1.296 * ratio**3


@dataclass(frozen=True)
class Shigley:
    """The same joint by Shigley.

    Attributes:
        stiffness_share: C, share of the load that the bolt feels.
        load_safety: overload that brings the bolt to its proof strength.
        separation_safety: overload that parts the joint.
        fatigue_safety: Goodman, the preload constant.
    """

    bolt_N_per_mm: float
    parts_N_per_mm: float
    stiffness_share: float
    preload_N: float
    torque_Nm: float
    proof_safety: float
    load_safety: float | None
    separation_safety: float | None
    fatigue_safety: float | None


def cut_cones_compliance_mm_per_N(bolt: Bolt, grip_mm: float, E_MPa: float) -> float:
    """Return the shortening of the clamped parts per newton by Shigley.

    Cones of 30 deg begin 1.5 thread diameters wide at both ends and meet halfway, about a hole as wide as the
    thread; where the parts are narrower, a cylinder as wide as they are lies between them.
    """
    d, outer = bolt.nominal.diameter_mm, bolt.member_diameter_mm
    widest = _SHIGLEY_HEAD * d + _CONE_TAN * grip_mm
    edge = widest if outer is None else min(outer, widest)
    begin = min(_SHIGLEY_HEAD * d, edge)
    ratio = (begin + d) * (edge - d) / ((begin - d) * (edge + d))
    cones = 2 * math.log(ratio) / (_CONE_TAN * d)
    cylinder = 4 / (edge**2 - d**2) * (grip_mm - (edge - begin) / _CONE_TAN)
    return (cones + cylinder) / (E_MPa * math.pi)


def shigley(bolt: Bolt, loads: JointLoads, material: Material) -> Shigley:
    """Return the verification of a joint by Shigley; the preload is 0.75 of the proof load, or that given."""
    nominal, limits = bolt.nominal, strength(bolt.strength_class, bolt.nominal)
    d, area, E = nominal.diameter_mm, bolt.stressed_area_mm2, material.E_GPa * MPA_PER_GPA
    in_hole = min(bolt.engaged_mm, d) / 2 if bolt.held_in == "tapped_hole" else 0.0
    grip = bolt.grip_mm + in_hole
    own = BOLT_E_MPA / (
        bolt.shank_mm / bolt.shank_area_mm2 + (grip - bolt.shank_mm) / nominal.stress_area_mm2
    )
    parts = 1 / cut_cones_compliance_mm_per_N(bolt, grip, E)
    share = own / (own + parts)
    preload = bolt.preload_N or 0.75 * limits.proof_MPa * area
    proof = limits.proof_MPa * area
    load = max(loads.max_N, 0.0)
    amplitude = share * (load - loads.min_N) / (2 * area)
    mean, initial = share * (load + loads.min_N) / (2 * area), preload / area
    used = limits.ultimate_MPa * amplitude + limits.endurance_MPa * mean
    return Shigley(
        own,
        parts,
        share,
        preload,
        _TORQUE_COEFFICIENT * preload * d / NMM_PER_NM,
        proof / (share * load + preload),
        _over(proof - preload, share * load),
        _over(preload, (1 - share) * load),
        _over(limits.endurance_MPa * (limits.ultimate_MPa - initial), used),
    )
