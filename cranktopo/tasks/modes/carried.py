"""Parts on the ends of the crankshaft: its steps as beams, pulley, damper, flywheel and what follows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.units import KG_PER_TONNE, MM2_PER_M2, MPA_PER_GPA, NMM_PER_NM, density_tonne_per_mm3
from cranktopo.bodies.crank_ends import EndPiece
from cranktopo.design.crank import Side
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Carried, Damper, Propeller, Rotor, ShaftTable
from cranktopo.numerics.tetrahedra.rigid_motions import RZ
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.numerics.turning_parts import RoundSection, rigid_disk
from cranktopo.tasks.modes.station import added


@dataclass(frozen=True)
class Part:
    """A body of revolution on an end of the crank; units mm, tonne, N.

    Attributes:
        polar: inertia about the crank axis of what turns as one.
        tilting: the same of what tilts as one, a damper's ring included.
        spring_Nmm_per_rad: torsional stiffness to the part before it; None where it turns with that.
        loss_factor: of that spring.
        fluid_Nmms_per_rad: viscous damping beside it.
        resisted_Nmms_per_rad: damping of its rotation by what is around it.
        mass: None where nothing but its rotation about the crank axis counts.
        outwards_mm: from the tip of the crank to its centre of mass.
    """

    name: str
    polar: float
    spring_Nmm_per_rad: float | None
    mass: float | None = None
    tilting: float = 0.0
    diametral: float = 0.0
    outwards_mm: float = 0.0
    loss_factor: float = 0.0
    fluid_Nmms_per_rad: float = 0.0
    resisted_Nmms_per_rad: float = 0.0

    def body(self, outward: int) -> TurningBody:
        """Return it over the motions of the tip; `outward` is 1 where that is along z, else -1."""
        turning = np.zeros((6, 6))
        turning[RZ, RZ] = self.polar
        about = added(6, mass=turning, lateral=turning, stiffening=turning)
        if self.mass is None:
            return about
        disk = rigid_disk(self.mass, self.diametral, self.tilting, outward * self.outwards_mm)
        return about + disk.over(np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0]))


def parts_on(shaft: ShaftTable, side: Side) -> tuple[Part, ...]:
    """Return what an end carries, from the crank outwards; a damper's ring comes last."""
    return _on_free_end(shaft) if side == "free" else _on_output(shaft)


def without_mass(shaft: ShaftTable) -> tuple[str, ...]:
    """Return the names of the parts that the crank carries and whose mass is not given."""
    carried = {
        "damper": shaft.damper,
        "pulley": shaft.pulley,
        "flywheel": shaft.flywheel,
        **({} if shaft.coupling else {"driven": shaft.driven, "propeller": shaft.propeller}),
    }
    return tuple(name for name, part in carried.items() if part is not None and part.mass_kg is None)


def _on_free_end(shaft: ShaftTable) -> tuple[Part, ...]:
    found = []
    if shaft.pulley is not None:
        spring = _spring(shaft.pulley.stiffness_Nm_per_rad)
        pulley = _part("pulley", shaft.pulley, shaft.pulley.inertia_kg_m2, spring)
        found.append(replace(pulley, loss_factor=shaft.pulley.loss_factor))
    if shaft.damper is not None:
        found += _damper(shaft.damper)
    return tuple(found)


def _damper(damper: Damper) -> list[Part]:
    """Return hub and ring: the ring turns on its spring, and for the rest moves with the hub."""
    ring = _polar(damper.ring_inertia_kg_m2)
    whole = _part("damper", damper, damper.hub_inertia_kg_m2 + damper.ring_inertia_kg_m2, None)
    hub = replace(whole, polar=whole.polar - ring)
    moved = Part(
        "damper ring",
        ring,
        _spring(damper.stiffness_Nm_per_rad or 0.0),
        loss_factor=damper.loss_factor or 0.0,
        fluid_Nmms_per_rad=(damper.damping_Nms_per_rad or 0.0) * NMM_PER_NM,
    )
    return [hub, moved]


def _on_output(shaft: ShaftTable) -> tuple[Part, ...]:
    parts: tuple[tuple[str, Rotor | None], ...] = (
        ("flywheel", shaft.flywheel),
        ("coupling", shaft.coupling),
        ("driven machine", shaft.driven),
        ("propeller", shaft.propeller),
    )
    found: list[Part] = []
    apart = False
    for name, rotor in parts:
        if rotor is None:
            continue
        apart = apart or name == "coupling"
        spring = _spring(rotor.stiffness_Nm_per_rad)
        if apart or not isinstance(rotor, Carried):
            part = Part(name, _polar(rotor.inertia_kg_m2), spring)
        else:
            part = _part(name, rotor, rotor.inertia_kg_m2, spring)
        resisted = rotor.damping_Nms_per_rad if isinstance(rotor, Propeller) else 0.0
        found.append(
            replace(part, loss_factor=rotor.loss_factor, resisted_Nmms_per_rad=resisted * NMM_PER_NM)
        )
    return tuple(found)


def _part(name: str, carried: Carried, inertia_kg_m2: float, spring: float | None) -> Part:
    polar = _polar(inertia_kg_m2)
    if carried.mass_kg is None:
        return Part(name, polar, spring)
    diametral_inertia = carried.diametral_inertia_kg_m2
    diametral = polar / 2 if diametral_inertia is None else _polar(diametral_inertia)
    mass = carried.mass_kg / KG_PER_TONNE
    return Part(name, polar, spring, mass, polar, diametral, carried.overhang_mm)


def _polar(inertia_kg_m2: float) -> float:
    return inertia_kg_m2 * MM2_PER_M2 / KG_PER_TONNE


def _spring(stiffness_Nm_per_rad: float | None) -> float | None:
    return None if stiffness_Nm_per_rad is None else stiffness_Nm_per_rad * NMM_PER_NM


def section_of(piece: EndPiece, scene: Scene, torsion: float = 1.0) -> RoundSection:
    """Return a piece of an end as a beam of the same mass, inertia and twist; `torsion` scales the last."""
    material = scene.material
    length = piece.step.length_mm
    return RoundSection(
        area=piece.moments.volume / length,
        polar=piece.moments.polar / length,
        torsion=torsion * length / piece.twist_per_mm3,
        youngs_MPa=material.E_GPa * MPA_PER_GPA,
        poisson=material.poisson,
        density=density_tonne_per_mm3(material.density_kg_m3),
    )
