"""The varying inertia of rod and piston against the non-linear motion in time and against its power."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.units import angular_speed_rad_s
from cranktopo.design.loading import load_scene
from cranktopo.engine.vibration.order_coupling import order_coupling
from cranktopo.engine.vibration.shaft_chain import ShaftChain
from cranktopo.engine.vibration.steady import on_disks, vibration
from cranktopo.engine.vibration.torque_harmonics import (
    TorqueHarmonics,
    torque_harmonics,
    varying_inertia_kg_m2,
    varying_part,
    varying_share_percent,
)
from cranktopo.numerics.disk_chain import DiskChain
from tests.physics.engine.dissipation import dissipated_J

SCENE = load_scene("mikron-iiic-plain")
OWN, HELD, ORDERS = 0.002, 1e7, 40
ONE = DiskChain((OWN, HELD), (5.0e4,), (), (0.3,), (0.3, 0.0))
TWO = DiskChain((OWN, 1.4 * OWN, HELD), (9.0e4, 1.1e5), (), (0.5, 0.8), (0.2, 0.3, 0.0))


def reciprocating() -> tuple[float, float]:
    """Reciprocating mass times the square of the throw radius, kg m2, and radius over rod length."""
    engine, radius = SCENE.engine, SCENE.throw.radius_mm
    assert engine is not None
    return engine.reciprocating_kg * (radius / 1000) ** 2, radius / engine.rod_length_mm


def engine_of(own: DiskChain, firing_deg: tuple[float, ...]) -> tuple[ShaftChain, TorqueHarmonics]:
    """Throws that fire at given angles, gas torque of the first orders alone; mean inertia as in a scene."""
    throws = len(firing_deg)
    mean = tuple(j + reciprocating()[0] / 2 * (i < throws) for i, j in enumerate(own.inertia_kg_m2))
    names = (*(f"throw {i + 1}" for i in range(throws)), "flywheel")
    harmonics = torque_harmonics(SCENE)
    assert harmonics is not None
    gas = np.where((harmonics.orders > 0) & (harmonics.orders <= 9), harmonics.gas_Nm, 0)
    shaft = ShaftChain(replace(own, inertia_kg_m2=mean), names, 0, throws, 1.0)
    return shaft, replace(harmonics, gas_Nm=gas, firing_deg=firing_deg, throw_of=tuple(range(throws)))


def integrated_Nm(own: DiskChain, harmonics: TorqueHarmonics, speed: float, turns: int) -> Array:
    """Half the range of the torque of every section in the last two turns, from the full equations.

    (J + m r^2 v(a)^2) a'' + m r^2 v v' a'^2 = torque, v = sin a (1 + lam cos a / sqrt(1 - lam^2 sin^2 a)).
    """
    mass, lam = reciprocating()
    firing = np.radians(harmonics.firing_deg)
    j, k = np.array(own.inertia_kg_m2), np.array(own.stiffness_Nm_per_rad)
    c, drag = np.array(own.relative_damping_Nms_per_rad), np.array(own.absolute_damping_Nms_per_rad)
    orders, gas = harmonics.orders[:ORDERS], harmonics.gas_Nm[:ORDERS]
    throws = slice(0, len(firing))

    def rate(t: float, state: Array) -> Array:
        twist, velocity = state.reshape(2, -1)
        a = speed * t + twist[throws] - firing
        sine, cosine = np.sin(a), np.cos(a)
        q = np.sqrt(1 - (lam * sine) ** 2)
        v = sine * (1 + lam * cosine / q)
        slope = cosine + lam * np.cos(2 * a) / q + lam**3 * np.sin(2 * a) ** 2 / (4 * q**3)
        torque = -drag * velocity
        clock = np.exp(1j * np.outer(speed * t - firing, orders))
        torque[throws] += (clock @ gas).real - mass * v * slope * (speed + velocity[throws]) ** 2
        through = k * (twist[:-1] - twist[1:]) + c * (velocity[:-1] - velocity[1:])
        torque[:-1] -= through
        torque[1:] += through
        inertia = j.copy()
        inertia[throws] += mass * v**2
        return np.concatenate([velocity, torque / inertia])

    end = turns * 2 * math.pi / speed
    when = np.linspace((turns - 2) / turns * end, end, 1441)
    start = np.zeros(2 * len(j))
    twist, velocity = solve_ivp(
        rate, (0.0, end), start, method="DOP853", t_eval=when, rtol=1e-6, atol=1e-9
    ).y.reshape(2, len(j), -1)
    curves = k[:, None] * -np.diff(twist, axis=0) + c[:, None] * -np.diff(velocity, axis=0)
    return np.asarray(np.ptp(curves, axis=1) / 2)


@pytest.mark.parametrize(
    ("own", "firing_deg", "rpm"),
    [(ONE, (0.0,), 4500.0), (TWO, (0.0, 250.0), 3300.0)],
    ids=["one throw", "two throws, uneven firing"],
)
def test_non_linear_motion_settles_to_the_same_torque(
    own: DiskChain, firing_deg: tuple[float, ...], rpm: float
) -> None:
    """Within 0.5 % at a speed where the mean inertia alone is off by several percent."""
    shaft, harmonics = engine_of(own, firing_deg)
    varying = varying_inertia_kg_m2(SCENE, harmonics)
    in_time = integrated_Nm(own, harmonics, angular_speed_rad_s(rpm), turns=8)
    found, mean = (
        vibration(shaft, harmonics, np.array([rpm]), ORDERS, part).torque_amplitude_Nm[0]
        for part in (varying, None)
    )
    assert found == pytest.approx(in_time, rel=0.005)
    assert (np.abs(mean / in_time - 1) > 0.03).all()


def two_throws(rpm: float) -> tuple[ShaftChain, Array, Complex, Complex, Complex]:
    """Shaft, orders, torques, harmonics of the inertia, and the twist with them."""
    shaft, harmonics = engine_of(TWO, (0.0, 250.0))
    varying = varying_inertia_kg_m2(SCENE, harmonics)
    orders = harmonics.orders[1 : ORDERS + 1]
    torque = on_disks(shaft, harmonics.of_throws_Nm(rpm))[1 : ORDERS + 1]
    twist = order_coupling(orders, varying).response_rad(shaft, angular_speed_rad_s(rpm), torque)
    return shaft, orders, torque, varying, twist


def test_power_of_torques_and_varying_inertia_is_what_the_damping_takes() -> None:
    """Power of the inertia on the twist: -w <J' t'^2> / 2 + w^3 <J''' t^2> / 4, means over the cycle."""
    w = angular_speed_rad_s(3300.0)
    shaft, orders, torque, varying, twist = two_throws(3300.0)
    often = orders * w / (2 * math.pi)
    taken = (often * dissipated_J(shaft.chain, orders * w, twist)).sum()
    given = (often * np.pi * (torque * twist.conj()).imag.sum(axis=-1)).sum()
    angle = np.arange(1440) / 1440 * 4 * math.pi
    moving = twist[:, shaft.driven]
    turning = np.exp(1j * np.outer(angle, orders))
    theta, velocity = (turning @ moving).real, (turning @ (1j * w * orders[:, None] * moving)).real
    k = np.arange(1, len(varying))
    first, third = (
        2 * (np.exp(1j * np.outer(angle, k)) @ ((1j * k[:, None]) ** n * varying[1:])).real for n in (1, 3)
    )
    pumped = (-w * first * velocity**2 / 2 + w**3 * third * theta**2 / 4).mean(axis=0).sum()
    assert abs(pumped) > 0.01 * taken
    assert taken == pytest.approx(given + pumped, rel=1e-9)


def test_no_varying_part_is_the_mean_inertia() -> None:
    shaft, harmonics = engine_of(TWO, (0.0, 250.0))
    speeds = np.array([3300.0, 5200.0])
    none = np.zeros((5, 2), dtype=complex)
    found = vibration(shaft, harmonics, speeds, ORDERS, none).twist_rad
    mean = vibration(shaft, harmonics, speeds, ORDERS).twist_rad
    assert np.abs(found - mean).max() < 1e-12 * np.abs(mean).max()


def test_harmonics_are_those_of_the_piston_speed() -> None:
    """J = m r^2 v^2 of two cylinders on one throw, one of them a quarter turn later."""
    mass, lam = reciprocating()
    harmonics = torque_harmonics(SCENE)
    assert harmonics is not None
    found = varying_inertia_kg_m2(SCENE, replace(harmonics, firing_deg=(0.0, 90.0), throw_of=(0, 0)))[:, 0]
    a = np.arange(4096) / 4096 * 2 * math.pi
    every = np.zeros(len(a))
    for b in (a, a - math.pi / 2):
        every = every + mass * (np.sin(b) * (1 + lam * np.cos(b) / np.sqrt(1 - (lam * np.sin(b)) ** 2))) ** 2
    expected = np.fft.rfft(every)[:5] / len(a)
    expected[0] -= mass
    assert np.abs(found - expected).max() < 1e-5 * mass


def test_share_of_what_swings() -> None:
    """One throw against a held end: the second harmonic over its inertia; half of it beside an equal disk."""
    shaft, harmonics = engine_of(ONE, (0.0,))
    varying = varying_inertia_kg_m2(SCENE, harmonics)
    expected = 200 * abs(varying[2, 0]) / shaft.chain.inertia_kg_m2[0]
    modes = shaft.chain.damped_modes()
    assert varying_share_percent(shaft, modes, varying) == pytest.approx(expected, rel=1e-4)
    j = shaft.chain.inertia_kg_m2[0]
    pair = replace(shaft, chain=DiskChain((j, j, HELD), (1e9, 5e4)), names=("throw 1", "pulley", "flywheel"))
    first = pair.chain.damped_modes()[:1]
    assert varying_share_percent(pair, first, varying) == pytest.approx(expected / 2, rel=1e-3)
    bare = varying_part(SCENE, shaft, harmonics, modes, {1})
    assert not bare.included  # the scene has no [shaft]
    assert bare.share_percent == pytest.approx(expected, rel=1e-4)
