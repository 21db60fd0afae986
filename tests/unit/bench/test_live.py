"""Gauges are exact, or say what they rest on; what commands warn of is told with them."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.design.checks.engine import shaft_warnings
from cranktopo.design.edits import changed_data
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad
from cranktopo.engine.vibration.disk_error import FEW_THROWS_ERROR
from cranktopo.engine.vibration.vibrating_shaft import VibratingShaft
from cranktopo.tasks.bench import settled
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.live import live_numbers
from cranktopo.tasks.loads.stage import loads_at_speeds

ANSWERS = {"layout": "in-line", "cylinders": 6, "bore_mm": 320, "stroke_mm": 480, "speed_rpm": 750}
LINE = {
    "shaft.coupling.stiffness_Nm_per_rad": 500000.0,
    "shaft.coupling.inertia_kg_m2": 100.0,
    "shaft.driven.inertia_kg_m2": 800.0,
    "shaft.damper.kind": "viscous",
    "shaft.damper.damping_Nms_per_rad": 3000.0,
    "shaft.damper.ring_inertia_kg_m2": 60.0,
    "shaft.damper.hub_inertia_kg_m2": 10.0,
    "effects.torsional_vibration": "on",
    # Light, so that the inertia of the throws hardly varies: less to compute.
    "engine.masses.piston_group_kg": 1.0,
    "engine.masses.rod_reciprocating_kg": 1.0,
}
RESTING = ["natural_frequency", "m53_pin", "m53_journal"]


@cache
def six() -> dict[str, Any]:
    """A marine six of a known power, without a shaft."""
    return parse_toml(new_design({**ANSWERS, "peak_pressure_MPa": 20, "power_kW": 3150})[0], "six")


def shaft() -> dict[str, Any]:
    return changed_data(six(), LINE)


def closed_form(data: dict[str, Any]) -> float:
    return throw_stiffness_Nm_per_rad(scene_from_dict(data, "six", whole=True))


def test_what_rests_on_a_stiffness_in_closed_form_is_not_called_exact() -> None:
    """Elements find a throw up to 1.56 times stiffer."""
    told = live_numbers(shaft())
    assert (told["stiffness"], told["of_stiffness"]) == ("closed form", RESTING[:1])
    assert told["rings"]["natural_frequency"].startswith("live, closed-form stiffness: up to 20 %")
    assert told["marks"] == {"m53_pin": 1.15, "m53_journal": 1.15}
    assert told["rings"]["power"] == "live, combustion model"


def test_a_drag_waits_for_no_solve_of_the_vibrating_shaft(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rule's gauges and the warnings of the plan did: each move of a six took seconds."""
    solved = list[str]()
    monkeypatch.setattr(VibratingShaft, "over_the_range", lambda self: solved.append("range"))
    told = live_numbers(shaft(), [1.4] * 6)
    assert solved == []
    assert not set(RESTING[1:]) & set(told["gauges"])
    for name in RESTING[1:]:
        assert told["rings"][name].startswith("waits: ")


def test_a_short_shaft_is_told_that_its_disks_swing_too_fast() -> None:
    """With a stiffness in closed form, with that of a settled web, and with one that the design gives."""
    told = f"; disks of so few throws: {FEW_THROWS_ERROR}"
    single = changed_data(shaft(), {"engine.cylinders": 1, "engine.firing_order": [1]})
    given = changed_data(single, {"shaft.throw_stiffness_Nm_per_rad": 5e6})
    for data, factors in ((single, ()), (single, (1.2,)), (given, ())):
        assert live_numbers(data, factors)["rings"]["natural_frequency"].endswith(told)
    assert told not in live_numbers(shaft())["rings"]["natural_frequency"]


def test_without_a_shaft_the_rule_rests_on_no_stiffness() -> None:
    told = live_numbers(six())
    assert (told["stiffness"], told["of_stiffness"]) == ("", [])
    assert not set(RESTING) & set(told["rings"])


@pytest.mark.slow
def test_a_settled_stiffness_gives_what_the_design_gives_that_states_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """So does `fatigue --method m53`: the stiffness by elements goes into the design, throw by throw."""
    factors = [1.4, 1.2, 1.4, 1.4, 1.1, 1.4]
    stiffnesses = [factor * closed_form(shaft()) for factor in factors]
    given = live_numbers(changed_data(shaft(), {"shaft.throw_stiffnesses_Nm_per_rad": stiffnesses}))
    assert (given["stiffness"], given["of_stiffness"]) == ("", []), "exact where the design says it"
    rule = settled.settled_vibration(
        changed_data(shaft(), {"shaft.throw_stiffnesses_Nm_per_rad": stiffnesses})
    )
    by_factor = live_numbers(shaft(), factors)
    found = SimpleNamespace(stiffness=SimpleNamespace(throws_Nm_per_rad=tuple(stiffnesses)))
    monkeypatch.setattr(settled, "evaluate_shaft", lambda *_: found)
    by_elements = settled.settled_shaft(shaft())
    assert by_elements["stiffness_factors"] == pytest.approx(factors)
    for found_Hz in (by_factor["gauges"], by_elements["gauges"]):
        frequency = given["gauges"]["natural_frequency"]
        assert found_Hz["natural_frequency"] == pytest.approx(frequency, rel=1e-9)
    by_elements = settled.settled_vibration(shaft(), stiffnesses)
    assert list(by_elements["gauges"]) == RESTING[1:]
    assert by_elements["gauges"] == pytest.approx(rule["gauges"], rel=1e-9)
    assert settled.settled_shaft(six()) == {"gauges": {}}


def test_an_implausible_pressure_is_told_with_the_gauges() -> None:
    uncharged: dict[str, Any] = {
        "engine.gas.intake_pressure_MPa": None,
        "engine.gas.exhaust_pressure_MPa": None,
    }
    uncharged |= {"engine.gas.compression_ratio": 9.0, "engine.gas.burn_duration_deg": 60.0}
    data = changed_data(six(), uncharged)
    (line,) = live_numbers(data)["warnings"]
    assert "no engine has more than 20 times: give engine.gas.intake_pressure_MPa" in line
    assert loads_at_speeds(scene_from_dict(data, "six"))[0].warnings == (line,)
    assert live_numbers(six())["warnings"] == []


def test_a_trace_with_firing_at_360_deg_is_told_with_the_gauges(tmp_path: Path) -> None:
    angle = np.arange(0, 720, 2.0)
    bar = 1 + 60 * np.exp(-(((angle - 372) / 25) ** 2))
    rows = [f"{a},{p:.3f}" for a, p in zip(angle, bar, strict=True)]
    (tmp_path / "trace.csv").write_text("\n".join(["crank_angle_deg,pressure_bar", *rows]), encoding="utf-8")
    trace: dict[str, Any] = {"engine.gas.indicator_csv": str(tmp_path / "trace.csv")}
    trace |= {"engine.gas.peak_pressure_MPa": None, "engine.gas.peak_angle_deg": None}
    told = live_numbers(changed_data(six(), trace))
    assert "write engine.gas.firing_deg = 360" in told["warnings"][0]
    assert told["rings"]["gas_force"] == "live, measured trace"
    (line,) = live_numbers(changed_data(six(), {**trace, "engine.gas.firing_deg": 360.0}))["warnings"]
    assert "exponent" in line


def test_what_plan_and_vibration_warn_of_is_told() -> None:
    bare = {
        "shaft.damper": None,
        "effects.torsional_vibration": "auto",
        "shaft.coupling": None,
        "shaft.driven": None,
    }
    data = changed_data(shaft(), bare)
    told = live_numbers(data)["warnings"]
    expected = shaft_warnings(scene_from_dict(data, "six", whole=True))
    assert expected
    assert set(expected) <= set(told)
