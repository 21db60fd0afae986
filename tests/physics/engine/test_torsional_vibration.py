"""Forced torsional vibration against closed forms, the energy balance and time integration."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import scipy.linalg
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize, minimize_scalar

from cranktopo.base.arrays import Array
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.vibration.barred import runs_barred
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.steady import critical_speeds, speeds_to_solve, vibration
from cranktopo.engine.vibration.study import run_up, study_vibration
from cranktopo.engine.vibration.telling import WEAK
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.numerics.disk_chain import DiskChain
from tests.fast_twin import fast_twin
from tests.physics.engine.dissipation import check_balance

DAMPED = {
    "throw_damping_Nms_per_rad": 8.0,
    "cylinder_damping_Nms_per_rad": 0.7,
    "throw_loss_factor": 0.0,
    "pulley": {"inertia_kg_m2": 0.002, "stiffness_Nm_per_rad": 9e5},
    "flywheel": {"inertia_kg_m2": 0.09},
    "coupling": {"inertia_kg_m2": 0.01, "stiffness_Nm_per_rad": 3e4, "loss_factor": 0.0},
    "propeller": {"inertia_kg_m2": 0.5, "stiffness_Nm_per_rad": 2e4, "damping_Nms_per_rad": 30.0},
}


def with_shaft(shaft: dict[str, object], name: str = "mikron-iiic-plain") -> Scene:
    data = load_scene(name).model_dump(mode="json", exclude_none=True)
    return scene_from_dict({**data, "shaft": shaft})


def stepped_bar(slices: int) -> tuple[float, float]:
    """First frequency of a free bar of two diameters: slices as disks, and in closed form, rad/s.

    Wave speed c; segments of length l and impedance Z = rho J c: Z1 tan(w l1/c) + Z2 tan(w l2/c) = 0.
    """
    speed, lengths, impedances = 3200.0, (0.6, 0.4), (1.0, 0.25)
    inertia, stiffness = [0.0] * (2 * slices + 1), []
    for part, (length, impedance) in enumerate(zip(lengths, impedances, strict=True)):
        piece = length / slices
        stiffness += [impedance * speed / piece] * slices
        for i in range(part * slices, (part + 1) * slices):
            inertia[i] += impedance * piece / speed / 2
            inertia[i + 1] += impedance * piece / speed / 2

    def balance(w: float) -> float:
        return sum(z * math.tan(w * length / speed) for z, length in zip(impedances, lengths, strict=True))

    # The first root lies between the poles of the two tangents.
    poles = sorted(math.pi / 2 * speed / length for length in lengths)
    exact = brentq(balance, poles[0] * (1 + 1e-9), poles[1] * (1 - 1e-9), xtol=1e-9)
    chain = DiskChain(tuple(inertia), tuple(stiffness))
    return 2 * math.pi * chain.natural_frequencies_Hz()[0], float(exact)


def test_stepped_bar_converges() -> None:
    errors = []
    for slices in (8, 16, 32):
        found, exact = stepped_bar(slices)
        errors.append(abs(found / exact - 1))
    assert errors[2] < 1e-3
    assert [a / b for a, b in pairwise(errors)] == pytest.approx([4, 4], rel=0.05)


def test_one_disk_against_closed_form() -> None:
    """A disk and a dashpot to ground behind a spring to a disk that is as good as held."""
    j, k, c, loss, torque = 0.3, 2.0e4, 4.0, 0.05, 12.0 - 5.0j
    chain = DiskChain((j, 1e12), (k,), (loss,), (), (c, 0.0))
    w = np.array([10.0, 258.0, 700.0])
    expected = torque / (k * (1 + 1j * loss) - j * w**2 + 1j * c * w)
    found = chain.response_rad(w, np.array([[torque, 0.0]] * 3))
    assert found[:, 0] == pytest.approx(expected, rel=1e-9)
    passed = chain.section_torque_Nm(w, found)[:, 0]
    assert passed == pytest.approx(k * (1 + 1j * loss) * expected, rel=1e-9)


def test_two_free_disks_against_closed_form() -> None:
    """The relative motion is that of one disk of inertia J1 J2 / (J1 + J2)."""
    j1, j2, k, c, torque = 0.03, 0.4, 6.0e4, 2.5, np.array([7.0 + 2.0j, -3.0 + 1.0j])
    chain = DiskChain((j1, j2), (k,), (), (c,))
    w = np.array([30.0, 1465.0, 4000.0])
    reduced = j1 * j2 / (j1 + j2)
    relative = reduced * (torque[0] / j1 - torque[1] / j2) / (k + 1j * w * c - reduced * w**2)
    passed = chain.section_torque_Nm(w, chain.response_rad(w, np.array([torque] * 3)))[:, 0]
    assert passed == pytest.approx((k + 1j * w * c) * relative, rel=1e-9)


def test_work_of_the_torques_is_what_the_damping_takes() -> None:
    damper = {"kind": "rubber", "ring_inertia_kg_m2": 0.004, "hub_inertia_kg_m2": 0.001}
    damper |= {"stiffness_Nm_per_rad": 2e4, "loss_factor": 0.2}
    scene = with_shaft({**DAMPED, "throw_loss_factor": 0.01, "damper": damper})
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene)
    assert harmonics is not None
    assert shaft.names[:2] == ("damper ring", "hub + pulley")
    for rpm in (900.0, 2750.0):
        check_balance(shaft, harmonics, rpm)


def integrated_Nm(scene: Scene, cycles: int) -> tuple[Array, Array]:
    """Torque of the sections over the last of some cycles, by time steps; and the torques on the throws.

    The cylinders' torque is that of the load analysis, joined by straight lines, not its orders.
    """
    shaft, engine, cycle = estimated_chain(scene), scene.engine, analyse(scene).cycle
    assert engine is not None
    assert cycle is not None
    chain, passed = shaft.chain, cycle.torque.passed_on_Nm
    single = np.diff(passed, axis=0, prepend=0.0)
    single -= single.mean(axis=1, keepdims=True)
    speed, period = angular_speed_rad_s(engine.speed_rpm), math.radians(engine.cycle_deg)
    angles = np.append(np.radians(cycle.torque.angle_deg), period)
    table = np.hstack([single, single[:, :1]]).T
    step = angles[1]
    j, k = np.array(chain.inertia_kg_m2), np.array(chain.stiffness_Nm_per_rad)
    c, own = np.array(chain.relative_damping_Nms_per_rad), np.array(chain.absolute_damping_Nms_per_rad)

    def rate(t: float, state: Array) -> Array:
        twist, velocity = state.reshape(2, -1)
        at, part = divmod((speed * t) % period / step, 1.0)
        torque = -own * velocity
        torque[shaft.driven] += table[int(at)] * (1 - part) + table[int(at) + 1] * part
        through = k * (twist[:-1] - twist[1:]) + c * (velocity[:-1] - velocity[1:])
        torque[:-1] -= through
        torque[1:] += through
        return np.concatenate([velocity, torque / j])

    end, last = cycles * period / speed, (cycles - 1) * period / speed
    when = np.linspace(last, end, 721)[:-1]
    found = solve_ivp(
        rate, (0.0, end), np.zeros(2 * len(j)), t_eval=when, rtol=1e-5, atol=1e-9, max_step=1e-4
    )
    twist, velocity = found.y.reshape(2, len(j), -1)
    return k[:, None] * -np.diff(twist, axis=0) + c[:, None] * -np.diff(velocity, axis=0), single


def test_time_integration_settles_to_the_same_vibration() -> None:
    """At a speed near a resonance; every section within 0.5 % of the largest amplitude."""
    scene = at_speed(with_shaft(DAMPED), 2600.0)
    harmonics = torque_harmonics(scene)
    assert harmonics is not None
    steady = vibration(estimated_chain(scene), harmonics, np.array([2600.0]), orders=60)
    curves, single = integrated_Nm(scene, cycles=9)
    assert np.ptp(single) > 500
    amplitude = (curves.max(axis=1) - curves.min(axis=1)) / 2
    assert steady.torque_amplitude_Nm[0] == pytest.approx(amplitude, rel=0.005)


def peak(chain: DiskChain, natural_rad_s: float) -> float:
    """Largest twist of the second disk over its static twist, the last disk being held."""
    w = natural_rad_s * np.linspace(0.5, 1.5, 4001)
    twist = chain.response_rad(w, np.array([[0.0, 1.0, 0.0]] * len(w)))[:, 1]
    return float(np.abs(twist).max() * chain.stiffness_Nm_per_rad[-1])


@pytest.mark.parametrize("ratio", [0.1, 0.5])
def test_best_untuned_viscous_damper_is_den_hartogs(ratio: float) -> None:
    """Damping ratio 1 / sqrt(2 (1 + m)(2 + m)) and magnifier (2 + m) / m (Mechanical Vibrations, 1956)."""
    j, k = 0.5, 8.0e4
    natural = math.sqrt(k / j)

    def magnifier(damping_ratio: float) -> float:
        c = 2 * ratio * j * natural * damping_ratio
        return peak(DiskChain((ratio * j, j, 1e12), (0.0, k), (), (c, 0.0)), natural)

    best = minimize_scalar(magnifier, bounds=(0.05, 1.5), method="bounded", options={"xatol": 1e-4})
    assert best.fun == pytest.approx((2 + ratio) / ratio, rel=1e-3)
    assert best.x == pytest.approx(1 / math.sqrt(2 * (1 + ratio) * (2 + ratio)), rel=0.01)


def tuned(ratio: float, tuning: float, loss: float = 0.0, damping_ratio: float = 0.0) -> DiskChain:
    """A ring on a spring with damping, on a disk whose own natural frequency is 400 rad/s."""
    j, natural = 0.5, 400.0
    spring = ratio * j * (tuning * natural) ** 2
    viscous = 2 * ratio * j * natural * damping_ratio
    return DiskChain((ratio * j, j, 1e12), (spring, j * natural**2), (loss, 0.0), (viscous, 0.0))


@pytest.mark.parametrize(("loss", "damping_ratio"), [(0.1, 0.0), (0.8, 0.0), (0.0, 0.1), (0.0, 0.6)])
def test_fixed_points_of_a_tuned_damper(loss: float, damping_ratio: float) -> None:
    """At the tuning 1 / (1 + m) two speeds have the magnifier sqrt(1 + 2 / m) whatever the damping."""
    ratio = 0.2
    chain = tuned(ratio, 1 / (1 + ratio), loss, damping_ratio)
    w = 400.0 * np.sqrt((1 + np.array([-1, 1]) * math.sqrt(ratio / (2 + ratio))) / (1 + ratio))
    twist = np.abs(chain.response_rad(w, np.array([[0.0, 1.0, 0.0]] * 2))[:, 1])
    assert twist * chain.stiffness_Nm_per_rad[1] == pytest.approx(math.sqrt(1 + 2 / ratio), rel=1e-9)


@pytest.mark.parametrize(("kind", "above"), [("rubber", 0.05), ("viscous", 0.01)])
def test_best_tuned_damper_is_den_hartogs(kind: str, above: float) -> None:
    """Tuning 1 / (1 + m), magnifier not far above sqrt(1 + 2 / m), damping ratio^2 3 m / (8 (1 + m)^3)."""
    ratio = 0.2
    least = math.sqrt(1 + 2 / ratio)

    def magnifier(design: Array) -> float:
        name = "loss" if kind == "rubber" else "damping_ratio"
        return peak(tuned(ratio, design[0], **{name: design[1]}), 400.0)

    best = minimize(magnifier, [0.9, 0.3], method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-3})
    assert least * 0.999 < best.fun < least * (1 + above)
    assert best.x[0] == pytest.approx(1 / (1 + ratio), rel=0.02)
    if kind == "viscous":
        assert best.x[1] == pytest.approx(math.sqrt(3 * ratio / (8 * (1 + ratio) ** 3)), rel=0.05)


def test_a_rigid_shaft_on_a_heavy_flywheel_passes_the_quasi_static_torque_on() -> None:
    """So a stiff shaft changes nothing of what the load cases are without vibration."""
    scene = with_shaft({"throw_stiffness_Nm_per_rad": 1e11, "flywheel": {"inertia_kg_m2": 1e6}})
    harmonics, cycle = torque_harmonics(scene), analyse(scene).cycle
    assert harmonics is not None
    assert cycle is not None
    found = vibration(estimated_chain(scene), harmonics, np.array([2100.0]), orders=60)
    passed = cycle.torque.passed_on_Nm
    assert found.torque_amplitude_Nm[0] == pytest.approx(np.ptp(passed, axis=1) / 2, rel=1e-4)
    assert found.mean_torque_Nm == pytest.approx(passed.mean(axis=1), rel=1e-6)


def test_a_slow_run_up_has_the_steady_peak_and_a_fast_one_less_and_later() -> None:
    """Two independent solutions of one shaft: in time and by order."""
    scene = with_shaft({"flywheel": {"inertia_kg_m2": 0.08}, "throw_loss_factor": 0.03})
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene)
    assert harmonics is not None
    speeds = (2150.0, 2550.0)  # order 10 in its middle
    critical = critical_speeds(shaft, shaft.chain.damped_modes(), harmonics, speeds)
    steady = vibration(shaft, harmonics, speeds_to_solve(speeds, critical, 50))
    slow, fast = (run_up(shaft, harmonics, speeds, seconds) for seconds in (4.0, 0.6))
    section = steady.worst.section
    peak = steady.torque_amplitude_Nm[:, section].max()
    assert slow.torque_amplitude_Nm[:, section].max() == pytest.approx(peak, rel=0.02)
    assert fast.torque_amplitude_Nm[:, section].max() < 0.99 * peak
    places = [r.speeds_rpm[r.torque_amplitude_Nm[:, section].argmax()] for r in (slow, fast)]
    assert steady.speeds_rpm[steady.worst.speed_index] < places[0] + 5.0 < places[1]


def test_major_orders_of_four_cylinders() -> None:
    """Firing twice a turn, orders 2, 4, 6 ... of all throws are in phase and no others."""
    scene = with_shaft({"flywheel": {"inertia_kg_m2": 0.2}})
    shaft, harmonics = estimated_chain(scene), torque_harmonics(scene)
    assert harmonics is not None
    modes = shaft.chain.damped_modes()
    found = critical_speeds(shaft, modes, harmonics, (500.0, 20000.0))
    assert {c.order for c in found if c.major} == {2.0, 4.0, 6.0, 8.0, 10.0, 12.0}
    assert all(c.speed_rpm * c.order / 60 == pytest.approx(modes[c.mode - 1].frequency_Hz) for c in found)
    assert {c.speed_rpm for c in found} <= set(speeds_to_solve((500.0, 20000.0), found, 10))


def test_critical_speeds_that_are_not_felt_are_counted_but_not_told() -> None:
    """Each crossing is solved for itself; low speeds meet the modes by high orders that carry nothing."""
    stiff = {"flywheel": {"inertia_kg_m2": 0.2}, "throw_stiffness_Nm_per_rad": 1.5e5}
    scene = with_shaft({**stiff, "throw_loss_factor": 0.02, "speed_min_rpm": 900.0, "speed_max_rpm": 2800.0})
    scene = scene.model_copy(update={"effects": scene.effects.model_copy(update={"threshold": 0.9})})
    study = study_vibration(scene, estimated_chain(scene), 1.0, "given")
    largest = study.response.torque_amplitude_Nm.max(axis=0)
    met = [
        (number, place, 60 * mode.frequency_Hz / order)
        for number, mode in enumerate(study.modes, start=1)
        for place, order in enumerate(study.response.orders)
        if 900.0 <= 60 * mode.frequency_Hz / order <= 2800.0
    ]
    found = vibration(study.shaft, study.response.harmonics, np.array([rpm for _, _, rpm in met]), 240)
    alone = [np.abs(found.torque_Nm[row, place]) for row, (_, place, _) in enumerate(met)]
    felt = {
        (number, float(study.response.orders[place]))
        for (number, place, _), torque in zip(met, alone, strict=True)
        if (torque >= 0.01 * largest).any()
    }
    told = {(one.mode, one.order) for one in study.critical if one.share >= WEAK}
    weak = {(one.mode, one.order) for one in study.critical if one.share < WEAK}
    assert told == felt - weak
    assert told
    assert sum(study.left_out) == len(met) - len(told) - len(weak) > 0


def test_damped_modes_of_two_disks() -> None:
    """Relative viscous damping: c / (2 sqrt(k J)), J the reduced inertia; a loss factor: half of it."""
    reduced, stiffness = 2.0 * 3.0 / 5.0, 5e4
    natural = math.sqrt(stiffness / reduced) / (2 * math.pi)
    viscous = 2 * 0.3 * math.sqrt(stiffness * reduced)
    (mode,) = DiskChain((2.0, 3.0), (stiffness,), (), (viscous,)).damped_modes()
    assert (mode.frequency_Hz, mode.damping_ratio) == pytest.approx((natural, 0.3), rel=1e-9)
    (mode,) = DiskChain((2.0, 3.0), (stiffness,), (0.02,)).damped_modes()
    assert (mode.frequency_Hz, mode.damping_ratio) == pytest.approx((natural, 0.01), rel=1e-3)
    assert DiskChain((2.0, 3.0), (stiffness,), (), (4 * viscous,)).damped_modes() == ()


def test_damped_modes_decay_in_time() -> None:
    """A ring on a viscous damper alone: motion from a mode's shape, stepped by the matrix exponential."""
    inertia, viscous = (80.0, 40.0, 300.0, 900.0), (30000.0, 0.0, 50.0)
    stiffness = (0.0, 2e8, 1e8)
    chain = DiskChain(inertia, stiffness, (), viscous)
    difference = np.diff(np.eye(4), axis=0)
    mass, k, c = np.diag(inertia), *(difference.T @ np.diag(v) @ difference for v in (stiffness, viscous))
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse @ k, -inverse @ c]])
    modes = chain.damped_modes()
    assert len(modes) == 2
    for mode in modes:
        size, time = 2 * math.pi * mode.frequency_Hz, 0.7 / mode.frequency_Hz
        eigenvalue = size * complex(-mode.damping_ratio, math.sqrt(1 - mode.damping_ratio**2))
        start = np.concatenate([mode.shape.real, (eigenvalue * mode.shape).real])
        moved = (mode.shape * np.exp(eigenvalue * time)).real
        assert scipy.linalg.expm(state * time)[:4] @ start == pytest.approx(moved, abs=1e-9)
        assert abs(mode.shape[0]) > 0.01, "the ring is dragged along"


def test_a_throw_has_the_damping_of_each_of_its_cylinders() -> None:
    """Two rods on the pin of a V: a disk on nothing but that damping settles twice as fast."""
    alone = {"cylinder_damping_Nms_per_rad": 0.2, "flywheel": {"inertia_kg_m2": 0.1}}
    for scene, cylinders in ((with_shaft(alone), 1), (fast_twin(shaft=alone), 2)):
        chain = estimated_chain(scene).chain
        throws = chain.absolute_damping_Nms_per_rad[: len(scene.shaft_angles_deg)]
        assert throws == pytest.approx([0.2 * cylinders] * len(throws))


@pytest.mark.parametrize(
    ("speed", "barred", "told"),
    [
        (2100.0, [(1900.0, 2100.0)], "the engine's speed of 2100 rpm lies in the barred range from 1900 to"),
        (2100.0, [(1000.0, 2000.0), (2200.0, 2300.0)], ""),
        (1500.0, [(2200.0, 2800.0)], "the engine's overspeed of 2800 rpm lies in the barred range"),
    ],
)
def test_an_engine_that_runs_at_a_barred_speed(
    speed: float, barred: list[tuple[float, float]], told: str
) -> None:
    scene = at_speed(with_shaft({**DAMPED, "permitted_shear_MPa": 40.0}), speed)
    assert scene.engine is not None
    assert scene.engine.overspeed_rpm == 2800.0
    assert runs_barred(scene, barred).startswith(told)
    assert bool(runs_barred(scene, barred)) == bool(told)
