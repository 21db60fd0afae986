"""Balance of a whole engine: textbook factors, and the sum of all masses' d'Alembert forces over a turn."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from cranktopo.design.loading import parse_scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.balancer_shafts import needed_shafts, size_shafts
from cranktopo.engine.balance.free_forces import (
    ORDERS,
    ForceEllipse,
    counterweights,
    free_forces,
    inner_moment,
    oscillating_force,
    rotating_force,
    turning_masses,
)
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.engine.bearings import equivalent_load_N, rating_life_h
from cranktopo.engine.forces import throw_forces
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.kinematics import acceleration_harmonics
from tests.engine_arrangements import MIKRON, VEE, arranged

PITCH, RADIUS, ROD = 114.0, 48.0, 166.0
ONE = arranged("", 1, (1,))
TWIN_180 = arranged("throw_angles_deg = [0.0, 180.0]", 2, (1, 2))
TWIN_360 = arranged("", 2, (1, 2))
THREE = arranged("", 3, (1, 3, 2))
FOUR = arranged("")
SIX = arranged("", 6, (1, 5, 3, 6, 2, 4))
V2 = arranged(VEE + "throw_angles_deg = [0.0]", 2, (1, 2))
BOXER_4 = arranged("layout = 'boxer'", 4, (1, 3, 2, 4))
UNEVEN_THREE = arranged("throw_angles_deg = [0.0, 100.0, 230.0]\ncylinder_pitch_mm = 90.0", 3, (1, 3, 2))
UNEVEN_V6 = arranged(
    "layout = 'V'\nbank_angle_deg = 72.0\nthrow_angles_deg = [0.0, 130.0, 245.0]\nrod_offset_mm = 11.0",
    6,
    (3, 6, 2, 5, 1, 4),
)
UNEVEN_BOXER = arranged("layout = 'boxer'\nthrow_angles_deg = [0.0, 80.0, 180.0, 270.0]", 4, (1, 2, 3, 4))


def unit_forces(masses):
    """m r w2 of one piston and of one throw's rotating unbalance, N."""
    return masses.piston_kg_mm * masses.w2 / 1000, abs(masses.throw_kg_mm) * masses.w2 / 1000


# Force over m r w2 c_n, moment over m r w2 c_n pitch: rotating, then oscillating of order 1, 2, 4, 6.
ROOT3 = math.sqrt(3)
GOLDEN = [
    (ONE, (1, 0), [(1, 0), (1, 0), (1, 0), (1, 0)]),
    (TWIN_180, (0, 1), [(0, 1), (2, 0), (2, 0), (2, 0)]),
    (TWIN_360, (2, 0), [(2, 0), (2, 0), (2, 0), (2, 0)]),
    (THREE, (0, ROOT3), [(0, ROOT3), (0, ROOT3), (0, ROOT3), (3, 0)]),
    (FOUR, (0, 0), [(0, 0), (4, 0), (4, 0), (4, 0)]),
    (SIX, (0, 0), [(0, 0), (0, 0), (0, 0), (6, 0)]),
    (BOXER_4, (0, 0), [(0, 0), (0, 2), (0, 2), (0, 2)]),
]


@pytest.mark.parametrize(
    ("scene", "rotating", "oscillating"),
    GOLDEN,
    ids=[
        "in-line 1",
        "in-line 2 at 180",
        "in-line 2 at 360",
        "in-line 3",
        "in-line 4",
        "in-line 6",
        "boxer 4",
    ],
)
def test_textbook_factors(scene, rotating, oscillating):
    masses = turning_masses(scene)
    piston, throw = unit_forces(masses)
    found = [rotating_force(masses), *(oscillating_force(masses, order) for order in ORDERS)]
    sizes = [throw, *(piston * abs(c) for c in masses.harmonics)]
    for free, size, (force, moment) in zip(found, sizes, [rotating, *oscillating], strict=True):
        assert free.force.largest / size == pytest.approx(force, abs=1e-12)
        assert free.moment.largest * 1000 / size / PITCH == pytest.approx(moment, abs=1e-12)
        if force or moment:  # along the cylinders, or all around
            alive = free.force if force else free.moment
            across = 90.0 if scene is BOXER_4 else 0.0
            assert alive.axis_deg == (None if free is found[0] else pytest.approx(across))
            if free is not found[0]:
                assert alive.smallest == pytest.approx(0, abs=1e-12 * size)


def test_v2_at_90_degrees():
    """First order: a circle with the crank, as of one rotating mass; second: sqrt 2 across the bisector."""
    masses = turning_masses(V2)
    piston, _ = unit_forces(masses)
    forces = {order: oscillating_force(masses, order).force for order in ORDERS}
    assert abs(forces[1].forward) == pytest.approx(piston, rel=1e-12)
    assert forces[1].backward == 0
    for order, axis in ((2, 90.0), (4, 0.0), (6, 90.0)):
        size = piston * abs(masses.harmonics[ORDERS.index(order)])
        assert forces[order].largest == pytest.approx(math.sqrt(2) * size, rel=1e-12)
        assert (forces[order].smallest / size, forces[order].axis_deg) == pytest.approx((0, axis), abs=1e-9)
    half = turning_masses(
        arranged(VEE + "throw_angles_deg = [0.0]\nbalanced_oscillating_share = 0.5", 2, (1, 2))
    )
    assert free_forces(half, counterweighted=True)[0].force.largest == 0


def test_harmonics_from_the_displacement():
    """c_n = -n^2 X_n / r, X_n that of the displacement r + l - r cos a - sqrt(l^2 - r^2 sin^2 a)."""

    def displacement(a):
        return RADIUS + ROD - RADIUS * math.cos(a) - math.sqrt(ROD**2 - (RADIUS * math.sin(a)) ** 2)

    lam = RADIUS / ROD
    series = [1.0, lam + lam**3 / 4 + 15 * lam**5 / 128, -(lam**3) / 4 - 3 * lam**5 / 16, 9 * lam**5 / 128]
    for order, found, textbook in zip(
        ORDERS, acceleration_harmonics(RADIUS, ROD, ORDERS), series, strict=True
    ):
        mean = (
            quad(lambda a, n=order: displacement(a) * math.cos(n * a), 0, math.pi, epsabs=1e-12)[0]
            * 2
            / math.pi
        )
        assert found == pytest.approx(-(order**2) * mean / RADIUS, abs=1e-11)
        assert found == pytest.approx(textbook, abs=lam**7)
    assert acceleration_harmonics(99.99, 100.0, (1, 3, 5)) == pytest.approx([1, 0, 0], abs=1e-11)


def inertia_of_all_masses(scene, masses, shafts=(), points=512):
    """Force and moment of all moving masses over a turn, from their places alone.

    Places are complex numbers across the shaft; accelerations are their exact derivatives by Fourier series.
    """
    engine, layout = scene.engine, scene.engine.arranged.layout
    turn = 2 * np.pi * np.arange(points) / points
    bank = np.radians({"V": engine.arranged.bank_angle_deg or 0.0, "boxer": 180.0}.get(layout, 0.0))
    throws = np.radians(engine.throw_angles_deg)
    pitch = engine.arranged.cylinder_pitch_mm or PITCH
    at_throw = (np.arange(len(throws)) - (len(throws) - 1) / 2) * pitch
    cylinders = []
    for number in range(1, engine.cylinders + 1):
        second = number % 2 == 0 if layout == "boxer" else layout == "V" and number > len(throws)
        throw = (number - 1) % len(throws)
        shift = (engine.arranged.rod_offset_mm or 18.0) / 2 * (1 if second else -1) if layout == "V" else 0.0
        cylinders.append(((bank if second else 0.0) - bank / 2, throw, at_throw[throw] + shift))
    axis, throw, _ = cylinders[engine.order[0] - 1]
    crank = turn[:, None] + throws + axis - throws[throw]
    moving = [
        (masses.throw_kg_mm / RADIUS, RADIUS * np.exp(1j * crank[:, k]), z) for k, z in enumerate(at_throw)
    ]
    for axis, throw, z in cylinders:
        pin = RADIUS * np.exp(1j * (crank[:, throw] - axis))
        piston = pin.real + np.sqrt(ROD**2 - pin.imag**2)
        moving.append((masses.piston_kg_mm / RADIUS, piston * np.exp(1j * axis), z))
    for shaft in shafts:
        angle = shaft.order * turn * (1 if shaft.turns == "with" else -1) + np.radians(shaft.phase_deg)
        for sign in (1, -1) if shaft.balances == "moment" else (1,):
            place = shaft.z_mm + sign * shaft.distance_mm / 2
            moving.append((shaft.unbalance_kg_mm, sign * np.exp(1j * angle), place))
    force, moment = np.zeros(points, complex), np.zeros(points, complex)
    orders = np.fft.fftfreq(points, 1 / points)
    for kg, place, z in moving:
        accelerated = np.fft.ifft(-(orders**2) * np.fft.fft(place)) * masses.w2 / 1000
        force -= kg * accelerated
        moment -= kg * accelerated * z / 1000
    return np.fft.fft(force) / points, np.fft.fft(moment) / points


ASYMMETRIC = [THREE, V2, UNEVEN_BOXER, UNEVEN_THREE, UNEVEN_V6]
NAMES = ["in-line 3", "V2", "uneven boxer 4", "uneven in-line 3", "uneven V6"]


@pytest.mark.parametrize("scene", ASYMMETRIC, ids=NAMES)
def test_against_the_inertia_of_all_masses(scene):
    """Both turning parts of every order, with a throw whose unbalance lies off its middle."""
    masses = replace(turning_masses(scene), throw_kg_mm=41.0 + 7.0j)
    force, moment = inertia_of_all_masses(scene, masses)
    scale = sum(unit_forces(masses))
    for free in free_forces(masses):
        for vector, spectrum in ((free.force, force), (free.moment, moment)):
            assert abs(vector.forward - spectrum[free.order]) < 1e-11 * scale
            assert abs(vector.backward - spectrum[-free.order]) < 1e-11 * scale
    rest = [n for n in range(8) if n not in ORDERS]
    assert np.abs(force[rest]).max() < 1e-11 * scale


def test_an_ellipse_is_largest_along_its_axis():
    ellipse = ForceEllipse(3.0 * np.exp(0.4j), 1.0 * np.exp(1.6j))
    turned = ellipse.over_turn(2, np.arange(0.0, 360.0, 0.01))
    worst = turned[np.abs(turned).argmax()]
    assert np.degrees(np.angle(worst)) % 180 == pytest.approx(ellipse.axis_deg, abs=0.01)
    assert (np.abs(turned).max(), np.abs(turned).min()) == pytest.approx((4.0, 2.0), abs=1e-6)


@pytest.mark.parametrize("scene", ASYMMETRIC, ids=NAMES)
def test_counterweights_leave_nothing(scene):
    """Of each throw: no rotating force but the share of the pistons. Of the shaft: the least-squares one."""
    masses = replace(turning_masses(scene), throw_kg_mm=41.0 + 7.0j, counterweight_kg_mm=41.0 + 7.0j)
    left = rotating_force(masses, counterweighted=True)
    assert (left.force.largest, left.moment.largest) == (0, 0)
    weights = counterweights(masses)
    throws = masses.throw_kg_mm * np.exp(1j * np.radians(scene.engine.throw_angles_deg))
    own = np.array([w.unbalance_kg_mm * np.exp(1j * np.radians(w.deg)) for w in weights])
    assert np.allclose(own[::2] + own[1::2], -throws, atol=1e-9)
    z = masses.layout.web_z_mm
    rows = np.stack([np.ones_like(z), z / PITCH])
    wanted = -np.array([throws.sum(), (throws * masses.layout.throw_z_mm).sum() / PITCH])
    least = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    shaft = [w.shaft_unbalance_kg_mm * np.exp(1j * np.radians(w.shaft_deg)) for w in weights]
    assert np.allclose(shaft, least, atol=1e-9)


def test_counterweights_of_the_share_of_the_pistons():
    """Half of the oscillating mass turns the line of the first order into a circle against the crank."""
    masses = turning_masses(arranged("balanced_oscillating_share = 0.5", 1, (1,)))
    piston, _ = unit_forces(masses)
    first = free_forces(masses, counterweighted=True)[0].force
    assert (abs(first.forward), abs(first.backward)) == pytest.approx((0, piston / 2), abs=1e-9)


def test_the_share_of_the_pistons_is_in_what_webs_need_for_throw_and_shaft():
    """Of three uneven throws: half of each piston beside what turns, for the shaft by least squares."""
    scene = arranged("balanced_oscillating_share = 0.5\nthrow_angles_deg = [0, 100, 250]", 3, (1, 2, 3))
    masses, angles = turning_masses(scene), np.radians(scene.engine.throw_angles_deg)
    throws = (masses.throw_kg_mm + masses.piston_kg_mm / 2) * np.exp(1j * angles)
    weights = counterweights(masses)
    own = np.array([w.unbalance_kg_mm * np.exp(1j * np.radians(w.deg)) for w in weights])
    assert np.allclose(own[::2] + own[1::2], -throws, atol=1e-9)
    z = masses.layout.web_z_mm
    wanted = -np.array([throws.sum(), (throws * masses.layout.throw_z_mm).sum() / PITCH])
    least = np.linalg.lstsq(np.stack([np.ones_like(z), z / PITCH]), wanted, rcond=None)[0]
    shaft = [w.shaft_unbalance_kg_mm * np.exp(1j * np.radians(w.shaft_deg)) for w in weights]
    assert np.abs(least).max() > 1
    assert np.allclose(shaft, least, atol=1e-9)


@pytest.mark.parametrize("density", ["", "density_kg_m3 = 17500.0\n"], ids=["one piece", "bolted"])
def test_counterweights_of_the_scene_count(density):
    """Webs need less by what they have, and the shaft bends as one whose webs have all by then."""
    weight = f"[web.counterweight]\nouter_radius_mm = 50.0\nhalf_angle_deg = 45.0\n{density}[material]"
    text = MIKRON[: MIKRON.index("[envelope]")]  # which has no room for it
    scene = parse_scene(text.replace("[material]", weight, 1))
    plain, weighted = turning_masses(FOUR), turning_masses(scene)
    taken = sum(weighted.own_kg_mm)
    assert taken > 1
    assert weighted.throw_kg_mm.real == pytest.approx(plain.throw_kg_mm.real - taken, rel=1e-9)
    needed = counterweights(weighted)
    assert needed[0].unbalance_kg_mm + needed[0].own_kg_mm == pytest.approx(plain.throw_kg_mm.real / 2)
    moments = [inner_moment(m, counterweights(m)).moment_Nm for m in (plain, weighted)]
    assert moments[0] == pytest.approx(moments[1], rel=1e-9)
    assert inner_moment(weighted).moment_Nm < 0.99 * inner_moment(plain).moment_Nm


def test_textbook_inner_moments():
    """Four in line: U w2 a; six: sqrt 3 times as much; less with counterweights."""
    for scene, factor in ((FOUR, 1.0), (SIX, ROOT3)):
        masses = turning_masses(scene)
        _, throw = unit_forces(masses)
        assert inner_moment(masses).moment_Nm * 1000 / throw / PITCH == pytest.approx(factor, rel=1e-12)
        # A balanced throw bends itself alone: half of what pulls at its pin over the webs' distance.
        weighted = inner_moment(masses, counterweights(masses))
        pin = throw * (1 - sum(masses.web_kg_mm) / masses.throw_kg_mm.real)
        assert 0.5 * throw < pin < 0.6 * throw
        assert weighted.moment_Nm * 1000 / pin == pytest.approx((36 + 19) / 4, rel=1e-12)


def test_rods_beside_each_other_bend_the_shaft_less_than_rods_in_one_plane():
    """The moment in the middle of the pin falls by a rod's pull times its distance from there."""
    planes = [
        arranged(VEE + f"throw_angles_deg = [0.0]\nrod_offset_mm = {mm}", 2, (1, 2)) for mm in (0.0, 18.0)
    ]
    together, apart = (inner_moment(turning_masses(scene)) for scene in planes)
    rod_kg, w2 = planes[0].engine.rod_rotating_kg, turning_masses(planes[0]).w2
    assert together.z_mm == apart.z_mm == 0.0
    less_Nm = rod_kg * RADIUS * w2 / 1000 * 9.0 / 1000
    assert together.moment_Nm - apart.moment_Nm == pytest.approx(less_Nm, rel=1e-9)


def test_inner_moment_of_an_uneven_shaft():
    """Against cuts at many places, each with what lies behind it."""
    masses = turning_masses(UNEVEN_THREE)
    layout = masses.layout
    along = masses.w2 / 1000 * np.exp(1j * np.radians(layout.throw_angle_deg))
    web = masses.web_kg_mm[0]
    force = np.concatenate([(masses.throw_kg_mm - 2 * web) * along, np.repeat(web * along, 2)])
    z = np.concatenate([layout.throw_z_mm, layout.web_z_mm])
    ends = layout.bearing_z_mm[[0, -1]]
    takeoff = -(force * (z - ends[0])).sum() / (ends[1] - ends[0])
    places = np.linspace(*ends, 6001)
    behind = np.maximum(z - places[:, None], 0.0) @ force + takeoff * (ends[1] - places)
    found = inner_moment(masses)
    assert found.moment_Nm == pytest.approx(np.abs(behind).max() / 1000, rel=1e-4)
    assert abs(found.z_mm - places[np.abs(behind).argmax()]) < 0.1


LANCHESTER = (
    "[[engine.arrangement.balancer_shaft]]\norder = 2\nturns = 'with'\n"
    "[[engine.arrangement.balancer_shaft]]\norder = 2\nturns = 'against'\n"
)


def test_lanchester_of_a_four_in_line():
    """Each shaft: half of 4 m r c_2 / 2^2, opposite at top dead centre, in the middle of the shaft."""
    scene = arranged(LANCHESTER)
    masses = turning_masses(scene)
    shafts, left = size_shafts(scene.engine.arranged.balancer_shaft, free_forces(masses), masses.w2)
    for shaft in shafts:
        assert shaft.unbalance_kg_mm == pytest.approx(
            masses.piston_kg_mm * masses.harmonics[1] / 2, rel=1e-12
        )
        assert (shaft.phase_deg, shaft.z_mm) == pytest.approx((180, 0), abs=1e-9)
        assert shaft.force_N == pytest.approx(shaft.unbalance_kg_mm / 1000 * 4 * masses.w2, rel=1e-12)
    assert left[1].force.largest == 0
    assert left[2] == free_forces(masses)[2]


@pytest.mark.parametrize("scene", ASYMMETRIC, ids=NAMES)
def test_needed_shafts_silence_the_first_two_orders(scene):
    masses = turning_masses(scene)
    shafts = needed_shafts(free_forces(masses), masses.w2, 500.0)
    assert shafts
    force, moment = inertia_of_all_masses(scene, masses, shafts)
    piston, throw = unit_forces(masses)
    assert np.abs(force[[1, 2, -1, -2]]).max() < 1e-10 * (piston + throw)
    assert np.abs(moment[[1, 2, -1, -2]]).max() < 1e-10 * (piston + throw)


def test_a_balanced_six_needs_no_shaft():
    masses = turning_masses(SIX)
    assert needed_shafts(free_forces(masses), masses.w2, 500.0) == ()


def test_given_balancer_shafts():
    """Given unbalance and phase are kept; what is open beside them is the best that is left."""
    table = "[[engine.arrangement.balancer_shaft]]\norder = 2\nturns = "
    against = f"{table}'against'\nunbalance_kg_mm = 3.0\nphase_deg = 150.0\nz_mm = 40.0\n"
    scene = arranged(f"{against}{table}'with'\nphase_deg = 170.0\n")
    masses = turning_masses(scene)
    free = free_forces(masses)
    (first, second), left = size_shafts(scene.engine.arranged.balancer_shaft, free, masses.w2)
    assert (first.unbalance_kg_mm, first.phase_deg, first.z_mm) == (3.0, pytest.approx(150.0), 40.0)
    assert second.phase_deg == pytest.approx(170.0)
    wanted = abs(free[1].force.forward) / (4e-3 * masses.w2)
    assert second.unbalance_kg_mm == pytest.approx(wanted * math.cos(math.radians(10)))
    force, moment = inertia_of_all_masses(scene, masses, (first, second))
    assert left[1].force.forward == pytest.approx(force[2], rel=1e-9)
    assert left[1].moment.backward == pytest.approx(moment[-2], rel=1e-9)


def test_bearings_of_one_cylinder_are_those_of_its_throw():
    bearings = main_bearings(ONE, turning_masses(ONE))
    for load in np.abs(bearings.load_N):
        assert np.allclose(load, analyse(ONE).cycle.forces.main_journal_force_N, rtol=1e-12)


@pytest.mark.parametrize("scene", [TWIN_180, V2, UNEVEN_THREE, UNEVEN_V6])
@pytest.mark.parametrize("weighted", [False, True])
def test_bearings_are_in_equilibrium_with_pistons_and_throws(scene, weighted):
    """Force and moment of all bearings: rods by axial and side force of each cylinder, and what turns."""
    masses = turning_masses(scene)
    layout, engine = masses.layout, scene.engine
    bearings = main_bearings(scene, masses, weighted)
    rod = throw_forces(engine, RADIUS, pressure_curve(scene), engine.speed_rpm)
    steps = round(1 / (bearings.angle_deg[1] - bearings.angle_deg[0]))
    axial = np.sqrt(rod.rod_force_N**2 - rod.side_force_N**2) * np.sign(rod.rod_force_N)
    spin = rotating_force(masses, weighted)
    force = spin.force.over_turn(1, bearings.angle_deg)
    moment = spin.moment.over_turn(1, bearings.angle_deg)
    for axis, fires, z in zip(layout.axis_deg, layout.firing_deg, layout.cylinder_z_mm, strict=True):
        pushed = np.roll(
            (-axial + 1j * rod.side_force_N) * np.exp(1j * np.radians(axis)), round(fires * steps)
        )
        force, moment = force + pushed, moment + pushed * z / 1000
    assert np.allclose(bearings.load_N.sum(axis=0), force, atol=1e-6)
    assert np.allclose(layout.bearing_z_mm / 1000 @ bearings.load_N, moment, atol=1e-6)


def test_without_gas_only_inertia_loads_the_bearings():
    scene = ONE.model_copy(update={"engine": ONE.engine.model_copy(update={"gas": None})})
    masses = turning_masses(scene)
    bearings = main_bearings(scene, masses)
    assert not bearings.gas
    piston, throw = unit_forces(masses)
    assert bearings.largest(0) == pytest.approx(((piston * (1 + RADIUS / ROD) + throw) / 2, 0.0))


def test_life_of_roller_bearings():
    """ISO 281: C / P = 10 gives 10^(10/3) million turns; a load on one turn of eight counts to the power."""
    assert rating_life_h(26.0, 2600.0, 1000.0) == pytest.approx(10 ** (10 / 3) * 1e6 / 60e3)
    assert equivalent_load_N(np.array([800.0] + [0.0] * 7)) == pytest.approx(800 / 8**0.3)
