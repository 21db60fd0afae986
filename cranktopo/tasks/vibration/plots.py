"""Campbell diagram, torque over speed by order, and mode shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import frequency_text
from cranktopo.engine.vibration.steady import CriticalSpeed
from cranktopo.engine.vibration.study import VibrationStudy
from cranktopo.report.plot import GREY, Picture, picture, plain
from cranktopo.tasks.vibration.text import WEAK

_MOST = 5
"""Orders that a plot shows by themselves."""
_MODES = 3
_OFFSET: dict[str, Any] = {"textcoords": "offset points"}


def vibration_pictures(study: VibrationStudy) -> tuple[Picture, ...]:
    """Return the plots of a study, with their text."""
    worst, response = study.response.worst, study.response
    section = study.shaft.sections[worst.section]
    frequencies = ", ".join(f"{mode.frequency_Hz:.0f}" for mode in study.modes)
    low, high = response.speeds_rpm[[0, -1]]
    return (
        picture(
            "campbell",
            f"Campbell diagram: orders against natural frequencies {frequencies} Hz, {low:.0f} to "
            f"{high:.0f} rpm",
            _draw_campbell,
            study,
        ),
        picture(
            "torque-over-speed",
            f"Torque amplitude of section {section} over speed, all orders and the largest ones; largest at "
            f"{response.speeds_rpm[worst.speed_index]:.0f} rpm, order {worst.order:g}",
            _draw_torque,
            study,
        ),
        picture(
            "mode-shapes", f"Shapes of the first natural vibrations: {frequencies} Hz", _draw_modes, study
        ),
    )


def _draw_campbell(axes: Any, study: VibrationStudy) -> None:
    """Draw orders against natural frequencies: at least the first of these, however far above all orders."""
    speeds, orders = study.response.speeds_rpm[[0, -1]], study.response.orders
    highest = orders[-1] * speeds[-1] / 60
    top = 1.15 * max(min(study.modes[-1].frequency_Hz, highest), study.modes[0].frequency_Hz)
    majors = study.response.harmonics.in_phase()[1:]
    for order, major in zip(orders, majors, strict=False):
        if order % 1 == 0 and order * speeds[0] / 60 <= top:
            _draw_order(axes, order, speeds, top, major)
    for number, mode in enumerate(study.modes, start=1):
        if mode.frequency_Hz <= top:
            axes.axhline(mode.frequency_Hz, color="C3", lw=1.2)
            name = f"mode {number}, {frequency_text(mode.frequency_Hz)}"
            axes.annotate(name, (speeds[0], mode.frequency_Hz), (2, 3), fontsize=7, color="C3", **_OFFSET)
    for found in study.critical:
        if found.share >= WEAK:
            _draw_critical(axes, found, speeds)
    axes.set(xlim=speeds, ylim=(0, top), xlabel="speed (rpm)", ylabel="frequency (Hz)")
    plain(axes)


def _draw_order(axes: Any, order: float, speeds: Array, top: float, major: bool) -> None:
    axes.plot(speeds, order * speeds / 60, color="C0" if major else "0.8", lw=1.0 if major else 0.6)
    at = min(speeds[-1], 60 * top / order)
    style: dict[str, Any] = {"va": "center", "fontsize": 6, "color": GREY, "annotation_clip": False}
    axes.annotate(f"{order:g}", (at, order * at / 60), (2, 0), **_OFFSET, **style)


def _draw_critical(axes: Any, found: CriticalSpeed, speeds: Array) -> None:
    """Mark a critical speed with its order, whose line is drawn where it is a half one."""
    frequency = found.order * found.speed_rpm / 60
    if found.order % 1:
        axes.plot(speeds, found.order * speeds / 60, color="C1", lw=0.8, ls="--", zorder=1)
    axes.plot([found.speed_rpm], [frequency], "o", color="C3", ms=4)
    style: dict[str, Any] = {"fontsize": 7, "ha": "right", "va": "top", "zorder": 4}
    style["bbox"] = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
    axes.annotate(f"{found.order:g}", (found.speed_rpm, frequency), (-3, -4), **_OFFSET, **style)


def _draw_torque(axes: Any, study: VibrationStudy) -> None:
    response, section = study.response, study.response.worst.section
    axes.plot(response.speeds_rpm, response.torque_amplitude_Nm[:, section], "k", lw=1.4, label="all orders")
    if study.run_up is not None:
        passage = study.run_up.torque_amplitude_Nm[:, section]
        label = f"run-up in {study.run_up.seconds:g} s"
        axes.plot(study.run_up.speeds_rpm, passage, color=GREY, ls="--", lw=1.0, label=label)
    single = np.abs(response.torque_Nm[:, :, section])
    for index in sorted(np.argsort(-single.max(axis=0), kind="stable")[:_MOST]):
        axes.plot(response.speeds_rpm, single[:, index], lw=0.9, label=f"order {response.orders[index]:g}")
    for low, high in study.barred_rpm or ():
        axes.axvspan(low, high, color="C3", alpha=0.15, lw=0)
    axes.set(xlabel="speed (rpm)", ylabel="torque amplitude (N m)", ylim=(0, None))
    axes.set_xlim(response.speeds_rpm[[0, -1]])
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)


def _draw_modes(axes: Any, study: VibrationStudy) -> None:
    places = range(len(study.shaft.names))
    for mode in study.modes[:_MODES]:
        axes.plot(places, mode.shape.real, "o-", ms=3, lw=1, label=frequency_text(mode.frequency_Hz))
    axes.axhline(0.0, color="0.5", lw=0.8)
    axes.set_xticks(places, study.shaft.names, fontsize=7, rotation=35, ha="right", rotation_mode="anchor")
    axes.set_ylabel("twist over the largest")
    plain(axes)
