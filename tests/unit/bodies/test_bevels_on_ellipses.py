"""Bevels with a draft on elliptical webs: the kernel cuts both of their sides."""

from __future__ import annotations

import pytest

from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.throw import add_web
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.numerics.gmsh_session import cad_session
from tests.featured_throws import featured_throw


@pytest.mark.parametrize(("seed", "rel"), [(153, 1e-6), (455, 1e-7), (607, 1e-7)])
def test_both_sides_of_a_drafted_bevel_are_cut(seed: int, rel: float) -> None:
    """One of them was not cut at all, of an ellipse that is one curve (455, 607) or two arcs (153)."""
    scene = featured_throw(seed)
    web = scene.web.model_copy(update={"pocket": (), "counterweight": None})
    scene = scene.model_copy(update={"web": web, "second_web": None})
    with cad_session("web") as gmsh:
        built_mm3 = volume_mm3(gmsh.model.occ, add_web(gmsh.model.occ, scene))
    assert built_mm3 == pytest.approx(web_volume_mm3(scene.with_drillings(())), rel=rel)


@pytest.mark.parametrize(("along_mm", "across_mm"), [(60.0, 40.0), (52.0, 56.0)])
def test_an_ellipse_of_arcs_is_the_same_ellipse(along_mm: float, across_mm: float) -> None:
    """Longer along the throw or across it: its arcs meet at the ends of the axis across."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    bevel = {"face": "journal", "y_mm": 55.0, "depth_mm": 5.0, "draft_deg": 3.0}
    ellipse = {"outline": "ellipse", "semi_axis_throw_mm": along_mm, "semi_axis_lateral_mm": across_mm}
    web = {**ellipse, "thickness_mm": 19.0, "bevel": [bevel]}
    scene = scene_from_dict(changed_data(data, {"web": web}))
    with cad_session("web") as gmsh:
        body = add_web(gmsh.model.occ, scene)
        gmsh.model.occ.synchronize()
        points = [gmsh.model.getValue(0, tag, []) for _, tag in gmsh.model.getEntities(0)]
        built_mm3 = volume_mm3(gmsh.model.occ, body)
    assert built_mm3 == pytest.approx(web_volume_mm3(scene), rel=1e-7)
    tips = [abs(x) for x, y, _ in points if abs(y - scene.throw.radius_mm / 2) < 1e-9]
    assert len(tips) >= 4
    assert tips == pytest.approx([across_mm] * len(tips))
