"""The small form of a web for the page of a sweep: decoded, it is the body."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.report.viewer.small_web import MOST_FACES, packed_web
from tests.packed_scenes import small_web


def packed(body: trimesh.Trimesh) -> tuple[SurfaceMesh, str]:
    """A body as it is and as it is packed, web between 10 and 20 mm."""
    mesh = SurfaceMesh(np.asarray(body.vertices, np.float64), np.asarray(body.faces, np.int64))
    return mesh, packed_web(ShownBody("body", mesh, (10.0, 20.0), 31.0))


def test_every_face_is_there_to_half_a_step() -> None:
    cone = trimesh.creation.cone(radius=9.0, height=31.0, sections=40)
    cone.apply_transform(trimesh.transformations.rotation_matrix(0.7, (1.0, 2.0, 3.0), (5.0, 6.0, 7.0)))
    mesh, text = packed(cone)
    half_a_step = np.ptp(mesh.vertices_mm, axis=0) / 4095 / 2
    assert (np.abs(small_web(text).corners_mm - mesh.corners_mm) <= 1.001 * half_a_step).all()


def test_a_fine_body_is_a_few_kilobytes_and_keeps_its_volume() -> None:
    body = trimesh.creation.icosphere(subdivisions=5, radius=40.0)
    body.apply_scale((1.0, 0.7, 0.4))
    mesh, text = packed(body)
    found = small_web(text)
    assert len(found.faces) <= MOST_FACES < len(mesh.faces) / 10
    assert len(text) < 16_000
    assert found.volume_mm3 == pytest.approx(mesh.volume_mm3, rel=0.02)
