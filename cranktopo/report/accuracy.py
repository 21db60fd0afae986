"""What the numbers of a report are worth, and what the next digit costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import Any

from cranktopo.report.axes_style import plain
from cranktopo.report.page import Picture, Section
from cranktopo.report.sections import pairs, picture


def accuracy_section(metrics: Mapping[str, Any], ladder: Mapping[str, Any] | None) -> Section:
    """Residuals and volume errors of a run, and error against seconds where the run has them.

    Args:
        metrics: content of metrics.json.
        ladder: object with `rungs`, each with `name`, `seconds` and `error_percent`; None without.
    """
    solver, surface = metrics["solver"], metrics["surface"]
    rows = [
        ("largest cell edge", f"{metrics['grid']['cell_mm']:.3g} mm"),
        ("relative residual of the reported solve", f"{solver['final_relative_residual']:.1e}"),
        ("cycles per solve, mean and most", "{mean:.1f}, {max}".format(**solver["cg_iterations"])),
    ]
    if "web_volume_error_percent" in surface:
        error = surface["web_volume_error_percent"]
        rows.append(("volume of the surface against the density", f"{error:+.4f} %"))
    text = (
        "Cells cut by a cylinder make the optimiser's model a little too stiff; the error falls with the "
        "cell size and is nearly the same for both webs. 'cranktopo evaluate' gives a value with an error "
        "estimate."
    )
    pictures: tuple[Picture, ...] = ()
    if ladder and ladder.get("rungs"):
        pictures = (error_picture(ladder["rungs"]),)
    return Section("accuracy", "Accuracy and its price", text, (("This run", pairs(rows)),), pictures)


def error_picture(rungs: Sequence[Mapping[str, Any]]) -> Picture:
    """Error against seconds, both logarithmic.

    Args:
        rungs: each with `name`, `seconds` and `error_percent`.
    """
    words = "; ".join(f"{r['name']}: {r['error_percent']:.2g} % in {r['seconds']:.3g} s" for r in rungs)
    return picture("accuracy", f"Error against seconds. {words}", _draw_errors, rungs)


def _draw_errors(axes: Any, rungs: Sequence[Mapping[str, Any]]) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    for rung, marker in zip(rungs, cycle("osD^vP*X"), strict=False):
        axes.plot(rung["seconds"], rung["error_percent"], marker, label=rung["name"])
    axes.set(xscale="log", yscale="log", xlabel="seconds", ylabel="error (%)")
    for axis in (axes.xaxis, axes.yaxis):  # a range below one decade has no power of ten to label
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.margins(0.15)
    axes.legend(fontsize=8)
    axes.grid(color="0.9", linewidth=0.8)
    plain(axes)
