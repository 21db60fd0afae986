"""The whole load analysis of a scene at one speed: curves, extremes, engine torque, balance."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.errors import invalid
from cranktopo.loads.balance import ThrowBalance, throw_balance
from cranktopo.loads.engine_torque import ShaftTorque, shaft_torque
from cranktopo.loads.forces import (
    INERTIA_EFFECTS,
    RotatingForces,
    ThrowForces,
    rotating_forces,
    throw_forces,
)
from cranktopo.loads.gas import PressureCurve, pressure_curve
from cranktopo.loads.kinematics import Array, exact_motion, series_motion
from cranktopo.loads.vibrating_torque import vibrating_torque, worst_speed_rpm
from cranktopo.scene import Scene
from cranktopo.scene.engine import Engine
from cranktopo.units import NMM_PER_NM


@dataclass(frozen=True)
class Extreme:
    """A value and the crank angle where it occurs.

    Attributes:
        deg: crank angle from firing top dead centre, deg; None when the scene gives only the value.
    """

    value: float
    deg: float | None

    def as_json(self) -> dict[str, float | None]:
        """The value and its angle."""
        return {"value": self.value, "deg": self.deg}


@dataclass(frozen=True)
class Cycle:
    """Curves over one working cycle at one speed.

    Attributes:
        indicated_work_J: work of the gas in one cylinder per cycle, J.
        series_difference_percent: largest difference of the textbook series from the exact motion, in
            percent of the largest exact value: displacement, velocity, acceleration.
    """

    pressure: PressureCurve
    forces: ThrowForces
    torque: ShaftTorque
    indicated_work_J: float
    series_difference_percent: dict[str, float]

    def extremes(self) -> dict[str, tuple[Extreme, Extreme]]:
        """Largest and smallest value of every curve of the throw."""
        return {name: _extremes(self.forces.angle_deg, curve) for name, curve in self.forces.curves().items()}

    def engine_torque(self) -> tuple[float, Extreme, Extreme]:
        """Mean, largest and smallest torque of the engine, N m (no friction)."""
        torque = self.torque.engine_Nm
        return float(torque.mean()), *_extremes(self.torque.angle_deg, torque)


@dataclass(frozen=True)
class LoadAnalysis:
    """Loads of a scene with an engine at the engine's speed.

    Attributes:
        cycle: curves over the cycle; None when the scene gives only peak loads.
    """

    engine: Engine
    radius_mm: float
    balance: ThrowBalance
    rotating: RotatingForces
    cycle: Cycle | None


def at_speed(scene: Scene, speed_rpm: float) -> Scene:
    """The scene with its engine at another speed; gas pressures stay as they are."""
    engine = engine_of(scene).model_copy(update={"speed_rpm": speed_rpm})
    return scene.model_copy(update={"engine": engine})


def at_worst_speed(scene: Scene, enabled: frozenset[str]) -> Scene:
    """The scene at the speed where the torque of its vibrating shaft swings most.

    Raises:
        CranktopoError: as `vibrating_torque`.
    """
    return at_speed(scene, worst_speed_rpm(scene, enabled))


def analyse(scene: Scene, enabled: frozenset[str] = INERTIA_EFFECTS) -> LoadAnalysis:
    """Forces over the cycle at the engine's speed.

    Args:
        enabled: `reciprocating_inertia` and `rotating_rod_mass` among these names make the inertia of the
            piston and of the rod count; with `torsional_vibration` the torques are those of the vibrating
            shaft at the engine's speed.

    Raises:
        CranktopoError: no engine, two rods on a pin, or gas data that cannot be used.
    """
    engine, radius = engine_of(scene), scene.throw.radius_mm
    if engine.rods_per_pin > 1:
        raise invalid(
            "engine.arrangement.layout",
            engine.arranged.layout,
            "loads of a throw are those of one rod, a V has two on each pin",
            "Only `cranktopo balance` knows both; for the loads of one rod leave layout out.",
        )
    balance = throw_balance(scene)
    curve = pressure_curve(scene)
    cycle = None if curve is None else _cycle(engine, radius, curve, balance, enabled)
    if cycle is not None and "torsional_vibration" in enabled:
        cycle = replace(cycle, torque=vibrating_torque(scene, enabled))
    rotating = rotating_forces(engine, balance, radius, engine.speed_rpm)
    return LoadAnalysis(engine, radius, balance, rotating, cycle)


def engine_of(scene: Scene) -> Engine:
    """The engine of a scene; raises CranktopoError where there is none."""
    if scene.engine is None:
        raise invalid("engine", None, "must be given for forces over the cycle", "Add an [engine] table.")
    return scene.engine


def _cycle(
    engine: Engine,
    radius: float,
    curve: PressureCurve,
    balance: ThrowBalance,
    enabled: frozenset[str],
) -> Cycle:
    forces = throw_forces(
        engine,
        radius,
        curve,
        balance,
        engine.speed_rpm,
        reciprocating="reciprocating_inertia" in enabled,
        rotating_rod="rotating_rod_mass" in enabled,
    )
    torque = shaft_torque(curve.angle_deg, forces.torque_Nm, engine.firing_angles_deg, engine.cycle_deg)
    work = indicated_work_J(curve, engine, radius)
    return Cycle(curve, forces, torque, work, series_difference_percent(radius, engine.rod_length_mm))


def indicated_work_J(curve: PressureCurve, engine: Engine, radius_mm: float) -> float:
    """Work of the gas in one cylinder per cycle, J: the closed integral of p dV.

    It uses pressures and piston positions only, no forces, so that the torque can be checked against it.
    Trapezoidal rule with every and with every other point, extrapolated (Romberg).

    Args:
        curve: cylinder pressure over one cycle, an even number of points.
    """
    motion = exact_motion(np.radians(curve.angle_deg), radius_mm, engine.rod_length_mm)
    volume = math.pi / 4 * engine.bore_mm**2 * motion.displacement_mm

    def trapezoid(stride: int) -> float:
        p, v = curve.pressure_MPa[::stride], volume[::stride]
        return float(((p + np.roll(p, -1)) / 2 * (np.roll(v, -1) - v)).sum())

    return (4 * trapezoid(1) - trapezoid(2)) / 3 / NMM_PER_NM


def series_difference_percent(radius_mm: float, rod_length_mm: float) -> dict[str, float]:
    """Largest difference of the textbook series from the exact motion over a turn, in percent of the peak."""
    angle = np.radians(np.arange(0.0, 360.0, 0.25))
    exact, series = (motion(angle, radius_mm, rod_length_mm) for motion in (exact_motion, series_motion))

    def percent(name: str) -> float:
        truth: Array = getattr(exact, name)
        return float(100 * np.abs(getattr(series, name) - truth).max() / np.abs(truth).max())

    return {
        "displacement": percent("displacement_mm"),
        "velocity": percent("velocity_ratio"),
        "acceleration": percent("acceleration_ratio"),
    }


def _extremes(angle_deg: Array, curve: Array) -> tuple[Extreme, Extreme]:
    """Largest and smallest value of a curve with their angles."""
    high, low = int(curve.argmax()), int(curve.argmin())
    return (
        Extreme(float(curve[high]), float(angle_deg[high])),
        Extreme(float(curve[low]), float(angle_deg[low])),
    )
