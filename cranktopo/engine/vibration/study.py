"""Torsional vibration of a scene's shaft: modes, critical speeds, response, what to look out for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable, shaft_warnings
from cranktopo.engine.vibration.run_up import RunUp, run_up
from cranktopo.engine.vibration.shaft_chain import ShaftChain, varying_inertia_percent
from cranktopo.engine.vibration.steady import CriticalSpeed, Vibration
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.engine.vibration.varying_inertia import VaryingPart
from cranktopo.engine.vibration.vibrating_shaft import vibrating_shaft
from cranktopo.numerics.disk_chain import Mode

SCHEMA_VERSION = 1
_NOT_DAMPING = {"speed_min_rpm", "speed_max_rpm", "permitted_shear_MPa", "throw_stiffness_Nm_per_rad"}


@dataclass(frozen=True)
class VibrationStudy:
    """Torsional vibration of a shaft over its range of speeds.

    Attributes:
        stiffness_source: where the torsional stiffness of the throws comes from.
        critical: crossings of orders and natural frequencies in the range.
        varying_inertia_percent: second harmonic of a throw's inertia over its mean.
        varying: whether the response has the varying part of the inertia.
        mean_response: the response with the mean inertia alone.
        barred_rpm: ranges above the permitted stress; None where no stress is given.
        warnings: what the shaft leaves out, one line each.
        run_up: passage through the range in a given time, if one was asked for; with the mean inertia.
    """

    scene: Scene
    stiffness_source: str
    modes: tuple[Mode, ...]
    critical: tuple[CriticalSpeed, ...]
    response: Vibration
    varying_inertia_percent: float
    varying: VaryingPart
    mean_response: Vibration
    barred_rpm: tuple[tuple[float, float], ...] | None
    warnings: tuple[str, ...]
    run_up: RunUp | None = None

    @property
    def shaft(self) -> ShaftChain:
        """The chain of disks."""
        return self.response.shaft

    @property
    def varying_change_percent(self) -> float | None:
        """What the varying part changes in the largest torque amplitude; None where it is left out."""
        return (
            100 * (self.response.worst_Nm / self.mean_response.worst_Nm - 1)
            if self.varying.included
            else None
        )

    def as_json(self) -> dict[str, Any]:
        """The object that `vibration --json` prints, but for what the design leaves out."""
        chain = self.shaft.chain
        return {
            "schema_version": SCHEMA_VERSION,
            "design": self.scene.name,
            "stiffness_source": self.stiffness_source,
            "disks": [
                {"name": name, "inertia_kg_m2": inertia}
                for name, inertia in zip(self.shaft.names, chain.inertia_kg_m2, strict=True)
            ],
            "sections": [
                {"name": name, "stiffness_Nm_per_rad": stiffness, "in_crankshaft": inside}
                for name, stiffness, inside in zip(
                    self.shaft.sections, chain.stiffness_Nm_per_rad, self.shaft.in_crankshaft, strict=True
                )
            ],
            "natural_frequencies_Hz": [mode.frequency_Hz for mode in self.modes],
            "modes": [
                {
                    "frequency_Hz": mode.frequency_Hz,
                    "damping_ratio": chain.damping_ratio(mode),
                    "shape": mode.shape.tolist(),
                }
                for mode in self.modes
            ],
            "damping": _damping(self.scene.shaft or ShaftTable()),
            "varying_inertia_percent": self.varying_inertia_percent,
            "varying_inertia": {
                "estimate_percent": self.varying.share_percent,
                "included": self.varying.included,
                "torque_change_percent": self.varying_change_percent,
            },
            "critical_speeds": [
                {
                    "speed_rpm": found.speed_rpm,
                    "order": found.order,
                    "mode": found.mode,
                    "share": found.share,
                    "major": found.major,
                }
                for found in self.critical
            ],
            "barred_ranges": None if self.barred_rpm is None else [list(pair) for pair in self.barred_rpm],
            "worst": self._worst(),
            "speeds": [self._speed(index) for index in range(len(self.response.speeds_rpm))],
            "run_up": self._run_up(),
            "warnings": list(self.warnings),
        }

    def _worst(self) -> dict[str, Any]:
        worst, response = self.response.worst, self.response
        amplitude = response.worst_Nm
        by_order = np.abs(response.torque_Nm[worst.speed_index, :, worst.section])
        return {
            "speed_rpm": float(response.speeds_rpm[worst.speed_index]),
            "section": self.shaft.sections[worst.section],
            "torque_amplitude_Nm": amplitude,
            "order": worst.order,
            "shear_MPa": self.shaft.shear_MPa(amplitude),
            "mean_torque_Nm": float(response.mean_torque_Nm[worst.section]),
            "by_order": [
                {"order": float(order), "torque_Nm": float(torque)}
                for order, torque in zip(response.orders, by_order, strict=True)
            ],
        }

    def run_up_worst(self) -> tuple[float, int, float] | None:
        """Speed (rpm), section and torque amplitude (N m) of the crankshaft's largest swing in the run-up."""
        if self.run_up is None:
            return None
        swing = np.where(np.array(self.shaft.in_crankshaft), self.run_up.torque_amplitude_Nm, -1.0)
        cycle, section = (int(i) for i in np.unravel_index(int(swing.argmax()), swing.shape))
        return float(self.run_up.speeds_rpm[cycle]), section, float(swing[cycle, section])

    def _run_up(self) -> dict[str, Any] | None:
        worst = self.run_up_worst()
        if worst is None or self.run_up is None:
            return None
        speed, section, torque = worst
        return {
            "seconds": self.run_up.seconds,
            "worst": {
                "speed_rpm": speed,
                "section": self.shaft.sections[section],
                "torque_amplitude_Nm": torque,
                "shear_MPa": self.shaft.shear_MPa(torque),
            },
            "speeds": [
                {"rpm": float(rpm), "torque_amplitude_Nm": row.tolist()}
                for rpm, row in zip(self.run_up.speeds_rpm, self.run_up.torque_amplitude_Nm, strict=True)
            ],
        }

    def _speed(self, index: int) -> dict[str, Any]:
        response = self.response
        amplitudes = [float(torque) for torque in response.torque_amplitude_Nm[index]]
        return {
            "rpm": float(response.speeds_rpm[index]),
            "torque_amplitude_Nm": amplitudes,
            "twist_deg": response.twist_amplitude_deg[index].tolist(),
            "shear_MPa": [
                self.shaft.shear_MPa(torque) if inside else None
                for torque, inside in zip(amplitudes, self.shaft.in_crankshaft, strict=True)
            ],
            "free_end_deg": float(response.free_end_deg[index]),
        }


def study_vibration(
    scene: Scene,
    shaft: ShaftChain,
    throw_inertia_kg_mm2: float,
    stiffness_source: str,
    run_up_s: float | None = None,
) -> VibrationStudy:
    """Modes, critical speeds and steady vibration of a shaft over the scene's range of speeds.

    Args:
        run_up_s: time in which the speed rises through the range, for a passage through its resonances.

    Raises:
        CranktopoError: the scene tells no torque over the cycle, the shaft is a single disk, or a run-up that
            is too short or too long.
    """
    harmonics = torque_harmonics(scene)
    if harmonics is None:
        raise CranktopoError(
            "engine.gas: is missing, so nothing is known of the torque over the cycle.",
            hint="Add [engine.gas] with a peak pressure or an indicator diagram.",
        )
    if len(shaft.names) == 1:
        raise CranktopoError(
            "shaft: one throw with nothing joined to it cannot twist.",
            hint="Add [shaft.flywheel] or [shaft.propeller].",
        )
    model = vibrating_shaft(scene, shaft, harmonics)
    response = model.over_the_range()
    permitted = scene.shaft.permitted_shear_MPa if scene.shaft else None
    return VibrationStudy(
        scene,
        stiffness_source,
        model.modes,
        model.critical,
        response,
        varying_inertia_percent(scene, throw_inertia_kg_mm2),
        model.varying,
        model.with_mean_inertia() if model.varying.included else response,
        None if permitted is None else response.barred_rpm(permitted),
        shaft_warnings(scene),
        None if run_up_s is None else run_up(shaft, harmonics, model.range_rpm, run_up_s),
    )


def _damping(shaft: ShaftTable) -> dict[str, Any]:
    """All damping of a shaft table, by key, without what is not given."""
    found: dict[str, Any] = {}
    for name, value in shaft.model_dump(exclude_none=True).items():
        if isinstance(value, dict):
            inner = {key: v for key, v in value.items() if "damping" in key or "loss" in key or key == "kind"}
            found |= {name: inner} if inner else {}
        elif name not in _NOT_DAMPING:
            found[name] = value
    return found
