"""Campbell diagrams of a whole crankshaft, in its own frame and as bearings have it, and its mode shapes."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.units import frequency_text
from cranktopo.report.plot import Picture, name_orders, picture, plain
from cranktopo.tasks.modes.result import ShaftMode, ShaftModes

_SHOWN = 6
"""Shapes that the page shows."""
_DRAWN = 5
"""Modes that a Campbell diagram shows at least."""
_COLOURS = {"torsion": "C3", "axial": "C2", "bending": "C0", "deformation": "C1"}
_LINES = (("in_plane", "in plane", "-"), ("across", "across", "--"), ("axial", "axial", ":"))


def modes_pictures(modal: ShaftModes) -> tuple[Picture, ...]:
    """Return the Campbell diagrams and the first shapes, with their text."""
    frequencies = ", ".join(f"{mode.frequency_Hz:.0f}" for mode in modal.modes)
    low, high = modal.speeds_rpm[0], modal.speeds_rpm[-1]
    over = f"modes {frequencies} Hz at rest, {low:.0f} to {high:.0f} rpm"
    campbell = picture(
        "campbell-turning", f"Campbell diagram in the frame that turns: {over}", _draw_turning, modal
    )
    bearings = picture(
        "campbell-bearings", f"Campbell diagram as bearings have it: {over}", _draw_bearings, modal
    )
    return campbell, bearings, *(_shape(mode) for mode in modal.modes[:_SHOWN])


def _shape(mode: ShaftMode) -> Picture:
    name = f"Mode {mode.mode}, {frequency_text(mode.frequency_Hz)}: {mode.kind}"
    return picture(f"mode-{mode.mode}", f"{name}; motion along the shaft", _draw_shape, mode)


def _draw_turning(axes: Any, modal: ShaftModes) -> None:
    speeds, orders = np.array(modal.speeds_rpm), _drawn_orders(modal)
    for order in orders:
        axes.plot(speeds, order * speeds / 60, color="0.8", lw=0.6)
    for mode in modal.modes:
        axes.plot(speeds, mode.frequencies_Hz, color=_colour(mode), lw=1.2)
        for at in mode.critical_speeds:
            axes.plot([at.speed_rpm], [at.order * at.speed_rpm / 60], "o", color=_colour(mode), ms=3)
    _frame(axes, modal)
    name_orders(axes, orders, speeds, _top(modal))


def _drawn_orders(modal: ShaftModes) -> list[int]:
    """Return the whole orders whose lines a diagram shows, the highest first."""
    top, first = _top(modal), modal.speeds_rpm[0]
    return [order for order in range(int(modal.highest_order), 0, -1) if order * first / 60 < top]


def _draw_bearings(axes: Any, modal: ShaftModes) -> None:
    """Draw what is seen at rest: a bending mode forward and backward, the weaker of them fainter."""
    speeds = np.array(modal.speeds_rpm)
    for mode in modal.modes:
        frequency, whirl = np.array(mode.frequencies_Hz), np.array(mode.whirl)
        if not mode.kind.startswith("bending"):
            axes.plot(speeds, frequency, color=_colour(mode), lw=1.2)
            continue
        for sign, style in ((1, "-"), (-1, "--")):
            share = (1 + sign * whirl.mean()) / 2
            seen = np.abs(frequency + sign * speeds / 60)
            axes.plot(speeds, seen, style, color=_colour(mode), lw=1.2, alpha=float(0.15 + 0.85 * share))
    _frame(axes, modal)


def _frame(axes: Any, modal: ShaftModes) -> None:
    first, last = modal.speeds_rpm[0], modal.speeds_rpm[-1]
    for name in dict.fromkeys(mode.kind.split()[0] for mode in modal.modes):
        axes.plot([], [], color=_COLOURS[name], label=name)
    axes.set(xlim=(first, last), ylim=(0, _top(modal)), xlabel="speed (rpm)", ylabel="frequency (Hz)")
    plain(axes)


def _draw_shape(axes: Any, mode: ShaftMode) -> None:
    places = [station.z_mm for station in mode.shape]
    for key, name, style in _LINES:
        axes.plot(places, [getattr(s, key) for s in mode.shape], style, color="C0", lw=1, label=name)
    axes.plot(places, [s.twist for s in mode.shape], color="C3", lw=1, label="twist times throw radius")
    axes.axhline(0.0, color="0.5", lw=0.8)
    axes.set_title(f"mode {mode.mode}, {frequency_text(mode.frequency_Hz)}: {mode.kind}", fontsize=8)
    axes.set(xlabel="along the shaft (mm)", ylim=(-1.1, 1.1))
    plain(axes)


def _top(modal: ShaftModes) -> float:
    """The highest frequency that is drawn: all orders, and some modes however far above."""
    orders = modal.highest_order * modal.speeds_rpm[-1] / 60
    return 1.15 * max(orders, *(max(mode.frequencies_Hz) for mode in modal.modes[:_DRAWN]))


def _colour(mode: ShaftMode) -> str:
    return _COLOURS[mode.kind.split()[0]]
