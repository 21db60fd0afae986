"""Campbell diagram, torque over speed by order, and mode shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.units import frequency_text
from cranktopo.design.misfire import silent_words
from cranktopo.engine.vibration.steady import CriticalSpeed
from cranktopo.engine.vibration.study import VibrationStudy, worst_swing
from cranktopo.engine.vibration.telling import WEAK
from cranktopo.report.plot import GREY, Picture, name_orders, name_points, picture, plain

_MOST = 5
"""Orders that a plot shows by themselves."""
_MODES = 3
_OFFSET: dict[str, Any] = {"textcoords": "offset points"}
_LINE_POINTS = 8.5
"""Of a line of the names of modes."""


def vibration_pictures(study: VibrationStudy) -> tuple[Picture, ...]:
    """Return the plots of a study, with their text."""
    worst, response = study.response.worst, study.response
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
            f"Largest torque amplitude of all sections of the crankshaft over speed, {_fire(study)}, all "
            f"orders and the largest ones; largest at {response.speeds_rpm[worst.speed_index]:.0f} rpm, in "
            f"section {study.shaft.sections[worst.section]}, {worst_swing(response).orders_words}",
            _draw_torque,
            study,
        ),
        picture(
            "mode-shapes", f"Shapes of the first natural vibrations: {frequencies} Hz", _draw_modes, study
        ),
    )


def _draw_campbell(axes: Any, study: VibrationStudy) -> None:
    """Draw orders against natural frequencies, as far as an order meets one: at least the first of these."""
    speeds, orders = study.response.speeds_rpm[[0, -1]], study.response.orders
    met = max((_frequency_Hz(found) for found in study.critical), default=0.0)
    top = 1.15 * max(met, study.modes[0].frequency_Hz)
    majors = study.response.harmonics.in_phase()[1:]
    drawn = [order for order in orders if order % 1 == 0 and order * speeds[0] / 60 <= top]
    for order, major in zip(orders, majors, strict=False):
        if order in drawn:
            style = {"color": "C0", "lw": 1.0} if major else {"color": "0.8", "lw": 0.6}
            axes.plot(speeds, order * speeds / 60, **style)
    for mode in study.modes:
        if mode.frequency_Hz <= top:
            axes.axhline(mode.frequency_Hz, color="C3", lw=1.2)
    critical = sorted((c for c in study.critical if c.share >= WEAK), key=lambda c: -c.share)
    for order in sorted({found.order for found in critical if found.order % 1}):
        axes.plot(speeds, order * speeds / 60, color="C1", lw=0.6, ls="--", zorder=1)
    places = [(found.speed_rpm, _frequency_Hz(found)) for found in critical]
    axes.plot(*zip(*places, strict=True) if places else ([], []), "o", color="C3", ms=3)
    axes.set(xlim=speeds, ylim=(0, top), xlabel="speed (rpm)", ylabel="frequency (Hz)")
    plain(axes)
    _name_modes(axes, study, top)
    name_orders(axes, drawn, speeds, top)
    for name in name_points(axes, [f"{one.order:g}" for one in critical], places, (), leave_out=True):
        name.set(zorder=4, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.2})


def _frequency_Hz(critical: CriticalSpeed) -> float:
    return critical.order * critical.speed_rpm / 60


def _name_modes(axes: Any, study: VibrationStudy, top: float) -> None:
    """Name the natural frequencies at the right of the numbers of the orders, apart from each other."""
    axes.figure.draw_without_rendering()
    points_per_Hz = axes.get_window_extent().height / axes.figure.dpi * 72 / top
    lowest = 0.0
    for number, mode in enumerate(study.modes, start=1):
        if mode.frequency_Hz > top:
            continue
        at = mode.frequency_Hz * points_per_Hz
        lowest = max(at, lowest)
        name = f"mode {number}, {frequency_text(mode.frequency_Hz)}"
        style = {"xycoords": axes.get_yaxis_transform(), "va": "center", "fontsize": 7, "color": "C3"}
        axes.annotate(
            name, (1.0, mode.frequency_Hz), (14, lowest - at), annotation_clip=False, **style, **_OFFSET
        )
        lowest += _LINE_POINTS


def _draw_torque(axes: Any, study: VibrationStudy) -> None:
    """Draw the largest amplitudes of the crankshaft's sections, over all of these at each speed."""
    response, inside = study.response, np.array(study.shaft.in_crankshaft)
    axes.plot(response.speeds_rpm, response.crankshaft_amplitude_Nm, "k", lw=1.4, label="all orders")
    if study.run_up is not None:
        passage = study.run_up.torque_amplitude_Nm[:, inside].max(axis=1)
        label = f"run-up in {study.run_up.seconds:g} s"
        axes.plot(study.run_up.speeds_rpm, passage, color=GREY, ls="--", lw=1.0, label=label)
    single = np.abs(response.torque_Nm[:, :, inside]).max(axis=2)
    for index in sorted(np.argsort(-single.max(axis=0), kind="stable")[:_MOST]):
        axes.plot(response.speeds_rpm, single[:, index], lw=0.9, label=f"order {response.orders[index]:g}")
    if study.misfires:
        worst = [(one.crankshaft.speed_rpm, one.crankshaft.torque_amplitude_Nm) for one in study.misfires]
        crosses = {"color": "k", "ms": 5, "clip_on": False, "label": "single misfires, largest"}
        axes.plot(*zip(*worst, strict=True), "x", **crosses)
    _draw_limit(axes, study)
    axes.set(xlabel="speed (rpm)", ylabel="torque amplitude (N m)", ylim=(0, None))
    axes.set_title(f"Largest of all sections of the crankshaft, {_fire(study)}", fontsize=8)
    axes.set_xlim(response.speeds_rpm[[0, -1]])
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)


def _fire(study: VibrationStudy) -> str:
    silent = study.response.harmonics.misfire
    words = silent_words(silent) if silent else "all cylinders fire"
    return words[:1].lower() + words[1:]


def _draw_limit(axes: Any, study: VibrationStudy) -> None:
    """Draw the permitted stress as torque of the weakest section, and the ranges that are barred by it."""
    permitted = study.scene.shaft.permitted_shear_MPa if study.scene.shaft else None
    if permitted is None:
        return
    limit = permitted / study.shaft.shear_MPa(1.0)
    axes.axhline(limit, color="C3", lw=1.0, ls=":", label=f"permitted, {permitted:g} MPa")
    for low, high in study.barred_rpm or ():
        axes.axvspan(low, high, color="C3", alpha=0.15, lw=0)


def _draw_modes(axes: Any, study: VibrationStudy) -> None:
    places = range(len(study.shaft.names))
    for mode in study.modes[:_MODES]:
        axes.plot(places, mode.shape.real, "o-", ms=3, lw=1, label=frequency_text(mode.frequency_Hz))
    axes.axhline(0.0, color="0.5", lw=0.8)
    axes.set_xticks(places, study.shaft.names, fontsize=7, rotation=35, ha="right", rotation_mode="anchor")
    axes.set_ylabel("twist over the largest")
    plain(axes)
