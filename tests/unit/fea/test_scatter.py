"""Lines of equal stiffness per mass reach as far as the points do."""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure

from cranktopo.tasks.bound.result import NoBound
from cranktopo.tasks.throw_fea.quantities import TORSION
from cranktopo.tasks.throw_fea.scatter import (
    LABELS,
    Point,
    draw_stiffness_over_mass,
    equal_ratio_factors,
    most_by_label,
)


@pytest.mark.parametrize(
    "ratios",
    [
        [1.0],
        [1.0, 1.05],
        [1.0, 1.6],
        [1.0, 0.3],
        [1.0, 4.2, 0.05],
        [1.0, 37.0],
        [1.0, 500.0],
        [0.999, 1.0, 1.101],
    ],
)
def test_every_point_is_between_two_lines(ratios: list[float]) -> None:
    lines = equal_ratio_factors(ratios)
    step = lines[1] - lines[0]
    assert 2 <= len(lines) <= 9
    assert lines[0] < min(ratios) or lines[0] == pytest.approx(step)  # then the line below it is the axis
    assert max(ratios) < lines[-1] < max(ratios) + 1.001 * step
    assert any(line == pytest.approx(1.0) for line in lines) or max(ratios) > 10


def test_the_curve_of_a_bound_is_that_of_the_original() -> None:
    label = LABELS[TORSION]
    curves = {"mass_percent": [40.0, 90.0, 110.0], "torsion_percent": [None, 105.0, 125.0]}
    most = most_by_label(curves, {label: Point("original", 2.0, 100.0)})
    assert list(most) == [label]
    assert most[label].mass_kg == pytest.approx((1.8, 2.2))
    assert most[label].stiffness == pytest.approx((105.0, 125.0))
    axes = Figure().add_subplot()
    draw_stiffness_over_mass(axes, [Point("original", 2.0, 100.0)], 0, label, most[label])
    assert axes.lines[-1].get_ydata()[1] == pytest.approx(125.0)
    assert most_by_label({}, {}) == most_by_label(NoBound(none="no envelope").stiffest, {}) == {}


def test_a_point_at_160_percent_has_a_line_above_it() -> None:
    axes = Figure().add_subplot()
    points = [Point("original", 2.0, 100.0), Point("light", 1.1, 88.0)]
    draw_stiffness_over_mass(axes, points, 0, "torsional stiffness")
    labels = [int(text.get_text()) for text in axes.texts]
    assert {100, 160, 170} <= set(labels)
    for line, label in zip(axes.lines, labels, strict=True):
        x, y = line.get_data()
        assert y[0] / x[0] == pytest.approx(label / 100 * 50.0)
