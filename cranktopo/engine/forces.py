"""Forces of one throw over the working cycle, of the rods on each pin, and torque along the shaft."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array, Complex, shared
from cranktopo.base.units import MM_PER_M, NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import ThrowBalance
from cranktopo.engine.gas import PressureCurve, gas_force_N
from cranktopo.engine.kinematics import Curve, exact_motion, force_ratios, phase_shift


@dataclass(frozen=True)
class ShaftTorque:
    """Torque along the shaft over the cycle.

    Attributes:
        angle_deg: crank angles from firing top dead centre of the cylinder that fires first.
        passed_on_Nm: torque behind each throw, from the free end to the takeoff, (throws, angles).
        ahead_Nm: of a vibrating shaft, torque ahead of each throw; else what is passed on less its own.
    """

    angle_deg: Array
    passed_on_Nm: Array
    ahead_Nm: Array | None = None

    @property
    def vibrates(self) -> bool:
        """True if it is that of a vibrating shaft."""
        return self.ahead_Nm is not None

    @property
    def sections_Nm(self) -> Array:
        """Torque ahead of throw 1, then behind every throw: ahead of the next, (throws + 1, angles)."""
        free = np.zeros_like(self.passed_on_Nm[:1]) if self.ahead_Nm is None else self.ahead_Nm[:1]
        return np.vstack([free, self.passed_on_Nm])

    @property
    def section_names(self) -> tuple[str, ...]:
        """Names of these sections."""
        return ("ahead of throw 1", *(f"behind throw {n + 1}" for n in range(len(self.passed_on_Nm))))

    @property
    def engine_Nm(self) -> Array:
        """Torque behind the last throw, N m: of a shaft that does not vibrate that of the engine."""
        return np.asarray(self.passed_on_Nm[-1])


def shaft_torque(angle_deg: Array, rods_Nm: Array, throws: int) -> ShaftTorque:
    """Return the torque behind each throw; the cylinders of a pin are as many numbers apart as it has throws.

    Args:
        rods_Nm: torque of every cylinder's rod, cylinder 1, at the free end, first, (cylinders, angles).
    """
    return ShaftTorque(angle_deg, np.cumsum(by_throw(rods_Nm, throws), axis=0))


def by_cylinder(curve: Curve, angle_deg: Array, firing_deg: Sequence[float], cycle_deg: float) -> Curve:
    """Return a curve after firing dead centre as each cylinder has it, (cylinders, angles)."""
    return np.array([phase_shift(curve, angle_deg, fires, cycle_deg) for fires in firing_deg])


def by_throw(curves: Curve, throws: int) -> Curve:
    """Return the sum of the cylinders on each throw, (throws, angles); one bank stands after the other."""
    return np.asarray(curves.reshape(-1, throws, curves.shape[1]).sum(axis=0))


INERTIA_EFFECTS = frozenset({"reciprocating_inertia", "rotating_rod_mass"})


@dataclass(frozen=True)
class ThrowForces:
    """Forces at each crank angle of the cycle; positive toward the crank axis (compression of the rod).

    Attributes:
        inertia_force_N: of the piston group.
        small_end_force_N: gas and inertia force on the piston pin.
        side_force_N: of the piston on the cylinder wall.
        rod_force_N: along the rod, with the reciprocating mass of the rod.
        radial_force_N: part of the rod force on the crankpin toward the crank axis.
        tangential_force_N: part of the rod force on the crankpin in the direction of rotation.
        web_force_N: radial force less the centrifugal force of the rod's rotating mass.
        crankpin_force_N: magnitude of the force that the rod's bearing passes to the pin.
        main_journal_force_N: magnitude of the force on each main journal of a throw that stands alone; of
            two different webs on that which has more.
    """

    angle_deg: Array
    gas_force_N: Array
    inertia_force_N: Array
    small_end_force_N: Array
    side_force_N: Array
    rod_force_N: Array
    radial_force_N: Array
    tangential_force_N: Array
    web_force_N: Array
    crankpin_force_N: Array
    main_journal_force_N: Array
    torque_Nm: Array

    def curves(self) -> dict[str, Array]:
        """Return the curves by name, without the angles."""
        return {field.name: getattr(self, field.name) for field in fields(self)[1:]}


@dataclass(frozen=True)
class RotatingForces:
    """Centrifugal forces of what turns with the pin, and r w^2 for the reciprocating masses, N per kg."""

    r_w2_m_s2: float
    rod_N: float
    throw_N: float


def rotating_forces(
    engine: Engine, balance: ThrowBalance, radius_mm: float, speed_rpm: float
) -> RotatingForces:
    """Return the centrifugal forces at a speed."""
    w2 = angular_speed_rad_s(speed_rpm) ** 2
    r_w2 = radius_mm / MM_PER_M * w2
    throw = balance.throw_unbalance_kg_mm / MM_PER_M * w2
    return RotatingForces(r_w2, engine.rod_rotating_kg * r_w2, throw)


def throw_forces(
    engine: Engine,
    radius_mm: float,
    pressure: PressureCurve,
    speed_rpm: float,
    enabled: frozenset[str] = INERTIA_EFFECTS,
) -> ThrowForces:
    """Return the forces of one throw that has no mass of its own over the cycle, read-only.

    The piston group loads the piston pin; the rod's reciprocating mass joins at the small end, its rotating
    mass at the crankpin (two-mass rod). The main journals share the pin's load equally.
    """
    return _throw_forces(engine, radius_mm, pressure, speed_rpm, enabled & INERTIA_EFFECTS)


@lru_cache(maxsize=32)
def _throw_forces(
    engine: Engine, radius_mm: float, pressure: PressureCurve, speed_rpm: float, enabled: frozenset[str]
) -> ThrowForces:
    """Return forces that are computed once: webs and journals that change leave them as they are."""
    angle = np.radians(pressure.angle_deg)
    r_w2_m_s2 = radius_mm / MM_PER_M * angular_speed_rad_s(speed_rpm) ** 2
    acceleration = exact_motion(angle, radius_mm, engine.rod_length_mm).acceleration_ratio
    inertia_per_kg = -acceleration * r_w2_m_s2 * ("reciprocating_inertia" in enabled)
    gas = gas_force_N(pressure.pressure_MPa, engine)
    piston = engine.masses.piston_group_kg * inertia_per_kg
    axial = gas + piston + engine.rod_parts_kg[0] * inertia_per_kg
    ratios = force_ratios(angle, radius_mm, engine.rod_length_mm)
    radial, tangential = axial * ratios.radial, axial * ratios.tangential
    web = radial - engine.rod_rotating_kg * r_w2_m_s2 * ("rotating_rod_mass" in enabled)
    found = ThrowForces(
        angle_deg=pressure.angle_deg,
        gas_force_N=gas,
        inertia_force_N=piston,
        small_end_force_N=gas + piston,
        side_force_N=axial * ratios.side,
        rod_force_N=axial * ratios.rod,
        radial_force_N=radial,
        tangential_force_N=tangential,
        web_force_N=web,
        crankpin_force_N=np.hypot(web, tangential),
        main_journal_force_N=np.hypot(web, tangential) / 2,
        torque_Nm=tangential * radius_mm / NMM_PER_NM,
    )
    for curve in found.curves().values():
        shared(curve)
    return found


def journal_force_N(forces: ThrowForces, throw_N: float) -> Array:
    """Return the force on each main journal of a throw of equal webs that stands alone between its bearings.

    Args:
        throw_N: centrifugal force of the throw alone, outward: both journals share it equally, too.
    """
    return np.asarray(np.hypot(forces.web_force_N - throw_N, forces.tangential_force_N) / 2)


def uneven_journal_force_N(
    forces: ThrowForces, spinning_N: complex, couple_Nmm: complex, arms_mm: tuple[float, float]
) -> Array:
    """Return the larger of the forces on the main journals of a throw with two different webs, by lever rule.

    Args:
        spinning_N: centrifugal force of the throw alone, real along it, imaginary ahead of it.
        couple_Nmm: of the throw's unbalance about the plane of its cylinder.
        arms_mm: distances of the main bearings from that plane.
    """
    near, far = arms_mm
    force = spinning_N - forces.web_force_N + 1j * forces.tangential_force_N
    first, second = far * force - couple_Nmm, near * force + couple_Nmm
    return np.asarray(np.maximum(np.abs(first), np.abs(second)) / (near + far))


@dataclass(frozen=True)
class RodsOnPin:
    """The rods on a pin as one of its webs feels them.

    A throw stands on its two main bearings, and what a web carries is the reaction of the bearing beside it.
    A rod that is nearer to one web therefore counts there by more than its force, and by less at the other:
    by twice the lever rule's share, which is 1 in the middle of the pin. Rods of one plane (radial) are all
    centred on the pin, articulated ones too.

    Attributes:
        name: the throw, or the web of it where the two differ; from the free end.
        phase_shifts_deg: crank angles at which its rods' cylinders fire, after the first of them by number.
        shares: by how much of itself each rod's force counts.
        ahead_deg: angle of each rod's part of a split pin ahead of that beside the web.
    """

    name: str
    throw: int
    phase_shifts_deg: tuple[float, ...] = (0.0,)
    shares: tuple[float, ...] = (1.0,)
    ahead_deg: tuple[float, ...] = (0.0,)

    def superpose(self, force: Complex, angle_deg: Array, cycle_deg: float) -> Complex:
        """Return a force on the pin, of all its rods, from that of one rod at angles after its own firing.

        Real along the part of the pin that it acts on, imaginary ahead of it.
        """
        turns = np.exp(1j * np.radians(self.ahead_deg))
        parts = zip(self.shares * turns, self.phase_shifts_deg, strict=True)
        every = [share * phase_shift(force, angle_deg, by, cycle_deg) for share, by in parts]
        return np.asarray(np.sum(every, axis=0))

    def forces(self, rod: ThrowForces, throw_N: complex, cycle_deg: float) -> ThrowForces:
        """Return the forces of the throw from those of one rod; what belongs to one piston stays as it is.

        Args:
            throw_N: centrifugal force of the throw alone, real along the pin beside the web, imaginary ahead.
        """
        if self.shares == (1.0,):
            return rod
        angle = rod.angle_deg
        across: Complex = np.asarray(1j * rod.tangential_force_N)
        by_rods, on_web = (
            self.superpose(np.asarray(across - radial), angle, cycle_deg)
            for radial in (rod.radial_force_N, rod.web_force_N)
        )
        torques = [phase_shift(rod.torque_Nm, angle, by, cycle_deg) for by in self.phase_shifts_deg]
        return replace(
            rod,
            radial_force_N=-by_rods.real,
            tangential_force_N=by_rods.imag,
            web_force_N=-on_web.real,
            main_journal_force_N=np.abs(on_web + throw_N) / 2,
            torque_Nm=np.sum(torques, axis=0),
        )


def web_shares(scene: Scene) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """By how much of itself the force of each rod on a pin counts at the first and at the second web."""
    toward = [2 * place / scene.pitch_mm for place in scene.rod_places_mm]
    return tuple(1 - part for part in toward), tuple(1 + part for part in toward)


def rods_on_pins(scene: Scene, engine: Engine) -> tuple[RodsOnPin, ...]:
    """Return the rods on the pin of every throw, or of every web where the two of a throw differ."""
    return _rods_on_pins(engine, *web_shares(scene))


@lru_cache(maxsize=16)
def _rods_on_pins(
    engine: Engine, first: tuple[float, ...], second: tuple[float, ...]
) -> tuple[RodsOnPin, ...]:
    fires, found = engine.firing_angles_deg, list[RodsOnPin]()
    for throw in range(engine.throws):
        own = fires[throw :: engine.throws]
        after = tuple((fire - own[0]) % engine.cycle_deg for fire in own)
        numbers = range(throw + 1, engine.cylinders + 1, engine.throws)
        pins = [engine.pin_deg(cylinder) for cylinder in numbers]
        if first == second:
            found.append(RodsOnPin(f"throw {throw + 1}", throw, after, first, (0.0,) * len(pins)))
            continue
        for side, (shares, beside) in enumerate(((first, pins[0]), (second, pins[-1]))):
            name = f"web {2 * throw + side + 1} of throw {throw + 1}"
            found.append(RodsOnPin(name, throw, after, shares, tuple(pin - beside for pin in pins)))
    return tuple(found)
