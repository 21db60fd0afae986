"""A design begins with six answers; what is proposed besides is sound, and power gives the pressure."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import parse_scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.performance import power_kW
from cranktopo.tasks.bench.forms import form_reference, new_design

TWIN: dict[str, Any] = {"layout": "V", "cylinders": 2, "bore_mm": 100, "stroke_mm": 67.5, "speed_rpm": 11500}


def test_answers_become_a_design() -> None:
    text, name, command = new_design({**TWIN, "rod_length_mm": 124, "peak_pressure_MPa": 9.5, "name": "twin"})
    scene = parse_scene(text, name)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    assert (scene.engine.rod_length_mm, scene.engine.gas.peak_pressure_MPa) == (124, 9.5)
    assert scene.envelope is not None, "an optimiser has room"
    assert (
        command == "cranktopo designs new twin.toml --layout=V --cylinders=2 --bore-mm=100 --stroke-mm=67.5"
    )


def test_power_gives_the_pressure() -> None:
    answers = {"layout": "in-line", "cylinders": 6, "bore_mm": 320, "stroke_mm": 480, "speed_rpm": 750}
    text, name, _ = new_design({**answers, "power_kW": 3000})
    found = analyse(parse_scene(text, name))
    assert found.cycle is not None
    assert power_kW(found.cycle.indicated_work_J, found.engine) == pytest.approx(3000, rel=5e-3)


def test_power_and_peak_give_the_intake_pressure() -> None:
    answers = {"layout": "in-line", "cylinders": 6, "bore_mm": 320, "stroke_mm": 480, "speed_rpm": 750}
    text, name, _ = new_design({**answers, "power_kW": 6000, "peak_pressure_MPa": 20})
    scene = parse_scene(text, name)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    assert scene.engine.gas.peak_pressure_MPa == 20
    found = analyse(scene)
    assert found.cycle is not None
    assert power_kW(found.cycle.indicated_work_J, found.engine) == pytest.approx(6000, rel=5e-3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"layout": "W"}, "layout"),
        ({"bore_mm": "wide"}, "bore_mm"),
        ({"cylinders": 7}, "--cylinders 7"),
        ({"power_kW": 1e6}, "power_kW"),
        ({"name": "///"}, "name"),
    ],
    ids=["layout", "bore", "cylinders", "power", "name"],
)
def test_bad_answers_are_one_line(change: dict[str, Any], said: str) -> None:
    with pytest.raises(CranktopoError, match=said):
        new_design({**TWIN, **change})


def test_forms_have_every_table_of_the_schema() -> None:
    tables = form_reference()
    assert {"throw.main_journal", "web.pocket", "engine.gas", "goal.limits"} <= {
        table["path"] for table in tables
    }
    width = next(key for table in tables for key in table["keys"] if key["name"] == "width_mm")
    assert (width["unit"], width["required"]) == ("mm", True)
