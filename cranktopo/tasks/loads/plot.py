"""Plot of the loads over the cycle: gas and inertia, crankpin, torque of throw and engine, piston."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.base.files import replacing
from cranktopo.base.formats import PLOTS
from cranktopo.base.units import stem_and_unit
from cranktopo.engine.analysis import Cycle, LoadAnalysis
from cranktopo.engine.performance import piston_motion
from cranktopo.report.plot import name_above, save_figure
from cranktopo.runs.destination import check_file

_AXES_INCHES = 7.8
_MOST_WEBS = 2
"""Webs whose forces can be told apart in one panel."""


def plot_loads(analysis: LoadAnalysis, title: str, path: Path) -> None:
    """Write the plot; the file's ending (png, svg, pdf) gives its format.

    Args:
        path: file to write, replaced only when the plot is complete.

    Raises:
        CranktopoError: no cycle to plot, an ending that is no plot format, or it cannot be written.
    """
    from matplotlib.figure import Figure

    _cycle(analysis)
    check_file(path, "--plot", PLOTS)
    panels = (*PANELS, _draw_piston)
    figure = Figure(figsize=(_AXES_INCHES + 1.2, 13), layout="constrained")
    for axes, panel in zip(figure.subplots(len(panels), 1, sharex=True), panels, strict=True):
        panel(axes, analysis)
        name_above(axes, _AXES_INCHES)
        axes.label_outer()
    figure.suptitle(title)
    with replacing(path) as temporary:
        save_figure(figure, temporary, dpi=120)


def _draw_piston_forces(axes: Any, analysis: LoadAnalysis) -> None:
    """Gas, inertia and their sum on the piston pin."""
    forces = _cycle(analysis).forces
    angle = forces.angle_deg
    axes.plot(angle, forces.gas_force_N / 1000, label="gas")
    axes.plot(angle, forces.inertia_force_N / 1000, label="inertia of the piston")
    axes.plot(angle, forces.small_end_force_N / 1000, "k", lw=1, label="total on the piston pin")
    _frame(axes, analysis, "force (kN)")


def _draw_crankpin_forces(axes: Any, analysis: LoadAnalysis) -> None:
    """Radial and tangential force on the crankpin, of more than two webs that differ the larger one's."""
    cycle = _cycle(analysis)
    drawn = cycle.unlike if len(cycle.unlike) <= _MOST_WEBS else ((cycle.place, cycle.forces),)
    for (place, forces), style in zip(drawn, ("-", "--"), strict=False):
        of_web = f", {place}" if place else ""
        axes.plot(forces.angle_deg, forces.radial_force_N / 1000, f"C0{style}", label=f"radial{of_web}")
        axes.plot(
            forces.angle_deg, forces.tangential_force_N / 1000, f"C1{style}", label=f"tangential{of_web}"
        )
    _frame(axes, analysis, "force on the crankpin (kN)")


def _draw_torque(axes: Any, analysis: LoadAnalysis) -> None:
    """Torque of one throw, and of the engine or in a section of a vibrating shaft."""
    cycle = _cycle(analysis)
    angle = cycle.forces.angle_deg
    axes.plot(angle, cycle.forces.torque_Nm, label="one throw")
    axes.plot(angle, cycle.torque.engine_Nm, label=torque_words(analysis))
    axes.axhline(cycle.engine_torque()[0], color="0.5", lw=0.8, ls="--", label="engine, mean")
    _frame(axes, analysis, "torque (N m)")


def torque_words(analysis: LoadAnalysis) -> str:
    """Return what the torque of the shaft is: the engine's, or that in one section of a vibrating shaft."""
    count, torque = analysis.engine.cylinders, _cycle(analysis).torque
    if torque.vibrates:
        section, speed = len(torque.passed_on_Nm), analysis.engine.speed_rpm
        return f"behind throw {section} of the vibrating shaft, {speed:.0f} rpm"
    return f"engine, {count} cylinder{'s' * (count > 1)}"


def _draw_piston(axes: Any, analysis: LoadAnalysis) -> None:
    """Path, speed and acceleration of the piston, each over its largest value."""
    angle = _cycle(analysis).forces.angle_deg
    units = {"displacement_mm": "path", "speed_m_per_s": "speed", "acceleration_m_per_s2": "acceleration"}
    for name, curve in vars(piston_motion(analysis.engine, analysis.radius_mm, angle)).items():
        largest = float(np.abs(curve).max())
        unit = stem_and_unit(name)[1]
        axes.plot(angle, curve / largest, label=f"{units[name]}, 1 = {largest:.4g} {unit}")
    _frame(axes, analysis, "piston, over the largest")


PANELS: tuple[Callable[[Any, LoadAnalysis], None], ...] = (
    _draw_piston_forces,
    _draw_crankpin_forces,
    _draw_torque,
)


def _cycle(analysis: LoadAnalysis) -> Cycle:
    if analysis.cycle is None:
        raise invalid("engine.gas", None, "must be given for a plot over the cycle")
    return analysis.cycle


def _frame(axes: Any, analysis: LoadAnalysis, label: str) -> None:
    axes.set_ylabel(label)
    axes.set_xlabel("crank angle from firing top dead centre (deg)")
    axes.grid(alpha=0.3)
    axes.set_xlim(0, analysis.engine.cycle_deg)
