"""The solid of the live picture is the throw, to a few thousandths, and one piece."""

from __future__ import annotations

import pytest

from cranktopo.bodies.shown_solid import display_half
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.halves import halves
from cranktopo.design.loading import builtin_designs, load_scene, parse_scene
from cranktopo.design.reference import template


@pytest.mark.parametrize("name", builtin_designs())
def test_it_has_the_volume_of_the_throw(name: str) -> None:
    for half in halves(load_scene(name, whole=True)):
        solid = display_half(half)
        assert solid.volume() == pytest.approx(half_throw_volume_mm3(half), rel=2e-3)
        assert len(solid.decompose()) == 1


@pytest.mark.parametrize(
    "outline",
    [
        {"outline": "rectangle", "width_mm": 60.0, "overhang_mm": 30.0, "corner_radius_mm": 8.0},
        {"outline": "ellipse", "semi_axis_throw_mm": 60.0, "semi_axis_lateral_mm": 40.0},
        {
            "outline": "profile",
            "stations_mm": [-24.0, -15.0, 5.0, 24.0, 45.0, 64.0, 72.0],
            "half_widths_mm": [0.0, 25.0, 31.0, 34.0, 30.0, 25.0, 0.0],
        },
        {
            "outline": "profile",
            "stations_mm": [-30.0, -15.0, 24.0, 64.0, 78.0],
            "half_widths_mm": [24.0, 27.0, 34.0, 30.0, 22.0],
        },
        {"outline": "tapered", "main_radius_mm": 34.0, "pin_radius_mm": 30.0},
    ],
)
def test_every_outline(outline: dict[str, object]) -> None:
    from cranktopo.design.loading import parse_toml, scene_from_dict

    data = parse_toml(template("any"), "any")
    data["web"] = {"thickness_mm": 19.0, **outline}
    scene = scene_from_dict(data)
    assert display_half(scene).volume() == pytest.approx(half_throw_volume_mm3(scene), rel=2e-3)
    assert parse_scene(template("any"), "any").name == "any"
