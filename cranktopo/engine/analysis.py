"""The whole load analysis of a scene at one speed: curves, extremes, engine torque, balance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.units import MM_PER_M, NMM_PER_NM, angular_speed_rad_s
from cranktopo.design.engine import Engine
from cranktopo.design.halves import difference, halves
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import (
    ThrowBalance,
    product_of_inertia_kg_mm2,
    splayed_mass,
    throw_balance,
)
from cranktopo.engine.chamber import Chamber, chamber_of
from cranktopo.engine.cylinders import cylinders
from cranktopo.engine.forces import (
    INERTIA_EFFECTS,
    RodsOnPin,
    RotatingForces,
    ShaftTorque,
    ThrowForces,
    journal_force_N,
    rods_on_pins,
    rotating_forces,
    uneven_journal_force_N,
)
from cranktopo.engine.gas import FileState, PressureCurve, pressure_curve, trace_states
from cranktopo.engine.kinematics import exact_motion, series_motion
from cranktopo.engine.motored import motored_curve
from cranktopo.engine.vibration.vibrating_shaft import extreme_speeds_rpm, vibrating_torque, worst_speed_rpm


@dataclass(frozen=True)
class Extreme:
    """A value and its crank angle from firing top dead centre, deg; None when the scene gives only the value.

    `place` is the throw or web, where they are not alike.
    """

    value: float
    deg: float | None
    place: str = ""


@dataclass(frozen=True)
class Cycle:
    """Curves over one working cycle at one speed.

    Pressure and forces on the pins are those of cylinders that fire, the torque is that of all cylinders as
    they are. Angles of a throw count from firing of its cylinder, where it has several of its first one. The
    forces on the pins are all the same object where all are alike.

    Attributes:
        indicated_work_J: work of the gas per cycle in one cylinder that fires, on the piston of this crank.
        mean_work_J: the same of all cylinders, those that do not fire among them, over their number.
        series_difference_percent: largest difference of the textbook series from the exact motion, in
            percent of the largest exact value: displacement, velocity, acceleration.
    """

    pressure: PressureCurve
    room: Chamber
    pins: tuple[tuple[RodsOnPin, ThrowForces], ...]
    torque: ShaftTorque
    indicated_work_J: float
    mean_work_J: float
    series_difference_percent: dict[str, float]

    @property
    def forces(self) -> ThrowForces:
        """Forces of the throw, or of the web, with the largest web force; of equal ones the first."""
        return self._governing[1]

    @property
    def place(self) -> str:
        """Name of the throw or web that these are of; empty where all are alike."""
        return self._governing[0]

    @property
    def _governing(self) -> tuple[str, ThrowForces]:
        return max(self.unlike, key=lambda one: _size(np.abs(one[1].web_force_N).max()))

    @property
    def unlike(self) -> tuple[tuple[str, ThrowForces], ...]:
        """Names and forces of throws or webs that differ; one without a name where all are alike."""
        if all(forces is self.pins[0][1] for _, forces in self.pins):
            return (("", self.pins[0][1]),)
        return tuple((rods.name, forces) for rods, forces in self.pins)

    def extreme(self, name: str) -> tuple[Extreme, Extreme]:
        """Largest and smallest value of a curve of all throws."""
        return _outermost([extremes_of(f.angle_deg, getattr(f, name), place) for place, f in self.unlike])

    def largest(self, name: str) -> Extreme:
        """Return the value of a curve of all throws that is largest in magnitude, with its sign."""
        return max(self.extreme(name), key=lambda extreme: abs(extreme.value))

    def extremes(self) -> dict[str, tuple[Extreme, Extreme]]:
        """Largest and smallest value of every curve of the throws."""
        return {name: self.extreme(name) for name in self.forces.curves()}

    def section_torque(self) -> tuple[Extreme, Extreme]:
        """Largest and smallest torque ahead of or behind any throw, N m: the webs of a throw carry both."""
        named = zip(self.torque.section_names, self.torque.sections_Nm, strict=True)
        return _outermost([extremes_of(self.torque.angle_deg, curve, name) for name, curve in named])

    def engine_torque(self) -> tuple[float, Extreme, Extreme]:
        """Return the mean, largest and smallest torque of the engine, N m (no friction)."""
        torque = self.torque.engine_Nm
        return float(torque.mean()), *extremes_of(self.torque.angle_deg, torque)


@dataclass(frozen=True)
class LoadAnalysis:
    """Loads of a scene at its engine's speed; `cycle` is None when the scene gives only peak loads."""

    engine: Engine
    radius_mm: float
    balance: ThrowBalance
    rotating: RotatingForces
    cycle: Cycle | None


def at_speed(scene: Scene, speed_rpm: float) -> Scene:
    """Return the scene with its engine at another speed, for which it has no rated power.

    Gas pressures stay as they are.
    """
    engine = engine_of(scene)
    rated_kW = engine.rated_power_kW if speed_rpm == engine.speed_rpm else None
    changed = engine.model_copy(update={"speed_rpm": speed_rpm, "rated_power_kW": rated_kW})
    return scene.model_copy(update={"engine": changed})


def at_worst_speed(scene: Scene, enabled: frozenset[str]) -> Scene:
    """Return the scene at the speed where the torque of its vibrating shaft swings most."""
    return at_speed(scene, worst_speed_rpm(scene, enabled))


def at_extreme_speeds(scene: Scene, enabled: frozenset[str]) -> tuple[Scene, ...]:
    """Return the scene as it is, then where the torque of its vibrating shaft is largest and smallest."""
    if "torsional_vibration" not in enabled:
        return (scene,)
    own = engine_of(scene).speed_rpm
    others = (speed for speed in extreme_speeds_rpm(scene, enabled) if speed != own)
    return (scene, *(at_speed(scene, speed) for speed in others))


def analyse(scene: Scene, enabled: frozenset[str] = INERTIA_EFFECTS) -> LoadAnalysis:
    """Return the forces over the cycle at the engine's speed; raises CranktopoError for gas data of no use.

    Args:
        enabled: `reciprocating_inertia` and `rotating_rod_mass` among these names make the inertia of the
            piston and of the rod count; with `torsional_vibration` the torques are those of the vibrating
            shaft.
    """
    return _analysis(scene, frozenset(enabled), trace_states(scene))


@lru_cache(maxsize=16)
def _analysis(scene: Scene, enabled: frozenset[str], _traces: tuple[FileState, ...]) -> LoadAnalysis:
    """Analyse a scene once for all who ask: a plan looks at the same one for half of its effects."""
    engine, radius = engine_of(scene), scene.throw.radius_mm
    balance = throw_balance(scene)
    curve = pressure_curve(scene)
    cycle = None if curve is None else _cycle(scene, engine, curve, balance, enabled)
    if cycle is not None and "torsional_vibration" in enabled:
        cycle = replace(cycle, torque=vibrating_torque(scene, enabled))
    rotating = rotating_forces(engine, balance, radius, engine.speed_rpm)
    return LoadAnalysis(engine, radius, balance, rotating, cycle)


def engine_of(scene: Scene) -> Engine:
    """Return the engine of a scene; raises CranktopoError where there is none."""
    if scene.engine is None:
        raise invalid("engine", None, "must be given for forces over the cycle", "Add an [engine] table.")
    return scene.engine


def _cycle(
    scene: Scene, engine: Engine, curve: PressureCurve, balance: ThrowBalance, enabled: frozenset[str]
) -> Cycle:
    radius = scene.throw.radius_mm
    rods = cylinders(scene, enabled)
    assert rods is not None
    rod = replace(rods.firing, main_journal_force_N=_on_journal_N(scene, rods.firing, balance, engine))
    pins = tuple(
        (pin, pin.forces(rod, _own_N(scene, engine, pin), engine.cycle_deg))
        for pin in rods_on_pins(scene, engine)
    )
    work = indicated_work_J(curve, engine, radius)
    mean = _mean_work_J(scene, engine, work)
    room = chamber_of(scene)
    return Cycle(
        curve, room, pins, rods.torque, work, mean, series_difference_percent(radius, engine.rod_length_mm)
    )


def _own_N(scene: Scene, engine: Engine, rods: RodsOnPin) -> complex:
    """Return the centrifugal force of the throw alone that loads a web: twice the reaction of its bearing.

    Real along the part of the pin beside the web. Of a throw with a straight pin it is the whole force.
    """
    per_kg_mm = angular_speed_rad_s(engine.speed_rpm) ** 2 / MM_PER_M
    if not any(rods.ahead_deg):
        return throw_balance(scene).throw_unbalance_kg_mm * per_kg_mm
    mass, first = splayed_mass(scene), rods.ahead_deg[0] == 0.0
    beside = engine.pin_deg(1 if first else engine.cylinders)
    turn = complex(np.exp(-1j * np.radians(beside)))
    return (mass.throw + (-2 if first else 2) * mass.throw_couple / scene.pitch_mm) * turn * per_kg_mm


def _mean_work_J(scene: Scene, engine: Engine, work_J: float) -> float:
    """Return the work of a cycle over all cylinders, from that of one that fires."""
    motored = motored_curve(scene) if engine.misfire else None
    if motored is None:
        return work_J
    lost = work_J - indicated_work_J(motored, engine, scene.throw.radius_mm)
    return work_J - lost * len(engine.misfire) / engine.cylinders


def _on_journal_N(scene: Scene, rod: ThrowForces, balance: ThrowBalance, engine: Engine) -> Array:
    """Return the force on each main journal with the throw's own mass; where webs differ the larger one."""
    if not difference(scene):
        spinning = rotating_forces(engine, balance, scene.throw.radius_mm, engine.speed_rpm)
        return journal_force_N(rod, spinning.throw_N)
    per_kg_mm = angular_speed_rad_s(engine.speed_rpm) ** 2 / MM_PER_M
    turning = complex(balance.throw_unbalance_kg_mm, balance.lateral_unbalance_kg_mm) * per_kg_mm
    near, far = (half.pitch_mm / 2 for half in halves(scene))
    couple = product_of_inertia_kg_mm2(scene) * per_kg_mm
    return uneven_journal_force_N(rod, turning, couple, (near, far))


@lru_cache(maxsize=32)
def indicated_work_J(curve: PressureCurve, engine: Engine, radius_mm: float) -> float:
    """Return the work of the gas on one piston per cycle, J: the closed integral of p dV of its own volume.

    It uses pressures and piston positions only, no forces, so that the torque can be checked against it.
    Trapezoidal rule with every and with every other of an even number of points, extrapolated (Romberg).
    """
    motion = exact_motion(np.radians(curve.angle_deg), radius_mm, engine.rod_length_mm)
    volume = math.pi / 4 * engine.bore_mm**2 * motion.displacement_mm

    def trapezoid(stride: int) -> float:
        p, v = curve.pressure_MPa[::stride], volume[::stride]
        return float(((p + np.roll(p, -1)) / 2 * (np.roll(v, -1) - v)).sum())

    return (4 * trapezoid(1) - trapezoid(2)) / 3 / NMM_PER_NM


@lru_cache(maxsize=64)
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


def _size(value: float) -> float:
    """Return a value without its last digits, so that of equal throws the first counts."""
    return round(float(value), 6)


def _outermost(pairs: Sequence[tuple[Extreme, Extreme]]) -> tuple[Extreme, Extreme]:
    """Return the largest and the smallest of several largest and smallest values."""
    highs, lows = zip(*pairs, strict=True)
    return max(highs, key=lambda e: _size(e.value)), min(lows, key=lambda e: _size(e.value))


def extremes_of(angle_deg: Array, curve: Array, place: str = "") -> tuple[Extreme, Extreme]:
    """Return the largest and smallest value of a curve with their angles."""
    high, low = int(curve.argmax()), int(curve.argmin())
    return (
        Extreme(float(curve[high]), float(angle_deg[high]), place),
        Extreme(float(curve[low]), float(angle_deg[low]), place),
    )
