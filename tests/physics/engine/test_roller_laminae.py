"""Rollers by laminae (ISO/TS 16281): printed load distributions, ISO 281, and what tilt and clearance do."""

from __future__ import annotations

from dataclasses import replace
from math import gamma, pi, sqrt

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.shaft import RollerBearing
from cranktopo.engine.bearings import (
    bearing_tilt_spring_Nmm_per_rad,
    max_gas_force_N,
    reference_life_h,
)
from cranktopo.numerics.roller_laminae import (
    RollerSet,
    lamina_loads,
    reference_life_turns,
    tilt_stiffness_Nmm_per_rad,
)

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


def moment_Nmm(rollers: RollerSet, load_N: float, tilt: tuple[float, float]) -> np.ndarray:
    """What laminae under a load along x press back by about their middles, along x and across."""
    (loads,) = lamina_loads(rollers, np.array([[load_N, 0.0]]), np.array([tilt]))
    return np.asarray(rollers.round_about.T @ loads @ rollers.along_mm)


@pytest.mark.parametrize(
    "rollers",
    [replace(NEEDLES, count=41), replace(NEEDLES, clearance_mm=0.01), RollerSet(15, 11.0, 11.0, 70.0)],
)
def test_rollers_resist_a_small_tilt_by_their_stiffness(rollers: RollerSet) -> None:
    """Differences of the moment of all laminae over a tilt in the plane of the load and one across it.

    No roller just touches: of 40 without play two stand across the load, which any tilt presses.
    """
    load, tilt = 17000.0, 1e-7
    along, across = moment_Nmm(rollers, load, (tilt, 0.0))[0], moment_Nmm(rollers, load, (0.0, tilt))[1]
    assert along > across > 0
    found = tilt_stiffness_Nmm_per_rad(rollers, load)
    assert found == pytest.approx((along + across) / 2 / tilt, rel=1e-5)


@pytest.mark.usefixtures("flat")
@pytest.mark.parametrize("load_N", [3000.0, 30000.0])
def test_a_row_of_flat_laminae_resists_a_tilt_as_in_closed_form(load_N: float) -> None:
    """Many rollers without play: approach d cos(a), forces K d^(10/9) cos^(10/9), slope (10/9) K d^(1/9).

    Integrals of cos^p over the loaded half are sqrt(pi) G((p + 1) / 2) / G(p / 2 + 1). A lamina at z turns
    with z^2, which over a roller is l^2 / 12.
    """

    def half(power: float) -> float:
        return sqrt(pi) * gamma((power + 1) / 2) / gamma(power / 2 + 1)

    count, length = 4000, NEEDLES.length_mm
    line = 35948.0 * length ** (8 / 9) * count / (2 * pi)
    approach = (load_N / (line * half(19 / 9))) ** 0.9
    expected = 10 / 9 * line * approach ** (1 / 9) * half(1 / 9) / 2 * length**2 / 12
    found = tilt_stiffness_Nmm_per_rad(replace(NEEDLES, count=count, laminae=60), load_N)
    assert found == pytest.approx(expected, rel=1e-3)


def test_moment_over_tilt_of_the_needles() -> None:
    """N m/rad as documented: in the plane of the load and across it, at larger tilts, and with play."""

    def over_tilt(load_N: float, tilt: float, rollers: RollerSet = NEEDLES) -> tuple[float, float]:
        along, across = (moment_Nmm(rollers, load_N, turned) for turned in ((tilt, 0.0), (0.0, tilt)))
        return along[0] / tilt / 1000, across[1] / tilt / 1000

    assert over_tilt(17000.0, 1e-5) == pytest.approx((46160, 30720), rel=1e-2)
    for load_N in (1000.0, 5000.0, 17000.0, 25000.0):
        for tilt in (2e-3, 3e-3):
            assert all(37_000 < one < 45_000 for one in over_tilt(load_N, tilt))
    loose = replace(NEEDLES, clearance_mm=0.03)
    assert over_tilt(17000.0, 1e-5, loose) == pytest.approx((41700, 10800), rel=2e-2)


def test_rollers_of_the_main_bearings_resist_tilt_where_their_sizes_are_given() -> None:
    """Under half the largest gas force; a spring that is given goes first, and plain bearings have none."""
    sizes = {"name": "HK6020", "roller_diameter_mm": 3.0, "pitch_diameter_mm": 63.0}

    scene = load_scene("mikron-iiic-plain")

    def tilt_spring(**supports: object) -> float:
        given = {f"supports.{key}": value for key, value in supports.items()}
        return bearing_tilt_spring_Nmm_per_rad(with_values(scene, given))

    expected = tilt_stiffness_Nmm_per_rad(NEEDLES, max_gas_force_N(scene) / 2)
    assert 35e6 < expected < 45e6
    assert tilt_spring(roller_bearing=sizes) == pytest.approx(expected, rel=1e-12)
    assert tilt_spring(roller_bearing=sizes, bearing_tilt_spring_Nm_per_rad=500.0) == 5e5
    assert tilt_spring(roller_bearing={"name": "HK6020"}) == 0
    plain = {"supports.roller_bearing": sizes, "bearings": load_scene("car-diesel").bearings}
    assert bearing_tilt_spring_Nmm_per_rad(with_values(scene, plain)) == 0
