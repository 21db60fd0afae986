"""Rollers by laminae (ISO/TS 16281): printed load distributions, ISO 281, and what tilt and clearance do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cranktopo.design.shaft import RollerBearing
from cranktopo.engine.bearings import reference_life_h
from cranktopo.numerics.roller_laminae import RollerSet, lamina_loads, reference_life_turns

NEEDLES = RollerSet(40, 3.0, 15.3, 63.0)
RATING_N = 31900.0
LOAD_N, STRAIGHT = np.array([[3000.0, 4000.0]]), np.zeros((1, 2))


def life(rollers: RollerSet, load_N: float = 5000.0, tilt: tuple[float, float] = (0.0, 0.0)) -> float:
    """Turns under a load along x."""
    found = reference_life_turns(rollers, RATING_N, np.array([[load_N, 0.0]]), np.array([tilt]))
    return float(found[0])


@pytest.fixture
def flat(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rollers without a profile and without stress at their edges."""
    monkeypatch.setattr(RollerSet, "profile_mm", property(lambda one: np.zeros(one.laminae)))
    monkeypatch.setattr(RollerSet, "edge_factor", property(lambda one: np.ones(one.laminae)))


@pytest.mark.usefixtures("flat")
def test_the_load_is_shared_as_printed() -> None:
    """T. Harris, M. Kotzalas, Rolling Bearing Analysis, line contact without clearance (epsilon 0.5).

    Load integral Jr = 0.2453, mean loads of the rings J1 = 0.6495 and J2 = 0.6744 of the largest: with the
    exponent 1.1 of the approach, which the standard has as 10/9.
    """
    many = replace(NEEDLES, count=400)
    (loads,) = lamina_loads(many, LOAD_N, STRAIGHT).sum(axis=2)
    share = loads / loads.max()
    assert 5000.0 / (400 * loads.max()) == pytest.approx(0.2453, rel=3e-3)
    for power, printed in ((4.0, 0.6495), (4.5, 0.6744)):
        assert (share**power).mean() ** (1 / power) == pytest.approx(printed, rel=3e-3)


@pytest.mark.usefixtures("flat")
def test_even_rollers_live_as_iso_281_without_its_reduction() -> None:
    """Loaded with its rating, a bearing lives a million turns, by ISO 281 over 0.83^4 of that.

    Line contact has the exponent 4; that of ISO 281, 10/3, is one between line and point contact.
    """
    assert life(NEEDLES, RATING_N) == pytest.approx(1e6 / 0.83**4, rel=0.02)
    assert life(NEEDLES, RATING_N / 2) == pytest.approx(16 * life(NEEDLES, RATING_N), rel=1e-3)


@pytest.mark.parametrize("clearance_mm", [0.0, 0.03])
def test_rollers_hold_the_journal(clearance_mm: float) -> None:
    """Forces of all laminae add up to the load, whichever way the journal tilts; no lamina pulls."""
    rng = np.random.default_rng(2)
    load, tilt = rng.normal(0.0, 8000.0, (30, 2)), rng.normal(0.0, 2e-3, (30, 2))
    rollers = replace(NEEDLES, clearance_mm=clearance_mm)
    found = lamina_loads(rollers, load, tilt)
    assert found.min() >= 0
    assert np.abs(found.sum(axis=2) @ rollers.round_about - load).max() < 1e-5


def test_tilt_and_clearance_shorten_the_life() -> None:
    """The more, the shorter; to either side alike; a tilt across the load does less than one along it."""
    lives = [life(NEEDLES, tilt=(tilt, 0.0)) for tilt in (0.0, 2e-4, 5e-4, 1e-3, 3e-3)]
    assert lives == sorted(lives, reverse=True)
    assert lives[-1] < 0.2 * lives[0]
    assert life(NEEDLES, tilt=(-1e-3, 0.0)) == pytest.approx(life(NEEDLES, tilt=(1e-3, 0.0)), rel=1e-6)
    assert lives[3] < life(NEEDLES, tilt=(0.0, 1e-3)) < lives[0]
    loose = [life(replace(NEEDLES, clearance_mm=one)) for one in (0.0, 0.01, 0.03)]
    assert loose == sorted(loose, reverse=True)
    assert loose[-1] < 0.9 * loose[0]


def test_damage_of_a_cycle_adds_up() -> None:
    """Half of the turns without a load: twice the life; sizes that are missing tell none; less with play."""
    sizes = {"roller_diameter_mm": 3.0, "pitch_diameter_mm": 63.0}
    bearing = RollerBearing(name="HK6020", **sizes)
    load, tilt = np.array([[5000.0, 0.0], [0.0, 0.0]]), np.zeros((2, 2))
    expected = 2 * life(NEEDLES) / (60 * 2100.0)
    assert reference_life_h(bearing, load, tilt, 2100.0) == pytest.approx(expected, rel=1e-9)
    loose = RollerBearing(name="HK6020", clearance_mm=0.03, **sizes)
    assert reference_life_h(loose, load, tilt, 2100.0) < 0.9 * expected
    assert reference_life_h(RollerBearing(name="HK6020"), load, tilt, 2100.0) is None
    assert reference_life_h(bearing, 0 * load, tilt, 2100.0) is None
