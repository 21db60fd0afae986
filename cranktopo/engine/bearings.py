"""Stiffness of a main bearing, radial and against tilt: given, of a clearance or of rollers. Their life."""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.table import SOFTEST_BEARING_N_PER_MM
from cranktopo.base.units import N_PER_KN, NMM_PER_NM
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import RollerBearing
from cranktopo.engine.gas import gas_force_N, pressure_curve
from cranktopo.numerics.roller_laminae import RollerSet, reference_life_turns, tilt_stiffness_Nmm_per_rad

_LIFE_EXPONENT = 10 / 3
"""Of line contact, ISO 281."""
_NO_LOAD = 1e-6
"""Part of the largest load of a cycle that wears no roller."""


def bearing_spring_N_per_mm(scene: Scene) -> float | None:
    """Return the radial stiffness of one main bearing, N/mm; None when the scene says nothing about it."""
    supports = scene.supports
    if supports.bearing_spring_N_per_mm is not None:
        return supports.bearing_spring_N_per_mm
    if supports.roller_bearing is not None:
        return _stiff_enough(roller_bearing_spring_N_per_mm(supports.roller_bearing), "roller_bearing")
    if supports.bearing_clearance_mm is not None:
        spring = _clearance_spring_N_per_mm(max_gas_force_N(scene), supports.bearing_clearance_mm)
        return _stiff_enough(spring, "bearing_clearance_mm")
    return None


def _stiff_enough(spring_N_per_mm: float, key: str) -> float:
    """Return the spring; raises CranktopoError where it is softer than one that may be given."""
    if spring_N_per_mm >= SOFTEST_BEARING_N_PER_MM:
        return spring_N_per_mm
    raise CranktopoError(
        f"supports.{key}: gives a main bearing of {spring_N_per_mm:.3g} N/mm; must be at least "
        f"{SOFTEST_BEARING_N_PER_MM:g} N/mm."
    )


def bearing_tilt_spring_Nmm_per_rad(scene: Scene) -> float:
    """Return the stiffness by which one main bearing resists the tilt of its journal; 0 where none is.

    Rollers whose sizes are given have that of ISO/TS 16281 under half the largest gas force, the load of the
    spring of a clearance: one number for all angles, as the shaft, its modes and its vibration take it.
    """
    if (given := scene.supports.bearing_tilt_spring_Nm_per_rad) is not None:
        return given * NMM_PER_NM
    rollers = _rollers(scene.supports.roller_bearing) if scene.bearings is None else None
    load_N = None if rollers is None else _largest_gas_force_N(scene)
    return tilt_stiffness_Nmm_per_rad(rollers, load_N / 2) if rollers and load_N else 0.0


def required_bearing_spring_N_per_mm(scene: Scene) -> float:
    """Return the same for supports that are springs; raises CranktopoError where there is none."""
    spring = bearing_spring_N_per_mm(scene)
    if spring is None:
        raise CranktopoError(
            "supports.bearing_spring_N_per_mm is missing.", hint="Give it in N/mm, or choose rigid bearings."
        )
    return spring


def radial_play_mm(scene: Scene) -> float:
    """Return the radial clearance of a main bearing; raises CranktopoError where the scene has none."""
    if scene.bearings is not None:
        return scene.bearings.clearance_mm / 2
    if scene.supports.bearing_clearance_mm is not None:
        return scene.supports.bearing_clearance_mm
    raise CranktopoError(
        f"{scene.name}: bearings.clearance_mm is missing: --bearings clearance needs it.",
        hint="Add [bearings] with clearance_mm = 0.05, for example, or choose --bearings rigid.",
    )


def max_gas_force_N(scene: Scene) -> float:
    """Return the largest gas force on the piston, N; raises CranktopoError where nothing tells it."""
    found = _largest_gas_force_N(scene)
    if found is None:
        raise invalid("engine.max_gas_force_N", None, "must be given, or [engine.gas]")
    return found


def _largest_gas_force_N(scene: Scene) -> float | None:
    engine, curve = scene.engine, pressure_curve(scene)
    if engine is not None and engine.max_gas_force_N is not None:
        return engine.max_gas_force_N
    return None if engine is None or curve is None else float(gas_force_N(curve.pressure_MPa, engine).max())


def _clearance_spring_N_per_mm(max_piston_force_N: float, clearance_mm: float) -> float:
    """Half the largest piston force moves the journal by 0.8 of the clearance.

    Source: J. Voparil, Shape optimisation of aircraft engine crankshaft, Brno University of Technology, 2011.
    """
    return 0.5 * max_piston_force_N / (0.8 * clearance_mm)


def table_slope_N_per_mm(bearing: RollerBearing) -> float:
    """Slope of the least-squares line of the table's reactions over their displacements, N/mm.

    Source of the method: M. Kral, Stress-strain analysis of balancing shaft support, Brno University of
    Technology, 2014.
    """
    x, y = np.array(bearing.displacement_mm), np.array(bearing.reaction_N)
    dx, dy = x - x.mean(), y - y.mean()
    return float((dx * dy).sum() / (dx**2).sum())


def roller_bearing_spring_N_per_mm(bearing: RollerBearing) -> float:
    """Radial stiffness of a roller bearing without clearance, N/mm: Z k / 4, k that of a whole roller.

    A radial displacement d compresses the roller at angle t by d cos t on the loaded half only; the sum of
    k d cos^2 t over these Z / 2 rollers is Z k d / 4.
    """
    whole_N_per_mm = table_slope_N_per_mm(bearing) * (bearing.roller_length_mm or 1.0)
    return bearing.rollers * whole_N_per_mm / 4


def equivalent_load_N(load_N: Array, turns: Array | None = None) -> float:
    """Constant load of a roller bearing under which it lives as long as under loads.

    Args:
        turns: share of the turns of each load; by default they are at even steps.
    """
    return float(np.average(np.abs(load_N) ** _LIFE_EXPONENT, weights=turns) ** (1 / _LIFE_EXPONENT))


def rating_life_h(dynamic_rating_kN: float, equivalent_N: float, speed_rpm: float) -> float:
    """Basic rating life of a roller bearing (90 % survive), hours: (C / P)^(10/3) million turns, ISO 281."""
    turns = 1e6 * math.pow(dynamic_rating_kN * N_PER_KN / equivalent_N, _LIFE_EXPONENT)
    return turns / (60.0 * speed_rpm)


def life_over_cycle_h(bearing: RollerBearing | None, load_N: Array, speed_rpm: float) -> float | None:
    """Basic rating life of a roller bearing under the forces of a cycle, hours; None without a rating.

    Args:
        load_N: radial force at even steps of the angle.
    """
    if bearing is None or bearing.dynamic_rating_kN is None or not speed_rpm:
        return None
    return rating_life_h(bearing.dynamic_rating_kN, equivalent_load_N(load_N), speed_rpm)


def reference_life_h(
    bearing: RollerBearing | None, load_N: Array, tilt: Array, speed_rpm: float
) -> float | None:
    """Return the life by ISO/TS 16281 under forces and tilts of a cycle, hours; None without rating or sizes.

    Damage of the states adds up (Palmgren, Miner).

    Args:
        load_N: x and y of the force of the journal at even steps of the angle, (2, states).
        tilt: how far the journal leads off along x and y per length, (2, states).

    Raises:
        CranktopoError: a load of which the rollers' is not found.
    """
    rollers = _rollers(bearing)
    if bearing is None or bearing.dynamic_rating_kN is None or rollers is None or not speed_rpm:
        return None
    size = np.hypot(*load_N)
    carries = size > _NO_LOAD * size.max(initial=0.0)
    if not carries.any():
        return None
    rating_N = bearing.dynamic_rating_kN * N_PER_KN
    turns = reference_life_turns(rollers, rating_N, load_N[:, carries].T, tilt[:, carries].T)
    return float(size.size / (1 / turns).sum() / (60.0 * speed_rpm))


def _rollers(bearing: RollerBearing | None) -> RollerSet | None:
    """Return the rollers of a bearing whose sizes are all given."""
    if bearing is None:
        return None
    diameter, length, pitch = bearing.sizes
    if diameter is None or length is None or pitch is None:
        return None
    return RollerSet(bearing.rollers, diameter, length, pitch, bearing.clearance_mm)
