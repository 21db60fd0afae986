"""Loads printed in theses: Dolezal 2024 (Walter Mikron III C), Voparil 2011, Kral 2014."""

import math

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.arrangement import Gear
from cranktopo.design.engine import Gas
from cranktopo.design.loading import load_scene
from cranktopo.design.shaft import RollerBearing
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.balancer_shafts import gear_forces
from cranktopo.engine.bearings import bearing_spring_N_per_mm, rating_life_h, table_slope_N_per_mm
from cranktopo.engine.kinematics import exact_motion, force_ratios

MIKRON = load_scene("mikron-iiic-plain")


@pytest.fixture
def driven(tmp_path):
    """The Mikron driven by a measured curve with 35 905 N of gas force at 11 deg."""
    peak = 0.10133 + 35905 / (math.pi / 4 * 95**2)
    update = {"peak_pressure_MPa": peak}
    gas = MIKRON.engine.gas.model_copy(update=update)
    modelled = analyse(MIKRON.model_copy(update={"engine": MIKRON.engine.model_copy(update={"gas": gas})}))
    curve = modelled.cycle.pressure
    file = tmp_path / "indicator.csv"
    rows = np.column_stack([curve.angle_deg, curve.pressure_MPa * 10])[::4]
    np.savetxt(file, rows, delimiter=",", header="crank_angle_deg,pressure_bar", comments="", fmt="%.10g")
    measured = Gas(indicator_csv=str(file), ambient_pressure_MPa=0.10133)
    return MIKRON.model_copy(update={"engine": MIKRON.engine.model_copy(update={"gas": measured})})


def test_mikron_small_end(driven):
    extremes = analyse(driven).cycle.extremes()
    assert extremes["gas_force_N"][0].value == pytest.approx(35905, rel=1e-6)
    assert extremes["gas_force_N"][0].deg == 11.0
    assert extremes["small_end_force_N"][0].value == pytest.approx(34480, rel=0.002)
    assert extremes["small_end_force_N"][0].deg == 11.0
    assert extremes["inertia_force_N"][1].value == pytest.approx(-1469, abs=0.5)
    assert extremes["inertia_force_N"][1].deg == 0.0


def test_mikron_pull_at_the_small_end_is_that_of_another_gas_exchange(driven):
    """-1348 N are printed 15 deg after gas-exchange top dead centre; ours is -1481 N, 10 deg after it.

    The source's series has -1386 N of inertia there, so its gas has +38 N. Ours has suction by then, -51 N at
    the largest pull, and the printed -95 N from 380 deg on, as at the printed place 284 deg before firing
    top dead centre. The diagram itself is not printed.
    """
    cycle = analyse(driven).cycle
    pull = cycle.extremes()["small_end_force_N"][1]
    assert pull.value == pytest.approx(-1480.9, abs=0.5)
    assert pull.deg == 370.5
    lam, angle = 48 / 166, math.radians(15)
    series = -0.491 * 0.048 * (2100 * math.pi / 30) ** 2 * (math.cos(angle) + lam * math.cos(2 * angle))
    assert -1348 - series == pytest.approx(38, abs=1)
    gas = np.interp([370.5, 380.0, 720 - 284], cycle.forces.angle_deg, cycle.forces.gas_force_N)
    assert gas == pytest.approx([-51, -95, -95], abs=1)


def test_mikron_inertia_at_top_dead_centre():
    r_w2 = 0.048 * (2100 * math.pi / 30) ** 2
    acceleration = r_w2 * exact_motion(np.zeros(1), 48.0, 166.0).acceleration_ratio[0]
    assert acceleration == pytest.approx(2992.56, abs=0.01)


def test_mikron_decomposition_of_the_printed_force():
    ratios = force_ratios(np.radians([11.0]), 48.0, 166.0)
    assert np.degrees(np.arctan(ratios.side[0])) == pytest.approx(3.1628, abs=5e-5)
    assert 34480 * ratios.rod[0] == pytest.approx(34532.6, abs=0.05)
    assert 34480 * ratios.tangential[0] == pytest.approx(8449.4, abs=0.05)
    assert 34480 * ratios.radial[0] == pytest.approx(33483.0, abs=0.05)
    assert 34480 * ratios.tangential[0] * 0.048 == pytest.approx(405.57, abs=0.005)


def test_bearing_spring_of_the_opposed_piston_engine():
    """0.5 max(F_p) / (0.8 clearance) = 1.072e6 N/mm for 85 730 N and 0.05 mm."""
    scene = load_scene("opposed-piston")
    supports = scene.supports.model_copy(
        update={"bearing_spring_N_per_mm": None, "bearing_clearance_mm": 0.05}
    )
    assert bearing_spring_N_per_mm(scene.model_copy(update={"supports": supports})) == pytest.approx(
        1.072e6, rel=5e-4
    )
    assert bearing_spring_N_per_mm(scene) == 1.072e6
    assert bearing_spring_N_per_mm(MIKRON) is None


def test_a_bearing_too_soft_to_hold_a_throw():
    """From a clearance as from a key: 85 730 N over 0.8 of 100 mm is 536 N/mm."""
    scene = load_scene("opposed-piston")
    supports = scene.supports.model_copy(
        update={"bearing_spring_N_per_mm": None, "bearing_clearance_mm": 100.0}
    )
    with pytest.raises(CranktopoError, match=r"bearing_clearance_mm: gives .* 536 N/mm; must be at least"):
        bearing_spring_N_per_mm(scene.model_copy(update={"supports": supports}))


@pytest.mark.parametrize(
    ("name", "slope"),
    [
        ("HK4520", 52094),
        ("HK6020", 50987),
        ("AXW45", 49818),
    ],
)
def test_linear_fit_of_roller_tables(name, slope):
    bearing = RollerBearing.model_validate({"name": name})
    assert table_slope_N_per_mm(bearing) == pytest.approx(slope, abs=0.5)


@pytest.mark.parametrize(("name", "length_mm"), [("HK4520", 15.3), ("HK6020", 15.3), ("AXW45", 5.8)])
def test_roller_tables_are_of_one_millimetre(name, length_mm):
    """Line contact of Palmgren, 3.84e-5 Q^0.9 / l^0.8 mm in steel: softer by a third than the tables are.

    As reactions of a whole roller the same tables would be softer than both its contacts one after the other.
    """
    bearing = RollerBearing.model_validate({"name": name})
    assert bearing.roller_length_mm == length_mm
    displacement, reaction = np.array(bearing.displacement_mm), np.array(bearing.reaction_N)

    def palmgren_mm(force_N):
        return 3.84e-5 * force_N**0.9 / length_mm**0.8

    heavy = displacement >= 0.004
    whole = palmgren_mm(reaction * length_mm)[heavy] / displacement[heavy]
    assert whole == pytest.approx(np.ones(heavy.sum()), abs=0.36)
    assert (2 * palmgren_mm(reaction)[heavy] < 0.6 * displacement[heavy]).all()


def test_roller_bearing_stiffness_in_a_scene():
    """Z k l / 4, against the sum over the rollers of the loaded half, each of 15.3 mm: eq. 69 of Kral."""
    bearing = RollerBearing.model_validate({"name": "HK6020"})
    supports = MIKRON.supports.model_copy(update={"roller_bearing": bearing, "bending": "spring"})
    got = bearing_spring_N_per_mm(MIKRON.model_copy(update={"supports": supports}))
    angle = 2 * np.pi * (np.arange(40) + 0.5) / 40
    rollers = np.maximum(np.cos(angle), 0) * np.cos(angle)
    assert got == pytest.approx(rollers.sum() * 15.3 * table_slope_N_per_mm(bearing), rel=1e-12)
    assert got == pytest.approx(7.80e6, rel=1e-3)
    whole = bearing.model_copy(update={"roller_length_mm": None})  # a table of whole rollers
    supports = supports.model_copy(update={"roller_bearing": whole})
    alone = bearing_spring_N_per_mm(MIKRON.model_copy(update={"supports": supports}))
    assert alone == pytest.approx(got / 15.3, rel=1e-12)


def test_gear_of_the_balancer_shaft():
    """Kral prints 112.2, 43.4 and 40.8 N at 2460 rpm on a radius of 34.586 mm.

    Helix and pressure angle are printed, 20 deg each; the power is not: 1 kW gives all three forces to 0.2 %.
    The printed forces of the counterweights cannot be reproduced: neither their masses nor radii are there.
    """
    gear = Gear(power_kW=1.0, pitch_radius_mm=34.586, helix_deg=20.0, pressure_deg=20.0)
    forces = gear_forces(gear, 2460 * math.pi / 30)
    assert forces.tangential_N == pytest.approx(112.2, abs=0.05)
    assert forces.radial_N == pytest.approx(43.4, rel=2e-3)
    assert forces.axial_N == pytest.approx(40.8, abs=0.06)


@pytest.mark.parametrize(("name", "rating_kN", "hours"), [("HK4520", 26.0, 9018), ("HK6020", 31.9, 17831)])
def test_life_of_the_balancer_shafts_bearings(name, rating_kN, hours):
    """Ratings as printed, life by ISO 281 under the largest printed force of a counterweight.

    No printed life is at hand to compare with: (C / P)^(10/3), C / P = 8.655 and 10.619, at 2460 rpm.
    """
    bearing = RollerBearing.model_validate({"name": name})
    assert bearing.dynamic_rating_kN == rating_kN
    assert rating_life_h(bearing.dynamic_rating_kN, 3004.1, 2460.0) == pytest.approx(hours, rel=1e-4)
