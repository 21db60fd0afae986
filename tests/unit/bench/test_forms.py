"""A design begins with six answers; what is proposed besides is sound, and power gives the pressure."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import UNITS
from cranktopo.design.loading import parse_scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.performance import implausible, power_kW
from cranktopo.tasks.bench.forms import form_reference, new_design, read_upload

TWIN: dict[str, Any] = {"layout": "V", "cylinders": 2, "bore_mm": 100, "stroke_mm": 67.5, "speed_rpm": 11500}
SIX: dict[str, Any] = {
    "layout": "in-line",
    "cylinders": 6,
    "bore_mm": 320,
    "stroke_mm": 480,
    "speed_rpm": 750,
}


def test_answers_become_a_design() -> None:
    text, name, command, assumed = new_design(
        {**TWIN, "rod_length_mm": 124, "peak_pressure_MPa": 9.5, "name": "twin"}
    )
    scene = parse_scene(text, name)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    assert (scene.engine.rod_length_mm, scene.engine.gas.peak_pressure_MPa) == (124, 9.5)
    assert scene.envelope is not None, "an optimiser has room"
    given = "--bore-mm=100 --stroke-mm=67.5 --speed-rpm=11500 --rod-length-mm=124 --peak-pressure-MPa=9.5"
    assert command == f"cranktopo designs new twin.toml --layout=V --cylinders=2 {given}", (
        "all that was entered"
    )
    assert "compression ratio 9, burn duration 60 deg" in assumed[1], "what nobody asked for is said"


def test_power_gives_the_pressure() -> None:
    text, name, *_ = new_design({**SIX, "power_kW": 3000})
    found = analyse(parse_scene(text, name))
    assert found.cycle is not None
    assert power_kW(found.cycle.indicated_work_J, found.engine) == pytest.approx(3000, rel=5e-3)


def test_power_and_peak_give_the_intake_pressure() -> None:
    text, name, *_ = new_design({**SIX, "power_kW": 6000, "peak_pressure_MPa": 20})
    scene = parse_scene(text, name)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    assert scene.engine.gas.peak_pressure_MPa == 20
    found = analyse(scene)
    assert found.cycle is not None
    assert power_kW(found.cycle.indicated_work_J, found.engine) == pytest.approx(6000, rel=5e-3)


def test_a_power_that_the_intake_alone_cannot_give_is_given_by_compression_and_burning() -> None:
    """3150 kW at 20 MPa: a diesel. With the ratio and the burning of a petrol engine it had 5380 at least."""
    text, name, _, assumed = new_design({**SIX, "power_kW": 3150, "peak_pressure_MPa": 20})
    scene = parse_scene(text, name)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    gas = scene.engine.gas
    assert (gas.peak_pressure_MPa, gas.compression_ratio > 9, gas.burn_duration_deg < 60) == (20, True, True)
    found = analyse(scene)
    assert found.cycle is not None
    assert power_kW(found.cycle.indicated_work_J, found.engine) == pytest.approx(3150, rel=5e-3)
    assert implausible(found.cycle, found.engine, scene.throw.radius_mm) == ()
    for word in ("compression ratio 17", "burn duration 30 deg", "intake 0.29", "3150 kW"):
        assert word in assumed[1]
        assert word in " ".join(text.replace("#", "").split()), "the file says it as well"


def test_power_alone_charges_an_engine_that_needs_it() -> None:
    """No pressure is proposed that `loads` would call implausible: 47.7 bar at 0.1 MPa of intake."""
    for power in (1500, 6000):
        text, name, *_ = new_design({**SIX, "power_kW": power})
        scene = parse_scene(text, name)
        found = analyse(scene)
        assert found.cycle is not None
        assert power_kW(found.cycle.indicated_work_J, found.engine) == pytest.approx(power, rel=5e-3)
        assert implausible(found.cycle, found.engine, scene.throw.radius_mm) == ()


@pytest.mark.parametrize(
    ("power", "said"),
    [
        (
            9000,
            r"assumed at 12 deg after top dead centre, and assumed compression ratio 9 to 17, "
            r"burn duration 20 to 60 deg, .* has 2660 to 6080 kW.* A peak pressure of 29\.6 MPa .*would do.*"
            r" give engine\.gas\.peak_angle_deg",
        ),
        pytest.param(
            1000,
            r"needs an indicated mean pressure of 0\.691 MPa; .* A peak pressure of 7\.52 MPa "
            r"\(--peak-pressure-MPa\) would do",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_power_that_nothing_gives_is_refused_with_what_is_assumed(power: float, said: str) -> None:
    with pytest.raises(CranktopoError, match=said):
        new_design({**SIX, "power_kW": power, "peak_pressure_MPa": 20})


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
    tables = form_reference()["tables"]
    assert {"throw.main_journal", "web.pocket", "engine.gas", "goal.limits"} <= {
        table["path"] for table in tables
    }
    width = next(key for table in tables for key in table["keys"] if key["name"] == "width_mm")
    assert (width["unit"], width["required"]) == ("mm", True)


def test_the_page_has_a_group_for_every_table() -> None:
    """Rod, bolted joints and balancer shaft had none; what others published of an engine is no input."""
    page = Path(__file__).parents[3] / "cranktopo" / "tasks" / "bench" / "page"
    groups = (
        (page / "forms.js").read_text(encoding="utf-8").partition("const GROUPS = [")[2].partition("];")[0]
    )
    shown = {
        name for roots in re.findall(r'", \[([^\]]+)\]', groups) for name in re.findall(r'"(\w+)"', roots)
    }
    roots = {table["path"].partition(".")[0] for table in form_reference()["tables"]}
    assert roots - {""} == shown | {"published"}


def test_the_page_has_no_units_of_its_own() -> None:
    """It takes those that names of keys end with from the server."""
    assert form_reference()["units"] == UNITS
    page = Path(__file__).parents[3] / "cranktopo" / "tasks" / "bench" / "page"
    text = "".join(script.read_text(encoding="utf-8") for script in page.glob("*.js"))
    assert "takeUnits(message.units)" in text
    assert not [unit for unit in ("kg_m3", "N_per_mm", "Nm_per_rad", "|mm|", "(mm|") if unit in text]


def test_a_dropped_trace_may_be_as_german_systems_write_it(tmp_path: Path) -> None:
    trace = tmp_path / "trace.csv"
    trace.write_bytes("Kurbelwinkel [°KW];Zylinderdruck [bar]\n0;1\n".encode("cp1252"))
    assert read_upload(trace) == (None, "trace.csv")
