"""Forces, whip, buckling, press fit and pin of the rod against closed forms and the engine's own forces."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.rod_body import rod_mass
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.rod_forces import rod_bolt_force_N, rod_motions
from cranktopo.tasks.rod.eye import bush_pressure_MPa, bush_share, press_fit_MPa, pulled_arch, pushed_arch
from cranktopo.tasks.rod.pin import check_pin
from cranktopo.tasks.rod.stage import check_rod_strength, navier_rankine_MPa

SCENE = load_scene("mikron-iiic-rod")
MASS = rod_mass(SCENE.rod, 166.0, SCENE.material)


def test_section_forces_are_those_of_the_engine_at_both_ends():
    """Beyond the small end the pin's force; below the big end the rod force less the turning mass."""
    motion = rod_motions(SCENE)[0]
    forces = analyse(SCENE).cycle.forces
    assert motion.section_force_N(MASS, 166.0, 1e9) * motion.cosine == pytest.approx(forces.small_end_force_N)
    below = motion.section_force_N(MASS, 166.0, -1e9) * motion.cosine
    whole = forces.rod_force_N * motion.cosine - MASS.rotating_kg * motion.pin_m_s2
    assert below == pytest.approx(whole, rel=1e-9, abs=1e-6)


def test_bolts_pull_half_of_what_is_above_the_cap():
    """At gas-exchange dead centre of the overspeed, by hand."""
    motion = rod_motions(SCENE)[1]
    centripetal = 0.048 * (2800 * math.pi / 30) ** 2
    above = MASS.y_mm > 0
    share = MASS.y_mm[above] / 166.0
    upper, lower = (share * MASS.y_kg[above]).sum(), ((1 - share) * MASS.y_kg[above]).sum()
    pull = centripetal * ((0.491 + upper) * (1 + 48 / 166) + lower)
    gas = np.interp(360.0, motion.angle_deg, motion.gas_N)
    assert 2 * rod_bolt_force_N(SCENE)[0] == pytest.approx(pull - gas, rel=1e-3)


def test_whip_of_a_uniform_bar():
    """A load that grows along a beam on two supports: W L / (9 sqrt 3) at L / sqrt 3 from the lighter end."""
    y = (np.arange(20000) + 0.5) * 166.0 / 20000
    bar = replace(MASS, y_mm=y, y_kg=np.full(20000, 0.3 / 20000))
    motion = rod_motions(SCENE)[0]
    only_big = replace(motion, small_m_s2=0 * motion.small_m_s2, big_m_s2=0 * motion.big_m_s2 + 1000.0)
    found = only_big.whip_moment_Nmm(bar, 166.0, 166.0 * (1 - 1 / math.sqrt(3)))[0]
    total = 0.3 * 1000.0 / 2
    assert found == pytest.approx(total * 2 * 166.0 / (9 * math.sqrt(3)), rel=1e-6)
    assert only_big.whip_moment_Nmm(bar, 166.0, 166.0)[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("held_deg", [100.0, 130.0])
@pytest.mark.parametrize("arch", [pulled_arch, pushed_arch])
def test_an_arch_stays_where_it_is_held(arch, held_deg):
    """The crown neither turns nor leaves the middle: both integrals of the moment vanish."""
    found = arch(math.radians(held_deg))
    size = np.abs(found.moment).max()
    rise = 1 - np.cos(found.angle_rad)
    assert abs(np.trapezoid(found.moment, found.angle_rad)) < 1e-12 + 1e-9 * size
    assert abs(np.trapezoid(found.moment * rise, found.angle_rad)) < 1e-12 + 1e-9 * size


def test_a_half_ring_under_even_pressure_is_a_membrane():
    found = pulled_arch(math.pi / 2)
    assert found.normal == pytest.approx(np.full(len(found.normal), 0.5), abs=1e-6)
    assert np.abs(found.moment).max() < 1e-6


def test_press_fit_closes_the_interference():
    """Radial growth of the eye's bore plus shrinkage of the bush is the interference."""
    rod = with_values(SCENE, {"rod.bush_interference_um": 30.0, "rod.bush_thickness_mm": 2.0}).rod
    pressure = bush_pressure_MPa(rod, rod.material)
    bore, inner = rod.small_end_bore_mm, rod.pin_diameter_mm
    at_bore, at_outside = press_fit_MPa(rod, pressure)
    grown = bore * (at_bore + rod.material.poisson * pressure) / (rod.material.E_GPa * 1e3)
    hoop = -pressure * (bore**2 + inner**2) / (bore**2 - inner**2)
    shrunk = -bore * (hoop + 0.34 * pressure) / (rod.bush_E_GPa * 1e3)
    assert grown + shrunk == pytest.approx(0.03, rel=1e-12)
    assert at_bore - at_outside == pytest.approx(pressure)
    assert 0 < bush_share(rod, rod.material) < 1


def test_navier_and_rankine_between_euler_and_yield():
    """A slender strut fails at Euler's load, a stocky one at the yield strength: 1/N = 1/Euler + 1/yield."""
    E, limit, area, moment = 210e3, 900.0, 100.0, 1000.0
    for length in (1.0, 50.0, 5000.0):
        failing = limit / navier_rankine_MPa(1.0, area, moment, length, E, limit)
        euler = math.pi**2 * E * moment / length**2
        assert 1 / failing == pytest.approx(1 / euler + 1 / (limit * area), rel=1e-12)


def test_navier_and_rankine_stays_below_euler_and_engesser():
    """Engesser with a parabolic tangent modulus (Johnson): Rankine has 64 % of the load at least, never more.

    The least ratio 4 x^2 / ((1 + x) (4 x - 1)) over x, Euler's over the yield load, is 16 / 25 at 2 / 3.
    """
    E, limit, area, moment = 210e3, 900.0, 100.0, 1000.0
    ratios = []
    for length in np.linspace(20, 1000, 981):
        failing = limit / navier_rankine_MPa(1.0, area, moment, length, E, limit)
        euler = math.pi**2 * E * moment / length**2
        johnson = limit * area * (1 - limit * area / (4 * euler)) if euler > limit * area / 2 else euler
        ratios.append(failing / min(johnson, euler))
    assert min(ratios) == pytest.approx(16 / 25, rel=1e-4)
    assert max(ratios) < 1


def test_pin_bends_as_a_beam():
    """Even load in the rod, triangles in the bosses: the moment in the middle by statics."""
    rod, pin = SCENE.rod, SCENE.rod.pin
    found = check_pin(rod, pin, 10_000.0)
    in_boss = (pin.length_mm - pin.boss_distance_mm) / 2
    arm = pin.boss_distance_mm / 2 + in_boss / 3 - rod.small_end_width_mm / 4
    outer, inner = rod.pin_diameter_mm, pin.bore_diameter_mm
    modulus = math.pi / 32 * (outer**4 - inner**4) / outer
    assert found.bending_MPa == pytest.approx(5000.0 * arm / modulus, rel=1e-12)
    assert found.eye_pressure_MPa == pytest.approx(10_000 / (outer * rod.small_end_width_mm))


def test_ovalisation_grows_as_a_thin_ring():
    """Of thin rings the diameter grows with the cube of mean diameter over wall."""
    pins = [SCENE.rod.pin.model_copy(update={"bore_diameter_mm": bore}) for bore in (16.0, 18.0)]
    first, second = (check_pin(SCENE.rod, pin, 1e4).ovalisation_um for pin in pins)
    ratio = (22 + 18) / (22 - 18) / ((22 + 16) / (22 - 16))
    slender = (0.1 - (18 / 22 - 0.4) ** 3) / (0.1 - (16 / 22 - 0.4) ** 3)
    assert second / first == pytest.approx(ratio**3 * slender, rel=1e-12)
    assert second > first


@pytest.mark.parametrize("key", ["rod.shank_width_mm", "rod.small_end_diameter_mm", "rod.big_end_width_mm"])
def test_more_material_is_safer(key):
    value = {"rod.shank_width_mm": 28.0, "rod.small_end_diameter_mm": 42.0, "rod.big_end_width_mm": 34.0}[key]
    roomy = {"throw.crankpin.length_mm": 40.0}
    before = check_rod_strength(with_values(SCENE, roomy))
    after = check_rod_strength(with_values(SCENE, {**roomy, key: value}))
    gained = [b.yield_safety - a.yield_safety for a, b in zip(before.sections, after.sections, strict=True)]
    assert max(gained) > 0.02
    assert after.masses.total_kg > before.masses.total_kg


def test_gas_at_overspeed_is_that_of_its_speed():
    low, high = (
        {"rpm": rpm, "peak_pressure_MPa": peak, "peak_angle_deg": 11.0}
        for rpm, peak in ((2100.0, 5.16), (2800.0, 6.5))
    )
    gas = SCENE.engine.gas.model_dump(exclude_none=True, exclude={"peak_pressure_MPa", "peak_angle_deg"})
    mapped = with_values(SCENE, {"engine.gas": {**gas, "map": [low, high]}})
    rated, fast = rod_motions(mapped)
    assert rated.gas_N == pytest.approx(rod_motions(SCENE)[0].gas_N)
    assert fast.gas_N == pytest.approx(rod_motions(at_speed(mapped, 2800.0))[0].gas_N)
    assert fast.gas_N.max() > 1.2 * rated.gas_N.max()


def test_between_pull_and_push_the_eye_has_its_press_fit_alone():
    """The bore at the crown is stretched by pull and push alike: a larger pull leaves its swing as it is."""
    fitted = with_values(SCENE, {"rod.bush_interference_um": 40.0})
    slow = with_values(fitted, {"engine.overspeed_rpm": 2200.0})
    (crown, *_), (slower, *_) = (check_rod_strength(scene).sections for scene in (fitted, slow))
    assert crown.push_N == slower.push_N
    assert crown.pull_N > 1.5 * slower.pull_N
    assert crown.fatigue_safety == pytest.approx(slower.fatigue_safety)
