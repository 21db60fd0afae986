"""An oblique split of the rod: its body against the CAD kernel, its joint by hand, its ring turned."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.solid.rod import add_rod
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.rod_body import rod_mass, section, width_mm
from cranktopo.design.rod_split import big_end_range_mm
from cranktopo.engine.rod_forces import rod_bolt_force_N, rod_motions
from cranktopo.engine.rod_split import cap_acceleration_m_s2, on_cap_N, split_forces
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.rod import ovalisation
from cranktopo.tasks.rod.lighter import rod_search
from cranktopo.tasks.rod.ring import ClosedRing
from cranktopo.tasks.rod.split import passage
from cranktopo.tasks.rod.stage import check_rod_strength

LENGTH_MM = 166.0
SQUARE = load_scene("mikron-iiic-rod-i")
OBLIQUE = with_values(SQUARE, {"rod.split_angle_deg": 45.0})
PLACES = [("mikron-iiic-rod", 45.0), ("mikron-iiic-rod-i", 20.0), ("mikron-iiic-rod-h", 40.0)]


@pytest.mark.parametrize(("name", "angle_deg"), PLACES)
def test_mass_centre_and_inertia_against_the_solid(name, angle_deg):
    """Without what is fitted; one valid body of the kernel."""
    bare = {"rod.bolt.hole_diameter_mm": 8.4, "rod.shells_kg": 0.0, "rod.bush_thickness_mm": 0.0}
    scene = with_values(load_scene(name), {**bare, "rod.split_angle_deg": angle_deg})
    rod = scene.rod
    with cad_session("rod") as gmsh:
        body = add_rod(gmsh.model.occ, scene)
        assert len(body) == 1
        volume = gmsh.model.occ.getMass(*body[0])
        x, y, _ = gmsh.model.occ.getCenterOfMass(*body[0])
        inertia = gmsh.model.occ.getMatrixOfInertia(*body[0])[8]
    kg = density_kg_per_mm3(rod.material.density_kg_m3) * volume
    found = rod_mass(rod, LENGTH_MM, scene.material)
    assert found.body_kg == pytest.approx(kg, rel=1e-6)
    bolts_y, bolts_kg = found.y_mm[-6:], found.y_kg[-6:]
    assert found.total_kg * found.centre_mm - bolts_y @ bolts_kg == pytest.approx(kg * y, rel=1e-6)
    u, v = bolt_points(rod)
    cosine, sine = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    bolts_x = u * cosine + v * sine
    assert bolts_y == pytest.approx(v * cosine - u * sine)
    assert found.total_kg * found.across_mm - bolts_x @ bolts_kg == pytest.approx(kg * x, rel=1e-5)
    spread = found.inertia_kg_mm2 + found.total_kg * (found.centre_mm**2 + found.across_mm**2)
    spread -= bolts_kg @ (bolts_x**2 + bolts_y**2)
    assert spread == pytest.approx(kg / volume * inertia + kg * (x**2 + y**2), rel=2e-6)


def bolt_points(rod):
    """Places of heads, shanks in the cap and shanks in the rod of both bolts, in the frame of the split."""
    below, reach = rod.boss_below_mm, rod.bolt.grip_mm + rod.bolt.engaged_mm
    v = [-below - rod.bolt.nominal.diameter_mm / 2, -below / 2, (reach - below) / 2]
    return np.tile([-rod.bolt_distance_mm / 2, rod.bolt_distance_mm / 2], 3), np.repeat(v, 2)


def test_widths_of_both_sides_add_up_to_the_sections():
    """Across the oblique bosses and above them, less the chords of the holes, which sections leave out."""
    rod = with_values(OBLIQUE, {"rod.bolt.hole_diameter_mm": 8.4}).rod
    whole = rod.model_copy(update={"bolt": None})
    x = (np.arange(-40_000, 40_000) + 0.5) / 500
    for y in (-39.0, -30.0, -24.0, 33.0, 45.0, 60.0):
        found = width_mm(whole, LENGTH_MM, x, np.full_like(x, y)).sum() / 500
        assert found == pytest.approx(section(rod, LENGTH_MM, np.array([y])).area_mm2[0], rel=2e-4)
    u, v = -rod.bolt_distance_mm / 2, np.array([rod.boss_above_mm - 0.1, rod.boss_above_mm + 0.1])
    turn = math.sqrt(0.5)
    drilled, beside = (width_mm(one, LENGTH_MM, (u + v) * turn, (v - u) * turn) for one in (rod, whole))
    assert beside - drilled == pytest.approx([8.4, 0.0])


def test_the_cap_is_the_square_one_turned():
    square, oblique = (rod_mass(one.rod, LENGTH_MM, one.material) for one in (SQUARE, OBLIQUE))
    assert oblique.split_kg == square.split_kg
    assert oblique.reciprocating_kg + oblique.rotating_kg == pytest.approx(oblique.total_kg, rel=1e-14)


def test_a_force_on_the_cap_by_hand():
    """A pull along the rod, split at 45 deg: sine and cosine of it; by the cosine the integral around."""
    turn = math.sqrt(0.5)
    u, v = np.array([turn * 1000.0]), np.array([-turn * 1000.0])
    assert np.hstack(on_cap_N(u, v, "point")) == pytest.approx([1000 * turn, 1000 * turn])
    assert np.hstack(on_cap_N(-u, -v, "point")) == pytest.approx([0.0, 0.0])
    for u, v in ((turn, -turn), (-0.3, -0.9), (0.6, 0.8), (0.0, 1.0), (1.0, 0.0)):
        found = np.hstack(on_cap_N(np.array([u]), np.array([v]), "cosine"))
        at = (np.arange(200_000) + 0.5) * math.pi / 200_000  # the half of the bore in the cap
        outward = np.stack([np.cos(at), -np.sin(at)])
        pressure = np.maximum(u * outward[0] + v * outward[1], 0.0) * 2 / math.pi
        by_hand = (pressure * outward).sum(axis=1) * math.pi / 200_000
        assert found == pytest.approx([by_hand[0], -by_hand[1]], abs=1e-6)
        other = np.hstack(on_cap_N(np.array([-u]), np.array([-v]), "cosine"))
        assert found - other == pytest.approx([u, -v], abs=1e-9)  # both halves carry all of it


def test_at_the_dead_centre_the_pull_is_resolved_by_sine_and_cosine():
    """At gas-exchange dead centre, by hand: the crankpin's pull less what the cap's own motion takes."""
    scene = with_values(OBLIQUE, {"rod.shells_kg": 0.0})
    mass = rod_mass(scene.rod, LENGTH_MM, scene.material)
    motion = rod_motions(scene)[1]
    at = int(np.abs(motion.angle_deg - 360.0).argmin())
    cap = mass.split_kg
    pin = motion.pin_force_N()[at]
    share = mass.y_mm / LENGTH_MM
    whole = (mass.y_kg * (share * motion.piston_m_s2[at] + (1 - share) * motion.pin_m_s2[at])).sum() - pin
    turn, below = math.sqrt(0.5), mass.split_centre_mm
    centripetal = (motion.piston_m_s2[at] - motion.pin_m_s2[at]) / LENGTH_MM
    along = motion.pin_m_s2[at] - centripetal * below * turn
    across = centripetal * below * turn
    one = next(f for f in split_forces(scene) if f.speed_rpm == 2800.0)
    assert one.parting_N[at] == pytest.approx(whole * turn - cap * (along - across) * turn, rel=1e-4)
    assert abs(one.shear_N[at]) == pytest.approx(whole * turn - cap * (along + across) * turn, rel=1e-4)


def test_points_of_the_rod_accelerate_as_its_positions_do():
    """Second difference of positions over the crank angle, along and across the rod."""
    motion = rod_motions(SQUARE)[0]
    place = (-12.0, -7.0)
    across, along = cap_acceleration_m_s2(motion, LENGTH_MM, place)
    radius, speed, step = SQUARE.throw.radius_mm, motion.speed_rpm * math.pi / 30, 1e-3
    a = np.radians(motion.angle_deg)

    def axes(a):
        tilt = np.arcsin(radius / LENGTH_MM * np.sin(a))
        return np.array([-np.cos(tilt), -np.sin(tilt)]), np.array([-np.sin(tilt), np.cos(tilt)])

    def position(a):
        x, y = axes(a)
        return radius * np.array([np.sin(a), np.cos(a)]) + place[0] * x + place[1] * y

    moved = (position(a + step) - 2 * position(a) + position(a - step)) / step**2 * speed**2 / 1000
    x, y = axes(a)
    size = np.abs(moved).max()
    assert across == pytest.approx((moved * x).sum(axis=0), abs=1e-5 * size)
    assert along == pytest.approx((moved * y).sum(axis=0), abs=1e-5 * size)


def test_the_crankpin_turns_the_rod():
    """Momentum of the whole rod: pins' forces across it are its mass times the centre's acceleration."""
    motion, mass = rod_motions(SQUARE)[0], rod_mass(SQUARE.rod, LENGTH_MM, SQUARE.material)
    across, along = motion.big_end_force_N(mass, LENGTH_MM)
    below = motion.section_force_N(mass, LENGTH_MM, -1e9)
    at = np.isin(motion.angle_deg, [0.0, 360.0])
    assert along[at] == pytest.approx(below[at], rel=1e-9)
    about_small = ((LENGTH_MM - mass.y_mm) * mass.y_kg)[:, None]
    share = (mass.y_mm / LENGTH_MM)[:, None]
    moved = share * motion.small_m_s2[None, ::40] + (1 - share) * motion.big_m_s2[None, ::40]
    assert across[::40] * LENGTH_MM == pytest.approx((about_small * moved).sum(axis=0), rel=1e-9, abs=1e-6)


def test_a_split_that_is_hardly_oblique_parts_as_a_square_one():
    scene = with_values(SQUARE, {"rod.split_angle_deg": 1e-6, "rod.shells_kg": 0.0})
    most = max(float(one.parting_N.max()) for one in split_forces(scene))
    square = with_values(scene, {"rod.split_angle_deg": 0.0})
    assert most == pytest.approx(2 * rod_bolt_force_N(square)[0], rel=2e-4)


def test_the_worst_of_the_joint_is_told():
    """Under the gas force the cosine reaches beyond the split: shear there is larger than under the pull."""
    found = check_rod_strength(OBLIQUE).oblique_split
    states = split_forces(OBLIQUE)
    assert found.parting.parting_N == max(one.parting_N.max() for one in states)
    assert found.shear.shear_N == max(np.abs(one.shear_N).max() for one in states)
    assert found.shear.crank_angle_deg < 30.0 < 330.0 < found.parting.crank_angle_deg
    joint = check_rod_strength(OBLIQUE).bolt.vdi_2230
    clamped = 2 * joint.least_preload_N - (1 - joint.load_factor) * found.sliding.parting_N
    assert found.left_for_shape_N == pytest.approx(max(found.sliding.shear_N - 0.15 * clamped, 0.0))
    rough = check_rod_strength(with_values(OBLIQUE, {"rod.split_friction": 0.5})).oblique_split
    assert rough.sliding_safety == pytest.approx(0.5 / 0.15 * found.sliding_safety)
    assert rough.left_for_shape_N == 0.0


def test_a_turned_ring_under_a_turned_load():
    """A plain ring does not know where it is held; the bosses' ring of a square split turned as a whole."""
    around = np.linspace(-math.pi, math.pi, 361)
    even = np.ones(361)
    plain = ClosedRing(around, 100 * even, 28 * even, 27.5 * even, 2e5, 0.3)
    turned = replace(plain, angle_rad=around + 0.7)
    towards = np.array([0.0, 0.5, math.pi / 2])
    found = plain.changes_mm(*ovalisation.cosine_N(around, 0.0), towards)
    again = turned.changes_mm(*ovalisation.cosine_N(turned.angle_rad, 0.7), towards + 0.7)
    assert again == pytest.approx(found, rel=1e-9)
    square, oblique = (ring_without_shank(scene) for scene in (SQUARE, OBLIQUE))
    shifted = np.roll(square.area_mm2[:-1], -45)
    assert oblique.area_mm2[:-1] == pytest.approx(shifted, rel=1e-9)
    load, at = math.radians(45.0), np.array([0.0, 0.4, math.pi / 2])
    start = np.r_[np.arange(45, 361), np.arange(1, 46)]  # held where the oblique one is
    angles = np.linspace(-math.pi, math.pi, 361) + load
    parts = (one[start] for one in (square.area_mm2, square.middle_mm, square.neutral_mm))
    moved = ClosedRing(angles, *parts, square.E_MPa, square.poisson)
    found = moved.changes_mm(*ovalisation.cosine_N(angles, load), at + load)
    assert oblique.changes_mm(*ovalisation.cosine_N(around, 0.0), at) == pytest.approx(found, rel=1e-9)


def ring_without_shank(scene):
    """The whole ring of the big end of a rod that has hardly any shank."""
    thin = dict.fromkeys(("shank_width_mm", "shank_small_mm", "shank_big_mm"), 1e-9)
    bare = scene.rod.model_copy(update={**thin, "shank": "plain", "shank_fillet_mm": 0.0})
    around = np.linspace(-math.pi, math.pi, 361)
    return ClosedRing(*ovalisation._ring(scene.model_copy(update={"rod": bare}), "big", around))


@pytest.mark.parametrize("middle", [0.0, math.pi])
def test_a_whole_ring_is_twice_its_half(middle):
    half = ovalisation.eye_ring(SQUARE, "big")
    whole = ClosedRing(*ovalisation._ring(SQUARE, "big", np.linspace(-math.pi, math.pi, 361)))
    loads = ovalisation.pulled_N() if middle == 0.0 else ovalisation.pushed_N()
    changes = whole.changes_mm(*ovalisation.cosine_N(whole.angle_rad, middle), np.array([math.pi / 2, 0.0]))
    assert changes == pytest.approx(half.opened_mm(*loads), rel=3e-3)


def test_what_passes_the_cylinder():
    """Width by the corners of bosses and ring of the rod's half, by points."""
    for angle_deg, wide in ((0.0, 90.0), (30.0, 90.0), (45.0, 70.0), (52.0, 110.0)):
        rod = with_values(SQUARE, {"rod.split_angle_deg": angle_deg, "rod.boss_width_mm": wide}).rod
        around = np.linspace(0.0, math.pi, 100_001)
        u = np.r_[rod.big_end_diameter_mm / 2 * np.cos(around), wide / 2, -wide / 2, wide / 2, -wide / 2]
        v = np.r_[rod.big_end_diameter_mm / 2 * np.sin(around), 0, 0, [rod.boss_above_mm] * 2]
        x = u * math.cos(math.radians(angle_deg)) + v * math.sin(math.radians(angle_deg))
        assert big_end_range_mm(rod) == pytest.approx((x.min(), x.max()), abs=1e-6)
    assert passage(SQUARE).passes
    found = passage(with_values(SQUARE, {"rod.boss_width_mm": 94.0}))
    assert found.over_corners_mm == pytest.approx(math.hypot(94.0, SQUARE.rod.big_end_width_mm))
    assert not found.passes


@pytest.mark.slow
def test_the_search_keeps_an_oblique_split():
    """A lighter rod whose bosses and shank leave the split what it asks for."""
    search = rod_search(OBLIQUE, "lsa", 3.0)
    at = [search.names.index(name) for name in ("shank_big_mm", "boss_above_mm", "web_mm")]
    bounds = tuple(bound[at] for bound in search.bounds)
    names = tuple(search.names[place] for place in at)
    few = replace(search, names=names, start_mm=search.start_mm[at], bounds=bounds)
    lighter = few.rod_at(few.best())
    found = check_rod_strength(lighter)
    assert few.is_better(lighter, found)
    assert lighter.rod.split_angle_deg == 45.0
