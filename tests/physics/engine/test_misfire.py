"""Cylinders that do not fire, against traces summed by hand, closed forms, balances of force and energy."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.balance.free_forces import turning_masses
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.engine.continuous_beam import span_bending
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.histories import load_history
from cranktopo.engine.motored import motored_curve
from cranktopo.engine.one_throw import one_throw
from cranktopo.engine.performance import power_kW
from cranktopo.engine.states import DEFAULT_EFFECTS, load_cases
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.steady import critical_speeds, on_disks, vibration
from cranktopo.engine.vibration.study import _torques
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.engine.vibration.vibrating_shaft import vibrating_torque
from cranktopo.tasks.loads.stage import loads_at_speeds
from cranktopo.tasks.shaft.cycle import cycle_forces, shaft_cycle
from tests.engine_arrangements import VEE, arranged
from tests.physics.engine.dissipation import check_balance
from tests.physics.shaft.test_continuous_shaft import CRANK_MM, beam_throw

SIX, STEP_DEG, RPM = "industrial-gas", 0.25, 1500.0
CHARGE = "intake_pressure_MPa", "exhaust_pressure_MPa"
DEAD = (3,)
FLYWHEEL = {"throw_damping_Nms_per_rad": 900.0, "flywheel": {"inertia_kg_m2": 6.0}}
BARE = {"throw_stiffness_Nm_per_rad": 5.5e6, "throw_damping_Nms_per_rad": 900.0}


def engine(scene: Scene, shaft: dict[str, object] | None = None, **changes: object) -> Scene:
    data = scene.model_dump(mode="json", exclude_none=True)
    data["engine"] |= changes
    return scene_from_dict(data if shaft is None else {**data, "shaft": shaft})


def six(shaft: dict[str, object] | None = None, **changes: object) -> Scene:
    """The engine at ambient pressure: a dead cylinder then does next to no work."""
    gas = load_scene(SIX).engine.gas.model_dump(mode="json", exclude_none=True)
    plain = {key: value for key, value in gas.items() if key not in CHARGE}
    return engine(load_scene(SIX), shaft, **{"gas": plain, **changes})


def volume(scene: Scene, angle_deg: Array) -> Array:
    """Volume over the clearance volume, by the law of cosines."""
    gas, radius, rod = scene.engine.gas, scene.throw.radius_mm, scene.engine.rod_length_mm
    a = np.radians(angle_deg)
    reach = radius * np.cos(a) + np.sqrt(rod**2 - (radius * np.sin(a)) ** 2)
    return 1 + (gas.compression_ratio - 1) * (radius + rod - reach) / (2 * radius)


def gas_torque_Nm(scene: Scene, pressure_MPa: Array) -> Array:
    """Work of the gas per radian of crank: pressure over ambient times the slope of the volume."""
    eng = scene.engine
    angle, small = np.arange(0.0, eng.cycle_deg, STEP_DEG), 1e-3
    swept = math.pi / 4 * eng.bore_mm**2 * 2 * scene.throw.radius_mm / (eng.gas.compression_ratio - 1)
    slope = (volume(scene, angle + small) - volume(scene, angle - small)) / (2 * math.radians(small))
    return (pressure_MPa - eng.gas.ambient_pressure_MPa) * swept * slope / 1000


def curves(scene: Scene) -> tuple[Array, Array]:
    fired, motored = pressure_curve(scene), motored_curve(scene)
    assert fired is not None
    assert motored is not None
    return fired.pressure_MPa, motored.pressure_MPa


def summed_Nm(scene: Scene, single: Array, silent: Array, dead: tuple[int, ...]) -> Array:
    """Torque of every cylinder at its own time, (cylinders, angles)."""
    order = scene.engine.order
    steps = [order.index(c) * len(single) // len(order) for c in range(1, len(order) + 1)]
    return np.stack([np.roll(silent if c in dead else single, by) for c, by in enumerate(steps, start=1)])


def orders_of(torque: Array) -> Complex:
    """Complex amplitudes of all orders from 0, by a plain Fourier sum."""
    return np.asarray(np.fft.rfft(torque, axis=-1) / torque.shape[-1] * 2)


@pytest.mark.parametrize("strokes", [4, 2])
def test_without_combustion_the_polytrope_of_compression_goes_both_ways(strokes: int) -> None:
    scene = six(strokes=strokes)
    gas, (fired, motored) = scene.engine.gas, curves(scene)
    closing = -180.0 if strokes == 4 else -gas.exhaust_opening_deg
    angle = np.arange(closing + STEP_DEG, gas.exhaust_opening_deg, STEP_DEG)
    by_hand = gas.intake_MPa * (volume(scene, np.array(closing)) / volume(scene, angle)) ** 1.32
    places = np.round(angle / STEP_DEG).astype(int) % len(motored)
    assert motored[places] == pytest.approx(by_hand, rel=1e-12)
    exchange = slice(round(180 / STEP_DEG), round((180.0 * strokes + closing) / STEP_DEG))
    assert np.array_equal(motored[exchange], fired[exchange])
    assert motored.max() < 0.25 * fired.max()


def test_a_measured_compression_is_mirrored(tmp_path: Path) -> None:
    angle = np.arange(0.0, 720.0, 1.0)
    before = np.where(angle < 360, angle, angle - 720)
    bump = np.exp(-(((before - 12) / 20) ** 2))
    trace = 0.1 + 1.5 / (1 + (before / 25) ** 2) + 4 * bump
    path = tmp_path / "trace.csv"
    rows = "\n".join(f"{a},{p}" for a, p in zip(angle, trace, strict=True))
    path.write_text(f"crank_angle_deg,pressure_MPa\n{rows}\n", encoding="utf-8")
    data = load_scene(SIX).model_dump(mode="json", exclude_none=True)
    data["engine"] |= {"gas": {"indicator_csv": str(path)}, "misfire": [2]}
    scene = scene_from_dict(data)
    fired, motored = curves(scene)
    half = round(130 / STEP_DEG)
    assert motored[1:half] == pytest.approx(fired[:-half:-1], rel=1e-12)
    assert np.array_equal(motored[round(180 / STEP_DEG) :], fired[round(180 / STEP_DEG) :])
    assert np.abs(np.diff(motored)).max() <= np.abs(np.diff(fired)).max()
    told = loads_at_speeds(scene)[0].silent
    assert told.startswith("Cylinder 2 does not fire: measured compression mirrored about top dead centre")


def test_six_equal_cylinders_have_no_half_orders_and_a_dead_one_its_own_vector() -> None:
    """The summed trace by a Fourier sum, beside the program's trace and its orders."""
    scene, dead = six(), six(misfire=list(DEAD))
    single, silent = (gas_torque_Nm(scene, curve) for curve in curves(scene))
    healthy = orders_of(summed_Nm(scene, single, silent, ()).sum(axis=0))
    expected = orders_of(summed_Nm(scene, single, silent, DEAD).sum(axis=0))
    half, size = np.arange(1, 48, 2), np.abs(healthy).max()
    assert np.abs(healthy[half]).max() < 1e-9 * size
    late = np.exp(-1j * np.arange(48) / 2 * math.radians(2 * 120.0))  # cylinder 3 fires third
    vector = (orders_of(single) - orders_of(silent))[:48] * late
    assert expected[:48] - healthy[:48] == pytest.approx(-vector, abs=1e-9 * size)
    assert np.abs(expected[1]) > 0.02 * size
    still = frozenset()
    trace = analyse(dead, still).cycle.torque.engine_Nm
    assert orders_of(trace)[:48] == pytest.approx(expected[:48], abs=1e-6 * size)
    harmonics = torque_harmonics(dead, still)
    assert harmonics is not None
    assert harmonics.of_throws_Nm(RPM).sum(axis=1)[1:48] == pytest.approx(expected[1:48], abs=1e-6 * size)


def test_inertia_stays_as_it_is() -> None:
    """At no gas difference between speeds: what the speed adds to the torque is the same with a dead one."""
    added = [
        analyse(at_speed(s, RPM)).cycle.torque.passed_on_Nm
        - analyse(at_speed(s, 0.0)).cycle.torque.passed_on_Nm
        for s in (six(), six(misfire=[1, 5]))
    ]
    assert added[0] == pytest.approx(added[1], abs=1e-9 * np.abs(added[0]).max())


@pytest.mark.parametrize("dead", [(3,), (1, 6)])
def test_mean_torque_work_and_power_fall_by_the_dead_cylinders(dead: tuple[int, ...]) -> None:
    scene, motor = six(), six(misfire=list(dead))
    whole, less = analyse(scene).cycle, analyse(motor).cycle
    single, silent = (gas_torque_Nm(scene, curve) for curve in curves(scene))
    lost = len(dead) * (single.mean() - silent.mean())
    assert whole.engine_torque()[0] - less.engine_torque()[0] == pytest.approx(lost, rel=1e-6)
    fall = whole.mean_work_J - less.mean_work_J
    assert fall * 6 == pytest.approx(lost * 4 * math.pi, rel=1e-5)
    passed = less.torque.passed_on_Nm
    own = np.diff(passed, axis=0, prepend=0.0).mean(axis=1)
    firing = np.diff(whole.torque.passed_on_Nm, axis=0, prepend=0.0).mean(axis=1)
    for cylinder in range(1, 7):
        less_by = firing[cylinder - 1] - own[cylinder - 1]
        assert less_by == pytest.approx((cylinder in dead) * lost / len(dead), rel=1e-6, abs=1e-9)
    assert less.engine_torque()[0] * 4 * math.pi == pytest.approx(6 * less.mean_work_J, rel=1e-5)
    found = loads_at_speeds(motor)[0]
    assert found.indicated_power_kW == pytest.approx(power_kW(less.mean_work_J, motor.engine), rel=1e-12)
    watts = less.engine_torque()[0] * angular_speed_rad_s(RPM)
    assert found.indicated_power_kW * 1000 == pytest.approx(watts, rel=1e-5)
    assert found.misfire == dead


def test_sums_of_torques_and_work_to_the_last_digits() -> None:
    """Five cylinders and one: from the program's own single curves, so nothing but the sum is looked at."""
    scene, motor = six(), six(misfire=list(DEAD))
    one, less = analyse(scene).cycle, analyse(motor).cycle
    mean = {dead: analyse(six(misfire=list(dead))).cycle.engine_torque()[0] for dead in [(3,), (3, 4), (4,)]}
    full = one.engine_torque()[0]
    assert full - mean[3, 4] == pytest.approx(2 * (full - mean[3,]), rel=1e-9)
    assert mean[3,] == pytest.approx(mean[4,], rel=1e-12)
    # Of work W and torque of five and none of the sixth: W' = W (5 + s) / 6, and so the mean torque.
    share = less.mean_work_J / one.mean_work_J
    assert mean[3,] / full == pytest.approx(share, rel=1e-6)


@pytest.mark.parametrize("rpm", [700.0, 1480.0])
def test_work_of_the_torques_is_what_the_damping_takes(rpm: float) -> None:
    scene = six({**FLYWHEEL, "throw_loss_factor": 0.01}, misfire=[2])
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene)
    assert harmonics is not None
    check_balance(shaft, harmonics, rpm)
    assert np.abs(harmonics.of_throws_Nm(rpm).sum(axis=1)[1]) > 100.0


def test_an_engine_numbered_from_its_other_end_has_the_same_numbers() -> None:
    order = load_scene(SIX).engine.firing_order
    scene = six(BARE, misfire=[2])
    mirrored = six(BARE, misfire=[5], firing_order=[7 - number for number in order])
    found = []
    for one in (scene, mirrored):
        harmonics = torque_harmonics(one)
        assert harmonics is not None
        found.append(vibration(estimated_chain(one), harmonics, np.array([900.0, 1500.0])))
    assert found[0].torque_amplitude_Nm == pytest.approx(found[1].torque_amplitude_Nm[:, ::-1], rel=1e-9)
    torques = [analyse(one).cycle.torque.engine_Nm for one in (scene, mirrored)]
    assert torques[0] == pytest.approx(torques[1], rel=1e-9, abs=1e-6)


def test_a_rigid_shaft_passes_the_quasi_static_torque_of_the_misfiring_engine_on() -> None:
    stiff = {"throw_stiffness_Nm_per_rad": 1e12, "flywheel": {"inertia_kg_m2": 1e6}}
    scene = six(stiff, misfire=[4])
    harmonics, cycle = torque_harmonics(scene), analyse(scene).cycle
    assert harmonics is not None
    found = vibration(estimated_chain(scene), harmonics, np.array([RPM]), orders=60)
    passed = cycle.torque.passed_on_Nm
    assert found.torque_amplitude_Nm[0] == pytest.approx(np.ptp(passed, axis=1) / 2, rel=1e-4)
    assert found.mean_torque_Nm == pytest.approx(passed.mean(axis=1), rel=1e-6)


def test_half_order_and_first_order_of_two_disks_in_closed_form() -> None:
    """Two throws alone: their relative motion is that of one disk of half the inertia."""
    shaft = {"throw_stiffness_Nm_per_rad": 1.4e5, "throw_damping_Nms_per_rad": 6.0, "throw_loss_factor": 0.0}
    plain = load_scene("mikron-iiic-plain")
    scene = engine(plain, shaft, cylinders=2, firing_order=[1, 2], misfire=[2], speed_rpm=2000.0)
    single, silent = (gas_torque_Nm(scene, curve) for curve in curves(scene))
    first, second = orders_of(summed_Nm(scene, single, silent, (2,)))[:, 1:3]  # inertia is equal: it cancels
    chain, harmonics = estimated_chain(scene), torque_harmonics(scene)
    assert harmonics is not None
    j, k = chain.chain.inertia_kg_m2[0], 1.4e5
    assert chain.chain.inertia_kg_m2[1] == j
    w, c = np.array([0.5, 1.0]) * angular_speed_rad_s(2000.0), 6.0
    expected = (k + 1j * w * c) * (first - second) / 2 / (k + 1j * w * c - j / 2 * w**2)
    found = vibration(chain, harmonics, np.array([2000.0])).torque_Nm[0, :2, 0]
    assert found == pytest.approx(expected, rel=1e-6)


def test_how_far_the_torques_add_up_in_a_rigid_motion() -> None:
    """Five vectors cancel but for the sixth: what it lacks, over the sum of all magnitudes."""
    scene = six(FLYWHEEL, misfire=[6])
    harmonics = torque_harmonics(scene)
    assert harmonics is not None
    speeds = np.full(12, RPM)
    found = harmonics.adding_up(np.ones(6), speeds)
    single = harmonics.gas_Nm + angular_speed_rad_s(RPM) ** 2 * harmonics.inertia_Nm_s2
    lost = harmonics.lost_Nm
    assert lost is not None
    by_hand = np.abs(lost) / (5 * np.abs(single) + np.abs(single - lost))
    minor = [k for k in range(1, 13) if k % 6]
    assert found[np.array(minor) - 1] == pytest.approx(by_hand[minor], rel=1e-9)
    shaft = estimated_chain(scene)
    crossings = critical_speeds(shaft, shaft.chain.damped_modes(), harmonics, (200.0, 1800.0))
    assert all(0 < one.share <= 1 for one in crossings)


def test_torques_of_a_run_up_are_those_of_the_orders() -> None:
    scene = six(FLYWHEEL, misfire=[1, 4])
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene)
    assert harmonics is not None
    angle = np.linspace(0.0, 4 * math.pi, 50)
    in_time = _torques(shaft, harmonics, np.full(50, angular_speed_rad_s(RPM)), angle)
    acting = on_disks(shaft, harmonics.of_throws_Nm(RPM))[1:25]
    clock = np.exp(1j * harmonics.orders[1:25] * angle[:, None])
    assert in_time == pytest.approx((clock @ acting).real, abs=1e-9 * np.abs(in_time).max())


def test_the_torque_of_a_vibrating_shaft_has_the_dead_cylinder() -> None:
    """At a low speed it is the quasi-static one, with its mean behind every throw."""
    scene = at_speed(six(FLYWHEEL, misfire=[2]), 5.0)
    found, slow = vibrating_torque(scene, DEFAULT_EFFECTS), analyse(scene, DEFAULT_EFFECTS).cycle.torque
    assert found.passed_on_Nm.mean(axis=1) == pytest.approx(slow.passed_on_Nm.mean(axis=1), rel=1e-9)
    means = np.diff(found.passed_on_Nm.mean(axis=1), prepend=0.0)
    assert means[1] == pytest.approx(means.min())
    assert abs(means[1]) < 0.01 * means[0]


def test_main_bearings_together_lack_the_gas_force_of_the_dead_cylinder() -> None:
    """In the direction of the cylinders, where inertia and the other cylinders stay as they are."""
    scene, dead = six(), six(misfire=[5])
    sums = [main_bearings(one, turning_masses(one)).load_N.sum(axis=0) for one in (scene, dead)]
    fired, motored = curves(scene)
    force = math.pi / 4 * scene.engine.bore_mm**2 * (fired - motored)
    late = round(120.0 / STEP_DEG)  # cylinder 5 fires second
    assert (sums[1] - sums[0]).real == pytest.approx(np.roll(force, late), abs=1e-9 * force.max())


def test_the_shaft_on_its_bearings_lacks_it_too() -> None:
    """Equilibrium: forces of all bearings together, of throws of beams, in axes that turn with the shaft."""
    throw, throws = beam_throw([*CRANK_MM[:3], (6.0, 48.0, 41.0), *CRANK_MM[3:]], 3), 6
    scene, dead = six(), six(misfire=[5])
    sums = []
    for one in (scene, dead):
        cycle = shaft_cycle([throw] * throws, scene.shaft_angles_deg, cycle_forces(one), None)
        sums.append(cycle.bearing_N.sum(axis=0))
    fired, motored = (curve[::4] for curve in curves(scene))
    force = np.roll(math.pi / 4 * scene.engine.bore_mm**2 * (fired - motored), 120)
    radius, rod = scene.throw.radius_mm, scene.engine.rod_length_mm
    after = np.radians(np.arange(720.0) - 120)
    sideways = force * np.tan(np.arcsin(radius / rod * np.sin(after)))
    assert np.hypot(*(sums[1] - sums[0])) == pytest.approx(np.hypot(force, sideways), abs=1e-6 * force.max())


def test_pins_of_other_throws_stay_as_they_are() -> None:
    whole, dead = cycle_forces(six()), cycle_forces(six(misfire=[5]))
    same = [bool(np.array_equal(a, b)) for a, b in zip(whole.radial_N, dead.radial_N, strict=True)]
    assert same == [True, True, True, True, False, True]
    assert np.ptp(dead.radial_N[4]) < 0.4 * np.ptp(whole.radial_N[4])


def test_one_rod_of_two_on_a_pin_of_a_v() -> None:
    """Cylinder 5 of eight is in the second bank, on the first pin."""
    vee = arranged(f"{VEE}throw_angles_deg = [0, 90, 270, 180]", 8, (1, 5, 4, 8, 6, 3, 7, 2))
    dead = engine(vee, misfire=[5])
    single, silent = (gas_torque_Nm(vee, curve) for curve in curves(vee))
    fires = round(vee.engine.firing_angles_deg[4] / STEP_DEG)
    lost = np.roll(single - silent, fires)
    fall = analyse(vee).cycle.torque.passed_on_Nm - analyse(dead).cycle.torque.passed_on_Nm
    assert fall == pytest.approx(np.tile(lost, (4, 1)), abs=1e-5 * np.abs(lost).max())


def test_a_map_over_speed_has_its_motored_curve_between_entries() -> None:
    data = six().model_dump(mode="json", exclude_none=True)
    gas = data["engine"]["gas"]
    peak = {key: gas.pop(key) for key in ("peak_pressure_MPa", "peak_angle_deg")}
    gas["map"] = [{"rpm": 900.0, **peak}, {"rpm": 1800.0, **peak, "peak_pressure_MPa": 12.0}]
    mapped = scene_from_dict({**data, "engine": {**data["engine"], "misfire": [1]}})
    single = six(misfire=[1])
    assert curves(mapped)[1] == pytest.approx(curves(single)[1], rel=1e-12)
    harmonics, one = torque_harmonics(at_speed(mapped, 1200.0)), torque_harmonics(single)
    assert harmonics is not None
    assert one is not None
    assert harmonics.of_throws_Nm(900.0) == pytest.approx(one.of_throws_Nm(900.0), rel=1e-9, abs=1e-6)
    trace = analyse(at_speed(mapped, 1500.0)).cycle.torque.passed_on_Nm
    found = np.cumsum(harmonics.of_throws_Nm(1500.0), axis=1)[1:60].T
    assert found == pytest.approx(orders_of(trace)[:, 1:60], abs=1e-9 * np.abs(found).max())


def test_load_cases_are_those_of_an_engine_that_fires() -> None:
    scene, dead = six(), six(misfire=[3])
    assert load_cases(dead) == load_cases(scene)
    histories = [load_history(one, "cycle", DEFAULT_EFFECTS) for one in (scene, dead)]
    assert np.array_equal(histories[0].torque_Nm, histories[1].torque_Nm)
    told: list[str] = []
    with redirected(told.append):
        assert one_throw(dead) == scene
        assert one_throw(dead, all_fire=False) is dead
    assert told == [
        "industrial-gas: engine.misfire is left out: one throw is judged with all cylinders firing"
    ]


def test_the_beam_on_its_bearings_has_each_cylinders_own_force() -> None:
    whole, dead = (span_bending(one) for one in (six(), six(misfire=[5])))
    assert dead.least < 0.7 * whole.least


def test_no_misfire_is_the_scene_without_the_key() -> None:
    scene = six()
    assert six(misfire=[]) == scene
    assert "misfire" not in scene.model_dump(mode="json")["engine"]
    assert loads_at_speeds(scene)[0].as_json().keys() >= {"indicated_power_kW"}
    assert "misfire" not in loads_at_speeds(scene)[0].as_json()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ([7], "must be numbers of cylinders, 1 to 6"),
        ([0], "must be numbers of cylinders, 1 to 6"),
        ([2, 2], "names a cylinder twice"),
        ([1, 2, 3, 4, 5, 6], "leaves no cylinder that fires"),
        ([1.0], "must be an integer"),
        ([True], "must be an integer"),
    ],
)
def test_what_no_engine_can_lack(given: list[object], said: str) -> None:
    with pytest.raises(CranktopoError, match=said) as error:
        six(misfire=given)
    assert "engine.misfire" in str(error.value)


def test_without_pressures_nothing_is_known_of_a_misfire() -> None:
    with pytest.raises(CranktopoError, match=r"needs \[engine.gas\]"):
        engine(load_scene("opposed-piston"), misfire=[1])
