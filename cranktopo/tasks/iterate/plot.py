"""Plot of the loop: every step in percent of the original web."""

from __future__ import annotations

from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.base.files import write_bytes
from cranktopo.report.png import png
from cranktopo.runs.kind import SHAPE
from cranktopo.tasks.fea.quantities import BENDING, BENDING_PER_MASS, MASS, TORSION, TORSION_PER_MASS
from cranktopo.tasks.iterate.result import LoopResult

_LINES = (
    (MASS, "s-", "0.45"),
    (TORSION, "o-", "#d1632a"),
    (BENDING, "^-", "#1f6fb4"),
    (TORSION_PER_MASS, "o--", "#d1632a"),
    (BENDING_PER_MASS, "^--", "#1f6fb4"),
)


def save_steps_plot(path: Path, loop: LoopResult) -> None:
    """Write the plot as PNG; raises CranktopoError when the file cannot be written."""
    write_bytes(path, png(steps_figure(loop)))


def steps_figure(loop: LoopResult) -> Figure:
    """Draw every step in percent of the original web."""
    figure = Figure(figsize=(7.2, 4.6), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    numbers = [step.number for step in loop.steps]
    names = [step.name or str(step.number) for step in loop.steps]
    done = len(numbers) - (names[-1] == SHAPE)
    for quantity, style, colour in _LINES:
        values = [step.percent_of_original[quantity.key] for step in loop.steps]
        label = f"{quantity.label}: {values[-1]:.1f} %"
        fill = "none" if style.endswith("--") else "full"
        axes.plot(numbers[:done], values[:done], style, color=colour, fillstyle=fill, label=label)
        axes.plot(numbers[done:], values[done:], style[0], color=colour, fillstyle=fill)
    axes.axhline(100.0, color="0.7", linewidth=1, zorder=0)
    if loop.best is not None:
        axes.axvline(loop.best.number, color="0.7", linestyle=":", zorder=0)
    axes.set(xlabel="step", ylabel="percent of the original web")
    axes.set_xticks(numbers, names)
    axes.set_title(f"{loop.design}: {loop.stop_reason}", fontsize=9)
    axes.legend(fontsize=8)
    return figure
