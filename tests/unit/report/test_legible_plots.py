"""Plots of a page: nothing is cut, names of curves cover none of them, ticks are apart."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.study import Misfire, Swing, VibrationStudy, study_vibration
from cranktopo.report.plot import Picture, emptiest_deg, name_above, picture, plain_decades, polar_frame
from cranktopo.tasks.modes.plots import _draw_turning
from cranktopo.tasks.throw_fea.scatter import LABELS, Point, scatter_pictures
from cranktopo.tasks.vibration.plots import _draw_modes, vibration_pictures
from cranktopo.tasks.web_shape.page import draw_goal, draw_worst_limit
from tests.physics.engine.test_line_damping import LINE, PROPELLER
from tests.physics.engine.test_orders_of_a_slow_engine import medium_speed

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


def test_two_webs_that_are_nearly_alike_stand_in_a_range_that_shows_it() -> None:
    """4 % of the mass and 20 % of the stiffness at least: 0.2 % between two points is no gulf."""
    axes = _webs().figure.axes[0]
    (low_kg, high_kg), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert (low_kg, high_kg) == pytest.approx((0.92 * 1.469, 1.08 * 1.472))
    assert (low, high) == pytest.approx((0.88 * 135.2, 1.12 * 153.3))


def test_a_settled_goal_is_not_magnified() -> None:
    """Three webs within 0.02 % of the original stand in a range of 1 %, worst limits in one of 0.2 %."""
    rounds = [SimpleNamespace(values={"mass": mass}, excess_percent=(0.0,)) for mass in (1.0, 0.9999, 0.9998)]
    values, goal = SimpleNamespace(original={"mass": 1.0}), SimpleNamespace(quantity=QUANTITIES["mass"])
    found: Any = SimpleNamespace(rounds=rounds, values=values, goal=goal, best_round=2)
    for draw, least in ((draw_goal, 1.0), (draw_worst_limit, 0.2)):
        axes = Figure().add_subplot()
        draw(axes, found)
        low, high = axes.get_ylim()
        assert high - low == pytest.approx(least)


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


def _marine(**more: float) -> VibrationStudy:
    """A slow six: modes at 7, 42 and 56 Hz are met, and one at 170 Hz; others up to 550 Hz are not."""
    shaft = {**LINE, "propeller": PROPELLER, **more}
    scene = medium_speed(shaft=shaft, effects={"threshold": 0.5})  # the mean inertia, which takes less time
    return study_vibration(scene, estimated_chain(scene), 1.0, "closed form")


def test_a_campbell_diagram_ends_above_what_an_order_meets_and_its_names_lie_apart() -> None:
    found = vibration_pictures(_marine())[0]
    axes = found.figure.axes[0]
    found.figure.canvas.draw()
    assert 60 < axes.get_ylim()[1] < 80, "no axis to modes that no order meets with a torque that is felt"
    boxes = {text: text.get_window_extent() for text in axes.texts}
    ticks = [tick.get_window_extent() for tick in (*axes.get_yticklabels(), *axes.get_xticklabels())]
    for one, other in combinations(boxes.values(), 2):
        assert not one.overlaps(other)
    assert not any(box.overlaps(tick) for box in boxes.values() for tick in ticks)
    names = [text.get_text() for text in boxes]
    assert [name for name in names if name.startswith("mode")] == [
        "mode 1, 7.12 Hz",
        "mode 2, 41.6 Hz",
        "mode 3, 56.1 Hz",
    ]
    whole = found.figure.bbox
    for box in boxes.values():
        assert (box.min >= whole.min).all()
        assert (box.max <= whole.max).all()
    (dots,) = (line for line in axes.lines if line.get_marker() == "o")
    halves = [name for name in names if name.endswith(".5")]
    assert len(dots.get_xdata()) >= 15
    assert "3.5" in halves, "the strongest at their dots"


def test_names_above_the_axes_leave_these_their_width() -> None:
    """A name that is too long for one line of three is in the next one."""
    figure = Figure(figsize=(9, 6), layout="constrained")
    FigureCanvasAgg(figure)
    for axes in figure.subplots(2, 1):
        for number in range(3):
            axes.plot([0, number], label=f"acceleration of the piston, 1 = 299{number} m/s²")
        name_above(axes, 7.8)
    figure.canvas.draw()
    for axes in figure.axes:
        inner, names = axes.get_window_extent(), axes.get_legend().get_window_extent()
        assert inner.width > 0.85 * figure.bbox.width
        assert names.x1 <= figure.bbox.x1
        assert not names.overlaps(inner)


@pytest.mark.parametrize(
    ("values", "told"),
    [((1.3, 25.0), {"2", "5", "10", "20"}), ((0.056, 1.0), {"0.1", "0.2", "0.5", "1"}), ((3.1, 4.2), set())],
)
def test_a_logarithmic_axis_has_plain_numbers(values: tuple[float, float], told: set[str]) -> None:
    axes = picture("log", "", lambda axes: axes.plot(values)).figure.axes[0]
    axes.set_yscale("log")
    plain_decades(axes.yaxis)
    axes.figure.canvas.draw()
    labels = {tick.get_text() for tick in axes.get_yticklabels(which="both") if tick.get_text()}
    assert told <= labels
    assert not any("10^" in label for label in labels)


def test_the_scale_of_a_polar_plot_stands_where_no_curve_goes() -> None:
    toward = np.exp(1j * np.deg2rad(np.array([100.0, 150.0, 157.5])))
    assert abs(emptiest_deg(38_761 * toward) - 157.5) > 90


def test_no_number_of_a_polar_plot_lies_on_its_edge() -> None:
    """Whatever the largest force is: each number is whole within the outermost line."""
    for largest in (10.98, 155_019.0, 38_761.0, 1.0):
        drawn = picture("polar", "", polar_frame, largest * np.exp(1j * np.arange(3)), largest, 4, polar=True)
        axes = drawn.figure.axes[0]
        drawn.figure.canvas.draw()
        edge = axes.patch.get_window_extent()
        names = [name for name in axes.get_yticklabels() if name.get_text()]
        assert len(names) >= 2
        for name in names:
            box = name.get_window_extent()
            far = np.hypot(*(box.corners() - np.array([edge.x0 + edge.x1, edge.y0 + edge.y1]) / 2).T).max()
            assert far < edge.width / 2


def test_numbers_of_orders_lie_apart_where_a_mode_lies_far_above_them() -> None:
    mode = SimpleNamespace(kind="torsion", frequencies_Hz=(2120.0, 2118.0), critical_speeds=())
    modal = SimpleNamespace(modes=[mode], speeds_rpm=(700.0, 2800.0), highest_order=12)
    found = picture("orders", "", _draw_turning, modal)
    axes = found.figure.axes[0]
    found.figure.canvas.draw()
    boxes = [text.get_window_extent() for text in axes.texts]
    assert axes.texts[0].get_text() == "12"
    assert 4 <= len(boxes) < 12
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


def test_the_curve_of_the_torque_is_the_largest_of_all_sections_and_is_named() -> None:
    """It reaches the table's torque at every speed, and lies above the limit where speeds are barred."""
    free = _marine()
    response, inside = free.response, np.array(free.shaft.in_crankshaft)
    most = response.torque_amplitude_Nm[:, inside].argmax(axis=1)
    assert len(set(most.tolist())) > 1, "sections take turns"
    limit = 0.6 * response.worst_Nm
    study = _marine(permitted_shear_MPa=free.shaft.shear_MPa(limit))
    worst = Swing(0, 300.0, 1.7 * response.worst_Nm, 0.5, 1.0)
    study = replace(study, misfires=(Misfire(1, worst, (), (), ()),))
    axes = vibration_pictures(study)[1].figure.axes[0]
    lines = {line.get_label(): line.get_xydata() for line in axes.get_lines()}
    speeds, torques = lines["all orders"].T
    for torque, row in zip(torques, response.torque_amplitude_Nm, strict=True):
        assert torque == max(row[inside])
    assert study.barred_rpm
    for low, high in study.barred_rpm:
        assert max(torques[(speeds >= low) & (speeds <= high)]) > limit
    assert lines["single misfires, largest"].tolist() == [[300.0, worst.torque_amplitude_Nm]]
    permitted = study.scene.shaft.permitted_shear_MPa if study.scene.shaft else None
    assert lines[f"permitted, {permitted:g} MPa"][0, 1] == pytest.approx(limit)
    assert axes.get_ylim()[1] > worst.torque_amplitude_Nm
    told = " ".join(axes.get_title().split())
    assert told == "Largest of all sections of the crankshaft, all cylinders fire"
