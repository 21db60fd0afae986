"""Plot of the loads over the cycle: gas and inertia; tangential and radial; torque of throw and engine."""

from __future__ import annotations

from pathlib import Path

from cranktopo.errors import invalid
from cranktopo.loads.analysis import LoadAnalysis


def plot_loads(analysis: LoadAnalysis, title: str, path: Path) -> None:
    """Write the plot; the file's ending (png, svg, pdf) gives its format.

    Args:
        analysis: an analysis with a cycle.
        title: heading, usually the design and the speed.
        path: file to write.

    Raises:
        CranktopoError: no cycle to plot, or an ending that is no plot format.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    cycle = analysis.cycle
    if cycle is None:
        raise invalid("engine.gas", None, "must be given for a plot over the cycle")
    formats = FigureCanvasAgg.get_supported_filetypes()
    if path.suffix.lstrip(".") not in formats:
        raise invalid("--plot", str(path), "must end in .png, .svg or .pdf")
    forces, angle = cycle.forces, cycle.forces.angle_deg
    figure = Figure(figsize=(9, 10), layout="constrained")
    top, middle, bottom = figure.subplots(3, 1, sharex=True)
    top.plot(angle, forces.gas_force_N / 1000, label="gas")
    top.plot(angle, forces.inertia_force_N / 1000, label="inertia of the piston")
    top.plot(angle, forces.small_end_force_N / 1000, "k", lw=1, label="total on the piston pin")
    top.set_ylabel("force [kN]")
    middle.plot(angle, forces.radial_force_N / 1000, label="radial")
    middle.plot(angle, forces.tangential_force_N / 1000, label="tangential")
    middle.set_ylabel("force on the crankpin [kN]")
    bottom.plot(angle, forces.torque_Nm, label="one throw")
    bottom.plot(angle, cycle.torque.engine_Nm, label=f"engine, {analysis.engine.cylinders} cylinders")
    bottom.axhline(cycle.engine_torque()[0], color="0.5", lw=0.8, ls="--", label="engine, mean")
    bottom.set_ylabel("torque [N m]")
    bottom.set_xlabel("crank angle from firing top dead centre [deg]")
    for axes in (top, middle, bottom):
        axes.grid(alpha=0.3)
        axes.legend()
        axes.set_xlim(0, analysis.engine.cycle_deg)
    figure.suptitle(title)
    figure.savefig(path, dpi=120)
