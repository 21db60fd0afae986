"""The side on which drawings show what lies off the plane of a throw, against the exact solid."""

from __future__ import annotations

from datetime import datetime

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.numerics.surfaces.plane_section import section_y
from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
from cranktopo.tasks.crank_drawing.crank_views import _FROM_FREE_END, _FROM_SIDE
from cranktopo.tasks.crank_drawing.sheet import crank_figure
from cranktopo.tasks.drawing.sheet import table_lines, throw_sheets
from cranktopo.tasks.drawing.views import Sheet
from tests.physics.throw.test_crossing_drillings import drilled_twin

LEVELS_MM = -10.0, 15.0, 30.0
"""Places along the throw that the drilling crosses between its journals."""


def holes(scene: Scene) -> Array:
    """Centres (x, y, z) of the drilling in the exact throw, where planes across the throw cut it."""
    whole = solid_of(kernel_surface_of(scene, "throw"), "throw")
    found = []
    for level in LEVELS_MM:
        inner = min(
            (p for p in section_y(whole, level).to_polygons() if np.ptp(p[:, 0]) < 12.0),
            key=lambda p: np.ptp(p[:, 0]),
        )
        x, z = (inner.min(axis=0) + inner.max(axis=0)) / 2
        found.append((x, level, z))
    return np.array(found)


def drawn_axis(sheet: Sheet, levels_mm: Array) -> Array:
    """Places across of the drilling's axis in the front view, at places along the throw."""
    (drilling,) = sheet.drilled
    edges = np.array([stroke.points for stroke in drilling.front])  # type: ignore[union-attr]
    (x0, y0), (x1, y1) = edges.mean(axis=0)
    return x0 + (x1 - x0) * (levels_mm - y0) / (y1 - y0)


@pytest.mark.slow
@pytest.mark.parametrize(("web", "way"), [("first", 1), ("second", -1)])
def test_a_drilling_is_drawn_on_its_side(web: str, way: int) -> None:
    """Seen from the crankpin, x of the solid runs right in the first half, and left in the second."""
    scene = throw_scenes(drilled_twin(4.0, 0.0, web))[0]
    sheets = throw_sheets(scene)
    sheet, other = sheets if web == "first" else sheets[::-1]
    assert not other.drilled
    solid = holes(scene)
    assert np.ptp(solid[:, 0]) > 5.0, "it leans"
    np.testing.assert_allclose(drawn_axis(sheet, solid[:, 1]), way * solid[:, 0], atol=0.05)
    for x, level, z in solid:
        (inner,) = (p for p in section_y(sheet.solid, level).to_polygons() if np.ptp(p[:, 0]) < 12.0)
        middle = (inner.min(axis=0) + inner.max(axis=0)) / 2
        along = z if way > 0 else scene.pitch_mm - z
        np.testing.assert_allclose(middle, (way * x, along), atol=0.05)
    assert "to   crankpin 50°" in "\n".join(table_lines(sheet)), "as the design has it"


@pytest.mark.slow
def test_the_sheet_of_the_crank_counts_x_as_the_design(monkeypatch: pytest.MonkeyPatch) -> None:
    """22.5 sin 50° = 17.24 mm toward +x: on the left of the second web, whose mark of x points there."""
    scene = drilled_twin(4.0, 0.0, "second")
    figure, _ = crank_figure(scene, crank_shape(scene), datetime(2026, 1, 2))
    (axes,) = (axes for axes in figure.axes if axes._left_title.get_text().startswith("Web 2"))  # type: ignore[attr-defined]
    places = {text.get_text(): text.get_position() for text in axes.texts if text.get_text()}
    assert places["17.24"][0] == pytest.approx(-17.24, abs=0.01)
    assert places["x"][0] < places["y"][0]
    (first,) = (axes for axes in figure.axes if axes._left_title.get_text().startswith("Web 1"))  # type: ignore[attr-defined]
    marks = {text.get_text(): text.get_position() for text in first.texts if text.get_text() in ("x", "y")}
    assert marks["x"][0] > marks["y"][0]


@pytest.mark.parametrize("view", [_FROM_SIDE, _FROM_FREE_END])
def test_views_of_the_crank_mirror_nothing(view: Array) -> None:
    assert np.linalg.det(view) == 1.0


def test_edges_of_a_side_pocket_end_at_the_outline() -> None:
    """They ran on as far as the web is wide, out of the ellipse."""
    scene = load_scene("opposed-piston-variant-2")
    strokes = [s for _, one in scene.web.features() for s in one.drawing(scene).front]
    assert len(strokes) > 4
    points = np.array([point for stroke in strokes for point in stroke.points])  # type: ignore[union-attr]
    outline = scene.web.half_width_mm(scene.throw.radius_mm, points[:, 1])
    assert (np.abs(points[:, 0]) <= outline + 1e-6).all()
