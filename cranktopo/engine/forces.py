"""Forces of one throw over the working cycle: gas, inertia, rod, crankpin, main journal, torque."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MM_PER_M, NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.engine import Engine
from cranktopo.engine.balance.throw import ThrowBalance
from cranktopo.engine.gas import PressureCurve, gas_force_N
from cranktopo.engine.kinematics import exact_motion, force_ratios

INERTIA_EFFECTS = frozenset({"reciprocating_inertia", "rotating_rod_mass"})


@dataclass(frozen=True)
class ThrowForces:
    """Forces at each crank angle of the cycle; positive toward the crank axis (compression of the rod).

    Attributes:
        inertia_force_N: inertia force of the piston group, N.
        small_end_force_N: gas and inertia force on the piston pin, N.
        side_force_N: force of the piston on the cylinder wall, N.
        rod_force_N: force along the rod, with the reciprocating mass of the rod, N.
        radial_force_N: part of the rod force on the crankpin toward the crank axis, N.
        tangential_force_N: part of the rod force on the crankpin in the direction of rotation, N.
        web_force_N: radial force less the centrifugal force of the rod's rotating mass, N.
        crankpin_force_N: magnitude of the force that the rod's bearing passes to the pin, N.
        main_journal_force_N: magnitude of the force on each main journal of a throw that stands alone, N.
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
    """Centrifugal forces of what turns with the pin, and the factor of the reciprocating masses.

    Attributes:
        r_w2_m_s2: throw radius times angular speed squared, m/s2 (N per kg).
    """

    r_w2_m_s2: float
    rod_N: float
    throw_N: float


def rotating_forces(
    engine: Engine, balance: ThrowBalance, radius_mm: float, speed_rpm: float
) -> RotatingForces:
    """Centrifugal forces at a speed."""
    w2 = angular_speed_rad_s(speed_rpm) ** 2
    r_w2 = radius_mm / MM_PER_M * w2
    throw = balance.throw_unbalance_kg_mm / MM_PER_M * w2
    return RotatingForces(r_w2, engine.rod_rotating_kg * r_w2, throw)


def throw_forces(
    engine: Engine,
    radius_mm: float,
    pressure: PressureCurve,
    balance: ThrowBalance,
    speed_rpm: float,
    *,
    reciprocating: bool = True,
    rotating_rod: bool = True,
) -> ThrowForces:
    """Forces of one throw over the cycle.

    The piston group loads the piston pin; the rod's reciprocating mass joins at the small end, its rotating
    mass at the crankpin (two-mass rod). The main journals share the pin's load and the throw's own
    centrifugal force equally, as if the throw stood alone between its two bearings.
    """
    angle = np.radians(pressure.angle_deg)
    spinning = rotating_forces(engine, balance, radius_mm, speed_rpm)
    acceleration = exact_motion(angle, radius_mm, engine.rod_length_mm).acceleration_ratio
    inertia_per_kg = -acceleration * spinning.r_w2_m_s2 * reciprocating
    gas = gas_force_N(pressure.pressure_MPa, engine)
    piston = engine.masses.piston_group_kg * inertia_per_kg
    axial = gas + piston + engine.rod_parts_kg[0] * inertia_per_kg
    ratios = force_ratios(angle, radius_mm, engine.rod_length_mm)
    radial, tangential = axial * ratios.radial, axial * ratios.tangential
    web = radial - spinning.rod_N * rotating_rod
    return ThrowForces(
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
        main_journal_force_N=np.hypot(web - spinning.throw_N, tangential) / 2,
        torque_Nm=tangential * radius_mm / NMM_PER_NM,
    )
