"""The coarse ring states an error that grows with the move, and says nothing too far away."""

from __future__ import annotations

from typing import Any

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
    assert stated({"throw.crankpin.fillet_mm": 3.5})["torsion"] > 2 * least["torsion"], "cells have no fillet"


def test_too_far_away_there_is_none() -> None:
    thickness = DATA["web"]["thickness_mm"]
    assert stated({"web.thickness_mm": thickness + 4.9})
    assert stated({"web.thickness_mm": thickness + 5.1}) == {}
    assert stated({"web.counterweight": {"outer_radius_mm": 60.0, "half_angle_deg": 60.0}}) == {}, (
        "another web"
    )
    assert stated({"engine.speed_rpm": 3000}), "an engine does not change a stiffness"
