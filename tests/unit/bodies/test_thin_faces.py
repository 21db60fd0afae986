"""Faces that another CAD kernel may not mesh are told when a STEP file is written."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.thin_faces import thin_faces
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session

STEP_MM, SIDE_MM = 0.004, 10.0


@pytest.mark.parametrize(("scale", "count"), [(1.0, 2), (2.0, 2), (4.0, 0)])
def test_two_boxes_that_nearly_agree_have_two_thin_steps(scale: float, count: int) -> None:
    """A rectangle of 0.004 by 10 mm: twice its area over its circumference."""
    with cad_session("boxes") as gmsh:
        occ = gmsh.model.occ
        boxes = [occ.addBox(k * STEP_MM, 0, k * SIDE_MM, SIDE_MM, SIDE_MM, SIDE_MM) for k in (0, 1)]
        found = thin_faces(occ, occ.fuse([(3, boxes[0])], [(3, boxes[1])])[0], scale)
    assert len(found) == count
    for face in found:
        assert face.width_mm == pytest.approx(STEP_MM * SIDE_MM / (STEP_MM + SIDE_MM), rel=1e-6)
        assert face.middle_mm[1:] == pytest.approx((SIDE_MM / 2, SIDE_MM), abs=1e-6)


def with_pockets(apart_mm: float) -> Scene:
    """A web with two pockets that are alike but for their depth, and so far apart."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    box = {"shape": "box", "face": "journal", "y_mm": 15.0, "size_x_mm": 8.0, "size_y_mm": 6.0}
    pockets = [{**box, "x_mm": x, "depth_mm": depth} for x, depth in ((17.0, 3.0), (17.0 + apart_mm, 4.0))]
    return scene_from_dict(changed_data(data, {"web.pocket": pockets}))


@pytest.mark.parametrize("apart_mm", [0.005, 0.5])
def test_a_file_with_a_thin_face_says_so(
    apart_mm: float, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, logger="cranktopo.notes")
    export_solid(with_pockets(apart_mm), "web", tmp_path / "web.step")
    told = [line for line in caplog.messages if "um wide" in line]
    assert len(told) == (apart_mm < 0.01)
    for line in told:
        assert line.startswith(
            "warning: web of mikron-iiic-plain: 3 faces are very thin, the thinnest 5 um wide, at (13, "
        )
        assert line.endswith(
            "other CAD may leave gaps in their triangles there. Move what meets there by 0.1 mm"
        )
