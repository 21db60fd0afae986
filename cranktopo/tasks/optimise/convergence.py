"""Curves of an optimisation over its iterations, drawn in axes of any figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from cranktopo.report.axes_style import GREY, plain

History = Sequence[Mapping[str, Any]]
_CASE_KEY = "_compliance_N_mm"
_COLOURS = ("#1f6fb4", "#d1632a", "#2c8c4f", "#8a4fa3")


def draw_compliances(axes: Any, history: History) -> None:
    """Compliance of every load case and the objective, each over its first value."""
    _draw_compliances(axes, history)
    _frame(axes, history)
    if not history:
        axes.text(0.5, 0.5, "no history", transform=axes.transAxes, ha="center", color=GREY)


def draw_volume(axes: Any, history: History) -> None:
    """Volume fraction."""
    _draw_share(axes, history, "volume_fraction", "volume fraction (-)")
    _frame(axes, history)


def draw_greyness(axes: Any, history: History) -> None:
    """Greyness."""
    _draw_share(axes, history, "greyness", "greyness (-)")
    axes.set_ylim(0.0, max(axes.get_ylim()[1], 0.05))
    _frame(axes, history)


PANELS: tuple[Callable[[Any, History], None], ...] = (draw_compliances, draw_volume, draw_greyness)


def _frame(axes: Any, history: History) -> None:
    axes.set_xlabel("iteration", fontsize=9)
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)
    _mark_projection(axes, history)


def _draw_compliances(axes: Any, history: History) -> None:
    keys = [key for key in dict.fromkeys(k for row in history for k in row) if key.endswith(_CASE_KEY)]
    lowest, highest = 1.0, 1.0
    lines = [(key, key.removesuffix(_CASE_KEY), "-") for key in keys] + [("objective", "objective", "--")]
    for number, (key, name, style) in enumerate(lines):
        steps, values = _series(history, key)
        if not values or values[0] == 0:
            continue
        relative = [value / values[0] for value in values]
        lowest, highest = min(lowest, *relative), max(highest, *relative)
        unit = "" if key == "objective" else f", {values[-1]:.4g} N mm"
        colour = "black" if key == "objective" else _COLOURS[number % len(_COLOURS)]
        text = f"{name}: {relative[-1]:.3g} of its start{unit}"
        axes.plot(steps, relative, style, color=colour, linewidth=1.6, label=text)
    if highest > 8 * lowest > 0:
        axes.set_yscale("log")
    axes.set_ylabel("compliance over its start (-)", fontsize=9)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=9, frameon=False, loc="upper right", bbox_to_anchor=(1.0, 0.94))


def _draw_share(axes: Any, history: History, key: str, label: str) -> None:
    steps, values = _series(history, key)
    axes.plot(steps, values, color=_COLOURS[0], linewidth=1.6)
    axes.set_ylabel(label, fontsize=9)
    if values:  # a converged constraint is no reason to magnify rounding
        middle, half = (max(values) + min(values)) / 2, (max(values) - min(values)) / 2
        half = max(1.1 * half, 0.05 * middle)
        axes.set_ylim(middle - half, middle + half)


def _mark_projection(axes: Any, history: History) -> None:
    """Thin lines where the sharpness of the projection changes: the curves jump there."""
    steps, betas = _series(history, "beta")
    for before, now, step in zip(betas, betas[1:], steps[1:], strict=False):
        if now != before:
            axes.axvline(step, color="0.6", linewidth=0.8, linestyle=":")
            axes.annotate(
                f"β {now:g}",
                (step, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(2, -9),
                textcoords="offset points",
                fontsize=7,
                color=GREY,
            )


def _series(history: History, key: str) -> tuple[list[float], list[float]]:
    rows = [row for row in history if row.get(key) is not None]
    return [float(row["iteration"]) for row in rows], [float(row[key]) for row in rows]
