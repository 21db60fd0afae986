"""The rod of a design under its cycle: small end, shank, buckling, cap, big end, pin and bolts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.material import Material
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.rod import Rod
from cranktopo.design.rod_body import RodMass, drilled, fillet, rod_mass, section
from cranktopo.design.rod_split import turns
from cranktopo.design.rod_strength import rod_strength_remarks
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import RodMotion, rod_bolt_force_N, rod_motions
from cranktopo.tasks.bolts.stage import check_rod_bolt, rod_bolt_assumed
from cranktopo.tasks.fatigue.criteria import check_method, criterion, strengths_of
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.rod.eye import (
    bush_pressure_MPa,
    bush_share,
    cap_stress_MPa,
    held_angle_rad,
    press_fit_MPa,
    pulled_arch,
    pushed_arch,
    ring_stress_MPa,
)
from cranktopo.tasks.rod.ovalisation import eye_shapes_of
from cranktopo.tasks.rod.pin import check_pin
from cranktopo.tasks.rod.result import Buckling, RodMasses, RodSectionCheck, RodStrength
from cranktopo.tasks.rod.split import cap_force_N, oblique_split, passage, split_stress_N


@dataclass(frozen=True)
class LoadedRod:
    """A rod with its cycles."""

    scene: Scene
    rod: Rod
    length_mm: float
    mass: RodMass
    motions: tuple[RodMotion, ...]
    method: str

    @property
    def material(self) -> Material:
        """Return the material of the rod."""
        return self.rod.material or self.scene.material

    @property
    def yield_MPa(self) -> float:
        """Return its yield strength."""
        return self.material.yield_MPa or math.nan

    def force_N(self, y_mm: float) -> list[Array]:
        """Compression at a place over each cycle."""
        return [motion.section_force_N(self.mass, self.length_mm, y_mm) for motion in self.motions]


def check_rod_strength(design: DesignLike, method: str = "lsa") -> RodStrength:
    """Return the strength of a design's rod; the method is that of `fatigue`, lsa or fkm.

    Raises:
        CranktopoError: no rod, no engine, no gas pressure, or a strength of the material is missing.
    """
    scene = as_scene(design)
    return strength_of(scene, loaded_rod(scene, method))


def strength_of(scene: Scene, loaded: LoadedRod) -> RodStrength:
    """Return the strength of a scene's rod by its cycles."""
    rod, length, mass = loaded.rod, loaded.length_mm, loaded.mass
    push, push_deg, pull, pull_deg = _pin_extremes(loaded)
    bolt = check_rod_bolt(scene)
    return RodStrength(
        design=scene.name,
        shank=rod.shank,
        speeds_rpm=tuple(motion.speed_rpm for motion in loaded.motions),
        method=loaded.method,
        masses=_masses(mass),
        push_N=push,
        push_deg=push_deg,
        pull_N=pull,
        pull_deg=pull_deg,
        bush_pressure_MPa=bush_pressure_MPa(rod, loaded.material),
        held_deg=math.degrees(held_angle_rad(rod, length)),
        sections=(*_eye(loaded, push, pull), *_shank(loaded), _cap(loaded), _big_end(loaded)),
        buckling=_buckling(loaded),
        eyes=eye_shapes_of(loaded.scene, mass, loaded.motions),
        pin=check_pin(rod, rod.pin, push) if rod.pin else None,
        bolt=bolt,
        assumed=rod_bolt_assumed(scene),
        strength_remarks=rod_strength_remarks(rod, scene, strengths_of([loaded.method])) or None,
        passage=passage(scene),
        oblique_split=oblique_split(scene, bolt),
    )


def loaded_rod(scene: Scene, method: str) -> LoadedRod:
    """Return the rod of a scene with its cycles; raises as `check_rod_strength`."""
    rod, length = rod_of(scene)
    of_rod = scene.model_copy(update={"material": rod.material or scene.material})
    check_method(of_rod, method)
    if of_rod.material.yield_MPa is None:
        raise CranktopoError(f"{scene.name}: rod.material.yield_MPa is missing.", hint="Give it.")
    return LoadedRod(of_rod, rod, length, rod_mass(rod, length, scene.material), rod_motions(scene), method)


def _masses(mass: RodMass) -> RodMasses:
    return RodMasses(
        total_kg=mass.total_kg,
        body_kg=mass.body_kg,
        below_split_kg=mass.split_kg,
        reciprocating_kg=mass.reciprocating_kg,
        rotating_kg=mass.rotating_kg,
        centre_from_big_end_mm=mass.centre_mm,
        centre_across_mm=mass.across_mm or None,
        inertia_kg_mm2=mass.inertia_kg_mm2,
    )


def _pin_extremes(loaded: LoadedRod) -> tuple[float, float, float, float]:
    """Largest push and pull of the piston pin with their crank angles."""
    values = [(motion.pin_force_N(), motion.angle_deg) for motion in loaded.motions]
    push, push_deg = max((float(force.max()), float(at[force.argmax()])) for force, at in values)
    pull, pull_deg = max((float(-force.min()), float(at[force.argmin()])) for force, at in values)
    return push, push_deg, max(pull, 0.0), pull_deg


def _fatigue(loaded: LoadedRod, high: Array, low: Array, gradient: float) -> float:
    """Smallest fatigue safety of points whose stress swings between two values."""
    amplitude, mean = np.abs(high - low) / 2, (high + low) / 2
    stress = LocalStress(amplitude, mean, np.full_like(amplitude, gradient))
    return float(criterion(loaded.method).point_safety(loaded.scene, stress).safety.min())


def _checked(
    loaded: LoadedRod,
    name: str,
    place_mm: float,
    area_mm2: float,
    forces_N: tuple[float, float],
    high: Array,
    low: Array,
    whip_MPa: float = 0.0,
    gradient: float = 0.0,
) -> RodSectionCheck:
    """Return the check of points whose stress swings between two values each, (n,)."""
    largest = float(max(np.abs(high).max(), np.abs(low).max()))
    return RodSectionCheck(
        section=name,
        place_mm=place_mm,
        area_mm2=area_mm2,
        push_N=forces_N[0],
        pull_N=forces_N[1],
        whip_MPa=whip_MPa,
        max_MPa=float(high.max()),
        min_MPa=float(low.min()),
        yield_safety=loaded.yield_MPa / largest,
        fatigue_safety=_fatigue(loaded, high, low, gradient),
    )


def _eye(loaded: LoadedRod, push: float, pull: float) -> Iterator[RodSectionCheck]:
    """Yield the small end at crown and worst place, both faces; between pull and push its press fit alone."""
    rod, held = loaded.rod, held_angle_rad(loaded.rod, loaded.length_mm)
    inner, outer, width = rod.small_end_bore_mm / 2, rod.small_end_diameter_mm / 2, rod.small_end_width_mm
    share, middle = bush_share(rod, loaded.material), (inner + outer) / 2
    fit = press_fit_MPa(rod, bush_pressure_MPa(rod, loaded.material))
    states = []
    pulled = pulled_arch(held)
    for arch, force in ((pulled, pull), (pulled, 0.0), (pushed_arch(held), push)):
        moment, normal = force * middle * arch.moment, force * arch.normal
        faces = ring_stress_MPa(inner, outer, width, moment, normal, share)
        states.append(np.stack([face + more for face, more in zip(faces, fit, strict=True)]))
    high, low = np.max(states, axis=0), np.min(states, axis=0)
    gradient = 2 / (outer - inner)
    area = width * (outer - inner)
    for name, points in (("eye, crown", np.s_[:, :1]), ("eye, worst", np.s_[:, :])):
        yield _checked(
            loaded,
            name,
            loaded.length_mm,
            area,
            (push, pull),
            high[points].ravel(),
            low[points].ravel(),
            gradient=gradient,
        )


def _shank(loaded: LoadedRod) -> Iterator[RodSectionCheck]:
    """Yield the shank below the small end, in its middle and above the big end.

    Bosses of an oblique split are left out: they strengthen one side only.
    """
    rod, length = loaded.rod, loaded.length_mm
    if rod.split_angle_deg:
        rod = rod.model_copy(update={"boss_above_mm": 0.0, "boss_below_mm": 0.0, "split_angle_deg": 0.0})
    arcs = [fillet(rod, length, small) for small in (True, False)]
    ends = length - rod.small_end_diameter_mm / 2, rod.big_end_diameter_mm / 2
    top, bottom = (arc.edge_y_mm if arc else end for arc, end in zip(arcs, ends, strict=True))
    for name, y in (("eye to shank", top), ("mid-shank", length / 2), ("shank to big end", bottom)):
        found = drilled(rod, section(rod, length, np.array([y])))
        area, modulus = found.area_mm2[0], found.swing_mm4[0] / found.edge_mm[0]
        edges, whip = [], 0.0
        for motion, force in zip(loaded.motions, loaded.force_N(y), strict=True):
            bent = motion.whip_moment_Nmm(loaded.mass, length, y) / modulus
            edges.append(np.stack([-force / area + bent, -force / area - bent]))
            whip = max(whip, float(np.abs(bent).max()))
        stress = np.concatenate(edges, axis=1)
        forces = np.concatenate(loaded.force_N(y))
        extremes = float(forces.max()), float(max(-forces.min(), 0.0))
        yield _checked(
            loaded, name, y, float(area), extremes, stress.max(axis=1), stress.min(axis=1), whip_MPa=whip
        )


def _cap(loaded: LoadedRod) -> RodSectionCheck:
    """The cap in its middle; of an oblique split as if its largest force of the cycle were square to it."""
    rod = loaded.rod
    pull = cap_force_N(loaded.scene) if rod.split_angle_deg else 2 * rod_bolt_force_N(loaded.scene)[0]
    height = (rod.big_end_diameter_mm - rod.big_end_bore_mm) / 2
    stress = np.array([cap_stress_MPa(rod, pull)])
    area = rod.big_end_width_mm * height
    place = -rod.big_end_bore_mm / 2 * turns(rod)[0]
    return _checked(loaded, "cap", place, area, (0.0, pull), stress, 0 * stress)


def _big_end(loaded: LoadedRod) -> RodSectionCheck:
    """Both sides of the big end at the split, less the holes of the bolts.

    Forces of an oblique split are counted as those of tension with the same stress by von Mises.
    """
    rod = loaded.rod
    side = rod.big_end_width_mm * (rod.boss_width_mm - rod.big_end_bore_mm) / 2
    area = 2 * (side - math.pi / 4 * rod.bolt_hole_mm**2)
    forces = np.concatenate(loaded.force_N(0.0))
    push, pull = float(forces.max()), float(max(-forces.min(), 0.0))
    stress = np.array([pull / area]), np.array([-push / area])
    if rod.split_angle_deg:
        cosine, sine = turns(rod)
        pressed = push * math.sqrt(cosine**2 + 3 * sine**2)
        stress = np.array([split_stress_N(loaded.scene) / area]), np.array([-pressed / area])
    return _checked(loaded, "big end", 0.0, area, (push, pull), *stress)


def _buckling(loaded: LoadedRod) -> tuple[Buckling, Buckling]:
    """Return the shank's middle as a strut hinged at both pins, and held by both eyes across."""
    rod, length = loaded.rod, loaded.length_mm
    found = drilled(rod, section(rod, length, np.array([length / 2])))
    area = float(found.area_mm2[0])
    push = max(float(force.max()) for force in loaded.force_N(length / 2))
    E, limit = loaded.material.E_GPa * MPA_PER_GPA, loaded.yield_MPa
    free = length - (rod.small_end_diameter_mm + rod.big_end_diameter_mm) / 2
    return (
        _strut("motion", length, found.swing_mm4[0], area, push, E, limit),
        _strut("pins", free / 2, found.side_mm4[0], area, push, E, limit),
    )


def _strut(
    plane: str, length: float, moment_mm4: float, area: float, push: float, E: float, limit: float
) -> Buckling:
    stress = navier_rankine_MPa(push, area, moment_mm4, length, E, limit)
    return Buckling(
        plane=plane,
        length_mm=length,
        slenderness=length / math.sqrt(moment_mm4 / area),
        euler_N=math.pi**2 * E * moment_mm4 / length**2,
        rankine_N=push * limit / stress,
        stress_MPa=stress,
        yield_safety=limit / stress,
    )


def navier_rankine_MPa(
    push_N: float, area_mm2: float, moment_mm4: float, length_mm: float, E_MPa: float, yield_MPa: float
) -> float:
    """Return the stress of a strut with Navier and Rankine's allowance for buckling."""
    factor = yield_MPa / (math.pi**2 * E_MPa)
    return push_N * (1 / area_mm2 + factor * length_mm**2 / moment_mm4)
