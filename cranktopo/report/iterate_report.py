"""ResultTable and plot of the loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.report.evaluations import estimate_line
from cranktopo.report.png import png
from cranktopo.report.tables import ResultTable
from cranktopo.store.files import write_bytes

_LINES = (
    ("mass", "mass of the throw", "s-", "0.45"),
    ("torsion", "torsional stiffness", "o-", "#d1632a"),
    ("bending", "bending stiffness", "^-", "#1f6fb4"),
    ("torsion_per_mass", "torsional stiffness per mass", "o--", "#d1632a"),
    ("bending_per_mass", "bending stiffness per mass", "^--", "#1f6fb4"),
)


def steps_table(steps: Sequence[dict[str, Any]]) -> ResultTable:
    """One row per step, the original web first; `steps` as iterate.json holds them."""
    columns: tuple[tuple[str, int], ...] = (
        ("step", 0),
        ("throw_kg", 3),
        ("web_kg", 3),
        ("torsion_kNm_per_rad", 2),
        ("bending_kN_per_mm", 2),
        ("torsion_per_mass_kNm_per_rad_kg", 2),
        ("bending_per_mass_kN_per_mm_kg", 2),
        ("mass_percent", 1),
        ("torsion_percent", 1),
        ("bending_percent", 1),
        ("torsion_per_mass_percent", 1),
        ("bending_per_mass_percent", 1),
        ("transition_mm", 1),
        ("overlap_percent", 1),
    )
    return ResultTable(
        columns=tuple(name for name, _ in columns),
        rows=tuple(_row(step) for step in steps),
        digits=tuple(digits for _, digits in columns),
    )


def steps_estimate(steps: Sequence[dict[str, Any]]) -> str:
    """The largest error estimates of the steps' stiffnesses, one line."""
    return estimate_line(
        *([step[f"{kind}_error_percent"] for step in steps] for kind in ("torsion", "bending"))
    )


def best_line(data: Mapping[str, Any]) -> str:
    """Which step is best and what it gains on the original web; `data` as iterate.json holds it."""
    if data["best_step"] is None:
        return "no step beats the original web: no heavier, no softer in bending, stiffer per mass in torsion"
    share = data["steps"][data["best_step"]]["percent_of_original"]
    return (
        f"best: step {data['best_step']}, "
        f"torsional stiffness per mass {share['torsion_per_mass'] - 100:+.1f} %, "
        f"mass {share['mass'] - 100:+.1f} %, bending stiffness {share['bending'] - 100:+.1f} %"
    )


def save_steps_plot(path: Path, data: Mapping[str, Any]) -> None:
    """Draw every step in percent of the original web.

    Args:
        path: PNG, replaced only when complete.
        data: content of iterate.json.

    Raises:
        CranktopoError: the file cannot be written.
    """
    write_bytes(path, png(steps_figure(data)))


def steps_figure(data: Mapping[str, Any]) -> Figure:
    """Every step in percent of the original web; `data` as iterate.json holds it."""
    figure = Figure(figsize=(9, 5.2), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    numbers = [step["number"] for step in data["steps"]]
    for key, label, style, colour in _LINES:
        values = [step["percent_of_original"][key] for step in data["steps"]]
        axes.plot(numbers, values, style, color=colour, label=f"{label}: {values[-1]:.1f} %")
    axes.axhline(100.0, color="0.7", linewidth=1, zorder=0)
    if data["best_step"] is not None:
        axes.axvline(data["best_step"], color="0.7", linestyle=":", zorder=0)
    axes.set(xlabel="step (0: original web)", ylabel="percent of the original web", xticks=numbers)
    axes.set_title(f"{data['design']}: {data['stop_reason']}", fontsize=9)
    axes.legend(fontsize=8)
    return figure


def _row(step: dict[str, Any]) -> tuple[str | float | None, ...]:
    share = step["percent_of_original"]
    return (
        "original" if step["number"] == 0 else str(step["number"]),
        step["throw_kg"],
        step["web_kg"],
        step["torsion_Nm_per_rad"] / 1000,
        step["bending_N_per_mm"] / 1000,
        step["torsion_per_mass_Nm_per_rad_kg"] / 1000,
        step["bending_per_mass_N_per_mm_kg"] / 1000,
        *(share[key] for key, *_ in _LINES),
        step["transition_mm"],
        step["overlap_percent"],
    )
