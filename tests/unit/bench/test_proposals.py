"""What the bench proposes: a counterweight with its room, and journals that keep the pitch."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import design_text, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.live import violated_rules_of
from cranktopo.tasks.bench.proposals import (
    counterweight_changes,
    freed_changes,
    nearest_sound,
    rod_changes,
    trace_changes,
    with_pitch_kept,
)

TWIN = {"layout": "V", "cylinders": 2, "bore_mm": 100, "stroke_mm": 67.5, "rod_length_mm": 124}


@cache
def twin() -> dict[str, Any]:
    return parse_toml(new_design(TWIN)[0], "twin")


def test_a_counterweight_has_its_room_and_the_wanted_balance() -> None:
    light = {"throw.crankpin.outer_diameter_mm": 44, "throw.main_journal.outer_diameter_mm": 48}
    light |= {"throw.crankpin.length_mm": 44, "web.width_mm": 64, "web.thickness_mm": 22}
    data = changed_data(twin(), light)
    changes = counterweight_changes(data, 10)
    assert changes["envelope.y_min_mm"] <= -changes["web.counterweight.outer_radius_mm"]
    scene = scene_from_dict(changed_data(data, changes), "twin", whole=True)
    assert throw_balance(scene).balance_factor_percent == pytest.approx(10, abs=0.1)
    own = throw_balance(scene).own_counterweight_kg_mm
    assert abs(throw_balance(scene).counterweight_kg_mm) < 2e-3 * own, "what it balances is what is asked for"
    with pytest.raises(CranktopoError, match="no outer radius"):
        counterweight_changes(data, 1e4)


def test_journals_give_what_webs_take_where_the_pitch_stays() -> None:
    changes = with_pitch_kept(twin(), {"web.thickness_mm": 28})
    assert changes == {"web.thickness_mm": 28, "throw.main_journal.length_mm": pytest.approx(33 - 2 * 2)}
    assert with_pitch_kept(twin(), {"web.width_mm": 88}) == {"web.width_mm": 88}


def test_a_rod_fits_engine_and_crankpin() -> None:
    """Its beginning was that of an example: a big end narrower than the pin of most engines."""
    moved = changed_data(twin(), rod_changes(twin()))
    scene = scene_from_dict(moved, "twin", whole=True)
    assert scene.rod is not None
    pin = scene.throw.crankpin
    assert scene.rod.big_end_bore_mm > pin.outer_diameter_mm
    assert 2 * scene.rod.big_end_width_mm < pin.length_mm, "two rods stand side by side on the pin of a V"
    del moved["engine"], moved["rod"]
    with pytest.raises(CranktopoError, match=r"rod: takes its size from the engine.*\s+Add the engine"):
        rod_changes(moved)


def test_a_dropped_trace_takes_the_place_of_the_peak(tmp_path: Path) -> None:
    angle = np.arange(0, 720, 2.0)
    bar = 1 + 60 * np.exp(-(((angle - 372) / 25) ** 2))
    trace = tmp_path / "trace.csv"
    rows = [f"{a},{p:.3f}" for a, p in zip(angle, bar, strict=True)]
    trace.write_text("\n".join(["crank_angle_deg,pressure_bar", *rows]), encoding="utf-8")
    moved = changed_data(twin(), trace_changes(twin(), str(trace)))
    assert moved["engine"]["gas"]["indicator_csv"] == str(trace)
    assert "peak_pressure_MPa" not in moved["engine"]["gas"]
    trace.write_text("angle,force\n1,2\n", encoding="utf-8")
    with pytest.raises(CranktopoError, match=r"trace\.csv"):
        trace_changes(twin(), str(trace))


def test_the_nearest_value_that_keeps_the_rules_is_sound_and_the_next_is_not() -> None:
    """The fillet of a journal needs a shoulder: a web that gets too narrow stops where it still fits."""
    data = parse_toml(design_text("mikron-iiic-plain"), "own")
    (key,) = wanted = {"web.width_mm": 40.0}
    found = nearest_sound(data, wanted)[key]
    assert wanted[key] < found < data["web"]["width_mm"]
    assert violated_rules_of(changed_data(data, {key: found})) == []
    assert violated_rules_of(changed_data(data, {key: found - 0.02})) != []
    assert nearest_sound(changed_data(data, {key: found}), wanted) == {}, "at the rule already"


def test_a_dimension_is_freed_in_a_range_that_the_rules_allow_or_it_is_said_why_not() -> None:
    """The fillet of 2 mm may not fall below 0.03 of the pin's 48 mm, 1.44 mm (IACS UR M53): 20 %, no more."""
    diesel = parse_toml(design_text("car-diesel"), "design")
    assert diesel["throw"]["crankpin"]["fillet_mm"] == 2.0
    changes = freed_changes(diesel, "throw.crankpin.fillet_mm")
    assert changes == {"shape.free.pin_fillet_mm": [1.6, 2.6]}
    assert violated_rules_of(changed_data(diesel, changes)) == []
    assert freed_changes(diesel, "throw.crankpin.bore_diameter_mm")["shape.free.pin_bore_mm"][0] == 0
    gas = parse_toml(design_text("industrial-gas"), "design")
    with pytest.raises(CranktopoError, match="rounded outlets, which cannot move with the journals"):
        freed_changes(gas, "throw.crankpin.fillet_mm")
    with pytest.raises(CranktopoError, match="no range of this dimension"):
        freed_changes(gas, "web.width_mm")
