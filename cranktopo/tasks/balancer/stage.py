"""The balancer shaft of a design on its bearings: forces, life, deflection, tilt, fatigue of its notches."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM, angular_speed_rad_s, density_kg_per_mm3
from cranktopo.design.balancer import BalancerBearing, BalancerPart, ShaftNotch
from cranktopo.design.checks.balancer import balancer_of
from cranktopo.design.material import Material
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.design.strength import RulingSection, material_remarks, through_mm
from cranktopo.engine.balance.balancer_shafts import GearForces, gear_forces, weight_force_N
from cranktopo.engine.bearings import equivalent_load_N, rating_life_h, roller_bearing_spring_N_per_mm
from cranktopo.numerics.stepped_beam import Beam, BentBeam, bend, round_beam
from cranktopo.tasks.balancer.notch import notch_stress, size_factor
from cranktopo.tasks.balancer.result import (
    BalancerStrength,
    NotchCheck,
    ProbeDeflection,
    ShaftBearingLoad,
    WeightForce,
)
from cranktopo.tasks.bolts.stage import weight_joints
from cranktopo.tasks.fatigue.criteria import check_method, strengths_of
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa, lsa_strength

_METHOD = "lsa"
_TURN_POINTS = 360
_PLACES = 2
"""Decimals of a millimetre to which places along the shaft count: shorter steps would be ill-conditioned."""


@dataclass(frozen=True)
class _LoadedShaft:
    """A shaft bent by its masses at the highest speed, and by its gear."""

    scene: Scene
    part: BalancerPart
    beam: Beam
    by_weights: BentBeam
    by_gear: BentBeam

    @property
    def material(self) -> Material:
        return part_material(self.scene, self.part)

    def node(self, z_mm: float) -> int:
        return _nearest(self.beam, z_mm)


def check_balancer(design: DesignLike) -> BalancerStrength:
    """Return forces, bearings, deflections and fatigue of a design's balancer shaft.

    Raises:
        CranktopoError: no balancer shaft, one that its bearings do not hold, a place beyond its ends, or a
            strength of its material that is missing.
    """
    scene = as_scene(design)
    return strength_of(scene, checked_part(scene))


def strength_of(scene: Scene, part: BalancerPart) -> BalancerStrength:
    """Return the strength of a shaft that is checked."""
    loaded = _load(scene, part)
    return BalancerStrength(
        design=scene.name,
        speed_rpm=part.max_speed_rpm,
        mass_kg=_mass_kg(part, loaded.material),
        gear=_gear(part),
        weights=tuple(
            WeightForce(z_mm=w.z_mm, force_N=weight_force_N(w.unbalance_kg_mm, part.max_speed_rpm), deg=w.deg)
            for w in part.weight
        ),
        bearings=tuple(_bearings(loaded)),
        largest_deflection_mm=float(
            (np.abs(loaded.by_weights.deflection_mm) + np.abs(loaded.by_gear.deflection_mm)).max()
        ),
        probes=tuple(
            ProbeDeflection(
                name=probe.name,
                z_mm=probe.z_mm,
                deflection_mm=_both(loaded, "deflection_mm", probe.z_mm),
                permitted_mm=probe.permitted_mm,
            )
            for probe in part.probe
        ),
        notches=tuple(_notch(loaded, notch) for notch in part.notch),
        joints=weight_joints(part, loaded.material),
        strength_remarks=_remarks(loaded) if part.notch else None,
    )


def checked_part(scene: Scene) -> BalancerPart:
    """Return the shaft of a design; raises CranktopoError as `check_balancer` where it is none."""
    part = balancer_of(scene)
    radial = [round(b.z_mm, _PLACES) for b in part.bearing if not is_thrust(b)]
    if len(set(radial)) < max(2, len(radial)):
        allowed = "needs at least two radial bearings, each at another place"
        raise invalid("balancer.bearing, places of radial ones", radial, allowed)
    for number, notch in enumerate(part.notch):
        if notch_stress(notch, *part.section_at(notch.z_mm))[0] <= 0:
            raise scene.invalid(f"balancer.notch[{number}].diameter_mm", "leaves nothing of the hollow shaft")
    if part.notch:
        check_method(_of_its_material(scene, part), _METHOD)
    return part


def part_material(scene: Scene, part: BalancerPart) -> Material:
    """Return the material of a shaft."""
    return part.material or scene.material


def _remarks(loaded: _LoadedShaft) -> tuple[str, ...] | None:
    """Return what the library's strengths do not hold for in a shaft that is judged by them."""
    return material_remarks(loaded.material, ruling_section(loaded.part), strengths_of([_METHOD])) or None


def ruling_section(part: BalancerPart) -> RulingSection:
    """Return the largest thickness through which a step of the shaft is hardened."""
    through = max(through_mm(step.diameter_mm, step.bore_mm) for step in part.step)
    return RulingSection(through, "shaft", "balancer.material" if part.material else "material")


def _of_its_material(scene: Scene, part: BalancerPart) -> Scene:
    return scene.model_copy(update={"material": part_material(scene, part)})


def is_thrust(bearing: BalancerBearing) -> bool:
    """Tell whether a bearing carries along the shaft alone."""
    return bearing.roller_bearing is not None and bearing.roller_bearing.kind == "thrust"


def _spring_N_per_mm(bearing: BalancerBearing) -> float | None:
    """Return the radial stiffness of a bearing; None where it is rigid."""
    rollers = bearing.roller_bearing
    if bearing.spring_N_per_mm is not None or rollers is None:
        return bearing.spring_N_per_mm
    return roller_bearing_spring_N_per_mm(rollers)


def _gear(part: BalancerPart) -> GearForces | None:
    return gear_forces(part.gear, angular_speed_rad_s(part.max_speed_rpm)) if part.gear else None


def _load(scene: Scene, part: BalancerPart) -> _LoadedShaft:
    material = part_material(scene, part)
    ends = np.round(np.cumsum([0.0, *(step.length_mm for step in part.step)]), _PLACES)
    z = np.unique(np.round([*ends, *(one.z_mm for one in part.placed)], _PLACES)).astype(float)
    middle = (z[1:] + z[:-1]) / 2
    step = np.searchsorted(ends, middle) - 1
    outer = np.array([part.step[i].diameter_mm for i in step])
    inner = np.array([part.step[i].bore_mm for i in step])
    beam = round_beam(z, outer, inner, material.E_GPa * MPA_PER_GPA, material.poisson)
    nowhere = np.zeros(len(z), dtype=complex)
    weights, gear, couple = nowhere.copy(), nowhere.copy(), nowhere.copy()
    for weight in part.weight:
        force = weight_force_N(weight.unbalance_kg_mm, part.max_speed_rpm)
        weights[_nearest(beam, weight.z_mm)] += cmath.rect(force, math.radians(weight.deg))
    forces = _gear(part)
    if part.gear and forces:
        at, out = _nearest(beam, part.gear.z_mm), cmath.rect(1.0, math.radians(part.gear.deg))
        gear[at] = out * (-forces.radial_N + 1j * forces.tangential_N)
        couple[at] = -out * forces.axial_N * part.gear.pitch_radius_mm
    supports = {_nearest(beam, b.z_mm): _spring_N_per_mm(b) for b in part.bearing if not is_thrust(b)}
    return _LoadedShaft(
        scene, part, beam, bend(beam, supports, weights, nowhere), bend(beam, supports, gear, couple)
    )


def _nearest(beam: Beam, z_mm: float) -> int:
    """Return the node at a place."""
    return int(np.abs(beam.z_mm - z_mm).argmin())


def _both(loaded: _LoadedShaft, name: str, z_mm: float) -> float:
    """Return what masses and gear make at a place when both point in one direction."""
    node = loaded.node(z_mm)
    return float(abs(getattr(loaded.by_weights, name)[node]) + abs(getattr(loaded.by_gear, name)[node]))


def _bearings(loaded: _LoadedShaft) -> Iterator[ShaftBearingLoad]:
    forces = _gear(loaded.part)
    for bearing in loaded.part.bearing:
        thrust, rollers = is_thrust(bearing), bearing.roller_bearing
        node = loaded.node(bearing.z_mm)
        weights = 0j if thrust else complex(loaded.by_weights.reaction_N[node])
        gear = 0j if thrust else complex(loaded.by_gear.reaction_N[node])
        axial = forces.axial_N if thrust and forces else 0.0
        equivalent, mean_rpm = _equivalent(loaded.part, weights, gear, axial)
        rating = rollers.dynamic_rating_kN if rollers else None
        yield ShaftBearingLoad(
            bearing=rollers.name if rollers else "rigid" if bearing.spring_N_per_mm is None else "spring",
            z_mm=bearing.z_mm,
            spring_N_per_mm=None if thrust else _spring_N_per_mm(bearing),
            weights_N=abs(weights),
            gear_N=abs(gear),
            max_N=axial or abs(weights) + abs(gear),
            tilt_mrad=1e3 * _both(loaded, "slope_rad", bearing.z_mm),
            equivalent_N=equivalent,
            life_h=rating_life_h(rating, equivalent, mean_rpm) if rating and equivalent else None,
        )


def _equivalent(part: BalancerPart, weights: complex, gear: complex, axial: float) -> tuple[float, float]:
    """Return the equivalent force over turn and spectrum, and the mean speed of all turns.

    Masses pull with the square of the speed; the gear's torque stays as it is.
    """
    turn = np.exp(2j * np.pi * np.arange(_TURN_POINTS) / _TURN_POINTS)
    steps = [(s.at_rpm, s.share) for s in part.speed] or [(part.max_speed_rpm, 1.0)]
    turns = np.array([speed * share for speed, share in steps])
    loads = np.array(
        [
            equivalent_load_N(np.abs(weights * (speed / part.max_speed_rpm) ** 2 + gear * turn) + axial)
            for speed, _ in steps
        ]
    )
    return equivalent_load_N(loads, turns), float(turns.sum() / sum(share for _, share in steps))


def _notch(loaded: _LoadedShaft, notch: ShaftNotch) -> NotchCheck:
    outer, bore = loaded.part.section_at(notch.z_mm)
    per_moment, factor, gradient = notch_stress(notch, outer, bore)
    node = loaded.node(notch.z_mm)
    steady = float(abs(loaded.by_weights.moment_Nmm[node])) * per_moment
    turning = float(abs(loaded.by_gear.moment_Nmm[node])) * per_moment
    size = size_factor(
        outer if notch.kind == "hole" else notch.diameter_mm, loaded.scene.fatigue.specimen_diameter_mm
    )
    largest = steady + turning

    def safety(amplitude: float, mean: float) -> float:
        stress = LocalStress(np.array([amplitude]), np.array([mean]), np.array([gradient]))
        return float(lsa(stress, _strength(loaded, size)).safety[0])

    return NotchCheck(
        name=notch.name,
        z_mm=notch.z_mm,
        moment_Nm=largest / per_moment / NMM_PER_NM,
        concentration=factor,
        stress_MPa=largest,
        gradient_per_mm=gradient,
        size_factor=size,
        running_safety=safety(turning, steady),
        starting_safety=safety(largest / 2, largest / 2),
        reversed_safety=safety(largest, 0.0),
    )


def _strength(loaded: _LoadedShaft, size: float) -> LsaStrength:
    own = lsa_strength(_of_its_material(loaded.scene, loaded.part))
    return replace(own, size_factor=size, treatment_factor=loaded.part.treatment_factor)


def _mass_kg(part: BalancerPart, material: Material) -> float:
    return density_kg_per_mm3(material.density_kg_m3) * part.unnotched_mm3
