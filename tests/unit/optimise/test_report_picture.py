"""The picture shows what is in front, the right way round, and the numbers of the history."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import trimesh
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.shading import JOURNAL_COLOUR, WEB_COLOUR, draw, extent_mm, shaded, view_axes, visible
from cranktopo.tasks.optimise.picture import run_figure, run_pictures

WEB_Z = (10.0, 16.0)
UP = (0.0, 1.0, 0.0)


def _block(*boxes: list[list[float]]) -> SurfaceMesh:
    body = trimesh.boolean.union([trimesh.creation.box(bounds=box) for box in boxes], engine="manifold")
    return SurfaceMesh(np.asarray(body.vertices, np.float64), np.asarray(body.faces, np.int64))


@pytest.fixture(scope="module")
def throw() -> SurfaceMesh:
    """A journal at x in (-5, 5), y in (-5, 5) and a pin at x in (2, 8), y in (20, 30): not symmetric."""
    return _block(
        [[-5, -5, 0], [5, 5, 10]],
        [[-10, -10, 10], [12, 34, 16]],
        [[2, 20, 16], [8, 30, 30]],
    )


def _pixels(mesh: SurfaceMesh, towards_viewer: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Picture (rows from the top, columns) and its extent in mm."""
    body, view = shaded(mesh, WEB_Z), view_axes(towards_viewer, UP)
    extent = extent_mm(body, view)
    size = np.ptp(extent, axis=0)
    figure = Figure(figsize=tuple(size / 10), dpi=100)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    draw(axes, body, view)
    axes.set_axis_off()
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3] / 255, extent


def _at(picture: tuple[np.ndarray, np.ndarray], right_mm: float, up_mm: float) -> np.ndarray:
    image, extent = picture
    share = (np.array([right_mm, up_mm]) - extent[0]) / (extent[1] - extent[0])
    return image[int((1 - share[1]) * image.shape[0]), int(share[0] * image.shape[1])]


def _is(colour: np.ndarray, expected: tuple[float, float, float]) -> bool:
    """Same hue, whatever the light."""
    return bool(np.allclose(colour / colour.max(), np.array(expected) / max(expected), atol=0.04))


def test_views_are_right_handed_and_named_right() -> None:
    point = np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(view_axes((0, 0, 1), UP) @ point, [1, 2, 3])
    np.testing.assert_allclose(view_axes((-1, 0, 0), UP) @ point, [3, 2, -1])
    np.testing.assert_allclose(view_axes((0, 0, -1), UP) @ point, [-1, 2, -3])
    axes = view_axes((0.75, 0.45, -0.8), UP)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1)


def test_no_face_is_drawn_near_another(throw: SurfaceMesh) -> None:
    """Caps of the journals, of 10 x 10 and 6 x 10 mm, lie inside them, or they would show in stripes."""
    body = shaded(throw, WEB_Z)
    corners = body.vertices_mm[body.faces]
    flat, areas, z = np.ptp(corners[:, :, 2], axis=1) < 1e-9, _areas(corners), corners[:, 0, 2]
    inset = 0.01 * throw.extent_mm + 0.06
    caps = {low: flat & (np.abs(z - low) < 1e-9) for low in (WEB_Z[0] - inset, WEB_Z[1] + inset)}
    assert [areas[here].sum() for here in caps.values()] == pytest.approx([100.0, 60.0])
    for here in caps.values():
        assert (body.colours[here] == JOURNAL_COLOUR).all()
    rest = ~np.logical_or(*caps.values())
    assert areas[rest].sum() == pytest.approx(_areas(throw.vertices_mm[throw.faces]).sum(), rel=1e-9)
    assert set(z[flat & rest].round(9)) == {0.0, *WEB_Z, throw.vertices_mm[:, 2].max()}


def _areas(corners: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(np.cross(*np.diff(corners, axis=1).transpose(1, 0, 2)), axis=1) / 2)


@pytest.mark.parametrize("off_mm", [-0.05, 0.05])
def test_sides_of_a_body_that_lies_off_stay_web(throw: SurfaceMesh, off_mm: float) -> None:
    body = shaded(throw, (WEB_Z[0] + off_mm, WEB_Z[1] + off_mm))
    corners = body.vertices_mm[body.faces]
    side = (np.isin(corners[:, :, 2], WEB_Z).all(axis=1)) & (corners[:, :, 0] > 8.5).any(axis=1)
    assert side.any()
    assert (body.colours[side] == WEB_COLOUR).all()


def test_a_point_is_seen_from_its_own_side_alone(throw: SurfaceMesh) -> None:
    """Of the free end of the pin, and of the web beside the journal."""
    body = shaded(throw, WEB_Z)
    for point, side in (((5.0, 25.0, 30.0), 1.0), ((-8.0, 0.0, 10.0), -1.0)):
        seen = [visible(body, view_axes((0.2, -0.1, z), UP), np.array(point)) for z in (side, -side)]
        assert seen == [True, False]


def test_what_is_in_front_hides_what_is_behind(throw: SurfaceMesh) -> None:
    from_pin, from_journal = _pixels(throw, (0, 0, 1)), _pixels(throw, (0, 0, -1))
    assert _is(_at(from_pin, 5, 25), JOURNAL_COLOUR)
    assert _is(_at(from_pin, 0, 0), WEB_COLOUR)
    assert _is(_at(from_journal, 0, 0), JOURNAL_COLOUR)
    assert _is(_at(from_journal, -5, 25), WEB_COLOUR)


def test_left_and_right_are_not_exchanged(throw: SurfaceMesh) -> None:
    from_pin = _pixels(throw, (0, 0, 1))
    assert _is(_at(from_pin, 7, 25), JOURNAL_COLOUR)
    assert _is(_at(from_pin, -7, 25), WEB_COLOUR)
    np.testing.assert_allclose(from_pin[1], [[-10, -10], [12, 34]], atol=1e-9)


def test_side_view_has_the_pin_on_the_right_and_background_beside(throw: SurfaceMesh) -> None:
    side = _pixels(throw, (-1, 0, 0))
    np.testing.assert_allclose(side[1], [[0, -10], [30, 34]], atol=1e-9)
    assert _is(_at(side, 25, 25), JOURNAL_COLOUR)
    assert _is(_at(side, 5, 0), JOURNAL_COLOUR)
    assert _is(_at(side, 13, 15), WEB_COLOUR)
    np.testing.assert_array_equal(_at(side, 5, 25), [1, 1, 1])


def test_light_comes_from_above(throw: SurfaceMesh) -> None:
    body = shaded(throw, WEB_Z)
    up = body.normals[:, 1] > 0.99
    assert up.any()
    tilted = _pixels(throw, (0.0, 0.7, 0.7)), _pixels(throw, (0.0, -0.7, 0.7))
    top = _at(tilted[0], 0, tilted[0][1][1, 1] - 2)
    bottom = _at(tilted[1], 0, tilted[1][1][0, 1] + 2)
    assert top.max() > bottom.max() + 0.1


def _history() -> list[dict[str, Any]]:
    return [
        {
            "iteration": i,
            "objective": 1.0 / (i + 1),
            "bending_compliance_N_mm": 400.0 / (i + 1) ** 2,
            "torsion_compliance_N_mm": 50.0 - i,
            "volume_fraction": 0.3 + 0.01 * (i == 2),
            "greyness": 0.6 - 0.05 * i,
            "beta": 1.0 if i < 3 else 2.0,
        }
        for i in range(6)
    ]


def test_curves_are_the_history_over_its_start(throw: SurfaceMesh) -> None:
    figure = run_figure(shaded(throw, WEB_Z), _history(), "title")
    compliance, volume, greyness = figure.axes[4:]
    lines = {
        line.get_label().split(":")[0]: line for line in compliance.get_lines() if ":" in line.get_label()
    }
    assert set(lines) == {"bending", "torsion", "objective"}
    np.testing.assert_allclose(lines["bending"].get_ydata(), [1 / (i + 1) ** 2 for i in range(6)])
    np.testing.assert_allclose(lines["torsion"].get_ydata(), [1 - i / 50 for i in range(6)])
    assert lines["torsion"].get_label() == "torsion: 0.9 of its start, 45 N mm"
    np.testing.assert_allclose(volume.get_lines()[0].get_ydata()[2], 0.31)
    np.testing.assert_allclose(greyness.get_lines()[0].get_ydata()[-1], 0.35)
    assert compliance.get_yscale() == "log"
    assert [text.get_text() for text in volume.texts] == ["β 2"]
    for axes in figure.axes[2:]:
        assert "(" in axes.get_xlabel() or axes.get_xlabel() == "iteration"
        assert axes.get_ylabel().endswith(")")


def test_first_four_axes_share_one_scale(throw: SurfaceMesh) -> None:
    figure = run_figure(shaded(throw, WEB_Z), [], "title")
    figure.canvas.draw()
    scales = [axes.get_window_extent().width / np.ptp(axes.get_xlim()) for axes in figure.axes[:4]]
    np.testing.assert_allclose(scales, scales[0], rtol=0.02)


@pytest.mark.parametrize(
    "history",
    [[], pytest.param([{"iteration": 0, "objective": 0.0}], marks=pytest.mark.slow), _history()],
)
def test_pngs_are_drawn_for_any_history(throw: SurfaceMesh, history: list[Any]) -> None:
    before = dict(mpl.rcParams)
    drawn = run_pictures(throw, history, "mikron-iiic-plain", WEB_Z)
    assert dict(mpl.rcParams) == before
    image, views = (mpl.image.imread(BytesIO(png)) for png in drawn)
    assert image.shape[:2] == (1288, 2100)
    assert views.shape[:2] == (539, 1650)
    assert np.unique(image[:900:5, ::5, :3].reshape(-1, 3), axis=0).shape[0] > 50
