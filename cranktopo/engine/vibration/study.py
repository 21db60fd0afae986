"""Torsional vibration of a scene's shaft: modes, critical speeds, response, what to look out for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.checks.shaft import shaft_warnings
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.run_up import RunUp, run_up
from cranktopo.engine.vibration.shaft_chain import ShaftChain, varying_inertia_percent
from cranktopo.engine.vibration.steady import CriticalSpeed, Vibration
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.engine.vibration.varying_inertia import VaryingPart
from cranktopo.engine.vibration.vibrating_shaft import vibrating_shaft
from cranktopo.numerics.disk_chain import DampedMode


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
    modes: tuple[DampedMode, ...]
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

    def run_up_worst(self) -> tuple[float, int, float] | None:
        """Speed (rpm), section and torque amplitude (N m) of the crankshaft's largest swing in the run-up."""
        if self.run_up is None:
            return None
        swing = np.where(np.array(self.shaft.in_crankshaft), self.run_up.torque_amplitude_Nm, -1.0)
        cycle, section = (int(i) for i in np.unravel_index(int(swing.argmax()), swing.shape))
        return float(self.run_up.speeds_rpm[cycle]), section, float(swing[cycle, section])


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
