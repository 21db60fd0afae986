"""The torsional vibration of a shaft: the JSON object of `vibration --json`."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import Assumption
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.vibration.steady import CriticalSpeed
from cranktopo.engine.vibration.study import Swing, VibrationStudy

_NOT_DAMPING = {"speed_min_rpm", "speed_max_rpm", "permitted_shear_MPa", "throw_stiffness_Nm_per_rad"}


class ShaftDisk(Result):
    """A disk of the shaft's model."""

    name: str
    inertia_kg_m2: float


class ShaftSection(Result):
    """A spring of the shaft's model."""

    name: str
    stiffness_Nm_per_rad: float
    in_crankshaft: bool


class NaturalMode(Result):
    """A natural vibration; its shape is that of the disks, the largest 1."""

    frequency_Hz: float
    damping_ratio: float
    shape: tuple[float, ...]


class VaryingInertia(Result):
    """Effect of the varying inertia of rod and piston."""

    estimate_percent: float
    included: bool
    torque_change_percent: float | None


class OrderTorque(Result):
    """Torque amplitude of one order."""

    order: float
    torque_Nm: float


class WorstTorque(Result):
    """The largest torque amplitude of the crankshaft over all speeds."""

    speed_rpm: float
    section: str
    torque_amplitude_Nm: float
    order: float
    """The largest of this torque; it may be of many orders."""
    shear_MPa: float
    mean_torque_Nm: float
    by_order: tuple[OrderTorque, ...]


class AtSpeed(Result):
    """Vibration at one speed by section; the stress is null outside the crankshaft."""

    rpm: float
    torque_amplitude_Nm: tuple[float, ...]
    twist_deg: tuple[float, ...]
    shear_MPa: tuple[float | None, ...]
    free_end_deg: float


class RunUpWorst(Result):
    """The largest torque amplitude of the crankshaft in a run-up."""

    speed_rpm: float
    section: str
    torque_amplitude_Nm: float
    shear_MPa: float


class RunUpSpeed(Result):
    """Torque amplitudes by section while the speed passes."""

    rpm: float
    torque_amplitude_Nm: tuple[float, ...]


class RunUpResult(Result):
    """A passage through the range of speeds."""

    seconds: float
    worst: RunUpWorst
    speeds: tuple[RunUpSpeed, ...]


class JoinedSwing(Result):
    """The largest torque amplitude of a section that is no part of the crankshaft, such as the coupling."""

    section: str
    speed_rpm: float
    torque_amplitude_Nm: float
    order: float
    """The largest of this torque; it may be of many orders."""


class MisfireWorst(Result):
    """The largest torque amplitude of the crankshaft where one cylinder alone does not fire."""

    cylinder: int
    speed_rpm: float
    section: str
    torque_amplitude_Nm: float
    order: float
    """The largest of this torque; it may be of many orders."""
    shear_MPa: float
    joined: tuple[JoinedSwing, ...]
    """Sections outside the crankshaft, each at its own worst speed."""
    joined_at_engine_speed: tuple[JoinedSwing, ...]
    """The same at the speed of the engine; none where that is outside of the range."""
    barred_ranges: tuple[tuple[float, float], ...] | None
    """Ranges of speed above the permitted stress with this misfire; null where no stress is given."""


class ShaftVibration(Result):
    """Torsional vibration of a shaft over its range of speeds."""

    schema_version: int = 1
    design: str
    stiffness_source: str
    disks: tuple[ShaftDisk, ...]
    sections: tuple[ShaftSection, ...]
    natural_frequencies_Hz: tuple[float, ...]
    modes: tuple[NaturalMode, ...]
    damping: dict[str, Any]
    """Values of the shaft table that damp, by key."""
    varying_inertia_percent: float
    """Half the range of a throw's inertia over a turn, of its mean."""
    varying_inertia: VaryingInertia
    critical_speeds: tuple[CriticalSpeed, ...]
    critical_speeds_left_out: int
    """Crossings whose order has less than a hundredth of the largest torque amplitude in every section."""
    barred_ranges: tuple[tuple[float, float], ...] | None
    """Ranges of speed above the permitted stress, of the cylinders that fire in `worst` and `speeds`."""
    worst: WorstTorque
    speeds: tuple[AtSpeed, ...]
    run_up: RunUpResult | None
    misfire: tuple[int, ...] | None = UNLESS_NONE
    """Cylinders that do not fire, where there are any."""
    misfires: tuple[MisfireWorst, ...] | None = UNLESS_NONE
    """Worst torque with the misfire of each cylinder alone, with `--misfire worst`."""
    warnings: tuple[str, ...]
    assumed: tuple[Assumption, ...]


def vibration_result(study: VibrationStudy, assumed: tuple[Assumption, ...]) -> ShaftVibration:
    """Return a study as the command prints it."""
    shaft, chain = study.shaft, study.shaft.chain
    return ShaftVibration(
        design=study.scene.name,
        stiffness_source=study.stiffness_source,
        disks=tuple(
            ShaftDisk(name=name, inertia_kg_m2=inertia)
            for name, inertia in zip(shaft.names, chain.inertia_kg_m2, strict=True)
        ),
        sections=tuple(
            ShaftSection(name=name, stiffness_Nm_per_rad=stiffness, in_crankshaft=inside)
            for name, stiffness, inside in zip(
                shaft.sections, chain.stiffness_Nm_per_rad, shaft.in_crankshaft, strict=True
            )
        ),
        natural_frequencies_Hz=tuple(mode.frequency_Hz for mode in study.modes),
        modes=tuple(
            NaturalMode(
                frequency_Hz=mode.frequency_Hz,
                damping_ratio=mode.damping_ratio,
                shape=tuple(mode.shape.real.tolist()),
            )
            for mode in study.modes
        ),
        damping=_damping(study.scene.shaft or ShaftTable()),
        varying_inertia_percent=study.varying_inertia_percent,
        varying_inertia=VaryingInertia(
            estimate_percent=study.varying.share_percent,
            included=study.varying.included,
            torque_change_percent=study.varying_change_percent,
        ),
        critical_speeds=study.critical,
        critical_speeds_left_out=sum(study.left_out),
        barred_ranges=study.barred_rpm,
        worst=_worst(study),
        speeds=tuple(_at_speed(study, index) for index in range(len(study.response.speeds_rpm))),
        run_up=_run_up(study),
        misfire=study.response.harmonics.misfire or None,
        misfires=_misfires(study) or None,
        warnings=study.warnings,
        assumed=assumed,
    )


def _worst(study: VibrationStudy) -> WorstTorque:
    worst, response = study.response.worst, study.response
    by_order = np.abs(response.torque_Nm[worst.speed_index, :, worst.section])
    return WorstTorque(
        speed_rpm=float(response.speeds_rpm[worst.speed_index]),
        section=study.shaft.sections[worst.section],
        torque_amplitude_Nm=response.worst_Nm,
        order=worst.order,
        shear_MPa=study.shaft.shear_MPa(response.worst_Nm),
        mean_torque_Nm=float(response.mean_torque_Nm[worst.section]),
        by_order=tuple(
            OrderTorque(order=float(order), torque_Nm=float(torque))
            for order, torque in zip(response.orders, by_order, strict=True)
        ),
    )


def _at_speed(study: VibrationStudy, index: int) -> AtSpeed:
    response, shaft = study.response, study.shaft
    amplitudes = tuple(float(torque) for torque in response.torque_amplitude_Nm[index])
    return AtSpeed(
        rpm=float(response.speeds_rpm[index]),
        torque_amplitude_Nm=amplitudes,
        twist_deg=tuple(response.twist_amplitude_deg[index].tolist()),
        shear_MPa=tuple(
            shaft.shear_MPa(torque) if inside else None
            for torque, inside in zip(amplitudes, shaft.in_crankshaft, strict=True)
        ),
        free_end_deg=float(response.free_end_deg[index]),
    )


def _misfires(study: VibrationStudy) -> tuple[MisfireWorst, ...]:
    return tuple(
        MisfireWorst(
            cylinder=one.cylinder,
            speed_rpm=one.crankshaft.speed_rpm,
            section=study.shaft.sections[one.crankshaft.section],
            torque_amplitude_Nm=one.crankshaft.torque_amplitude_Nm,
            order=one.crankshaft.order,
            shear_MPa=study.shaft.shear_MPa(one.crankshaft.torque_amplitude_Nm),
            joined=_joined(study, one.joined),
            joined_at_engine_speed=_joined(study, one.joined_own),
            barred_ranges=one.barred_rpm,
        )
        for one in study.misfires
    )


def _joined(study: VibrationStudy, swings: tuple[Swing, ...]) -> tuple[JoinedSwing, ...]:
    return tuple(
        JoinedSwing(
            section=study.shaft.sections[swing.section],
            speed_rpm=swing.speed_rpm,
            torque_amplitude_Nm=swing.torque_amplitude_Nm,
            order=swing.order,
        )
        for swing in swings
    )


def _run_up(study: VibrationStudy) -> RunUpResult | None:
    worst, passage = study.run_up_worst(), study.run_up
    if worst is None or passage is None:
        return None
    speed, section, torque = worst
    return RunUpResult(
        seconds=passage.seconds,
        worst=RunUpWorst(
            speed_rpm=speed,
            section=study.shaft.sections[section],
            torque_amplitude_Nm=torque,
            shear_MPa=study.shaft.shear_MPa(torque),
        ),
        speeds=tuple(
            RunUpSpeed(rpm=float(rpm), torque_amplitude_Nm=tuple(row.tolist()))
            for rpm, row in zip(passage.speeds_rpm, passage.torque_amplitude_Nm, strict=True)
        ),
    )


def _damping(shaft: ShaftTable) -> dict[str, Any]:
    """Return all damping of a shaft table, by key, without what is not given."""
    found: dict[str, Any] = {}
    for name, value in shaft.model_dump(exclude_none=True).items():
        if isinstance(value, dict):
            loses = name == "damper" or name in shaft.elastic_rotors
            inner = {key: v for key, v in value.items() if "damping" in key or key == "kind"}
            inner |= {key: v for key, v in value.items() if key == "loss_factor" and loses}
            found |= {name: inner} if inner else {}
        elif name not in _NOT_DAMPING:
            found[name] = value
    return found
