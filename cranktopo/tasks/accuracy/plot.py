"""Error against seconds, both logarithmic."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any, TypeVar

from cranktopo.report.plot import GREY, Picture, picture, plain
from cranktopo.tasks.accuracy.text import study_name
from cranktopo.tasks.fea.study_result import LevelResult, StudyResult

_MARKERS, _COLOURS = "osD^vP*X", ("C0", "C1", "C2")
_Point = TypeVar("_Point", "TimedError", LevelResult)


@dataclass(frozen=True)
class TimedError:
    """The error estimate of a result and the seconds that it took."""

    name: str
    seconds: float
    error_percent: float


def error_picture(points: Sequence[TimedError]) -> Picture:
    """Return error against seconds."""
    return _picture([point for point in points if point.error_percent], _draw_errors)


def study_pictures(result: StudyResult) -> tuple[Picture, ...]:
    """Return error against seconds where any error is known, the Pareto front of each study joined."""
    shown = [level for level in result.rungs if level.error_percent]
    return (_picture(shown, _draw_fronts),) if shown else ()


def _picture(shown: Sequence[_Point], draw: Callable[[Any, Sequence[_Point]], None]) -> Picture:
    words = "; ".join(f"{v.name}: {v.error_percent:.2g} % in {v.seconds:.3g} s" for v in shown)
    return picture("accuracy", f"Error against seconds. {words}", draw, shown)


def _draw_errors(axes: Any, levels: Sequence[TimedError]) -> None:
    for level, marker in zip(levels, cycle(_MARKERS), strict=False):
        axes.plot(level.seconds, level.error_percent, marker, label=level.name)
    _frame(axes)


def _draw_fronts(axes: Any, levels: Sequence[LevelResult]) -> None:
    studies = dict.fromkeys(level.ladder for level in levels)
    for study, marker, colour in zip(studies, _MARKERS, _COLOURS, strict=False):
        mine = [level for level in levels if level.ladder == study]
        best = sorted((level for level in mine if level.efficient), key=lambda level: level.seconds)
        others = [level for level in mine if not level.efficient]
        axes.plot(*_points(best), marker, color=colour, ls="-", label=f"{study_name(study)}, Pareto front")
        if others:
            axes.plot(*_points(others), marker, color=colour, mfc="none", ls="")
        for level in best:
            _name(axes, level)
    _frame(axes)


def _points(levels: Sequence[LevelResult]) -> tuple[list[float], list[float | None]]:
    return [level.seconds for level in levels], [level.error_percent for level in levels]


def _name(axes: Any, level: LevelResult) -> None:
    place = level.seconds, level.error_percent
    style = {"textcoords": "offset points", "xytext": (4, 4), "fontsize": 6, "color": GREY}
    axes.annotate(level.name, place, **style)


def _frame(axes: Any) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    axes.set(xscale="log", yscale="log", xlabel="seconds", ylabel="error (%)")
    for axis in (axes.xaxis, axes.yaxis):  # a range below one decade has no power of ten to label
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.margins(0.15 if len(axes.texts) == 0 else 0.25, 0.15)
    axes.legend(fontsize=8)
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)
