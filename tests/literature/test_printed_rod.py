"""Rods of the Walter Mikron III C as Dolezal 2024 prints them, and the sources of the formulae.

Printed are masses, strengths and safeties of three rods, not their dimensions: those of the built-in designs
are a reconstruction from these numbers. What can be wrong is then the way from forces to safeties, and
whether one rod meets all its numbers at once.
"""

import functools
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from cranktopo.design.loading import load_scene
from cranktopo.design.material import Material
from cranktopo.tasks.rod.element_stage import check_rod_elements, rod_on_elements
from cranktopo.tasks.rod.eye import pulled_arch, pushed_arch, ring_stress_MPa
from cranktopo.tasks.rod.lighter import lighten_rod
from cranktopo.tasks.rod.stage import check_rod_strength
from tests.studies.rod_sections import (
    PUSH_SPEED,
    at_section,
    goodman,
    hardly_tightened,
    largest_MPa,
    mesh_rows,
    printed_fatigue,
)

PRINTED = {
    "mikron-iiic-rod": (0.469, 2.56, 2.15, 1.92, 2.66),
    "mikron-iiic-rod-i": (0.6105, 3.41, 2.67, 3.08, 3.09),
    "mikron-iiic-rod-h": (0.5422, 3.04, 2.95, 2.74, 3.89),
}
"""Mass, analytic safety against yield of sections II and III, fatigue of both."""


@pytest.fixture(scope="module")
def rods():
    return {name: check_rod_strength(name) for name in PRINTED}


def of(rod, name):
    return next(section for section in rod.sections if section.section == name)


@pytest.mark.parametrize("name", PRINTED)
def test_masses_and_yield_safeties(rods, name):
    """Section II has the push over its area, section III the allowance of Navier and Rankine."""
    rod, material = rods[name], load_scene(name).rod.material
    mass, second, third, *_ = PRINTED[name]
    assert rod.masses.total_kg == pytest.approx(mass, abs=1.5e-4)
    neck = of(rod, "eye to shank")
    assert material.yield_MPa * neck.area_mm2 / neck.push_N == pytest.approx(second, abs=0.005)
    assert rod.buckling[0].yield_safety == pytest.approx(third, abs=0.005)


@pytest.mark.parametrize(
    ("row", "section"), [("the same with whip", "eye to shank"), ("big end, computed", "big end")]
)
def test_computed_rows_of_the_page_are_those_of_the_command(rods, row, section):
    """The page had 2.56 for the neck, which is without whip, and 9.97 and 9.38 for the big ends of steel."""
    lines = (Path(__file__).parents[2] / "docs/pages/crank-train.md").read_text(encoding="utf-8").splitlines()
    (line,) = (line for line in lines if line.startswith(f"| {row}"))
    told = [f"{of(rods[name], section).yield_safety:.2f}" for name in PRINTED]
    assert [cell.strip() for cell in line.strip("|").split("|")[1:]] == told


def test_split_of_the_rod_of_aluminium(rods):
    masses = rods["mikron-iiic-rod"].masses
    assert masses.reciprocating_kg == pytest.approx(0.1436, abs=1e-4)
    assert masses.rotating_kg == pytest.approx(0.3254, abs=1e-4)


@pytest.mark.parametrize("name", PRINTED)
def test_eye_and_cap_have_more_than_fifteen(rods, name):
    assert of(rods[name], "eye, crown").yield_safety > 15
    assert of(rods[name], "cap").yield_safety > 15


def test_big_end_of_aluminium(rods):
    """5.94 is met by the push on both sides of the split; no section explains 4.27 and 4.51 of steel.

    Their printed fatigue safeties of this section ask for a smallest stress of a quarter of the largest with
    the same sign, three times what inertia makes of it: it has another load there, which is not printed.
    """
    assert of(rods["mikron-iiic-rod"], "big end").yield_safety == pytest.approx(5.94, abs=0.01)
    for name in ("mikron-iiic-rod-i", "mikron-iiic-rod-h"):
        assert of(rods[name], "big end").yield_safety > 6


@pytest.mark.parametrize("name", PRINTED)
@pytest.mark.parametrize(("section", "place"), [("eye to shank", 3), ("mid-shank", 4)])
def test_fatigue_safeties_with_the_pull_taken_as_a_push(rods, name, section, place):
    """Printed values follow where the largest pull has the sign of the push, at the speed of the push.

    With its own sign, and the mean stress in tension as it is taken there, each is 3 to 5 % lower. The
    allowance for buckling is in the printed safety against yield of section III, not in that for fatigue.
    """
    found, printed = of(rods[name], section), PRINTED[name][place]
    material = load_scene(name).rod.material
    push, pull = found.push_N / found.area_mm2, found.pull_N / found.area_mm2
    slower = pull * PUSH_SPEED**2
    assert goodman(material, push, slower) == pytest.approx(printed, rel=0.02)
    assert goodman(material, push, -slower) / printed == pytest.approx(0.964, abs=0.011)


@pytest.mark.parametrize("name", PRINTED)
def test_eye_and_cap_have_more_than_fifteen_for_fatigue(rods, name):
    """By the same rule; the cap at the speed of the push, as at takeoff speed that of aluminium has 11.6."""
    material = load_scene(name).rod.material
    crown, cap = of(rods[name], "eye, crown"), of(rods[name], "cap")
    assert goodman(material, crown.min_MPa, crown.max_MPa) > 15
    assert goodman(material, cap.max_MPa * PUSH_SPEED**2, 0.0) > 15


def test_fatigue_of_the_big_end_of_aluminium(rods):
    found, material = of(rods["mikron-iiic-rod"], "big end"), load_scene("mikron-iiic-rod").rod.material
    slower = found.max_MPa * PUSH_SPEED**2
    assert goodman(material, -found.min_MPa, slower) == pytest.approx(4.55, rel=0.02)


@pytest.mark.parametrize(
    ("name", "against_yield", "fatigue", "ours", "share"),
    [("mikron-iiic-rod-i", 4.27, 4.08, 9.06, 0.25), ("mikron-iiic-rod-h", 4.51, 4.26, 8.51, 0.21)],
)
def test_fatigue_of_the_big_ends_of_steel_is_that_of_another_load(
    rods, name, against_yield, fatigue, ours, share
):
    """Both printed safeties together ask for a smallest stress of 0.25 and 0.21 of the largest, of one sign.

    The printed pull is 0.039 of the printed push. By the rule that meets aluminium ours are twice as safe.
    """
    found, material = of(rods[name], "big end"), load_scene(name).rod.material
    assert goodman(material, -found.min_MPa, found.max_MPa * PUSH_SPEED**2) == pytest.approx(ours, abs=0.01)
    largest = material.yield_MPa / against_yield
    smallest = brentq(lambda low: goodman(material, largest, low) - fatigue, -largest, largest)
    assert smallest / largest == pytest.approx(share, abs=0.005)
    assert share > 5 * 1348 / 34480


def test_printed_strengths_are_those_of_the_library():
    """1100, 900 and 630 MPa of the steel; 385, 300 and 154 MPa of the aluminium, 0.4 of the first."""
    steel, aluminium = (load_scene(name).rod.material for name in ("mikron-iiic-rod-i", "mikron-iiic-rod"))
    for material, printed in ((steel, (1100, 900, 630)), (aluminium, (385, 300, 154))):
        library = Material.model_validate({"name": material.name})
        assert (library.ultimate_MPa, library.yield_MPa, library.fatigue_bending_MPa) == printed
        assert material == library
    assert aluminium.fatigue_bending_MPa == pytest.approx(0.4 * aluminium.ultimate_MPa)


def test_stresses_by_elements_that_are_printed():
    """148, 337 and 382 MPa: yield strength over the printed safety, and Goodman with the pull as a pull."""
    aluminium, steel = (load_scene(name).rod.material for name in ("mikron-iiic-rod", "mikron-iiic-rod-i"))
    for material, stress, safety, fatigue in (
        (aluminium, 148.0, 2.02, 1.46),
        (steel, 337.0, 2.70, 2.34),
        (steel, 382.0, 2.40, 2.06),
    ):
        assert material.yield_MPa / stress == pytest.approx(safety, rel=0.02)
        assert goodman(material, stress, -stress * 1348 / 34480) == pytest.approx(fatigue, rel=0.012)


NECK_MPA = {"mikron-iiic-rod": 148.0, "mikron-iiic-rod-i": 337.0, "mikron-iiic-rod-h": 382.0}
"""Largest stress of section II by elements."""
PRINTED_ELEMENTS = {
    "mikron-iiic-rod": {"II": (2.02, 1.46), "III": (2.54, 1.83), "big end": (5.59, 4.51)},
    "mikron-iiic-rod-i": {"II": (2.70, 2.34), "III": (3.46, 3.04), "big end": (8.24, 6.51)},
    "mikron-iiic-rod-h": {"II": (2.40, 2.06), "III": (3.11, 2.74), "big end": (7.01, 4.74)},
}
"""Safeties by elements, against yield and for fatigue. Eye and cap have more than 15, but the eye of
aluminium 10.63 and 4.98."""


@functools.cache
def on_elements(name):
    """A rod whose bores rigid pins touch: the load for which the printed order of its places speaks.

    A cap with more than 15 has no preload.
    """
    return rod_on_elements(hardly_tightened(name), "lsa", None, contact=True)


def as_printed(name, place):
    """Safety against yield, and by Goodman with the pull at the speed of the push."""
    material = load_scene(name).rod.material
    largest = max(place.max_MPa, -place.min_MPa)
    return material.yield_MPa / largest, printed_fatigue(material, place.max_MPa, place.min_MPa)


@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED_ELEMENTS)
def test_stresses_by_elements_of_rods_that_meet_the_analytic_numbers(name):
    """With rigid pins the neck has the printed stress within 13 %, from below in all three rods.

    By the cosine over half the bore the small end bends about the narrow neck, and its bore alone has more
    than all that is printed: it is not the source's load.
    """
    found = on_elements(name).strength.elements
    places = {place.place: place for place in found.places}
    assert 0.87 * NECK_MPA[name] < -places["eye to shank"].min_MPa < NECK_MPA[name]
    assert all(place.error_percent < 3 for place in places.values() if place.place != "cap")
    by_cosine = check_rod_elements(hardly_tightened(name), element_size_mm=3.0).elements
    assert by_cosine.yield_safety < found.yield_safety


@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED_ELEMENTS)
def test_safeties_by_elements_of_every_section(name):
    """Neck 3 to 12 % above, shank 3 to 14 % below the printed ones; the big end, of guessed shape, is below.

    Crown and cap have more than 15 in all rods; 10.63 of the eye of aluminium has no place in ours.
    """
    places = {place.place: place for place in on_elements(name).strength.elements.places}
    for section, place, low, high in (
        ("II", "eye to shank", 1.0, 1.13),
        ("III", "mid-shank", 0.85, 1.0),
        ("big end", "big end", 0.5, 1.15),
    ):
        for ours, printed in zip(
            as_printed(name, places[place]), PRINTED_ELEMENTS[name][section], strict=True
        ):
            assert low < ours / printed < high
    material, stress = load_scene(name).rod.material, on_elements(name).stress
    for section in ("crown of the eye", "middle of the cap"):
        here = at_section(stress, section)
        assert material.yield_MPa / largest_MPa(stress, section) > 15
        assert printed_fatigue(material, stress.high_MPa[:, here].max(), stress.low_MPa[:, here].min()) > 15


def test_both_printed_safeties_of_the_eye_of_aluminium_are_not_of_one_place():
    """10.63 against yield is 28.2 MPa: if all of it were amplitude, the fatigue safety would be 5.46."""
    aluminium = load_scene("mikron-iiic-rod").rod.material
    largest = aluminium.yield_MPa / 10.63
    assert goodman(aluminium, largest, -largest) == pytest.approx(5.46, abs=0.01)


@pytest.mark.slow
def test_printed_study_of_elements():
    """142.9, 147.6 and 148.6 MPa with 3, 2 and 1 mm: 3 mm is 3.8 % off. Curved elements are within 0.3 %."""
    stresses = [float(row.split("|")[3]) for row in mesh_rows()]
    assert 142.9 / 148.6 < 0.962
    assert stresses[:2] == pytest.approx([stresses[2]] * 2, rel=3e-3)


def test_pull_of_the_piston_group_at_takeoff_speed(rods):
    """2445 N are printed; 0.491 kg at 2800 rpm have 2612 N, and 2445 N belong to 2709 rpm."""
    centripetal = 48.0 * (2800 * math.pi / 30) ** 2 / 1000
    gas = (0.10133 - 0.10133) * math.pi / 4 * 95**2
    assert 0.491 * centripetal * (1 + 48 / 166) - gas == pytest.approx(2612, abs=1)
    assert rods["mikron-iiic-rod"].pull_N == pytest.approx(2612, abs=1)


@pytest.mark.parametrize("held_deg", [90, 105, 120, 130])
def test_pulled_eye_against_the_fit_of_kinasoshvili(held_deg):
    """N = F (0.572 - 0.0008 phi), M = F r (0.00033 phi - 0.0297): straight lines through the same curves."""
    arch = pulled_arch(math.radians(held_deg))
    assert arch.normal[0] == pytest.approx(0.572 - 0.0008 * held_deg, rel=0.02)
    assert arch.moment[0] == pytest.approx(0.00033 * held_deg - 0.0297, abs=0.0041)


@pytest.mark.parametrize(
    ("held_deg", "normal", "moment"), [(110, 0.0009, 0.00025), (120, 0.0030, 0.0011), (130, 0.0085, 0.0030)]
)
def test_pushed_eye_against_the_table_of_kinasoshvili(held_deg, normal, moment):
    arch = pushed_arch(math.radians(held_deg))
    assert arch.normal[0] == pytest.approx(normal, abs=4.5e-4)
    assert -arch.moment[0] == pytest.approx(moment, abs=1.6e-4)


@pytest.mark.parametrize(("ratio", "error"), [(1.3, 0.002), (2.0, 0.012), (3.0, 0.05)])
def test_curved_beam_against_timoshenko_and_goodier(ratio, error):
    """Pure bending of a curved bar, Theory of Elasticity, article 29: the exact stress at both faces."""
    a, b = 10.0, 10.0 * ratio
    square, log = b**2 - a**2, math.log(ratio)
    norm = square**2 - 4 * (a * b * log) ** 2

    def exact(r):
        rest = b**2 * math.log(r / b) + a**2 * math.log(a / r) + square
        return 4 / norm * (-((a * b / r) ** 2) * log + rest)

    inner, outer = ring_stress_MPa(a, b, 1.0, np.array([-1.0]), np.array([0.0]), 1.0)
    assert abs(inner[0]) == pytest.approx(abs(exact(a)), rel=error)
    assert abs(outer[0]) == pytest.approx(abs(exact(b)), rel=error)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "share"), [("mikron-iiic-rod-h", 0.97), ("mikron-iiic-rod-i", 0.88)])
def test_a_lighter_rod_than_printed_at_no_less_safety(name, share):
    """No section less safe than the weakest of the printed rod; eyes and bolts stay, walls are no thinner."""
    changed, found = lighten_rod(name)
    assert found.result_kg < share * found.start_kg
    assert found.smallest_yield_safety[1] >= found.smallest_yield_safety[0]
    assert found.smallest_fatigue_safety[1] >= found.smallest_fatigue_safety[0]
    assert found.crankpin_pull_N[1] < found.crankpin_pull_N[0]
    assert changed.rod.flange_mm >= 3.0
    assert changed.rod.web_mm >= 3.0
    assert changed.rod.boss_width_mm >= load_scene(name).rod.boss_width_mm
    assert changed.rod.small_end_diameter_mm >= load_scene(name).rod.small_end_diameter_mm
