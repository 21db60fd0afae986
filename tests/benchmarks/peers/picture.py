"""The picture of a comparison: seconds per iteration and peak memory over the cells, on log scales."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLOURS = {"cranktopo": "#2f6db5", "pyMOTO": "#c2571a", "PyTopo3D": "#5b8c3a"}
_LIMIT = "products at the bandwidth of the memory"


def save_picture(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Write the picture; a code has a point for every grid that it ended.

    Args:
        rows: of `--json`; those of cranktopo have `limit_s`.
        path: .svg, .png or .pdf.
    """
    done = [row for row in rows if "failure" not in row]
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    seconds, memory = figure.subplots(1, 2)
    for code, colour in COLOURS.items():
        own = [row for row in done if row["code"] == code]
        cells = [row["cells"] for row in own]
        _line(seconds, cells, [row["iteration_s"] for row in own], colour, code)
        _line(memory, cells, [row["peak_MiB"] for row in own], colour, code)
    limits = [row for row in done if "limit_s" in row]
    cells, least = [row["cells"] for row in limits], [row["limit_s"] for row in limits]
    seconds.plot(cells, least, "--", color="grey")
    seconds.annotate(
        _LIMIT,
        (cells[0], least[0]),
        (14, 0),
        textcoords="offset points",
        ha="left",
        va="top",
        color="grey",
        fontsize=8,
    )
    for axes, label in ((seconds, "seconds per design iteration"), (memory, "peak memory, MiB")):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("cells")
        axes.set_ylabel(label)
        axes.grid(True, which="major", color="#e3e6ea", lw=0.8)
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(x=0.12, y=0.12)
    figure.savefig(path)


def _line(axes: Axes, cells: list[int], values: list[float], colour: str, name: str) -> None:
    axes.plot(cells, values, "o-", color=colour, ms=4.5, lw=1.8)
    if cells:
        at = (cells[-1], values[-1])
        axes.annotate(name, at, (0, 6), textcoords="offset points", ha="center", color=colour, fontsize=9)
