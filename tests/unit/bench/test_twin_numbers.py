"""A motorcycle twin as it is typed on the page, against what is reckoned by hand."""

from __future__ import annotations

import math
from typing import Any

import pytest

from cranktopo.design.edits import changed_data
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.engine.balance.free_forces import oscillating_force, turning_masses
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.live import gauge_numbers

STROKE_MM, ROD_MM, SPEED_RPM, BORE_MM = 67.5, 124.0, 11_500.0, 100.0
PISTON_KG, SMALL_END_KG, BIG_END_KG = 0.40, 0.13, 0.30
ANSWERS: dict[str, Any] = {
    "layout": "V", "cylinders": 2, "bore_mm": BORE_MM, "stroke_mm": STROKE_MM, "speed_rpm": SPEED_RPM,
    "rod_length_mm": ROD_MM, "peak_pressure_MPa": 9.5, "bank_angle_deg": 90.0, "name": "twin",
}  # fmt: skip
TYPED = {
    "throw.main_journal.outer_diameter_mm": 48.0, "throw.main_journal.length_mm": 30.0,
    "throw.crankpin.outer_diameter_mm": 44.0, "throw.crankpin.length_mm": 44.0,
    "web.width_mm": 64.0, "web.thickness_mm": 22.0,
    "engine.masses.piston_group_kg": PISTON_KG, "engine.masses.rod_reciprocating_kg": SMALL_END_KG,
    "engine.masses.rod_rotating_kg": BIG_END_KG, "engine.gas.peak_angle_deg": 14.0,
    "engine.gas.compression_ratio": 12.5,
}  # fmt: skip


def test_the_numbers_of_the_twin_are_those_by_hand() -> None:
    data = changed_data(parse_toml(new_design(ANSWERS).text, "twin"), TYPED)
    scene = scene_from_dict(data, "twin", whole=True)
    gauges = gauge_numbers(scene)["gauges"]
    radius_m, w2 = STROKE_MM / 2e3, (SPEED_RPM * math.pi / 30) ** 2
    swept_m3 = math.pi / 4 * (BORE_MM / 1e3) ** 2 * STROKE_MM / 1e3
    work_J = gauges["mean_torque"] * 4 * math.pi / 2  # two strokes of power in two turns
    assert work_J == pytest.approx(1000.3, rel=2e-3)
    assert gauges["mean_pressure"] == pytest.approx(18.9, abs=0.05)
    assert gauges["mean_pressure"] == pytest.approx(work_J / swept_m3 / 1e5, rel=1e-3)
    assert gauges["gas_force"] == pytest.approx(73_817, rel=1e-3)
    assert gauges["power"] == pytest.approx(192, rel=5e-3)
    lam = STROKE_MM / 2 / ROD_MM
    second = lam + lam**3 / 4 + 15 * lam**5 / 128
    first_N = (PISTON_KG + SMALL_END_KG) * radius_m * w2
    assert first_N == pytest.approx(25_942, rel=1e-3)
    masses = turning_masses(scene)
    assert largest_N(oscillating_force(masses, 1)) == pytest.approx(first_N, rel=1e-6), "a circle at 90 deg"
    assert largest_N(oscillating_force(masses, 2)) == pytest.approx(math.sqrt(2) * second * first_N, rel=1e-4)
    assert largest_N(oscillating_force(masses, 2)) == pytest.approx(10_170, rel=1e-3)
    assert 2 * BIG_END_KG * radius_m * w2 == pytest.approx(29_400, rel=2e-3)


def largest_N(force: Any) -> float:
    """Long half-axis of the ellipse of a force."""
    return float(abs(force.force.forward) + abs(force.force.backward))
