"""Films of a load that is turned, mirrored, scaled, or whose cycle begins elsewhere: the same film."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.numerics.bearing_film.conserving_orbit import ConservedOrbit, OilFeed, conserved_orbit
from cranktopo.numerics.bearing_film.orbit import JournalBearing, LoadedJournal, Orbit, orbits

Array = NDArray[np.float64]
ANGLE = np.arange(0.0, 720.0, 4.0)
START = 0.5 + 0.1j
BEARING = JournalBearing(60.0, 24.0, 1, 0.03, 0.01)
LATER = 97


def journal(later: int = 0) -> LoadedJournal:
    """A pulse beside a turning load, not the same from any side; the bearing swings."""
    load = 9000.0 * np.exp(-(((ANGLE - 370.0) / 40.0) ** 2)) + 2500.0 * np.exp(1j * np.radians(ANGLE + 20.0))
    swing = 60.0 * np.cos(np.radians(ANGLE))
    own = np.full_like(ANGLE, 300.0)
    return LoadedJournal(BEARING, np.roll(load, -later), 300.0, (own, np.roll(swing, -later)))


def by_mobility(of: LoadedJournal, start: complex = START) -> Orbit:
    (found,) = orbits([of], ANGLE, start)
    return found


@pytest.fixture(scope="module")
def of_one_start() -> list[Orbit]:
    """The journal, twice as large, and begun later: in one solve, which takes as long as one of them."""
    return orbits([journal(), scaled(journal()), journal(LATER)], ANGLE, START)


def keeping(of: LoadedJournal, start: complex, hole_rad: float, size: float = 1.0) -> ConservedOrbit:
    """Return the cycle; with the pressure of the feed as of `scaled` where the size is another."""
    pressure = 0.3 if size == 1.0 else 6 * 0.3
    feed = OilFeed(pressure, hole_mm=5.0 * size, hole_rad=np.full_like(ANGLE, hole_rad))
    return conserved_orbit(of, ANGLE, feed, by_mobility(of, start), None, (60, 4))


def turned(of: LoadedJournal, angle_rad: float) -> LoadedJournal:
    return replace(of, load_N=of.load_N * np.exp(1j * angle_rad))


def mirrored(of: LoadedJournal) -> LoadedJournal:
    own, sleeve = of.surfaces_rad_s
    return replace(of, load_N=of.load_N.conj(), surfaces_rad_s=(-own, -sleeve))


def scaled(of: LoadedJournal) -> LoadedJournal:
    """Twice as large and as fast, oil of three times the viscosity: pressures 6 times, loads 24 times."""
    bearing = JournalBearing(120.0, 48.0, 1, 0.06, 0.03)
    own, sleeve = of.surfaces_rad_s
    return LoadedJournal(bearing, 24 * of.load_N, 600.0, (2 * own, 2 * sleeve))


def apart(one: Array, other: Array) -> float:
    return float(np.abs(one / other - 1).max())


def the_same(found: Orbit, film_mm: Array, pressure_MPa: Array, friction_W: Array) -> bool:
    """Whether film, pressure and friction are these to 1e-9."""
    pairs = (found.film_mm, film_mm), (found.pressure_MPa, pressure_MPa), (found.friction_W, friction_W)
    return max(apart(*pair) for pair in pairs) < 1e-9


def test_films_of_a_turned_a_mirrored_and_a_scaled_load(of_one_start: list[Orbit]) -> None:
    base, larger, _ = of_one_start
    own = base.film_mm, base.pressure_MPa, base.friction_W
    assert the_same(by_mobility(mirrored(journal()), START.conjugate()), *own)
    assert the_same(by_mobility(turned(journal(), -2.0), START * np.exp(-2j)), *own)
    # Twice as large and as fast, with three times the viscosity: 24 times the load, four times the way.
    assert the_same(larger, 2 * own[0], 6 * own[1], 96 * own[2])


def test_the_film_does_not_depend_on_where_the_cycle_begins(of_one_start: list[Orbit]) -> None:
    """Also where it begins at the foot of the pulse."""
    base, _, later = of_one_start
    assert_begun_later(base, later, LATER)


@pytest.mark.slow
@pytest.mark.parametrize("steps", [47, 111])
def test_the_film_does_not_depend_on_other_beginnings(steps: int) -> None:
    assert_begun_later(by_mobility(journal()), by_mobility(journal(steps)), steps)


def assert_begun_later(base: Orbit, later: Orbit, steps: int) -> None:
    own = [np.roll(one, -steps) for one in (base.film_mm, base.pressure_MPa, base.friction_W)]
    assert the_same(later, *own)


@pytest.mark.slow
def test_the_film_that_keeps_its_oil() -> None:
    """Turned by whole cells, so that they meet the load alike, and scaled; begun elsewhere, within 0.4 %.

    Cycles end where film and pressure change by less than 0.2 %.
    """
    base, turn = keeping(journal(), START, 1.1), 2 * np.pi * 7 / 60
    other = keeping(turned(journal(), turn), START * np.exp(1j * turn), 1.1 + turn)
    assert apart(other.film_mm, base.film_mm) < 1e-9
    assert apart(other.pressure_MPa, base.pressure_MPa) < 1e-9
    larger = keeping(scaled(journal()), START, 1.1, 2.0)
    assert apart(larger.film_mm, 2 * base.film_mm) < 1e-9
    assert apart(larger.pressure_MPa, 6 * base.pressure_MPa) < 1e-9
    later = keeping(journal(LATER), START, 1.1)
    assert later.film_mm.min() == pytest.approx(base.film_mm.min(), rel=4e-3)
    assert later.pressure_MPa.max() == pytest.approx(base.pressure_MPa.max(), rel=4e-3)
