"""Tables of a shaft's bearings and of the parts on its ends: columns are there where there are values."""

from __future__ import annotations

from cranktopo.tasks.shaft.result import CarriedMotion, ContinuousShaft, ShaftBearing, ShaftBigEnds
from cranktopo.tasks.shaft_safety.text import bearing_table, carried_table


def shaft(**of_bearing: float) -> ContinuousShaft:
    rest = {"largest_N": 1e4, "at_deg": 10.0, "halves_N": 2e4, "tilt_mrad": 0.1, "offset_um": 20.0}
    bearing = ShaftBearing(bearing=1, **{**rest, **of_bearing})
    part = CarriedMotion(part="flywheel", offset_um=170.2, tilt_mrad=2.84)
    return ContinuousShaft(
        speed_rpm=2100.0,
        spring_N_per_mm=None,
        webs=(),
        main_bearings=(bearing,),
        big_ends=ShaftBigEnds(tilt_mrad=(0.3, 0.41)),
        carried=(part,),
    )


def test_the_life_of_rollers_has_a_column_of_its_own() -> None:
    assert "life_h" not in bearing_table(shaft()).columns
    table = bearing_table(shaft(life_h=283.4))
    assert table.columns["life_h"] == 0
    assert table.rows[0]["life_h"] == 283.4
    assert "reference_life_h" not in table.columns
    assert bearing_table(shaft(life_h=283.4, reference_life_h=12.5)).rows[0]["reference_life_h"] == 12.5


def test_parts_on_the_ends_have_offset_and_tilt() -> None:
    table = carried_table(shaft())
    assert list(table.rows) == [{"part": "flywheel", "offset_um": 170.2, "tilt_mrad": 2.84}]
