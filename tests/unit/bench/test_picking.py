"""A line of sight meets a feature: what is named is what the design says of that place."""

from __future__ import annotations

import math
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import builtin_designs, design_text, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.picking import Sight, picked
from cranktopo.tasks.bench.placing import placed_pocket
from cranktopo.throw.web import web_bodies

PLAIN = parse_toml(design_text("mikron-iiic-plain"), "design")
SCENE = scene_from_dict(PLAIN, "design", whole=True)
(START, END), RADIUS = SCENE.web_z_mm, SCENE.throw.radius_mm
MIDDLE = (START + END) / 2
MAIN, PIN = "throw.main_journal", "throw.crankpin"
"""The plain web is an obround of 50 mm: flanks at x = 25 mm, ends 25 mm beyond each axis."""


def seen(data: dict[str, Any], start: tuple[float, ...], to: tuple[float, ...], **shown: Any) -> Any:
    along = [b - a for a, b in zip(start, to, strict=True)]
    return picked(data, {"start": list(start), "along": along, **shown})


@pytest.mark.parametrize(
    ("start", "to", "key"),
    [
        ((300, 24, MIDDLE), (0, 24, MIDDLE), "web.width_mm"),
        ((0, -300, MIDDLE), (0, 0, MIDDLE), "web.width_mm"),
        ((300, 0, 8), (0, 0, 8), f"{MAIN}.outer_diameter_mm"),
        ((300, 0, START - 1), (0, 0, START - 1), f"{MAIN}.fillet_mm"),
        ((300, RADIUS, 50), (0, RADIUS, 50), f"{PIN}.outer_diameter_mm"),
        ((300, RADIUS, END + 1), (0, RADIUS, END + 1), f"{PIN}.fillet_mm"),
        ((16, 0, -300), (16, 0, 0), f"{MAIN}.length_mm"),
        ((0, 0, -10), (0, 14, 10), f"{MAIN}.bore_diameter_mm"),
        ((0, 0, 0), (0, 14, MIDDLE), f"{MAIN}.bore_diameter_mm"),
    ],
)
def test_a_plain_web_and_its_journals_are_told_apart(start: Any, to: Any, key: str) -> None:
    assert seen(PLAIN, start, to) == {"key": key}


@pytest.mark.parametrize(
    ("table", "start", "to", "key"),
    [
        ({"shape": "cylinder", "x_mm": 16, "y_mm": 24, "diameter_mm": 8}, (13, 24, 0), (20, 24, 30), "[0]"),
        (
            {
                "shape": "box",
                "face": "pin",
                "x_mm": 0,
                "y_mm": 24,
                "size_x_mm": 9,
                "size_y_mm": 9,
                "depth_mm": 5,
            },
            (0, 24, 300),
            (0, 24, 0),
            "[0]",
        ),
        (
            {"shape": "side", "y_mm": 24, "length_mm": 20, "height_mm": 8, "depth_mm": 6},
            (300, 24, MIDDLE),
            (0, 24, MIDDLE),
            "[0]",
        ),
    ],
)
def test_a_pocket_is_named_by_its_wall_or_floor(table: Any, start: Any, to: Any, key: str) -> None:
    data = changed_data(PLAIN, {"web.pocket[0]": table})
    assert seen(data, start, to) == {"key": f"web.pocket{key}"}
    assert seen(data, (300, -10, MIDDLE), (0, -10, MIDDLE)) == {"key": "web.width_mm"}, "beside it"


def test_bevel_counterweight_and_drilling_are_named() -> None:
    bevelled = parse_toml(design_text("mikron-iiic"), "design")
    assert seen(bevelled, (16, 300, START + 1), (16, 0, START + 1)) == {"key": "web.bevel[0]"}
    diesel = parse_toml(design_text("car-diesel"), "design")
    assert seen(diesel, (0, -300, 22), (0, 0, 22)) == {"key": "web.counterweight"}
    gas = parse_toml(design_text("industrial-gas"), "design")
    scene = scene_from_dict(gas, "design", whole=True)
    assert gas["throw"]["drilling"][0]["to"] == {"on": "crankpin", "angle_deg": 0.0, "place_mm": 15.0}
    outlet = scene.pitch_mm / 2 - 15.0
    assert seen(gas, (0, 600, outlet), (0, 95, outlet)) == {"key": "throw.drilling[0]"}


def test_a_web_face_tells_where_it_was_met() -> None:
    face = seen(PLAIN, (22, 24, 300), (22, 24, 0))
    assert face == {"key": "web.thickness_mm", "face": "pin", "x_mm": 22, "y_mm": 24, "side": "first"}
    assert seen(PLAIN, (22, 24, -300), (22, 24, 0))["face"] == "journal"
    assert seen(PLAIN, (300, 200, 0), (300, 201, 0)) == {}
    assert seen(PLAIN, (40, 24, 300), (40, 24, 0)) == {}, "beside the web"


def test_what_is_not_shown_is_not_met() -> None:
    from_beyond = (22, 24, 57), (22, 24, 300)
    assert seen(PLAIN, *from_beyond) == {}
    assert seen(PLAIN, *from_beyond, whole=True)["face"] == "pin"
    flank = (300, 24, MIDDLE), (0, 24, MIDDLE)
    assert seen(PLAIN, *flank, section=20.0) == {}, "the section itself"
    assert seen(PLAIN, (-300, 24, MIDDLE), (0, 24, MIDDLE), section=20.0) == {"key": "web.width_mm"}
    with pytest.raises(ValueError, match="vectors"):
        Sight.of({"start": [0, 0], "along": [0, 0, 1]})
    with pytest.raises(ValueError, match="vectors"):
        Sight.of({"start": [0, 0, math.nan], "along": [0, 0, 1]})


def test_of_two_webs_that_differ_the_second_has_its_own_keys() -> None:
    own = {**PLAIN["web"], "width_mm": 56.0}
    data = changed_data(PLAIN, {"second_web": own})
    height = 2 * 57 - MIDDLE
    assert seen(data, (300, 24, height), (0, 24, height), whole=True) == {"key": "second_web.width_mm"}
    assert seen(data, (300, 24, MIDDLE), (0, 24, MIDDLE), whole=True) == {"key": "web.width_mm"}


def test_of_a_crank_each_throw_is_met_where_it_is_turned() -> None:
    """The pin of a throw stands where its angle puts it, by the frame alone: a turn from +y toward +x."""
    data = parse_toml(design_text("car-diesel"), "design")
    scene = scene_from_dict(data, "design", whole=True)
    number = next(i for i, angle in enumerate(scene.shaft_angles_deg) if angle)
    turn = math.radians(scene.shaft_angles_deg[number])
    x, y = scene.throw.radius_mm * math.sin(turn), scene.throw.radius_mm * math.cos(turn)
    z = (number + 0.5) * scene.pitch_mm - 3
    found = seen(data, (x + 300, y, z), (x, y, z), crank=True)
    assert found == {"key": "throw.crankpin.outer_diameter_mm"}


@pytest.mark.parametrize("kind", ["hole", "pocket"])
def test_a_new_pocket_keeps_the_rules_and_lies_in_the_outline(kind: str) -> None:
    place = {"face": "pin", "x_mm": 24.0, "y_mm": 24.3, "side": "first"}
    ((key, table),) = placed_pocket(PLAIN, kind, place).items()
    assert key == "web.pocket[0]"
    scene = scene_from_dict(changed_data(PLAIN, {key: table}), "design", whole=True)
    (body,) = (one for one in web_bodies(scene) if one.key == key)
    size = table.get("diameter_mm") or table["size_x_mm"]
    assert table["x_mm"] + size / 2 <= 25
    assert body.distance_mm(0.0, MIDDLE) > 23.4, "clear of the journal and its fillet"
    assert table["y_mm"] % 0.5 == 0
    again = placed_pocket(changed_data(PLAIN, {key: table}), kind, {**place, "x_mm": -20.0})
    assert list(again) == ["web.pocket[1]"]


def test_near_the_middle_it_is_put_in_the_middle_and_without_room_refused() -> None:
    place = {"face": "pin", "x_mm": 2.0, "y_mm": -15.0, "side": "first"}
    ((_, table),) = placed_pocket(PLAIN, "pocket", place).items()
    assert table["x_mm"] == 0
    gas = parse_toml(design_text("industrial-gas"), "design")
    with pytest.raises(CranktopoError, match=r"hole: none of 9\.5 mm and more has room near x = 1\.0"):
        placed_pocket(gas, "hole", {**place, "x_mm": 1.0, "y_mm": 24.0})


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in builtin_designs() if "balancer" not in name])
def test_every_place_of_a_built_in_throw_has_a_name(name: str) -> None:
    data = parse_toml(design_text(name), "design")
    radius = scene_from_dict(data, "design", whole=True).throw.radius_mm
    for number in range(24):
        turn, lift = 2.4 * number, -1 + (number + 0.5) / 12
        out = (math.cos(turn) * math.sqrt(1 - lift**2), lift, math.sin(turn) * math.sqrt(1 - lift**2))
        middle = (0.0, radius / 2, MIDDLE)
        start = tuple(m + 20 * radius * o for m, o in zip(middle, out, strict=True))
        found = seen(data, start, middle)
        assert found == {} or found["key"].startswith(("web.", "throw.")), (name, out)
