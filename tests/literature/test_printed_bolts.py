"""Bolts against the tables of standards and textbooks, and against their own closed forms.

The rods of Dolezal 2024 are no case here: no thread, grip, preload or factor of their bolts is among the
printed values at hand.
"""

import math

import numpy as np
import pytest

from cranktopo.design.bolt import Bolt, strength, thread
from cranktopo.design.material import Material
from cranktopo.tasks.bolts.joint import (
    BOLT_E_MPA,
    JointLoads,
    assembly_preload_N,
    bolt_compliance_mm_per_N,
    cut_cones_compliance_mm_per_N,
    part_compliance_mm_per_N,
    shigley,
    tightening_torque_Nm,
    vdi_2230,
)

STEEL = Material.model_validate({"name": "42CrMo4"})


def bolt(**changes):
    return Bolt.model_validate({"thread": "M10", "strength_class": "8.8", "grip_mm": 30.0, **changes})


@pytest.mark.parametrize(
    ("name", "area"),
    [("M3", 5.03), ("M8", 36.6), ("M8x1", 39.2), ("M10", 58.0), ("M12x1.5", 88.1), ("M36", 817.0)],
)
def test_stress_areas_of_iso_898(name, area):
    assert thread(name).stress_area_mm2 == pytest.approx(area, rel=1.5e-3)


def test_diameters_of_iso_724():
    m10 = thread("M10")
    assert m10.pitch_diameter_mm == pytest.approx(9.026, abs=5e-4)
    assert m10.core_diameter_mm == pytest.approx(8.160, abs=5e-4)
    assert m10.nut_core_diameter_mm == pytest.approx(8.376, abs=5e-4)


@pytest.mark.parametrize(
    ("name", "pitch_diameter", "core_diameter"),
    [("M9", 8.188, 7.647), ("M9x1", 8.350, 7.917), ("M11", 10.026, 9.376), ("M11x1", 10.350, 9.917)],
)
def test_third_choices_of_iso_261_have_the_diameters_of_iso_724(name, pitch_diameter, core_diameter):
    """D2 and D1 as the table prints them; bolts of rods have these threads."""
    found = thread(name)
    assert found.pitch_diameter_mm == pytest.approx(pitch_diameter, abs=5e-4)
    assert found.nut_core_diameter_mm == pytest.approx(core_diameter, abs=5.1e-4)


def test_a_thread_that_is_none_is_told_which_are():
    with pytest.raises(ValueError, match=r"8, 9, 10, 11, 12, 14, 16"):
        thread("M13")
    with pytest.raises(ValueError, match=r"from 0\.36 to 1\.25 mm"):
        thread("M9x1.5")


@pytest.mark.parametrize("name", ["M13", "M9.5", "M10x2", "M10x0.1", "10", "M"])
def test_threads_that_are_none(name):
    with pytest.raises(ValueError, match="ISO 261"):
        thread(name)


@pytest.mark.parametrize(
    ("name", "strength_class", "head", "hole", "preload_kN", "torque_Nm"),
    [
        ("M8", "8.8", 11.6, 9.0, 18.6, 24.6),
        ("M10", "8.8", 14.6, 11.0, 29.6, 48.0),
        ("M12", "8.8", 16.6, 13.5, 43.0, 84.0),
        ("M16", "8.8", 22.5, 17.5, 80.9, 206.0),
        ("M10", "10.9", 14.6, 11.0, 43.4, 71.0),
        ("M10", "12.9", 14.6, 11.0, 50.8, 83.0),
    ],
)
def test_assembly_preloads_and_torques_of_vdi_2230(name, strength_class, head, hole, preload_kN, torque_Nm):
    """Table A1 of the guideline at friction 0.12, ninety percent of the yield strength."""
    screw = bolt(thread=name, strength_class=strength_class, head_diameter_mm=head, hole_diameter_mm=hole)
    preload = assembly_preload_N(screw)
    assert preload / 1000 == pytest.approx(preload_kN, rel=3e-3)
    assert tightening_torque_Nm(screw, preload) == pytest.approx(torque_Nm, rel=1.5e-2)


def test_tightening_takes_the_utilised_share_of_the_yield_strength():
    found = vdi_2230(bolt(utilisation=0.7), JointLoads(1000.0), STEEL)
    assert found.assembly_stress_MPa == pytest.approx(0.7 * 640, rel=2e-3)


def test_torque_without_friction_is_the_work_of_the_pitch():
    screw = bolt(thread_friction=0.02, head_friction=0.02)
    rough = bolt(thread_friction=0.04, head_friction=0.04)
    frictionless = 2 * tightening_torque_Nm(screw, 1e4) - tightening_torque_Nm(rough, 1e4)
    assert frictionless * 1000 * 2 * math.pi == pytest.approx(1e4 * 1.5, rel=6e-3)


def test_a_narrow_part_is_a_sleeve_and_a_wide_one_a_cone():
    sleeve = math.pi / 4 * (14.0**2 - 11.0**2) * 210e3 / 30.0
    narrow = bolt(member_diameter_mm=14.0, head_diameter_mm=14.6)
    assert 1 / part_compliance_mm_per_N(narrow, 210e3) == pytest.approx(sleeve, rel=1e-12)
    at_head = bolt(member_diameter_mm=14.6 + 1e-9, head_diameter_mm=14.6)
    just_below = bolt(member_diameter_mm=14.6, head_diameter_mm=14.6)
    assert part_compliance_mm_per_N(at_head, 210e3) == pytest.approx(
        part_compliance_mm_per_N(just_below, 210e3), rel=1e-6
    )
    widths = [part_compliance_mm_per_N(bolt(member_diameter_mm=w), 210e3) for w in (18.0, 25.0, 40.0)]
    assert widths[0] > widths[1] > widths[2]


def test_a_long_bolt_is_its_shank():
    long = bolt(grip_mm=2000.0, shank_mm=2000.0)
    plain = 2000.0 / (BOLT_E_MPA * math.pi / 4 * 100)
    assert bolt_compliance_mm_per_N(long, 210e3) == pytest.approx(plain, rel=1e-2)


def test_members_by_shigley_agree_with_the_fit_of_wileman():
    """k = E d 0.78715 exp(0.62873 d / l) for steel, Shigley (8-23); a fit to elements."""
    screw = bolt(held_in="nut", grip_mm=30.0)
    fit = 210e3 * 10 * 0.78715 * math.exp(0.62873 * 10 / 30)
    assert shigley(screw, JointLoads(1000.0), STEEL).parts_N_per_mm == pytest.approx(fit, rel=0.05)


def by_quadrature(width, grip, d=10.0, steps=400_000):
    """Compliance as the sum of dl / (E A) over slices of cones of 30 deg that the width cuts."""
    at = (np.arange(steps) + 0.5) * grip / steps
    diameter = np.minimum(1.5 * d + 2 * 0.5774 * np.minimum(at, grip - at), width)
    return float(np.sum(grip / steps / (210e3 * math.pi / 4 * (diameter**2 - d**2))))


@pytest.mark.parametrize("held_in", ["nut", "tapped_hole"])
@pytest.mark.parametrize("width", [12.5, 15.0, 16.0, 20.0, 25.0, 31.0, 40.0])
def test_cones_of_shigley_end_at_the_width_of_the_parts(width, held_in):
    """A part of 25 mm had the stiffness of one without an end, 1,776,951 N/mm."""
    screw = bolt(held_in=held_in, grip_mm=30.0, member_diameter_mm=width)
    grip = 30.0 if held_in == "nut" else 35.0
    found = cut_cones_compliance_mm_per_N(screw, grip, 210e3)
    assert found == pytest.approx(by_quadrature(width, grip), rel=1e-8)
    judged = shigley(screw, JointLoads(1000.0), STEEL)
    assert judged.parts_N_per_mm == pytest.approx(1 / found, rel=1e-12)


@pytest.mark.parametrize("width", [None, 15.0 + 0.5774 * 30.0, 100.0])
def test_cones_of_shigley_within_the_parts_have_the_printed_form(width):
    given = {} if width is None else {"member_diameter_mm": width}
    cone, d, E = 0.5774 * 30.0, 10.0, 210e3
    printed = 0.5774 * math.pi * E * d / (2 * math.log(5 * (cone + 0.5 * d) / (cone + 2.5 * d)))
    found = cut_cones_compliance_mm_per_N(bolt(held_in="nut", **given), 30.0, E)
    assert 1 / found == pytest.approx(printed, rel=1e-12)


def test_the_bolt_of_a_narrower_part_takes_more_by_both_methods():
    loads = JointLoads(5000.0, -2000.0)
    widths = [bolt(held_in="nut", member_diameter_mm=w) for w in (13.0, 18.0, 25.0, 32.0)]
    by_shigley = [shigley(one, loads, STEEL) for one in widths]
    shares = [one.stiffness_share for one in by_shigley]
    assert shares == sorted(shares, reverse=True)
    assert len(set(shares)) == len(shares)
    assert by_shigley[0].fatigue_safety < by_shigley[-1].fatigue_safety
    factors = [vdi_2230(one, loads, STEEL).load_factor for one in widths]
    assert factors == sorted(factors, reverse=True)


def test_joint_forces_balance():
    """What the split loses and the bolt gains is the load, by both methods."""
    loads = JointLoads(5000.0)
    vdi = vdi_2230(bolt(embedding_um=0.0, tightening_factor=1.0), loads, STEEL)
    gained, lost = vdi.max_bolt_N - vdi.preload_N, vdi.preload_N - vdi.residual_clamp_N
    assert gained + lost == pytest.approx(5000.0, rel=1e-12)
    parting = JointLoads(vdi.preload_N / (1 - vdi.load_factor))
    at_split = vdi_2230(bolt(embedding_um=0.0, tightening_factor=1.0), parting, STEEL)
    assert at_split.residual_clamp_N == pytest.approx(0.0, abs=1e-6)
    assert at_split.clamp_safety == pytest.approx(1.0, rel=1e-12)


def test_shigleys_safeties_are_the_loads_at_which_they_are_one():
    screw, found = bolt(), shigley(bolt(), JointLoads(5000.0), STEEL)
    assert shigley(screw, JointLoads(5000.0 * found.load_safety), STEEL).proof_safety == pytest.approx(1.0)
    again = shigley(screw, JointLoads(5000.0 * found.separation_safety), STEEL)
    assert again.separation_safety == pytest.approx(1.0)
    assert again.fatigue_safety * found.separation_safety == pytest.approx(found.fatigue_safety)


def test_a_short_thread_strips_and_a_long_one_breaks_the_bolt():
    short, long = (vdi_2230(bolt(engagement_mm=e), JointLoads(1e3), STEEL).thread_safety for e in (4.0, 15.0))
    assert short < 1 < long
    assert strength("8.8", thread("M20")).yield_MPa == 660


def test_a_reduced_shank_is_the_stressed_section():
    """VDI 2230 takes d0 = d_T; Shigley's proof load is that of the weakest section as well."""
    loads, shank = JointLoads(5000.0, 1000.0), math.pi / 4 * 5.5**2
    waisted = bolt(shank_mm=20.0, shank_diameter_mm=5.5)
    found, again = vdi_2230(waisted, loads, STEEL), shigley(waisted, loads, STEEL)
    assert found.assembly_stress_MPa == pytest.approx(0.9 * 640, rel=2e-3)
    assert found.amplitude_MPa == pytest.approx(found.load_factor * 2000 / shank)
    assert again.preload_N == pytest.approx(0.75 * 580 * shank)
    full = bolt(shank_mm=20.0, shank_diameter_mm=5.5, preload_N=43_400.0, strength_class="10.9")
    assert vdi_2230(full, loads, STEEL).yield_safety < 940 / 1830
    assert assembly_preload_N(bolt(shank_diameter_mm=5.5)) == assembly_preload_N(bolt())
