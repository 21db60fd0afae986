"""The coarse ring states an error that grows with the move, and says nothing too far away."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.design.edits import changed_data
from cranktopo.design.loading import design_text
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.coarse_error import stated_errors

DATA = parse_toml(design_text("mikron-iiic"), "web")


def stated(changes: dict[str, Any], percent: float = 0.0) -> dict[str, float]:
    return stated_errors(DATA, changed_data(DATA, changes), {"torsion": percent, "bending_per_mass": percent})


def test_it_grows_with_the_change_and_with_fillets() -> None:
    least = stated({})
    assert 0 < least["torsion"] < least["bending_per_mass"]
    assert stated({}, -5.0)["bending_per_mass"] > least["bending_per_mass"]
    assert stated({"throw.crankpin.fillet_mm": 2.9})["torsion"] > 2 * least["torsion"], "cells have no fillet"


def test_where_a_fillet_may_move_a_stiffness_by_more_than_a_percent_none_is_told() -> None:
    """The pin fillet of an engine by 0.98 mm: +1.4 % torsion, +1.3 % bending by elements, 0 by cells."""
    assert stated({"throw.crankpin.fillet_mm": 2.6}).keys() == {"torsion", "bending_per_mass"}
    assert stated({"throw.crankpin.fillet_mm": 2.9}).keys() == {"torsion"}
    assert stated({"throw.crankpin.fillet_mm": 3.48}) == {}
    assert stated({"web.width_mm": 52}, -12.0).keys() == {"torsion", "bending_per_mass"}, "cells see a width"


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


@pytest.mark.parametrize("factor", [0.1, 0.5])
def test_a_smaller_throw_has_the_same_error(factor: float) -> None:
    """Stiffnesses of like bodies change alike; the fillet of a model engine was judged by its millimetres."""
    change = {"throw.crankpin.fillet_mm": 2.9}
    found = stated_errors(sized(DATA, factor), sized(changed_data(DATA, change), factor), {"torsion": 0.0})
    assert found["torsion"] == pytest.approx(stated(change)["torsion"])


def test_a_small_throw_has_a_shorter_way() -> None:
    small = sized(DATA, 0.2)
    for way, tells in ((0.9, True), (1.1, False)):
        moved = changed_data(small, {"web.width_mm": small["web"]["width_mm"] + way})
        assert bool(stated_errors(small, moved, {"torsion": 0.0})) is tells
