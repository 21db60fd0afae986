"""Error against seconds, both logarithmic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import Any

from cranktopo.report.axes_style import GREY, plain
from cranktopo.report.plot import Picture, picture
from cranktopo.tasks.accuracy.text import study_name

_MARKERS, _COLOURS = "osD^vP*X", ("C0", "C1", "C2")
_Level = Mapping[str, Any]


def error_picture(levels: Sequence[_Level]) -> Picture:
    """Error against seconds.

    Args:
        levels: each with `name`, `seconds` and `error_percent`; where they have `ladder` (their study) and
            `efficient`, the Pareto front of each study is joined and named.
    """
    shown = [level for level in levels if level["error_percent"]]
    words = "; ".join(f"{v['name']}: {v['error_percent']:.2g} % in {v['seconds']:.3g} s" for v in shown)
    draw = _draw_fronts if any("efficient" in level for level in shown) else _draw_errors
    return picture("accuracy", f"Error against seconds. {words}", draw, shown)


def study_pictures(result: Mapping[str, Any]) -> tuple[Picture, ...]:
    """The plot of what `cranktopo accuracy --json` prints, where any error is known."""
    levels = result["rungs"]
    return (error_picture(levels),) if any(level["error_percent"] for level in levels) else ()


def _draw_errors(axes: Any, levels: Sequence[_Level]) -> None:
    for level, marker in zip(levels, cycle(_MARKERS), strict=False):
        axes.plot(level["seconds"], level["error_percent"], marker, label=level["name"])
    _frame(axes)


def _draw_fronts(axes: Any, levels: Sequence[_Level]) -> None:
    studies = dict.fromkeys(level["ladder"] for level in levels)
    for study, marker, colour in zip(studies, _MARKERS, _COLOURS, strict=False):
        mine = [level for level in levels if level["ladder"] == study]
        best = sorted((level for level in mine if level["efficient"]), key=lambda level: level["seconds"])
        others = [level for level in mine if not level["efficient"]]
        axes.plot(*_points(best), marker, color=colour, ls="-", label=f"{study_name(study)}, Pareto front")
        if others:
            axes.plot(*_points(others), marker, color=colour, mfc="none", ls="")
        for level in best:
            _name(axes, level)
    _frame(axes)


def _points(levels: Sequence[_Level]) -> tuple[list[float], list[float]]:
    return [level["seconds"] for level in levels], [level["error_percent"] for level in levels]


def _name(axes: Any, level: _Level) -> None:
    place = level["seconds"], level["error_percent"]
    style = {"textcoords": "offset points", "xytext": (4, 4), "fontsize": 6, "color": GREY}
    axes.annotate(level["name"], place, **style)


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
