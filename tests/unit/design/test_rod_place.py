"""The rod against what it meets: bolts in their bosses, crankpin, fillets, bearings, piston pin, cylinder."""

from __future__ import annotations

import random
import re
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import builtin_designs, load_scene, parse_scene
from cranktopo.design.named import with_values
from cranktopo.design.starting_point import LayoutName
from cranktopo.tasks.designs.beginning import begun

OWN = load_scene("mikron-iiic-rod")
BEARINGS = {"clearance_mm": 0.06}
_SMALLEST_WITH_BOLTS_MM = 20.0
"""Bore of an engine whose big end is wide enough for M3, the smallest thread of the library."""


def refused(changes: dict[str, Any]) -> str:
    with pytest.raises(CranktopoError) as told:
        with_values(OWN, changes)
    return told.value.message


@pytest.mark.parametrize("angle_deg", [0.0, 30.0])
@pytest.mark.parametrize("grip_mm", [15.9, 32.3, 200.0])
def test_a_tapped_bolt_clamps_the_cap_and_ends_in_its_boss(angle_deg: float, grip_mm: float) -> None:
    """Bosses 30.26 above and 16 below, 14 engaged: 16 to 16 + 30.26 - 14; square splits took any grip."""
    told = refused({"rod.split_angle_deg": angle_deg, "rod.bolt.grip_mm": grip_mm})
    assert told.startswith(f"rod.bolt.grip_mm = {grip_mm}: must be 16 to 32.26 mm")


@pytest.mark.parametrize("grip_mm", [16.0, 32.26])
def test_a_tapped_bolt_within_its_bosses_is_taken(grip_mm: float) -> None:
    found = with_values(OWN, {"rod.bolt.grip_mm": grip_mm}).rod
    assert found is not None


def test_a_boss_lower_than_the_engaged_thread() -> None:
    assert "must be at least 14 mm" in refused({"rod.boss_above_mm": 13.0})


@pytest.mark.parametrize("grip_mm", [40.0, 60.0])
def test_a_through_bolt_has_head_and_nut_on_the_bosses(grip_mm: float) -> None:
    nut = {"rod.bolt.held_in": "nut"}
    assert "must be 46.26 mm" in refused({**nut, "rod.bolt.grip_mm": grip_mm})
    with_values(OWN, {**nut, "rod.bolt.grip_mm": 46.26})
    assert "the nuts meet the shank" in refused(
        {**nut, "rod.bolt.grip_mm": 46.26, "rod.shank_big_mm": 50.0, "rod.shank_fillet_mm": 0.0}
    )


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"rod.big_end_bore_mm": 40.0}, "rod.big_end_bore_mm = 40.0: must be above .* crankpin, 42 mm"),
        ({"rod.big_end_bore_mm": 42.0}, "rod.big_end_bore_mm = 42.0: must be above"),
        ({"rod.big_end_bore_mm": 42.05, "bearings": BEARINGS}, "clearance of its bearing, 0.06 mm"),
        ({"rod.big_end_bore_mm": 42.06, "bearings": BEARINGS}, "clearance of its bearing, 0.06 mm"),
        ({"rod.big_end_width_mm": 31.1}, "rod.big_end_width_mm = 31.1: must be at most 31 mm"),
        ({"throw.crankpin.fillet_mm": 3.1}, "rod.big_end_width_mm = 30.0: must be at most 29.8 mm"),
        ({"throw.crankpin.fillet_axial_mm": 3.1}, "rod.big_end_width_mm = 30.0: must be at most 29.8 mm"),
        ({"shape.free.pin_fillet_mm": [2.5, 3.2]}, "shape.free.pin_fillet_mm .* rod.big_end_width_mm"),
        (
            {"bearings": {**BEARINGS, "big_end_width_mm": 30.5}},
            "bearings.big_end_width_mm = 30.5: must be at",
        ),
        ({"rod.pin.length_mm": 95.0}, "rod.pin.length_mm = 95.0: must be below engine.bore_mm, 95 mm"),
        ({"rod.boss_above_mm": 150.0}, "rod.boss_above_mm = 150.0: .* small end"),
        (
            {"rod.bolt.thread": "M36", "rod.bolt_distance_mm": 90.0, "rod.boss_width_mm": 140.0},
            "big_end_width",
        ),
    ],
)
def test_every_dimension_against_its_neighbour(changes: dict[str, Any], told: str) -> None:
    if "rod.bolt.thread" in changes:
        changes |= {"rod.bolt.hole_diameter_mm": 39.6, "rod.bolt.head_diameter_mm": 52.0}
        changes |= {"rod.bolt.member_diameter_mm": 42.0, "rod.bolt.engagement_mm": 16.0}
    assert re.search(told, refused(changes))


def test_a_rod_may_run_on_the_pin_without_shells() -> None:
    """With the clearance of the bearing as the whole thickness."""
    bare = {"rod.shells_kg": 0.0, "rod.big_end_bore_mm": 42.06, "bearings": BEARINGS}
    assert with_values(OWN, bare).rod is not None


def test_built_in_rods_are_taken() -> None:
    assert [name for name in builtin_designs() if load_scene(name, whole=True).rod] == [
        "mikron-iiic-rod",
        "mikron-iiic-rod-h",
        "mikron-iiic-rod-i",
    ]


def with_rod(text: str, tables: str) -> str:
    """The template with the tables of the rod switched on: one `#` off each line."""
    for block in text.split("\n\n"):
        if re.search(rf"(?m)^#\[{tables}\]", block):
            text = text.replace(block, re.sub(r"(?m)^#(?! )", "", block), 1)
    return text


def random_beginnings() -> list[tuple[LayoutName, int, float, float, dict[str, float]]]:
    """Layout, cylinders, bore and stroke, with rods of their own length in half of them."""
    draw = random.Random(7)
    kinds: list[tuple[LayoutName, int]] = [("single", 1), ("in-line", 4), ("V", 8), ("boxer", 4)]
    found: list[tuple[LayoutName, int, float, float, dict[str, float]]] = []
    for _ in range(12):
        bore = round(8.0 * 180 ** draw.random(), 1)
        stroke = round(bore * draw.uniform(0.7, 1.8), 1)
        length = {"rod_length_mm": round(stroke * draw.uniform(1.4, 2.5), 1)} if draw.random() < 0.5 else {}
        found.append((*draw.choice(kinds), bore, stroke, length))
    return found


def test_the_rod_of_every_template_is_sound() -> None:
    """Bolts from the bore on whose big end the smallest thread of ISO 261 fits."""
    for layout, cylinders, bore_mm, stroke_mm, known in random_beginnings():
        text = begun("mine", layout, cylinders, bore_mm, stroke_mm, known).text
        with_bolts = bore_mm >= _SMALLEST_WITH_BOLTS_MM
        tables = r"rod(\.\w+)?" if with_bolts else r"rod(\.(pin|material))?"
        scene = parse_scene(with_rod(text, tables))
        assert scene.rod is not None
        assert scene.rod.pin is not None
        assert (scene.rod.bolt is not None) == with_bolts
        pin_mm = scene.throw.crankpin.outer_diameter_mm
        assert 1.0 < scene.rod.big_end_bore_mm / pin_mm < 1.5


def test_two_rods_on_a_pin_share_it() -> None:
    scene = parse_scene(with_rod(begun("mine", "V", 8, 80.0, 80.0).text, r"rod(\.\w+)?"))
    pin = scene.throw.crankpin
    half_mm = (pin.length_mm - 2 * pin.fillet_mm) / 2
    assert with_values(scene, {"rod.big_end_width_mm": half_mm}).rod is not None
    with pytest.raises(CranktopoError, match="over the 2 rods on it"):
        with_values(scene, {"rod.big_end_width_mm": half_mm + 0.1})
