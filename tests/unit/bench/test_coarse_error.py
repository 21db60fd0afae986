"""The coarse ring states an error that grows with the move, and says nothing too far away."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.design.edits import changed_data
from cranktopo.design.loading import design_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.coarse_error import MOST_PERCENT, stated_errors

DATA = parse_toml(design_text("mikron-iiic"), "web")


def stated(changes: dict[str, Any], percent: float = 0.0) -> dict[str, float]:
    change = {"torsion": percent, "bending": percent, "bending_per_mass": 0.0}
    return stated_errors(DATA, changed_data(DATA, changes), change)


WIDER = {"web.width_mm": 52.0}


def test_it_grows_with_the_change_until_nothing_is_told() -> None:
    errors = [stated(WIDER, percent).get("bending", 99.0) for percent in (0.0, 1.0, -1.4, 5.0)]
    assert 0 < errors[0] < errors[1] < errors[2] <= MOST_PERCENT
    assert errors[3] == 99.0
    assert "torsion" in stated(WIDER, 5.0), "which cells see better"


def test_a_stiffness_per_mass_has_the_error_of_the_stiffness() -> None:
    """A web that gains as much stiffness as mass keeps its ratio, not its error."""
    found = stated(WIDER, 1.4)
    assert found["bending_per_mass"] == found["bending"]
    assert "bending_per_mass" not in stated(WIDER, 5.0)


def test_dimensions_that_move_together_add_their_errors() -> None:
    both = WIDER | {"throw.main_journal.length_mm": 41.0}
    alone = [stated({key: value}, 0.5)["bending"] for key, value in both.items()]
    assert max(alone) < stated(both, 0.5)["bending"] < sum(alone)


def test_of_the_radius_of_a_throw_the_way_counts() -> None:
    """Of a hollow throw whose radius was 5 % less cells told 1.3 % of the 3.4 % that it was stiffer."""
    first = DATA["throw"]["radius_mm"]
    assert stated({"throw.radius_mm": 0.95 * first}, 1.3).keys() == set()
    assert stated({"throw.radius_mm": 0.995 * first}, 0.1)["bending"] > 0.5


def test_cells_tell_more_of_a_wider_counterweight_than_elements() -> None:
    """Of the car-diesel's, 9.4 deg wider: 0.65 % in torsion by cells, 0.05 % by elements."""
    first = changed_data(DATA, {"web.counterweight": {"outer_radius_mm": 60.0, "half_angle_deg": 60.0}})
    wider = changed_data(first, {"web.counterweight.half_angle_deg": 69.4})
    assert stated_errors(first, wider, {"torsion": 0.65})["torsion"] > 0.65 - 0.05


@pytest.mark.parametrize("key", ["fillet_axial_mm", "recess_mm"])
def test_of_what_was_not_measured_there_is_none(key: str) -> None:
    first = changed_data(DATA, {f"throw.crankpin.{key}": 1.0})
    moved = changed_data(first, {f"throw.crankpin.{key}": 1.2})
    assert stated_errors(first, moved, {"torsion": 0.1}) == {}


def test_too_far_away_there_is_none() -> None:
    thickness = DATA["web"]["thickness_mm"]
    assert stated({"web.thickness_mm": thickness + 4.9})
    assert stated({"web.thickness_mm": thickness + 5.1}) == {}
    assert stated({"web.counterweight": {"outer_radius_mm": 60.0, "half_angle_deg": 60.0}}) == {}, (
        "another web"
    )
    assert stated({"engine.speed_rpm": 3000}), "an engine does not change a stiffness"


def sized(data: Any, factor: float) -> Any:
    """The same tables for a throw of another size."""
    if isinstance(data, dict):
        return {
            key: value * factor
            if key.endswith("_mm") and isinstance(value, int | float)
            else sized(value, factor)
            for key, value in data.items()
        }
    return [sized(one, factor) for one in data] if isinstance(data, list) else data


def test_a_small_throw_has_a_shorter_way() -> None:
    small = sized(DATA, 0.2)
    for way, tells in ((0.9, True), (1.1, False)):
        moved = changed_data(small, {"web.width_mm": small["web"]["width_mm"] + way})
        assert bool(stated_errors(small, moved, {"torsion": 0.0})) is tells
