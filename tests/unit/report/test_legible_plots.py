"""Plots of a page: nothing is cut, names of curves cover none of them, ticks are apart."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.report.plot import Picture, picture
from cranktopo.tasks.balance.plot import _Curve, _emptiest_deg
from cranktopo.tasks.fea.scatter import LABELS, Point, scatter_pictures
from cranktopo.tasks.vibration.plots import _draw_modes

_NAMES = ("damper ring", "hub", *(f"throw {n}" for n in range(1, 7)), "flywheel", "coupling + driven machine")


def _steep(axes: Any) -> None:
    for number in range(7):
        axes.plot([0, 1], [0, 171_158 * number], label=f"a curve with a name, {number}")
    axes.set_ylabel("torque amplitude (N m)")
    axes.annotate("order", (1, 0), annotation_clip=False)


def _modes(axes: Any) -> None:
    shape = np.linspace(-1, 1, len(_NAMES))
    mode = SimpleNamespace(frequency_Hz=56.4, shape=shape)
    _draw_modes(axes, SimpleNamespace(shaft=SimpleNamespace(names=_NAMES), modes=[mode]))  # type: ignore[arg-type]


def _webs() -> Picture:
    points = [Point("the original web", 1.469, 135.2), Point("optimised", 1.472, 153.3)]
    return scatter_pictures({next(iter(LABELS.values())): points}, 0, {})[0]


@pytest.mark.parametrize(
    "plot", [picture("steep", "", _steep), picture("modes", "", _modes), _webs()], ids=lambda plot: plot.name
)
def test_a_plot_is_legible(plot: Picture) -> None:
    figure, axes = plot.figure, plot.figure.axes[0]
    figure.canvas.draw()
    outer, inner = axes.get_tightbbox(), axes.get_window_extent()
    assert outer is not None
    low, high = figure.bbox.min - 1, figure.bbox.max + 1
    assert (outer.min >= low).all()
    assert (outer.max <= high).all()
    (names,) = figure.legends
    assert not names.get_window_extent().overlaps(inner)
    assert not names.get_window_extent().overlaps(outer)
    assert inner.height > 1.2 * figure.dpi, "the names take no height from the axes"
    ticks = [tick.get_window_extent() for tick in axes.get_yticklabels() if tick.get_text()]
    assert not any(one.overlaps(other) for one, other in pairwise(ticks))


def test_the_scale_of_a_polar_plot_stands_where_no_curve_goes() -> None:
    toward = np.exp(1j * np.deg2rad(np.array([100.0, 150.0, 157.5])))
    place = _emptiest_deg([_Curve("load", 38_761 * toward, "C0", "-")])
    assert abs(place - 157.5) > 90
    assert _Curve("load", 38_761 * toward, "C0", "-").size("N") == "38,761 N"
