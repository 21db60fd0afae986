"""Gas of a design that begins with its power: met for every plausible compression, or advice that works."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.engine.performance import power_kW
from cranktopo.engine.starting_gas import work_J
from cranktopo.tasks.designs.beginning import begun

DIESEL = (86.0, 75.0, 3000.0)
SIZES = (DIESEL, (40.0, 35.0, 4000.0), (320.0, 480.0, 750.0))
RATIOS = (8.0, 11.0, 15.0, 18.0, 20.0, 23.0)
Size = tuple[float, float, float]


def power_of(mean_MPa: float, size: Size) -> float:
    """Power of a four-stroke cylinder, in closed form: mean pressure, volume and cycles per second."""
    bore_mm, stroke_mm, rpm = size
    return float(f"{mean_MPa * math.pi / 4 * bore_mm**2 * stroke_mm * 1e-6 * rpm / 120:.4g}")


def began(size: Size, kW: float, ratio: float | None = None, peak_MPa: float | None = None) -> Scene:
    known: dict[str, Any] = {"speed_rpm": size[2], "compression_ratio": ratio, "power_kW": kW}
    known["peak_pressure_MPa"] = peak_MPa
    return begun("new", "single", 1, size[0], size[1], known).scene


def check_power(scene: Scene, kW: float) -> None:
    assert scene.engine is not None
    assert power_kW(work_J(scene), scene.engine) == pytest.approx(kW, rel=3e-3)


def check_refused(error: CranktopoError, size: Size, kW: float, ratio: float | None, peak: float) -> str:
    """Do what a refusal advises, which must work; return the advice."""
    hint = error.hint
    if found := re.search(r"A peak pressure of (\S+) MPa \(--peak-pressure-MPa\) would do", hint):
        check_power(began(size, kW, ratio, float(found[1])), kW)
        if "or leave it out" in hint:
            check_power(began(size, kW, ratio), kW)
        return "peak"
    if found := re.search(r"Leave --peak-pressure-MPa out: it is (\S+) MPa then", hint):
        scene = began(size, kW, ratio)
        check_power(scene, kW)
        assert scene.engine is not None
        assert scene.engine.gas is not None
        assert scene.engine.gas.peak_pressure_MPa == pytest.approx(float(found[1]), rel=5e-3)
        return "no peak"
    found = re.search(r"A power of (\S+) kW \(--power-kW\) would do", hint)
    assert found, hint
    kept = None if "without --peak-pressure-MPa" in hint or not peak else peak
    check_power(began(size, float(found[1]), ratio, kept), float(found[1]))
    return "power"


@pytest.mark.parametrize(
    ("ratio", "kW"),
    [
        (20, 10),
        (18, 8.75),
        (23, 7),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in ((20, 7), (20, 8.75), (22, 8.75))),
    ],
)
def test_a_diesel_begins_with_its_power(ratio: float, kW: float) -> None:
    """Its peak is above what compression alone reaches; with that, burning for 60 deg gives more."""
    scene = began(DIESEL, kW, ratio)
    check_power(scene, kW)
    assert scene.engine is not None
    gas = scene.engine.gas
    assert gas is not None
    assert gas.peak_pressure_MPa is not None
    assert gas.peak_pressure_MPa > 1.04 * 0.101325 * ratio**1.32
    assert gas.burn_duration_deg < 60


def test_a_usual_power_keeps_a_usual_burning() -> None:
    scene = began(DIESEL, 11.5, 14)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    assert scene.engine.gas.burn_duration_deg == 60


@pytest.mark.parametrize(
    ("kW", "ratio", "peak", "advice"),
    [
        (2.2, 23, 0, "power"),
        pytest.param(98, 20, 0, "power", marks=pytest.mark.slow),
        (8.75, 20, 5, "no peak"),
        (8.75, 14, 20, "peak"),
        pytest.param(2.2, 23, 5, "power", marks=pytest.mark.slow),
    ],
)
def test_a_refusal_advises_what_works(kW: float, ratio: float, peak: float, advice: str) -> None:
    with pytest.raises(CranktopoError) as caught:
        began(DIESEL, kW, ratio, peak or None)
    assert "0 to 0 kW" not in caught.value.message
    assert check_refused(caught.value, DIESEL, kW, ratio, peak) == advice


@pytest.mark.slow
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("ratio", RATIOS)
def test_every_plausible_power_is_met(size: Size, ratio: float) -> None:
    """Mean pressures from those of a weak engine to above any in series; beyond them the advice works."""
    for mean in (0.6, 0.8, 1.0, 1.5, 2.0, 3.0):
        kW = power_of(mean, size)
        check_power(began(size, kW, ratio), kW)
    for mean in (0.2, 0.4, 5.0, 9.0):
        kW = power_of(mean, size)
        try:
            check_power(began(size, kW, ratio), kW)
        except CranktopoError as error:
            check_refused(error, size, kW, ratio, 0)


@pytest.mark.slow
@pytest.mark.parametrize("peak", [5.0, 20.0])
@pytest.mark.parametrize("ratio", [None, 8.0, 20.0])
def test_a_known_peak_gives_the_power_or_advice(ratio: float | None, peak: float) -> None:
    for mean in (0.4, 0.8, 1.5, 3.0):
        kW = power_of(mean, DIESEL)
        try:
            check_power(began(DIESEL, kW, ratio, peak), kW)
        except CranktopoError as error:
            check_refused(error, DIESEL, kW, ratio, peak)
