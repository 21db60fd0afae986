"""Polar plots of bearing forces against sums by hand: a rod on its pin, a single between two bearings."""

from __future__ import annotations

from functools import cache
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from cranktopo.design.edits import changed_data
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.toml_text import parse_toml
from cranktopo.engine.analysis import analyse
from cranktopo.tasks.bench.bearing_forces import largest_bearing_force_N, polars
from cranktopo.tasks.bench.engine_loads import EngineLoads
from cranktopo.tasks.bench.forms import new_design
from cranktopo.tasks.bench.live import live_numbers
from cranktopo.tasks.bench.settled import settled_film
from cranktopo.tasks.film.result import FilmResult
from cranktopo.tasks.film.stage import oil_films


@cache
def single() -> dict[str, Any]:
    return parse_toml(
        new_design({"layout": "single", "cylinders": 1, "bore_mm": 80, "stroke_mm": 90}).text, "single"
    )


def test_a_pin_carries_its_rod() -> None:
    """The other way to it: extremes of the cycle by `loads`."""
    scene = scene_from_dict(single(), "single", whole=True)
    _, pin = polars(EngineLoads(scene))
    cycle = analyse(scene).cycle
    assert cycle is not None
    largest = max(np.hypot(*point) for point in pin["points"])
    assert largest == pytest.approx(cycle.extreme("rod_force_N")[0].value / 1e3, rel=1e-3)


def test_two_bearings_share_what_a_single_carries() -> None:
    scene = scene_from_dict(single(), "single", whole=True)
    bearing, pin = polars(EngineLoads(scene))
    assert bearing["name"] == "main bearing 1"
    sizes = [max(np.hypot(*point) for point in one["points"]) for one in (bearing, pin)]
    assert 0.3 < sizes[0] / sizes[1] < 0.7, "about half, less or more what turns with the crank"
    assert largest_bearing_force_N(EngineLoads(scene)) / 1e3 == pytest.approx(sizes[0], rel=1e-3)


def test_they_follow_the_speed_and_an_engine_without_one_has_none() -> None:
    fast = changed_data(single(), {"engine.speed_rpm": 9000.0})
    gauges = [live_numbers(data)["gauges"]["bearing_force"] for data in (single(), fast)]
    assert gauges[0] != gauges[1]
    assert live_numbers(changed_data(single(), {"engine": None}))["polars"] == []


def test_the_film_is_that_of_the_command() -> None:
    data = changed_data(single(), {"bearings": {"clearance_mm": 0.05, "viscosity_mPas": 9.0}})
    told: list[tuple[Scene, FilmResult]] = []

    def watched(scene: Scene) -> FilmResult:
        told.append((scene, oil_films(scene)))
        return told[-1][1]

    with patch("cranktopo.tasks.bench.settled.oil_films", watched):
        gauges = settled_film(data)["gauges"]
        assert settled_film(single())["gauges"] == {}
    ((scene, films),) = told
    assert scene == scene_from_dict(data, scene.name, whole=True)
    (found,) = films.speeds
    assert gauges["film"] == min(film.film_um for film in found.bearings)
    assert gauges["film_pressure"] == max(film.pressure_MPa for film in found.bearings)
