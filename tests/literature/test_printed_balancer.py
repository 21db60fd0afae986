"""The balancer shaft of Kral 2014: what is printed, and what a reconstruction has to meet at once.

Printed are forces, bearings, lengths without their places, the deflection of the spline and one safety.
Diameters and the radius of the groove are not: those of the design make the spline bend by 0.043 mm.
"""

import math

import numpy as np
import pytest

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.named import with_values
from cranktopo.engine.bearings import rating_life_h, table_slope_N_per_mm
from cranktopo.tasks.balancer.notch import groove_factor, hole_factor, size_factor
from cranktopo.tasks.balancer.redesign import redesign_balancer
from cranktopo.tasks.balancer.stage import check_balancer
from tests.studies.balancer_forces import BUILT, PRINTED_N, TOLERANCE, any_speed, layouts, readings

SCENE = load_scene("balancer-shaft")
FOUND = check_balancer(SCENE)
HK4520, HK6020, AXW45 = FOUND.bearings


def test_forces_of_masses_and_gear():
    assert [w.force_N for w in FOUND.weights] == pytest.approx([3004.1, 3003.8], abs=0.2)
    assert FOUND.gear.tangential_N == pytest.approx(112.2, abs=0.05)
    assert FOUND.gear.axial_N == pytest.approx(40.8, abs=0.06)
    assert FOUND.gear.radial_N == pytest.approx(43.4, abs=0.1)


def test_reactions_by_statics():
    """Both masses on two supports 161 mm apart, by hand; springs do not change them."""
    right = (3004.1 * (92 - 32) + 3003.8 * (253 - 32)) / 161
    assert HK6020.weights_N == pytest.approx(right, abs=0.5)
    assert HK4520.weights_N == pytest.approx(abs(3004.1 + 3003.8 - right), abs=0.5)
    assert AXW45.max_N == pytest.approx(40.8, abs=0.06)


IN_BEARINGS = "in space", "both in one direction"
"""Sums that are the force of a bearing: the others leave a part of it out, or add what is at right angles."""


@pytest.fixture(scope="module")
def layout():
    return layouts()


def hits(layout, wanted, sums):
    """Readings with the layouts that meet two forces, and by which share the nearest of all misses them."""
    off = list(readings(layout, wanted, sums))
    found = [(*what, layout[share < TOLERANCE]) for *what, share in off if (share < TOLERANCE).any()]
    return found, min(share.min() for *_, share in off)


def test_no_reading_makes_the_other_printed_forces_those_of_bearings(layout):
    """1981.5 and 1877.4 N stand beside the forces of the masses: not with 161 mm between the bearings."""
    built = layout[layout[:, 0] == 161.0]
    found, nearest = hits(built, PRINTED_N, IN_BEARINGS)
    assert not found
    assert TOLERANCE < nearest < 1e-2


@pytest.mark.slow
def test_readings_of_any_layout(layout):
    """Nor elsewhere; but for bearings 32 mm apart where the gear's force along the shaft is left out.

    Masses alone need a speed that is not printed.
    """
    found, nearest = hits(layout, PRINTED_N, IN_BEARINGS)
    assert {(masses, gear) for masses, gear, *_ in found} == {("opposed", "not axial")}
    assert {span for *_, at in found for span in at[:, 0]} == {32.0}
    assert nearest == pytest.approx(2.66e-4, abs=1e-6)
    assert all(abs(speed - 1) > 0.05 for speed in any_speed(layout, PRINTED_N)[1])


def test_the_search_of_readings_finds_the_shafts_own_forces(layout):
    """Forces by the beam on springs, told as if they were printed: the places of all parts come out."""
    built, own = layout[layout[:, 0] == 161.0], (HK4520.max_N, HK6020.max_N)
    found, _ = hits(built, own, ("both in one direction",))
    assert ("on one side", "all") in {(masses, gear) for masses, gear, *_ in found}
    assert any((at == BUILT).all(axis=1).any() for *_, at in found)


def test_stiffness_of_the_needle_bearings_is_that_of_their_whole_rollers():
    """Tables are of one millimetre of a roller: Z k l / 4 with 15.3 mm."""
    assert HK4520.spring_N_per_mm == pytest.approx(38 * 52094 * 15.3 / 4, rel=1e-4)
    assert HK6020.spring_N_per_mm == pytest.approx(40 * 50987 * 15.3 / 4, rel=1e-4)
    per_roller = with_values(SCENE, {"balancer.bearing[0].roller_bearing.roller_length_mm": 1.0})
    assert check_balancer(per_roller).bearings[0].spring_N_per_mm == pytest.approx(38 * 52094 / 4, rel=1e-4)


def test_spline_before_and_after_the_redesign():
    """0.043 mm printed; below 0.025 mm with a third bearing beyond it, as the redesign wants.

    Its place and stiffness are not printed. Life and safety, told by the shaft that was found, do not fall.
    """
    assert FOUND.probes[0].deflection_mm == pytest.approx(0.043, abs=1e-4)
    scene, found = redesign_balancer(SCENE)
    again = check_balancer(scene)
    assert [b.z_mm for b in again.bearings[:3]] == [b.z_mm for b in FOUND.bearings]
    assert 272.0 <= again.bearings[3].z_mm <= 284.0
    assert again.probes[0].deflection_mm < 0.025
    assert again.bearings[1].life_h > HK6020.life_h
    assert again.notches[0].running_safety > 2.9
    assert again.mass_kg == found.redesign.result_kg < FOUND.mass_kg


def test_lengths_that_are_printed_without_their_places():
    """32, 28, 76, 161, 60 and 60 mm: of the reconstruction the distances from the gear and the bearings."""
    part = SCENE.balancer
    first, second, thrust = (bearing.z_mm for bearing in part.bearing)
    masses = [weight.z_mm for weight in part.weight]
    found = [first - part.gear.z_mm, thrust - first, part.probe[0].z_mm - second, second - first]
    assert [*found, masses[0] - first, masses[1] - second] == [32.0, 28.0, 76.0, 161.0, 60.0, 60.0]
    assert part.gear.pitch_radius_mm == 34.586
    assert part.max_speed_rpm == 2460.0


def test_strengths_of_the_shaft():
    """16MnCr5: 900, 600, 385 and 315 MPa, of a specimen of 7.5 mm."""
    steel = SCENE.balancer.material
    found = steel.ultimate_MPa, steel.yield_MPa, steel.fatigue_bending_MPa, steel.fatigue_tension_MPa
    assert found == (900.0, 600.0, 385.0, 315.0)
    assert SCENE.fatigue.specimen_diameter_mm == 7.5


@pytest.mark.parametrize(
    ("name", "rollers", "rating_kN", "intercept_N", "r2"),
    [
        ("HK4520", 38, 26.0, -30.808, 0.9982),
        ("HK6020", 40, 31.9, -37.224, 0.9982),
        ("AXW45", 36, 27.0, -38.845, 0.9978),
    ],
)
def test_bearings_and_the_lines_through_their_tables(name, rollers, rating_kN, intercept_N, r2):
    """Least-squares lines have the printed intercept and scatter; for slopes see the main bearings."""
    bearing = next(b.roller_bearing for b in SCENE.balancer.bearing if b.roller_bearing.name == name)
    assert (bearing.rollers, bearing.dynamic_rating_kN) == (rollers, rating_kN)
    slope, intercept = np.polyfit(bearing.displacement_mm, bearing.reaction_N, 1)
    assert intercept == pytest.approx(intercept_N, abs=0.01)
    fitted = np.corrcoef(bearing.displacement_mm, bearing.reaction_N)[0, 1] ** 2
    assert fitted == pytest.approx(r2, abs=1e-4)
    assert slope == pytest.approx(table_slope_N_per_mm(bearing), rel=1e-9)


NEEDLE_TILT_DEG = np.linspace(0.05, 0.15, 11)
TILT_NMM = {
    "HK4520": [709, 1499, 2402, 4371, 5142, 5401, 6447, 7506, 8574, 9651, 10822],
    "HK6020": [1480, 2383, 3334, 4313, 5306, 6312, 7325, 8345, 9369, 10398, 11433],
    "AXW45": [3200, 14231, 25545, 36968, 48658, 60491, 72418, 85506, 96441, 108510],
}
"""Printed moments against tilt; those of AXW45 from 0.01 to 0.10 deg."""


def test_tilt_in_the_bearings_is_below_their_tables():
    """Moments against tilt are printed from 0.05 deg for needles, from 0.01 deg for AXW45: none acts here.

    Their lines begin at 0.05, 0.04 and 0.009 deg, up to which the rollers have play.
    """
    for bearing, least_deg in ((HK4520, 0.05), (HK6020, 0.05), (AXW45, 0.01)):
        tilts = NEEDLE_TILT_DEG if bearing is not AXW45 else np.linspace(0.01, 0.1, 10)
        slope, moment = np.polyfit(tilts[-5:], TILT_NMM[bearing.bearing][-5:], 1)
        assert math.degrees(bearing.tilt_mrad / 1000) < least_deg / 5 < -moment / slope


@pytest.mark.parametrize(("name", "share"), [("HK4520", 0.803), ("HK6020", 0.773)])
def test_moments_of_tilted_needles_are_those_of_one_roller_by_slices(name, share):
    """Half a roller, slice by slice on the printed line of a millimetre, is a quarter stiffer: k l^3 / 24."""
    bearing = next(b.roller_bearing for b in SCENE.balancer.bearing if b.roller_bearing.name == name)
    slope = np.polyfit(np.radians(NEEDLE_TILT_DEG[-5:]), TILT_NMM[name][-5:], 1)[0]
    slices = table_slope_N_per_mm(bearing) * bearing.roller_length_mm**3 / 24
    assert slope / slices == pytest.approx(share, abs=1e-3)


def test_two_printed_moments_of_hk4520_are_off_their_line():
    """At 0.08 and 0.09 deg; all steps that do not touch them are those of HK6020 within 14 %."""
    own, other = np.array(TILT_NMM["HK4520"]), np.array(TILT_NMM["HK6020"])
    off = np.abs(np.diff(own) / np.diff(other) - 1) > 0.14
    assert np.flatnonzero(off).tolist() == [2, 3, 4]
    between = np.interp([0.08, 0.09], [0.07, 0.10], own[[2, 5]])
    assert own[3:5] / between - 1 == pytest.approx([0.285, 0.168], abs=1e-3)


def test_safety_of_the_groove():
    """2.9 printed for the hardened groove, by elements; here by DIN 743, with a radius of 0.45 mm for it."""
    assert FOUND.notches[0].running_safety == pytest.approx(2.9, abs=0.1)


def test_life_over_one_speed_and_over_a_spectrum():
    """ISO 281; at half the speed a force of masses is a quarter and lives 4^(10/3) times as many turns."""
    assert HK6020.life_h == pytest.approx(rating_life_h(31.9, HK6020.equivalent_N, 2460.0), rel=1e-12)
    assert HK6020.weights_N < HK6020.equivalent_N < HK6020.max_N
    data = SCENE.model_dump(mode="json", exclude_none=True)
    del data["balancer"]["gear"]
    alone = check_balancer(scene_from_dict(data, whole=True)).bearings[1]
    assert alone.life_h == pytest.approx(rating_life_h(31.9, alone.weights_N, 2460.0), rel=1e-9)
    data["balancer"]["speed"] = [{"at_rpm": 1230.0, "share": 1.0}]
    slow = check_balancer(scene_from_dict(data, whole=True)).bearings[1]
    assert slow.life_h / alone.life_h == pytest.approx(2 * 4 ** (10 / 3), rel=1e-9)
    data["balancer"]["speed"] = [{"at_rpm": 2460.0, "share": 0.3}, {"at_rpm": 1230.0, "share": 0.6}]
    both = check_balancer(scene_from_dict(data, whole=True)).bearings[1]
    turns = 1 / (0.5 / (alone.life_h * 2460) + 0.5 / (slow.life_h * 1230))
    assert both.life_h == pytest.approx(turns / (2 / 3 * 2460), rel=1e-4)


@pytest.mark.parametrize("sharpness", [5.0, 10.0, 20.0])
def test_a_deep_groove_against_neuber(sharpness):
    """Hyperbolic groove in bending, Neuber's closed solution, by root radius over notch radius."""
    nu, root = 0.3, math.sqrt(sharpness + 1)
    norm = 3 * (sharpness + 1) + (1 + 4 * nu) * root + (1 + nu) / (1 + root)
    exact = 0.75 * (root + 1) * (3 * sharpness - (1 - 2 * nu) * root + 4 + nu) / norm
    assert groove_factor(4000.0, 40.0, 20.0 / sharpness) == pytest.approx(exact, rel=0.07)


def test_a_shallow_groove_against_inglis():
    """1 + 2 sqrt(t / r) for a groove that is small beside the shaft."""
    assert groove_factor(4000.02, 4000.0, 0.01) == pytest.approx(3.0, rel=0.09)


@pytest.mark.parametrize(("ratio", "factor"), [(0.05, 2.45), (0.1, 2.26), (0.2, 2.03)])
def test_hole_factors_against_din_743(ratio, factor):
    assert hole_factor(50.0, 50 * ratio) == pytest.approx(factor, abs=0.01)


def test_size_factor_falls_with_the_diameter():
    """One at the specimen; Shigley (6-20) at 45 over 7.5 mm; both branches meet at 51 mm to a percent."""
    assert size_factor(7.5, 7.5) == 1.0
    assert size_factor(45.0, 7.5) == pytest.approx((45 / 7.5) ** -0.107, rel=1e-12)
    assert size_factor(51.0, 7.5) == pytest.approx(size_factor(51.001, 7.5), rel=0.01)
    assert math.isclose(size_factor(5.0, 7.5), 1.0)
