"""Texts about points of the outline keep clear of the lines of dimensions."""

from __future__ import annotations

import pytest
from matplotlib.figure import Figure

from cranktopo.report.drafting import number_mm
from cranktopo.tasks.drawing.point_texts import line_levels, texts_about

EDGE_MM = 112.5


@pytest.mark.parametrize("level_mm", [-85.0, -92.0, -99.0])
@pytest.mark.parametrize("scale", [0.2, 0.5])
def test_texts_keep_clear_of_running_dimensions_and_of_the_line_of_the_width(
    level_mm: float, scale: float
) -> None:
    """ "2 × 70°" hid the kink of -85.00 of a marine six, R231.51 the line of its width."""
    axes, paper = Figure().subplots(), 1 / scale
    named = [((217.5, -79.2), "2 × 70°"), ((98.0, -209.8), "R231.51"), ((-98.0, -209.8), "R12")]
    levels = line_levels([(0.0, level_mm), (0.0, 195.0)])
    assert levels == [level_mm, 0.0, 195.0]
    right = texts_about(axes, named, 9.0 * paper, paper, levels=levels, edge=EDGE_MM)
    places = {text.get_text(): text.get_position() for text in axes.texts}
    assert right == [places["2 × 70°"][1], places["R231.51"][1]]
    for name in ("2 × 70°", "R231.51"):
        x, y = places[name]
        assert min(abs(y - level) for level in levels) > 1.7 * paper, name
        assert x > EDGE_MM or x + number_mm(name) * paper < EDGE_MM, name


def test_without_places_there_are_no_lines() -> None:
    assert line_levels([]) == []
