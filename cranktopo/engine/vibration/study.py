"""Torsional vibration of a scene's shaft: modes, critical speeds, response, passage through resonances."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.checks.engine import shaft_warnings, speed_range_rpm
from cranktopo.design.misfire import with_misfire
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.barred import (
    MisfireRange,
    misfire_ranges,
    ranges_above,
    runs_barred,
    too_near_words,
)
from cranktopo.engine.vibration.shaft_chain import ShaftChain, varying_inertia_percent
from cranktopo.engine.vibration.steady import ORDERS, CriticalSpeed, Vibration, order_words, vibration
from cranktopo.engine.vibration.telling import left_out, telling
from cranktopo.engine.vibration.torque_harmonics import TorqueHarmonics, VaryingPart, torque_harmonics
from cranktopo.engine.vibration.vibrating_shaft import vibrating_shaft
from cranktopo.numerics.disk_chain import DampedMode, Mode

_STEPS_PER_PERIOD = 24
"""Of the highest order at the highest speed; the integration itself is exact between the steps."""
_FEWEST_CYCLES, _MOST_STEPS = 10, 2_000_000


@dataclass(frozen=True)
class RunUp:
    """Torques while the speed changes evenly over some seconds.

    Attributes:
        speeds_rpm: in the middle of each working cycle, shape (cycles,).
        torque_amplitude_Nm: half the range over each cycle, shape (cycles, sections).
    """

    seconds: float
    speeds_rpm: Array
    torque_amplitude_Nm: Array


def run_up(
    shaft: ShaftChain, harmonics: TorqueHarmonics, range_rpm: tuple[float, float], seconds: float
) -> RunUp:
    """Return the torque of every section from rest at the first speed to the last one.

    Loss factors act as viscous damping that loses as much at the natural frequency that they matter for.
    """
    from scipy.signal import lsim

    steps = run_up_steps(harmonics, range_rpm, seconds)
    first, last = (angular_speed_rad_s(rpm) for rpm in range_rpm)
    time = np.linspace(0.0, seconds, steps + 1)
    speed = first + (last - first) * time / seconds
    angle = first * time + (last - first) * time**2 / (2 * seconds)
    stiffness, damping = np.array(shaft.chain.stiffness_Nm_per_rad), _viscous(shaft)
    _, _, state = lsim(_system(shaft, damping), _torques(shaft, harmonics, speed, angle), time)
    twist, velocity = np.split(state, 2, axis=1)
    torque = -stiffness * np.diff(twist, axis=1) - damping * np.diff(velocity, axis=1)
    cycle = np.floor(angle * float(harmonics.orders[1]) / (2 * math.pi)).astype(int)
    starts = np.flatnonzero(np.diff(cycle, prepend=-1))
    swing = np.maximum.reduceat(torque, starts) - np.minimum.reduceat(torque, starts)
    count = np.diff(np.append(starts, len(cycle)))
    middle = np.add.reduceat(speed, starts) / count / angular_speed_rad_s(1.0)
    return RunUp(seconds, middle, swing / 2)


def run_up_steps(harmonics: TorqueHarmonics, range_rpm: tuple[float, float], seconds: float) -> int:
    """Return the number of steps in time of a run-up; raises CranktopoError for one too short or too long."""
    first, last = (angular_speed_rad_s(rpm) for rpm in range_rpm)
    highest = float(harmonics.orders[ORDERS]) * max(first, last) / (2 * math.pi)
    steps = math.ceil(seconds * highest * _STEPS_PER_PERIOD)
    cycles = seconds * (first + last) / 2 * float(harmonics.orders[1]) / (2 * math.pi)
    if cycles < _FEWEST_CYCLES or steps > _MOST_STEPS:
        shortest, longest = seconds * _FEWEST_CYCLES / cycles, seconds * _MOST_STEPS / steps
        raise CranktopoError(
            f"--run-up {seconds:g} s: must be >= {shortest:.3g} and <= {longest:.3g} s from "
            f"{range_rpm[0]:g} to {range_rpm[1]:g} rpm.",
            hint="Take another time, or shaft.speed_min_rpm and speed_max_rpm.",
            code=ExitCode.USAGE,
        )
    return steps


def _torques(shaft: ShaftChain, harmonics: TorqueHarmonics, speed: Array, angle: Array) -> Array:
    """Alternating torques on the disks, shape (times, disks)."""
    torque = np.zeros((len(angle), len(shaft.names)))
    gas, lost = (at(speed / angular_speed_rad_s(1.0)) for at in (harmonics.gas_at_Nm, harmonics.lost_at_Nm))
    for order in range(1, ORDERS + 1):
        single = gas[:, order] + speed**2 * harmonics.inertia_Nm_s2[order]
        clock = np.exp(1j * harmonics.orders[order] * angle)
        acting = (single * clock)[:, None] * harmonics.shifts[order]
        if harmonics.misfire:
            acting -= (lost[:, order] * clock)[:, None] * harmonics.misfire_shifts[order]
        torque[:, shaft.driven] += acting.real
    return torque


def _system(shaft: ShaftChain, damping: Array) -> tuple[Array, Array, Array, Array]:
    """State space of angles and angular velocities under torques on the disks."""
    chain = shaft.chain
    disks = len(chain.inertia_kg_m2)
    difference = np.eye(disks - 1, disks) - np.eye(disks - 1, disks, 1)
    inverse = np.diag(1 / np.array(chain.inertia_kg_m2))
    stiff = difference.T @ (np.array(chain.stiffness_Nm_per_rad)[:, None] * difference)
    lossy = difference.T @ (damping[:, None] * difference) + np.diag(chain.absolute_damping_Nms_per_rad)
    nothing = np.zeros((disks, disks))
    state = np.block([[nothing, np.eye(disks)], [-inverse @ stiff, -inverse @ lossy]])
    return state, np.vstack([nothing, inverse]), np.eye(2 * disks), np.zeros((2 * disks, disks))


def _viscous(shaft: ShaftChain) -> Array:
    """Viscous damping of each section, its loss factor included, N m s/rad."""
    chain, inside = shaft.chain, np.array(shaft.in_crankshaft)
    stiffness = np.array(chain.stiffness_Nm_per_rad)
    modes = chain.modes()
    alone = np.eye(len(stiffness), dtype=bool)
    holders = [inside if inside[i] else alone[i] for i in range(len(stiffness))]
    frequency = np.array([_held_by(modes, stiffness, sections) for sections in holders])
    viscous = np.array(chain.relative_damping_Nms_per_rad)
    return np.asarray(viscous + stiffness * np.array(chain.loss_factor) / frequency)


def _held_by(modes: tuple[Mode, ...], stiffness: Array, sections: Array) -> float:
    """Frequency (rad/s) of the lowest mode of whose strain energy some sections hold most, or the most."""
    energies = [stiffness * np.diff(mode.shape) ** 2 for mode in modes]
    shares = [float(energy[sections].sum() / energy.sum()) for energy in energies]
    place = next((i for i, share in enumerate(shares) if share >= 0.5), int(np.argmax(shares)))
    return 2 * math.pi * modes[place].frequency_Hz


@dataclass(frozen=True)
class Swing:
    """The largest torque amplitude of a section of the shaft over all speeds.

    Attributes:
        section: of the shaft, by its number.
        order, order_Nm: the largest of it, and its torque alone.
    """

    section: int
    speed_rpm: float
    torque_amplitude_Nm: float
    order: float
    order_Nm: float

    @property
    def orders_words(self) -> str:
        """Return in words the orders that it is of."""
        return order_words(self.order, self.order_Nm, self.torque_amplitude_Nm)


def largest_swing(response: Vibration, section: int) -> Swing:
    """Return where a section's torque swings most, of equal speeds at the lowest."""
    return swing_at(response, section, worst_speed(response, section))


def worst_speed(response: Vibration, section: int) -> int:
    """Return the number of the speed at which a section's torque swings most, of those the engine runs at."""
    return int(np.where(response.running, response.torque_amplitude_Nm[:, section], -1.0).argmax())


def swing_at(response: Vibration, section: int, speed: int) -> Swing:
    """Return how a section's torque swings at a speed, given by its number."""
    amplitude = float(response.torque_amplitude_Nm[speed, section])
    return Swing(
        section, float(response.speeds_rpm[speed]), amplitude, *response.largest_order(speed, section)
    )


def worst_swing(response: Vibration) -> Swing:
    """Return the largest torque amplitude of the crankshaft."""
    return swing_at(response, response.worst.section, response.worst.speed_index)


@dataclass(frozen=True)
class Misfire:
    """Torques of the shaft where one cylinder alone does not fire.

    Attributes:
        crankshaft: the largest of the crankshaft.
        joined: the largest of every section that is no part of the crankshaft: coupling, damper, line.
        joined_own: the same at the engine's own speed; empty where that is outside of the range.
        barred_rpm: ranges above the permitted stress; None where no stress is given.
    """

    cylinder: int
    crankshaft: Swing
    joined: tuple[Swing, ...]
    joined_own: tuple[Swing, ...]
    barred_rpm: tuple[tuple[float, float], ...] | None


@dataclass(frozen=True)
class VibrationStudy:
    """Torsional vibration of a shaft over its range of speeds.

    Attributes:
        critical: crossings of orders and natural frequencies in the range, felt or where cylinders cancel.
        left_out: how many other crossings each mode has.
        varying_inertia_percent: half the range of a throw's inertia over a turn, over its mean.
        mean_response: the response with the mean inertia alone, at the speeds where it is largest.
        barred_rpm: ranges above the permitted stress, of the scene's own firing; None where no stress is
            given.
        warnings: what the shaft leaves out, one line each.
        run_up: passage through the range in a given time, if one was asked for; with the mean inertia.
        misfires: of every cylinder, if asked for.
    """

    scene: Scene
    stiffness_source: str
    modes: tuple[DampedMode, ...]
    critical: tuple[CriticalSpeed, ...]
    left_out: tuple[int, ...]
    response: Vibration
    varying_inertia_percent: float
    varying: VaryingPart
    mean_response: Vibration
    barred_rpm: tuple[tuple[float, float], ...] | None
    warnings: tuple[str, ...]
    run_up: RunUp | None = None
    misfires: tuple[Misfire, ...] = ()

    @property
    def cylinders(self) -> int:
        """Number of cylinders of the engine."""
        return len(self.response.harmonics.firing_deg)

    @property
    def worst_misfire(self) -> Misfire | None:
        """That with the largest torque, of equal ones the first; None where it was not asked for."""
        found = self.misfires
        return max(found, key=lambda one: round(one.crankshaft.torque_amplitude_Nm, 6)) if found else None

    @property
    def misfire_barred(self) -> tuple[MisfireRange, ...]:
        """Ranges above the permitted stress where one cylinder does not fire; none if not asked for."""
        return misfire_ranges(
            MisfireRange(low, high, (one.cylinder,))
            for one in self.misfires
            for low, high in one.barred_rpm or ()
        )

    @property
    def joined_sections(self) -> tuple[int, ...]:
        """Sections that are no part of the crankshaft: coupling, damper, line."""
        return tuple(i for i, inside in enumerate(self.shaft.in_crankshaft) if not inside)

    @property
    def own_speed(self) -> int | None:
        """Number of the engine's own speed among those that are solved; None outside of the range."""
        rpm = self.scene.engine.speed_rpm if self.scene.engine else math.nan
        found = np.flatnonzero(self.response.speeds_rpm == rpm)
        return int(found[0]) if len(found) else None

    @property
    def joined_own(self) -> tuple[Swing, ...]:
        """Torque of the sections outside the crankshaft at the engine's own speed."""
        return _own_swings(self, self.response)

    @property
    def shaft(self) -> ShaftChain:
        """The chain of disks."""
        return self.response.shaft

    @property
    def varying_change_percent(self) -> float | None:
        """Change of the largest torque amplitude by the varying part; None where it is left out."""
        if not self.varying.included:
            return None
        return 100 * (self.response.worst_Nm / self.mean_response.worst_Nm - 1)

    def run_up_worst(self) -> tuple[float, int, float] | None:
        """Speed (rpm), section and torque amplitude (N m) of the crankshaft's largest swing in the run-up."""
        if self.run_up is None:
            return None
        swing = np.where(np.array(self.shaft.in_crankshaft), self.run_up.torque_amplitude_Nm, -1.0)
        cycle, section = (int(i) for i in np.unravel_index(int(swing.argmax()), swing.shape))
        return float(self.run_up.speeds_rpm[cycle]), section, float(swing[cycle, section])


def check_vibration(scene: Scene, run_up_s: float | None) -> None:
    """Refuse before any solve what the study would refuse; raises CranktopoError as `study_vibration`."""
    harmonics = _harmonics(scene)
    if run_up_s is not None:
        run_up_steps(harmonics, speed_range_rpm(scene), run_up_s)


def _harmonics(scene: Scene) -> TorqueHarmonics:
    harmonics = torque_harmonics(scene)
    if harmonics is None:
        raise CranktopoError(
            "engine.gas: is missing, so nothing is known of the torque over the cycle.",
            hint="Add [engine.gas] with a peak pressure or an indicator diagram.",
        )
    return harmonics


def study_vibration(
    scene: Scene,
    shaft: ShaftChain,
    throw_inertia_kg_mm2: float,
    stiffness_source: str,
    run_up_s: float | None = None,
) -> VibrationStudy:
    """Return modes, critical speeds and steady vibration of a shaft over the scene's range of speeds.

    Args:
        run_up_s: time in which the speed rises through the range, for a passage through its resonances.

    Raises:
        CranktopoError: the scene tells no torque over the cycle, the shaft is a single disk, or a run-up that
            is too short or too long.
    """
    harmonics = _harmonics(scene)
    if len(shaft.names) == 1:
        raise CranktopoError(
            "shaft: one throw with nothing joined to it cannot twist.",
            hint="Add [shaft.flywheel] or [shaft.propeller].",
        )
    model = vibrating_shaft(scene, shaft, harmonics)
    response = model.over_the_range()
    told = telling(model.critical, response, model.varying.rise)
    worst_rpm = float(response.speeds_rpm[response.worst.speed_index])
    barred = _barred_rpm(scene, response, model.at)
    faults = [runs_barred(scene, barred or ()), too_near_words(scene, barred or ())]
    return VibrationStudy(
        scene,
        stiffness_source,
        model.modes,
        told,
        left_out(told, model.modes, response),
        response,
        varying_inertia_percent(scene, throw_inertia_kg_mm2),
        model.varying,
        model.with_mean_inertia(worst_rpm) if model.varying.included else response,
        barred,
        (*shaft_warnings(scene), *(f"shaft: {fault}" for fault in faults if fault)),
        None if run_up_s is None else run_up(shaft, harmonics, model.range_rpm, run_up_s),
    )


def _barred_rpm(
    scene: Scene, response: Vibration, at: Callable[[Array], Vibration]
) -> tuple[tuple[float, float], ...] | None:
    permitted = scene.shaft.permitted_shear_MPa if scene.shaft else None
    return None if permitted is None else ranges_above(response, permitted, at)


def misfires_of_each(study: VibrationStudy) -> tuple[Misfire, ...]:
    """Return the largest torques of the shaft where one cylinder does not fire, for every cylinder.

    At the speeds of the study: they have every crossing of an order with a natural frequency.
    """
    if study.cylinders == 1:
        raise invalid("--misfire", "worst", "needs an engine with more than one cylinder")
    return tuple(_misfire(study, cylinder) for cylinder in range(1, study.cylinders + 1))


def misfire_warnings(study: VibrationStudy) -> tuple[str, ...]:
    """Return that the engine runs at a speed that is barred with a misfire alone, in one line; or nothing."""
    ranges = [(one.low_rpm, one.high_rpm) for one in study.misfire_barred]
    warning = runs_barred(study.scene, ranges)
    if not warning or runs_barred(study.scene, study.barred_rpm or ()):
        return ()
    return (f"shaft: with one cylinder misfiring, {warning}",)


def _misfire(study: VibrationStudy, cylinder: int) -> Misfire:
    harmonics = torque_harmonics(with_misfire(study.scene, [cylinder]))
    assert harmonics is not None
    varying = study.varying.harmonics_kg_m2 if study.varying.included else None
    speeds, orders = study.response.speeds_rpm, len(study.response.orders)

    def at(speeds_rpm: Array) -> Vibration:
        solved = vibration(study.shaft, harmonics, speeds_rpm, orders, varying)
        return replace(solved, barred_rpm=study.response.barred_rpm)

    found = at(speeds)
    joined = tuple(largest_swing(found, section) for section in study.joined_sections)
    crankshaft = largest_swing(found, found.worst.section)
    barred = _barred_rpm(study.scene, found, at)
    return Misfire(cylinder, crankshaft, joined, _own_swings(study, found), barred)


def _own_swings(study: VibrationStudy, response: Vibration) -> tuple[Swing, ...]:
    own = study.own_speed
    return () if own is None else tuple(swing_at(response, one, own) for one in study.joined_sections)
