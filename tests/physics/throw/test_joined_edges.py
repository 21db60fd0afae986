"""Side pockets with rounded corners in an elliptical web: the kernel leaves edges of 1e-4 mm."""

from __future__ import annotations

import pytest

from cranktopo.bodies.solid import joined
from cranktopo.bodies.solid.throw import add_half_throw
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session

POCKET = {
    "shape": "side",
    "y_mm": 39.34354245804579,
    "length_mm": 30.130763162558814,
    "height_mm": 8.725901608957656,
    "depth_mm": 11.519272208011104,
    "offset_mm": -0.4233415572003744,
    "corner_radius_mm": 2.853725057989415,
}


@pytest.fixture(scope="module")
def slotted() -> Scene:
    material = load_scene("mikron-iiic-plain").material.model_dump(exclude_none=True)
    main = {"outer_diameter_mm": 79.3, "bore_diameter_mm": 28.2, "length_mm": 54.05661737832937}
    pin = {"outer_diameter_mm": 66.9, "length_mm": 51.3}
    web = {
        "thickness_mm": 34.96201436177011,
        "outline": "ellipse",
        "semi_axis_throw_mm": 117.22093996086008,
        "semi_axis_lateral_mm": 71.2268731687466,
        "pocket": [POCKET],
    }
    throw = {"radius_mm": 75.25105388781611, "main_journal": main, "crankpin": pin}
    return scene_from_dict({"name": "slotted", "throw": throw, "web": web, "material": material})


def _shortest_mm(scene: Scene) -> float:
    with cad_session("slotted") as gmsh:
        body = add_half_throw(gmsh.model.occ, scene)
        assert gmsh.model.occ.getMass(*body[0]) == pytest.approx(half_throw_volume_mm3(scene), rel=1e-6)
        return joined.shortest_edge_mm(gmsh.model.occ, body)


def test_points_near_each_other_are_one(slotted: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    assert _shortest_mm(slotted) > 0.01
    monkeypatch.setattr(joined, "_SHORT_MM", 0.0)
    assert 0 < _shortest_mm(slotted) < 1e-3, "the kernel joins them by itself: the second try can go"
