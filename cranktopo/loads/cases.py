"""Load cases handed to the optimiser and the judge, derived from the engine or unit loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cranktopo.loads.gas import gas_force_N
from cranktopo.loads.kinematics import exact_motion, force_ratios
from cranktopo.scene import Scene
from cranktopo.scene.schema import Engine
from cranktopo.units import MM_PER_M, NMM_PER_NM, angular_speed_rad_s

LoadKind = Literal["bending", "torsion", "tangential", "centrifugal"]

UNIT_FORCE_N = 1000.0
UNIT_TORQUE_NM = 1.0
DEFAULT_EFFECTS = frozenset({"bending", "torsion", "reciprocating_inertia", "rotating_rod_mass"})


@dataclass(frozen=True)
class LoadCase:
    """One load case of a throw; forces are those of the full throw.

    Attributes:
        name: unique name, used as key in metrics.
        kind: which load and which mirror symmetry about the mid-pin plane.
        radial_N: force on the crankpin along -y (compression of the rod), N.
        tangential_N: force on the crankpin along x, N.
        torque_Nm: torque at the two mid-journal planes, equal and opposite, N m.
        speed_rpm: speed for body forces, rpm.
        source: where the numbers come from, one sentence.
    """

    name: str
    kind: LoadKind
    radial_N: float = 0.0
    tangential_N: float = 0.0
    torque_Nm: float = 0.0
    speed_rpm: float = 0.0
    source: str = ""


def load_cases(scene: Scene, enabled: frozenset[str] | None = None) -> tuple[LoadCase, ...]:
    """The load cases of a scene.

    Args:
        scene: the scene; without an engine the cases carry unit loads (1000 N, 1 N m).
        enabled: names of the effects that are on; bending, torsion and the rod's and piston's inertia
            when not given.

    Returns:
        The cases that are enabled, `bending` before `torsion`.
    """
    effects = DEFAULT_EFFECTS if enabled is None else enabled
    radial, torque, source = _peak_loads(scene, effects)
    cases = (
        LoadCase("bending", "bending", radial_N=radial, source=source),
        LoadCase("torsion", "torsion", torque_Nm=torque, source=source),
    )
    return tuple(case for case in cases if case.kind in effects)


def _peak_loads(scene: Scene, effects: frozenset[str]) -> tuple[float, float, str]:
    """Radial force (N), torque (N m) and where they come from."""
    engine = scene.engine
    if engine is None:
        return UNIT_FORCE_N, UNIT_TORQUE_NM, "unit load: the scene has no engine"
    if engine.max_gas_force_N is not None or engine.gas is None:
        force = UNIT_FORCE_N if engine.max_gas_force_N is None else engine.max_gas_force_N
        torque = force * scene.throw.radius_mm / NMM_PER_NM
        given = torque if engine.max_torque_Nm is None else engine.max_torque_Nm
        return force, given, "engine.max_gas_force_N and engine.max_torque_Nm"
    return _loads_at_peak_pressure(scene, engine, effects)


def _loads_at_peak_pressure(
    scene: Scene, engine: Engine, effects: frozenset[str]
) -> tuple[float, float, str]:
    gas, masses, radius = engine.gas, engine.masses, scene.throw.radius_mm
    assert gas is not None  # for the type checker: the caller has looked
    angle = np.radians([gas.peak_angle_deg])
    motion = exact_motion(angle, radius, engine.rod_length_mm)
    ratios = force_ratios(angle, radius, engine.rod_length_mm)
    r_w2 = radius / MM_PER_M * angular_speed_rad_s(engine.speed_rpm) ** 2
    force = gas_force_N(gas.peak_pressure_MPa, gas.ambient_pressure_MPa, engine.bore_mm)
    if "reciprocating_inertia" in effects:
        force -= (masses.piston_group_kg + masses.rod_reciprocating_kg) * r_w2 * motion.acceleration_ratio[0]
    radial = force * ratios.radial[0]
    if "rotating_rod_mass" in effects:
        radial -= masses.rod_rotating_kg * r_w2
    torque = force * ratios.tangential[0] * radius / NMM_PER_NM
    return float(radial), float(torque), f"peak gas force at {gas.peak_angle_deg:g} deg"
