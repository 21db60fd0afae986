"""The solid of the live picture is the throw, to a few thousandths, and one piece."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.bodies.shown_solid import display_half
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.halves import halves
from cranktopo.design.loading import builtin_designs, load_scene, parse_scene, scene_from_dict
from cranktopo.design.reference import template
from cranktopo.design.toml_text import parse_toml
from tests.unit.throw.counterweight_cases import PLAIN, roomy_scene, weighted


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
    data = parse_toml(template("any"), "any")
    data["web"] = {"thickness_mm": 19.0, **outline}
    scene = scene_from_dict(data)
    assert display_half(scene).volume() == pytest.approx(half_throw_volume_mm3(scene), rel=2e-3)
    assert parse_scene(template("any"), "any").name == "any"


def test_a_flank_of_many_stations_has_no_more_chords_than_it_turns() -> None:
    """A crank read from a STEP has some seventeen stations, each of which had 32 chords a side."""
    data = parse_toml(template("any"), "any")
    places = np.linspace(-30.0, 78.0, 17)
    halves_mm = np.sqrt(np.maximum(54.0**2 - (places - 24.0) ** 2, 0.0)) * 0.6
    data["web"] = {"thickness_mm": 19.0, "outline": "profile"}
    data["web"] |= {"stations_mm": places.tolist(), "half_widths_mm": halves_mm.tolist()}
    scene = scene_from_dict(data)
    solid = display_half(scene)
    assert solid.volume() == pytest.approx(half_throw_volume_mm3(scene), rel=2e-3)
    assert solid.num_tri() < 4000


def test_the_bevelled_edge_of_a_counterweight_is_shown() -> None:
    """Its tool is swept from a plane that is oblique to all axes; the whole picture was empty."""
    edge = {"flanks": "both", "face": "both", "width_mm": 6.0, "depth_mm": 5.0, "length_mm": 20.0}
    scene = weighted(roomy_scene(load_scene("mikron-iiic-plain")), {**PLAIN, "edge": edge})
    assert display_half(scene).volume() == pytest.approx(half_throw_volume_mm3(scene), rel=2e-3)
