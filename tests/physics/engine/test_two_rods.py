"""Two rods on one pin: their sum, their places along the pin, their phases; closed forms and other paths."""

import math

import numpy as np
import pytest

from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.balance.free_forces import turning_masses
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.histories import load_history
from cranktopo.engine.judged_histories import histories_of
from cranktopo.engine.states import extreme_states, load_cases
from cranktopo.engine.vibration.torque_harmonics import curve_of, torque_harmonics
from tests.engine_arrangements import VEE, arranged
from tests.fast_twin import ENGINE, fast_twin

TWIN = VEE + "throw_angles_deg = [0.0]\nrod_offset_mm = {}"
EIGHT = arranged(VEE + "rod_offset_mm = 14.0", 8, (1, 5, 4, 2, 6, 3, 7, 8))
KINDS = frozenset({"bending", "torsion", "tangential"}) | INERTIA_EFFECTS


def twin(offset_mm=0.0, strokes=4, **engine):
    scene = arranged(TWIN.format(offset_mm), 2, (1, 2), strokes)
    return scene.model_copy(update={"engine": scene.engine.model_copy(update=engine)})


def parallel_banks(offset_mm):
    """A two-stroke V whose banks are parallel: both rods do the same at the same time."""
    scene = twin(offset_mm, strokes=2)
    one_bank = scene.engine.arranged.model_copy(update={"bank_angle_deg": 0.0})
    return scene.model_copy(update={"engine": scene.engine.model_copy(update={"arrangement": one_bank})})


@pytest.mark.parametrize("offset_mm", [0.0, 17.0])
def test_parallel_banks_double_the_single(offset_mm):
    both = analyse(parallel_banks(offset_mm)).cycle
    single = analyse(arranged("", 1, (1,), 2)).cycle.forces
    for _, forces in both.pins:
        for name in ("radial_force_N", "tangential_force_N", "web_force_N", "torque_Nm"):
            assert getattr(forces, name) == pytest.approx(2 * getattr(single, name), rel=1e-12, abs=1e-9)
    assert both.torque.engine_Nm == pytest.approx(2 * single.torque_Nm, rel=1e-12, abs=1e-9)


def test_each_web_carries_the_reaction_of_its_bearing():
    """Equilibrium of the throw as a beam on two bearings, from directions and places of the rods in space."""
    scene = twin(14.0)
    pins, bearings = analyse(scene).cycle.pins, main_bearings(scene, turning_masses(scene))
    assert [rods.name for rods, _ in pins] == ["web 1 of throw 1", "web 2 of throw 1"]
    for (_, forces), load in zip(pins, bearings.load_N, strict=True):
        assert forces.main_journal_force_N == pytest.approx(np.abs(load), rel=1e-9)
    first, second = (forces.web_force_N.max() for _, forces in pins)
    assert second != pytest.approx(first, rel=1e-3)


def test_inertia_of_a_right_angled_twin_turns_with_the_crank():
    """With long rods m r w2 (cos2 a + sin2 a) along the throw and nothing across it, whatever the angle."""
    scene = twin(rod_length_mm=1e4)
    still, turning = (analyse(at_speed(scene, rpm)).cycle.forces for rpm in (0.0, 2100.0))
    engine, r_w2 = scene.engine, 0.048 * (2100 * math.pi / 30) ** 2
    constant = (engine.reciprocating_kg + 2 * engine.rod_rotating_kg) * r_w2
    radial, across = (
        getattr(turning, name) - getattr(still, name) for name in ("web_force_N", "tangential_force_N")
    )
    # What the rods' lean adds is of the size of r / l, 0.0048, of one piston's force.
    assert radial == pytest.approx(-constant, abs=0.0075 * engine.reciprocating_kg * r_w2)
    assert across == pytest.approx(0.0, abs=0.0075 * engine.reciprocating_kg * r_w2)
    given = twin(rod_length_mm=1e4, gas=None, max_gas_force_N=2e4, max_torque_Nm=600.0)
    pull = next(s for s in extreme_states(given, KINDS) if s.name == "overspeed_inertia").case.radial_N
    assert pull == pytest.approx(-constant * (2800 / 2100) ** 2, rel=0.005)


def hand_pull_N(scene, rpm, offset_mm):
    """Slider and crank by hand, acceleration by differences: the outward force on the web that has more."""
    engine, (radius, rod) = scene.engine, (scene.throw.radius_mm, scene.engine.rod_length_mm)
    curve, step = pressure_curve(scene), 1e-4
    angle, speed = np.radians(curve.angle_deg), rpm * math.pi / 30

    def height(at):
        return radius * np.cos(at) + np.sqrt(rod**2 - (radius * np.sin(at)) ** 2)

    per_rad2 = (height(angle + step) - 2 * height(angle) + height(angle - step)) / step**2
    area = math.pi / 4 * engine.bore_mm**2
    down = (curve.pressure_MPa - engine.gas.ambient_pressure_MPa) * area
    down = down + engine.reciprocating_kg * per_rad2 / 1000 * speed**2
    lean = np.arcsin(radius * np.sin(angle) / rod)
    outward = -down * np.cos(angle + lean) / np.cos(lean)
    outward += engine.rod_rotating_kg * radius / 1000 * speed**2
    bank = outward.size * engine.firing_angles_deg[1] / 720
    other, share = np.roll(outward, round(bank)), offset_mm / scene.pitch_mm
    return max(float(((1 + part) * outward + (1 - part) * other).max()) for part in (share, -share))


def test_gas_of_the_other_cylinder_adds_to_the_pull_at_overspeed():
    """The case was the pull without gas, and the same cycle at that speed told 3 % more."""
    scene = fast_twin(
        engine={**ENGINE, "overspeed_rpm": 13000.0},
        effects={"torsional_vibration": "off"},
    )
    case = next(one for one in load_cases(scene) if one.kind == "bending")
    assert -case.radial_N == pytest.approx(hand_pull_N(scene, 13000.0, 22.0), rel=1e-4)
    assert case.source.startswith("largest pull on the web, with gas, at 98.5 deg, 13000 rpm")
    fast = next(one for one in load_cases(at_speed(scene, 13000.0)) if one.kind == "bending")
    assert fast.radial_N == pytest.approx(case.radial_N, rel=1e-9)
    own = next(one for one in load_cases(scene, KINDS | {"centrifugal"}) if one.kind == "centrifugal")
    assert (own.radial_N, own.speed_rpm) == (case.radial_N, 13000.0)
    judged = histories_of(scene, "extremes", KINDS - {"tangential"})
    (joined,) = (one for one in judged if one.labels[0].endswith(", 13000 rpm"))
    assert joined.radial_N.min() == pytest.approx(case.radial_N, rel=1e-9)


def test_torque_along_a_cross_plane_eight_by_orders():
    """Sum of Fourier orders with the phases of the cylinders; each throw's rods fire 90 or 450 deg apart."""
    torque, harmonics = analyse(EIGHT).cycle.torque, torque_harmonics(EIGHT)
    by_orders = np.cumsum(curve_of(harmonics.of_throws_Nm(2100.0).T, len(torque.angle_deg)), axis=0)
    assert torque.passed_on_Nm == pytest.approx(by_orders, abs=0.1)
    assert np.ptp(torque.engine_Nm) > 100


def test_history_follows_every_web_through_its_own_phase():
    """The torque through a throw is the mean of what is ahead of it and behind it, at the shaft's angle."""
    history, cycle = load_history(EIGHT, "cycle", KINDS), analyse(EIGHT).cycle
    angle = np.arange(0.0, 720.0)
    passed = np.vstack([np.zeros(len(cycle.torque.angle_deg)), cycle.torque.passed_on_Nm])
    for row, web in enumerate(range(1, 9)):
        throw = row // 2
        states = slice(row * 720, (row + 1) * 720)
        assert history.labels[states.start] == f"web {web} of throw {throw + 1}, 0 deg"
        at = angle + EIGHT.engine.firing_angles_deg[throw]
        ends = [np.interp(at, cycle.torque.angle_deg, passed[throw + i], period=720) for i in (0, 1)]
        assert history.torque_Nm[states] == pytest.approx(np.mean(ends, axis=0), abs=1e-9)
    worst = next(s for s in extreme_states(EIGHT, KINDS) if s.name == "max_radial").case
    assert history.radial_N.max() == pytest.approx(worst.radial_N, rel=2e-3)
    extremes = load_history(EIGHT, "extremes", KINDS).radial_N
    assert (extremes.max(), extremes.min()) == pytest.approx(
        (worst.radial_N, history.radial_N.min()), rel=2e-3
    )


def test_a_given_gas_force_counts_for_the_web_nearer_to_its_rod():
    scene = twin(19.0, gas=None, max_gas_force_N=10000.0)
    case = next(s for s in extreme_states(scene, KINDS) if s.name == "max_radial").case
    assert case.radial_N == pytest.approx(10000 * (1 + 19 / 114))
    assert "nearer to its rod" in case.source
