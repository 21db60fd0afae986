"""`[shape.free]`: ranges that cannot be are refused, and dimensions go where they belong."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.free_dimensions import DIMENSIONS, own_dimension_mm, with_dimensions
from cranktopo.design.loading import designs_folder, parse_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import Layout, scene_at, size_rules, with_free, with_part
from cranktopo.tasks.refit.search import with_stations
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.counterweight.table import Counterweight
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


def scene(free: str) -> Scene:
    return parse_scene(f"{MIKRON}\n[shape.free]\n{free}\n")


@pytest.mark.parametrize(
    ("free", "message"),
    [
        ("pin_filet_mm = [2.5, 5.0]", r"shape.free.pin_filet_mm. Did you mean 'pin_fillet_mm'\?"),
        ("pin_fillet_mm = 3.0", "the least and the greatest value in mm"),
        ("pin_fillet_mm = [2.5, true]", "the least and the greatest value in mm"),
        ("pin_fillet_mm = [5.0, 2.5]", "the least must be smaller than the greatest"),
        ("pin_bore_mm = [-1.0, 30.0]", "both must be >= 0"),
        (f"pin_bore_mm = [0, 1{'0' * 400}]", "both must be >= 0 and <= "),
        ("pin_fillet_mm = [3.0, 5.0]", "own value, throw.crankpin.fillet_mm = 2.5 mm"),
        ("journal_bore_mm = [0, 20]", "own value, throw.main_journal.bore_diameter_mm = 24 mm"),
        ("journal_fillet_mm = [1.2, 5.0]", "within 1.26 and 5.46 mm, 0.03 to 0.13 of the pin's diameter"),
        ("pin_bore_mm = [20, 42]", "throw.crankpin.outer_diameter_mm = 42 mm"),
        ("web_thickness_mm = [18, 37]", "the greatest must be smaller than 36.5 mm"),
        ("pin_fillet_axial_mm = [3.0, 5.0]", "own value, throw.crankpin.fillet_axial_mm = 2.5 mm"),
        ("journal_fillet_axial_mm = [2.5, 5.5]", "within 1.26 and 5.46 mm"),
        ("web_thickness_mm = [18, 36]\njournal_fillet_axial_mm = [2.5, 5]", "which is at least 6 mm"),
        ("web_thickness_mm = [18, 36]\njournal_fillet_mm = [2.5, 5]", "which is at least 6 mm"),
    ],
)
def test_a_range_that_cannot_be_is_refused_with_what_would_do(free: str, message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        scene(free)


def test_a_bore_that_cuts_the_other_fillet_cannot_be_freed() -> None:
    short = MIKRON.replace("radius_mm = 48.0", "radius_mm = 35.0").replace(
        "rod_length_mm = 166", "rod_length_mm = 160"
    )
    for free in ("pin_bore_mm = [20, 30]", "journal_fillet_mm = [2, 3]", "journal_fillet_axial_mm = [2, 3]"):
        with pytest.raises(CranktopoError, match=r"bore_diameter_mm cuts throw\.main_journal.fillet_mm"):
            parse_scene(f"{short}\n[shape.free]\n{free}\n")
    parse_scene(f"{short}\n[shape.free]\nweb_thickness_mm = [18, 20]\n")


def test_the_length_of_an_ellipse_is_its_axial_semi_axis() -> None:
    """A radius that does not lie along the journal may be larger than half of that."""
    short = MIKRON.replace("length_mm = 36.0", "length_mm = 9.0")
    free = "[shape.free]\npin_fillet_mm = [2, 5]"
    with pytest.raises(CranktopoError, match=r"half of throw.crankpin.length_mm, which is at least 9 mm"):
        parse_scene(f"{short}\n{free}\n")
    parse_scene(f"{short}\n{free}\npin_fillet_axial_mm = [2, 4]\n")


def test_each_dimension_goes_to_its_place_and_the_pitch_stays() -> None:
    before = scene("pin_fillet_mm = [2, 5]\nweb_thickness_mm = [18, 24]")
    weight = Counterweight(outer_radius_mm=30.0, half_angle_deg=60.0)
    before = before.model_copy(update={"web": before.web.model_copy(update={"counterweight": weight})})
    values = {name: 3.0 + k for k, name in enumerate(DIMENSIONS)}
    after = with_dimensions(before, values)
    assert {name: own_dimension_mm(after, name) for name in DIMENSIONS} == values
    assert after.pitch_mm == pytest.approx(before.pitch_mm)
    assert after.throw.main_journal.length_mm == pytest.approx(40 + 2 * (19 - 9))
    assert after.throw.crankpin.length_mm == before.throw.crankpin.length_mm
    assert after.web_z_mm[1] == pytest.approx(before.web_z_mm[1])
    assert (after.throw.crankpin.fillet_mm, after.throw.main_journal.fillet_mm) == (3.0, 4.0)
    ellipses = [journal.fillet_axial_mm for journal, _ in after.throw.journals]
    assert ellipses == [6.0, 5.0]
    assert with_dimensions(before, {}) is before


def test_features_and_stations_come_before_the_dimensions_of_the_throw() -> None:
    before = scene("pin_fillet_mm = [2, 5]\njournal_bore_mm = [10, 30]")
    outline = np.array([-27.0, 76.0, 18.0, 30.0, 28.0, 27.0, 17.0])
    layout, values = with_free(Layout(7), outline, before, ("pin_fillet", "journal_bore"))
    assert list(values[7:]) == [2.5, 24.0]
    more, grown = with_part(layout, values, FittedBevel("pin"), np.array([-1.0, 8.0, 0.5]))
    assert list(grown[7:]) == [-1.0, 8.0, 0.5, 2.5, 24.0]
    assert more.names[7:] == (
        "bevel-pin.y",
        "bevel-pin.depth",
        "bevel-pin.crown",
        "pin_fillet",
        "journal_bore",
    )
    assert list(with_stations(more, grown, 9)[9:]) == list(grown[7:])
    grown[-2:] = [4.0, 20.0]
    sized = scene_at(before, more, grown)
    assert (sized.throw.crankpin.fillet_mm, sized.throw.main_journal.bore_diameter_mm) == (4.0, 20.0)
    assert scene_at(before, Layout(7), outline) is before


def test_the_rules_of_the_thickness_are_the_same_at_every_thickness() -> None:
    """Their slopes are differences: at the greatest thickness a rule may not come or go."""
    free = scene("web_thickness_mm = [18, 24]")
    outline = np.array([-27.0, 76.0, 18.0, 30.0, 28.0, 27.0, 17.0])
    layout, values = with_free(Layout(7), outline, free, ("web_thickness",))
    layout, values = with_part(layout, values, FittedBevel("pin"), np.array([-1.0, 8.0, 0.5]))
    found = []
    for thickness in (17.999, 18.0, 21.0, 24.0, 24.001):
        values[-1] = thickness
        found.append([name for name, _ in size_rules(layout, values, free, ManufacturingLimits())])
    assert found[0]
    assert all(names == found[0] for names in found)


@pytest.mark.parametrize(
    ("bearings", "free", "message"),
    [
        (
            "width_mm = 34",
            "web_thickness_mm = [17, 24]",
            "web_thickness_mm = 24, .*at most 25 mm, the journal",
        ),
        (
            "width_mm = 34",
            "journal_fillet_mm = [2, 4.5]",
            "journal_fillet_mm = 4.5, .*at most 31 mm, the journal",
        ),
        (
            "big_end_width_mm = 30",
            "pin_fillet_mm = [2, 4.5]",
            "pin_fillet_mm = 4.5, .*at most 27 mm, the journal",
        ),
        (
            "groove_mm = 30",
            "web_thickness_mm = [17, 26]",
            "web_thickness_mm = 26, .*leaves each film of a 21 mm",
        ),
    ],
)
def test_bearings_fit_beside_the_greatest_dimensions(bearings: str, free: str, message: str) -> None:
    """Lengths between the fillets: 35 mm of the main journal, 31 mm of the crankpin."""
    with_bearings = f"{MIKRON}\n[bearings]\nclearance_mm = 0.05\n"
    with pytest.raises(CranktopoError, match=message):
        parse_scene(f"{with_bearings}{bearings}\n[shape.free]\n{free}\n")
    parse_scene(f"{with_bearings}\n[shape.free]\n{free}\n")
