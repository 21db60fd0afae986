"""Sharp edges of a body that is drawn: known of a box and of a prism, and those of the bench's picture."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.bodies.shown_solid import display_half
from cranktopo.design.loading import load_scene
from cranktopo.report.shading import sharp_edges
from cranktopo.tasks.bench.live_picture import live_picture
from tests.packed_scenes import unpacked


def of(solid: Manifold) -> tuple[np.ndarray, np.ndarray]:
    mesh = solid.to_mesh64()
    points = np.asarray(mesh.vert_properties)[:, :3]
    return points, sharp_edges(points, np.asarray(mesh.tri_verts).astype(int))


def test_a_box_has_twelve() -> None:
    points, edges = of(Manifold.cube((2.0, 3.0, 4.0)))
    lengths = np.linalg.norm(np.diff(points[edges], axis=1), axis=2).ravel()
    assert sorted(lengths) == pytest.approx([2.0] * 4 + [3.0] * 4 + [4.0] * 4)


@pytest.mark.parametrize(("sides", "along"), [(8, 8), (12, 0)])  # 45 and 30 degrees from face to face
def test_a_prism_has_its_rims_and_its_sides_where_they_meet_sharply(sides: int, along: int) -> None:
    points, edges = of(Manifold.cylinder(5.0, 3.0, circular_segments=sides))
    rise = np.abs(np.diff(points[edges][:, :, 2], axis=1)).ravel()
    assert np.count_nonzero(rise > 1.0) == along
    assert np.count_nonzero(rise < 1e-9) == 2 * sides


def test_the_picture_of_a_drag_has_those_of_its_body() -> None:
    """Corners at one place with several normals are told apart there, and count as one here."""
    scene = load_scene("mikron-iiic-plain")
    header, arrays = unpacked(live_picture(scene.model_dump(mode="json", exclude_none=True))["picture"])
    body = header["bodies"][0]
    places = np.array(body["low_mm"]) + arrays[body["positions"]].reshape(-1, 3) / 65535 * body["size_mm"]
    points, edges = of(display_half(scene))
    found, known = (
        np.sort(np.linalg.norm(np.diff(where[pairs], axis=1), axis=2).ravel())
        for where, pairs in ((places, arrays[body["edges"]].reshape(-1, 2)), (points, edges))
    )
    assert len(found) == len(known) > 20
    assert found == pytest.approx(known, abs=0.01)
