"""Plots of the bench against sums by hand: an in-line four, the peak of its cycle, a Campbell diagram."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from cranktopo.design.edits import changed_data
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.tasks.bench.engine_loads import EngineLoads
from cranktopo.tasks.bench.engine_plots import line_plots, live_plots, vibration_plots
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.live import live_numbers
from cranktopo.tasks.bench.settled import settled_vibration

SHAFT = {"shaft.flywheel.inertia_kg_m2": 0.2, "shaft.throw_stiffness_Nm_per_rad": 4e5}
SHAFT |= {"shaft.permitted_shear_MPa": 30.0}


@cache
def four() -> dict[str, Any]:
    return parse_toml(
        new_design(
            {"layout": "in-line", "cylinders": 4, "bore_mm": 80, "stroke_mm": 90, "speed_rpm": 3000}
        ).text,
        "four",
    )


def plots_of(data: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Live plots of a design by their names."""
    found = live_plots(EngineLoads(scene_from_dict(data, "four", whole=True)))
    return {plot["name"]: plot for plot in found}


def test_a_four_in_line_shakes_by_its_second_order_alone() -> None:
    """Taylor, The Internal Combustion Engine: 4 m r w^2 times r / l, and a higher term of it."""
    scene = scene_from_dict(four(), "four", whole=True)
    engine, radius = scene.engine, scene.throw.radius_mm
    assert engine is not None
    ratio, w2 = radius / engine.rod_length_mm, (3000 * math.pi / 30) ** 2
    by_hand = 4 * engine.reciprocating_kg * radius / 1e3 * w2 * (ratio + ratio**3 / 4)
    force = {one["name"]: one["value"] for one in plots_of(four())["Free forces"]["bars"]}
    assert force["order 1"] == pytest.approx(0, abs=1e-3)
    assert force["order 2"] == pytest.approx(by_hand, rel=2e-3)
    moment = plots_of(four())["Free moments"]["bars"]
    assert max(one["value"] for one in moment) < 1e-3 * by_hand, "its crank is a mirror image of itself"


def test_the_curves_of_the_cycle_have_its_peak_and_its_mean() -> None:
    told = plots_of(four())
    ((_, *pressure),) = [zip(*curve["points"], strict=True) for curve in told["Cylinder pressure"]["curves"]]
    assert max(pressure[0]) == pytest.approx(four()["engine"]["gas"]["peak_pressure_MPa"], rel=1e-3)
    engine, section = told["Torque"]["curves"]
    angle, torque = np.array(engine["points"]).T
    mean = np.trapezoid(torque, angle) / (angle[-1] - angle[0])
    assert mean == pytest.approx(live_numbers(four())["gauges"]["mean_torque"], rel=0.03)
    assert section["name"].startswith(("behind", "throw"))
    assert plots_of(changed_data(four(), {"engine": None})) == {}


def test_orders_go_through_the_origin_and_meet_the_frequency_of_the_gauge() -> None:
    data = changed_data(four(), SHAFT)
    torque, campbell = vibration_plots(scene_from_dict(data, "four", whole=True))
    lines = {curve["name"]: curve["points"] for curve in campbell["curves"]}
    scene = scene_from_dict(data, "four", whole=True)
    first = min(hertz for hertz in estimated_chain(scene).chain.natural_frequencies_Hz() if hertz > 1)
    assert next(iter(lines.values()))[0][1] == pytest.approx(first, rel=1e-3)
    orders = {name: points for name, points in lines.items() if name.startswith("order")}
    assert orders
    for name, points in orders.items():
        order = float(name.removeprefix("order "))
        for rpm, hertz in points:
            assert hertz == pytest.approx(order * rpm / 60, rel=1e-3)
    assert torque["curves"][1]["name"] == "permitted"


def test_the_shaft_line_is_told_disk_by_disk() -> None:
    """Of a four: its throws and the flywheel, whose inertia the design gives, with springs between them."""
    scene = scene_from_dict(changed_data(four(), SHAFT), "four", whole=True)
    disks, springs = (plot["bars"] for plot in line_plots(EngineLoads(scene)))
    assert [one["name"] for one in disks] == ["throw 1", "throw 2", "throw 3", "throw 4", "flywheel"]
    assert disks[-1]["value"] == 0.2
    assert [one["value"] for one in springs[:3]] == pytest.approx([400.0] * 3)


@pytest.mark.slow
def test_the_vibration_settles_with_a_shaft_line_alone() -> None:
    assert settled_vibration(four()) == {"gauges": {}}
    data = changed_data(four(), {**SHAFT, "shaft.throw_stiffness_Nm_per_rad": None})
    of_throws = (settled_vibration(data, [stiffness] * 4)["plots"][1] for stiffness in (4e5, 8e5))
    soft, stiff = (campbell["curves"][0]["points"][0][1] for campbell in of_throws)
    assert soft < stiff < math.sqrt(2) * soft, (
        "twice as stiff throws, and a shaft that has other springs, too"
    )
