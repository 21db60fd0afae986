"""Ends of the crank on its drawing: diameters on the steps, keyways in section, flanges with their holes."""

from __future__ import annotations

import re
from math import asin, cos, pi, radians, sin, sqrt
from typing import Any

import numpy as np
import pytest
from manifold3d import CrossSection
from matplotlib.figure import Figure

from cranktopo.base.units import MM_PER_INCH
from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
from cranktopo.tasks.crank_drawing.end_views import EndView, across, draw_end_along, end_blocks, end_views
from tests.cli.test_crank_drawing import drawn, small
from tests.drawn_texts import beyond_frame, over_each_other, over_edges, over_lines

KEYWAY = {"kind": "keyway", "diameter_mm": 30.0, "length_mm": 20.0, "bore_diameter_mm": 8.0}
SLOT = {"width_mm": 8.0, "depth_mm": 4.0, "angle_deg": 40.0}
SEAT = {"fit": "k6", "roughness_um": 0.8, "run_out_mm": 0.02}
FREE = [
    {"kind": "gear_seat", "diameter_mm": 36.0, "length_mm": 12.0, "bore_diameter_mm": 8.0, **SEAT},
    {**KEYWAY, **SLOT},
    {"kind": "thread", "thread": "M24x1.5", "diameter_mm": 24.0, "length_mm": 14.0, "bore_diameter_mm": 8.0},
]
OUTPUT = [
    {"kind": "cylinder", "diameter_mm": 34.0, "length_mm": 6.0},
    {"kind": "cone", "diameter_mm": 40.0, "outer_end_diameter_mm": 36.0, "length_mm": 40.0},
    {
        "kind": "flange",
        "diameter_mm": 90.0,
        "length_mm": 10.0,
        "bolts": 5,
        "bolt_circle_mm": 70.0,
        "bolt_diameter_mm": 9.0,
        "first_bolt_deg": 17.0,
    },
]


@pytest.fixture(scope="module")
def scene() -> Any:
    ends = [{"side": "free", "step": FREE}, {"side": "output", "step": OUTPUT}]
    return small(crank={"end": ends})


@pytest.fixture(scope="module")
def ends(scene: Any, fine_triangles: None) -> list[EndView]:
    return end_views(crank_shape(scene))


def radius_at(end: EndView, z_mm: float) -> float:
    """Largest distance from the axis of the kernel's body there."""
    return float(np.hypot(*np.concatenate(end.piece.solid.slice(z_mm).to_polygons()).T).max())


def test_each_step_has_its_diameter_on_its_surface(ends: list[EndView]) -> None:
    told = [text for end in ends for _, text in end.callouts]
    assert told == [
        "M24x1.5\n⌀24\nbore ⌀8",
        "⌀30",
        "⌀36 k6 (+0.018/+0.002)\nRa 0.8\n↗ 0.02 A-B",
        "⌀34",
        "⌀40 to ⌀36\ncone 1:10",
        "⌀90",
    ], "the bore once, where it opens"
    for end in ends:
        for (z, y), text in end.callouts:
            diameters = [float(one) for one in re.findall(r"(?<!bore )⌀([\d.]+)", text)]
            assert -y == pytest.approx(np.mean(diameters) / 2)
            assert -y == pytest.approx(radius_at(end, z), rel=1e-3)


@pytest.mark.parametrize("scale", [2.0, 0.5, 0.1])
def test_callouts_keep_their_order_and_their_distance(ends: list[EndView], scale: float) -> None:
    for end in ends:
        row, room = end.row(1 / scale), end.room(scale)
        assert list(np.argsort(row)) == [0, 1, 2]
        figure = Figure(figsize=[mm / MM_PER_INCH for mm in room.size_mm(scale)])
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        room.set_limits(axes, scale)
        draw_end_along(end, axes, scale)
        for misplaced in (over_each_other, over_edges, over_lines):
            assert not misplaced(figure), misplaced.__name__


def test_a_keyway_is_cut_where_its_key_says(ends: list[EndView]) -> None:
    """Area in closed form; its walls and its bottom are up in the section, which is turned by 40 deg."""
    (one,) = (one for one in ends[0].steps if one.letter)
    section = across(ends[0], one, 40.0)
    half, bottom = SLOT["width_mm"] / 2, 15.0 - SLOT["depth_mm"]
    above = half * sqrt(15.0**2 - half**2) + 15.0**2 * asin(half / 15.0)
    expected = pi * (15.0**2 - 4.0**2) - (above - 2 * half * bottom)
    assert section.area() == pytest.approx(expected, rel=1e-3)
    tool = CrossSection.square((2 * half - 0.02, 20.0)).translate((0.01 - half, bottom + 0.01))
    assert (section ^ tool).area() < 1e-6
    turned = ends[0].piece.solid.slice(one.middle_mm).rotate(40.0)  # +x toward the sense of rotation
    assert (turned ^ tool).area() < 1e-6


def test_the_keyway_is_dimensioned(scene: Any) -> None:
    (figure, found) = drawn(scene)
    (axes,) = (one for one in figure.axes if one.get_title(loc="left") == "Section C-C")
    measured = {text.measured.text: text.measured for text in axes.texts if hasattr(text, "measured")}
    assert abs(np.subtract(measured["8"].start, measured["8"].end))[0] == pytest.approx(8.0)
    assert abs(np.subtract(measured["4"].start, measured["4"].end))[1] == pytest.approx(4.0)
    words = [text.get_text() for text in axes.texts]
    assert "keyway 40° from throw 1\nin the sense of rotation" in words
    assert "Output end, flange" in [one.get_title(loc="left") for one in figure.axes]
    for misplaced in (over_each_other, over_edges, over_lines, beyond_frame):
        assert not misplaced(figure), misplaced.__name__
    assert found.sheet in ("A3", "A2")


def test_a_flange_shows_its_holes_the_first_up(ends: list[EndView]) -> None:
    one = ends[1].steps[-1]
    centres = [
        np.mean(polygon, axis=0)
        for polygon in across(ends[1], one, 17.0).to_polygons()
        if np.ptp(polygon[:, 0]) < 10.0
    ]
    angles = radians(72.0) * np.arange(5)
    expected = 35.0 * np.column_stack([-np.sin(angles), np.cos(angles)])
    assert len(centres) == 5
    for place in expected:
        assert min(np.hypot(*(np.array(centres) - place).T)) < 0.01
    at = (35.0 * sin(radians(17.0)), 35.0 * cos(radians(17.0)))  # x as it is along throw 1's sense
    hole = CrossSection.circle(4.4).translate(at)
    assert (ends[1].piece.solid.slice(one.middle_mm) ^ hole).area() < 1e-6


def test_a_crank_without_steps_has_no_views_of_ends() -> None:
    bare = crank_shape(small())
    assert end_blocks(end_views(bare), 1.0) == []
