"""Rated power beside that of the cylinder pressure."""

from __future__ import annotations

import re

import pytest

from cranktopo import load_scene, with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.rated_power import MECHANICAL_EFFICIENCY, burn_duration_deg, rated_power
from cranktopo.tasks.loads.stage import loads_at_speeds


def rated(kW: float) -> Scene:
    return with_values(load_scene("mikron-iiic-plain"), {"engine.rated_power_kW": kW})


def indicated_kW(scene: Scene) -> float:
    (loads,) = loads_at_speeds(scene)
    assert loads.indicated_power_kW is not None
    return loads.indicated_power_kW


def test_the_burn_duration_that_is_told_gives_the_rated_power() -> None:
    """By the loads of a scene that has it: another path than the one that looks for it."""
    own = indicated_kW(load_scene("mikron-iiic-plain"))
    scene = rated(0.95 * own * MECHANICAL_EFFICIENCY)
    burn, found = burn_duration_deg(scene, 0.95 * own), rated_power(scene)
    assert burn is not None
    assert found is not None
    assert indicated_kW(with_values(scene, {"engine.gas.burn_duration_deg": burn})) == pytest.approx(
        0.95 * own, rel=2e-3
    )
    assert f"engine.gas.burn_duration_deg = {burn:.3g} gives the rated one" in found.words


@pytest.mark.parametrize(("share", "warned"), [(0.8, True), (0.9, False), (1.1, False), (1.3, True)])
def test_a_power_far_off_is_warned_of(share: float, warned: bool) -> None:
    """0.8: the pressure gives 25 % above; 1.3: 23 % below."""
    scene = rated(share * indicated_kW(load_scene("mikron-iiic-plain")) * MECHANICAL_EFFICIENCY)
    found = rated_power(scene)
    assert found is not None
    assert bool(found.warnings) == warned
    (loads,) = loads_at_speeds(scene)
    assert any("rated power" in line for line in loads.warnings) == warned
    assert loads.rated_power is not None
    off = re.search(r"gives ([\d.]+) % (above|below)", loads.rated_power)
    assert off is not None
    signed = float(off[1]) * (1 if off[2] == "above" else -1)
    assert signed == pytest.approx(100 * (1 / share - 1), abs=0.06)


@pytest.mark.parametrize("kW", [0.75, 7.5, 75.0, 12000.0])
def test_the_percent_follows_from_the_printed_powers(kW: float) -> None:
    """Of 7.5 kW at the shaft 8 kW indicated were printed, whose percent is another."""
    found = rated_power(rated(kW))
    assert found is not None
    printed = re.search(r"([\d.]+) kW indicated.* gives ([\d.]+) % (above|below), ([\d.]+) kW", found.words)
    assert printed is not None
    off = float(printed[2]) * (1 if printed[3] == "above" else -1)
    assert off == pytest.approx(100 * (float(printed[4]) / float(printed[1]) - 1), rel=2e-3, abs=0.1)


def test_nothing_is_told_without_a_rated_power() -> None:
    scene = load_scene("mikron-iiic-plain")
    assert rated_power(scene) is None
    (loads,) = loads_at_speeds(scene)
    assert "rated_power" not in loads.as_json()


def test_another_speed_has_no_rated_power() -> None:
    """At two thirds of the speed the power is two thirds, and no burn duration is to blame."""
    scene = rated(indicated_kW(load_scene("mikron-iiic-plain")) * MECHANICAL_EFFICIENCY)
    at_rated, slower = loads_at_speeds(scene, [2100.0, 1400.0])
    assert scene.engine is not None
    assert at_rated.speed_rpm == scene.engine.speed_rpm
    assert at_rated.rated_power is not None
    assert slower.rated_power is None
    assert not any("rated power" in line for line in slower.warnings)
