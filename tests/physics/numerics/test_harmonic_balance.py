"""Steady vibration of turning bodies against closed forms: a rotor of one mass, rods and beams."""

from __future__ import annotations

import math
from dataclasses import fields
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.numerics.harmonic_balance import (
    DampedBody,
    condensed,
    curves_of,
    damping_work,
    harmonics_of,
)
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.numerics.turning_parts import RoundSection, beam, rigid_disk

Complex = NDArray[np.complex128]
MASS, SPRING = 8e-3, 5e4
OWN = math.sqrt(SPRING / MASS)
YOUNGS, POISSON, DENSITY = 210e3, 0.3, 7.85e-9
SHEAR_MPA = YOUNGS / (2 * (1 + POISSON))
LENGTH, RADIUS = 600.0, 1.0
AREA, POLAR = math.pi * RADIUS**2, math.pi / 2 * RADIUS**4
ROD = RoundSection(AREA, POLAR, POLAR, YOUNGS, POISSON, DENSITY)
LOSS, ELEMENTS = 0.03, 30


def rotor(loss: float = 0.0, viscous: float = 0.0) -> DampedBody:
    """One mass across the axis on a spring alike in every direction."""
    body = rigid_disk(MASS, 1.0, 2.0).over(np.eye(6)[:, :2])
    stiffness = SPRING * np.eye(2)
    body = TurningBody(stiffness, body.mass, body.coriolis, body.lateral, body.stiffening)
    return DampedBody(body, loss * stiffness, viscous * np.eye(2))


def answer(body: DampedBody, frequency: float, speed: float, force: Complex) -> Complex:
    (dynamic,) = body.dynamic_stiffness(np.array([frequency]), speed)
    return np.asarray(np.linalg.solve(dynamic, force))


@pytest.mark.parametrize("speed", [0.3 * OWN, 0.99 * OWN, -2.5 * OWN])
def test_a_force_that_stands_still_moves_a_turning_rotor_as_if_it_did_not_turn(speed: float) -> None:
    """Its weight, say: in the frame that turns it is of order 1; the mass stays where it is, at F / k."""
    sense = math.copysign(1.0, speed)
    force = np.array([70.0, sense * 70.0j], dtype=complex)
    found = answer(rotor(), abs(speed), speed, force)
    assert np.abs(found - force / SPRING).max() < 1e-9 * 70.0 / SPRING


@pytest.mark.parametrize("speed", [0.5 * OWN, 3.0 * OWN])
def test_unbalance_of_a_turning_rotor(speed: float) -> None:
    """It stands in the frame that turns: e w^2 / (k / m - w^2), without any damping by the material."""
    force = np.array([0.2 * MASS * speed**2, 0.0], dtype=complex)
    found = answer(rotor(LOSS), 0.0, speed, force)
    assert found[0].real == pytest.approx(0.2 * speed**2 / (OWN**2 - speed**2), rel=1e-12)
    assert abs(found[1]) < 1e-15


def test_a_force_that_circles_otherwise_than_the_shaft() -> None:
    """In space it circles at the sum of both: F / (k - m (w + f)^2), beyond and below the resonance."""
    speed = 0.4 * OWN
    for frequency in (0.3 * OWN, 0.9 * OWN):
        forward = np.array([1.0, -1j])
        found = answer(rotor(), frequency, speed, forward)
        expected = forward / (SPRING - MASS * (speed + frequency) ** 2)
        assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@cache
def rod() -> TurningBody:
    """A free rod of beams over the motions of all their ends."""
    count = 6 * (ELEMENTS + 1)
    body = TurningBody.of_nothing(count)
    for index in range(ELEMENTS):
        body += beam(ROD, LENGTH / ELEMENTS).over(np.eye(count)[6 * index : 6 * index + 12])
    return body


def ordered(order: list[int]) -> DampedBody:
    """Some unknowns of it in another order, the others held, with loss."""
    parts = (getattr(rod(), one.name)[np.ix_(order, order)] for one in fields(TurningBody))
    body = TurningBody(*parts)
    return DampedBody(body, LOSS * body.stiffness, np.zeros_like(body.stiffness))


@pytest.mark.parametrize("share", [0.0, 0.5, 0.97, 1.6])
def test_rods_under_harmonic_forces_at_their_end(share: float) -> None:
    """Torsion and stretching of a clamped rod by the impedance of its waves, with loss, around resonance.

    c tan(b l) / b with b^2 = f^2 rho / G.
    """
    last = 6 * ELEMENTS
    body = ordered([*range(last, last + 6), *range(6, last)])
    modulus = complex(1.0, LOSS if share else 0.0)
    for motion, elastic, section in ((5, SHEAR_MPA, POLAR), (2, YOUNGS, AREA)):
        first = math.pi / 2 / LENGTH * math.sqrt(elastic / DENSITY)
        frequency = share * first
        dynamic = body.dynamic_stiffness(np.array([frequency]), 0.0)
        (stiff,) = condensed(dynamic, np.zeros((len(body.loss), 0)), 6).stiffness
        found = np.linalg.inv(stiff)[motion, motion]
        wave = frequency * np.sqrt(DENSITY / (elastic * modulus))
        spread = np.tan(wave * LENGTH) / wave if share else LENGTH
        expected = spread / (elastic * modulus * section)
        assert abs(found / expected - 1) < 5e-3


def test_a_slender_beam_on_two_bearings_under_a_harmonic_force_in_its_middle() -> None:
    """(tan b l/2 - tanh b l/2) / (4 E I b^3) with loss, below, at and above its first resonance."""
    middle, last = 6 * (ELEMENTS // 2), 6 * ELEMENTS
    held = {0, 1, 2, 5, last, last + 1}
    damped = ordered([middle + 1, *(i for i in range(last + 6) if i not in held | {middle + 1})])
    bending = YOUNGS * (1 + LOSS * 1j) * POLAR / 2
    first = (math.pi / LENGTH) ** 2 * math.sqrt(YOUNGS * POLAR / 2 / (DENSITY * AREA))
    for share in (0.3, 1.0, 2.0):
        dynamic = damped.dynamic_stiffness(np.array([share * first]), 0.0)
        (stiff,) = condensed(dynamic, np.zeros((len(damped.loss), 0)), 1).stiffness
        wave = (DENSITY * AREA * (share * first) ** 2 / bending) ** 0.25
        half = wave * LENGTH / 2
        expected = (np.tan(half) - np.tanh(half)) / (4 * bending * wave**3)
        assert abs(1 / stiff[0, 0] / expected - 1) < 2e-3


def test_what_is_eliminated_moves_as_it_would_in_one_piece() -> None:
    """Joined motions, inner motions and loads: those of the whole matrix; a loose ring stays at order 0."""
    rng = np.random.default_rng(4)
    count, joined = 9, 4
    half = rng.standard_normal((count, count))
    body = TurningBody(
        half @ half.T, np.diag(rng.uniform(0.1, 1, count)), half - half.T, *2 * (np.eye(count),)
    )
    damped = DampedBody(body, 0.1 * body.stiffness, 0.2 * np.eye(count))
    at, loads = np.array([0.0, 0.7, 2.0]), rng.standard_normal((count, 2))
    dynamic = damped.dynamic_stiffness(at, 0.3)
    small = condensed(dynamic, loads, joined)
    shares = rng.standard_normal(2)
    for index in range(len(at)):
        whole = np.linalg.solve(dynamic[index], loads @ shares)
        kept = np.linalg.solve(small.stiffness[index], small.loads[index] @ shares)
        inner = small.by_motion[index] @ kept + small.by_load[index] @ shares
        assert np.abs(np.concatenate([kept, inner]) - whole).max() < 1e-10 * np.abs(whole).max()
    fluid = DampedBody(
        TurningBody(np.diag([3.0, 0.0]), np.eye(2), *3 * (np.zeros((2, 2)),)),
        np.zeros((2, 2)),
        np.array([[1.0, -1.0], [-1.0, 1.0]]),
    )
    still = condensed(fluid.dynamic_stiffness(np.array([0.0, 1.0]), 0.0), np.zeros((2, 0)), 1)
    assert still.by_motion[0, 0, 0] == 0.0
    assert still.stiffness[0, 0, 0] == 3.0
    assert still.by_motion[1, 0, 0] == pytest.approx(1j / (1j - 1))


def test_damping_takes_the_work_of_the_force() -> None:
    """Integrated over the cycle: force times velocity, of several orders at once."""
    states, speed = 96, 0.8 * OWN
    angle = 2 * np.pi * np.arange(states) / states
    force = np.stack([np.cos(angle) + 0.4 * np.sin(3 * angle), 0.3 * np.cos(2 * angle + 1.0)])
    body, frequency = rotor(LOSS, 0.1), speed * np.arange(states // 2 + 1.0)
    dynamic = body.dynamic_stiffness(frequency, speed)
    solved = np.linalg.solve(dynamic, harmonics_of(force).T[..., None])
    motion: Complex = np.asarray(solved[..., 0].T, dtype=complex)
    moved = curves_of(motion, states)
    slope = np.fft.irfft(1j * np.arange(states // 2 + 1) * np.fft.rfft(moved), n=states)
    work = float((force * slope).sum() * 2 * np.pi / states)
    assert damping_work(frequency, motion, body.loss, body.viscous) == pytest.approx(work, rel=1e-9)
    assert work > 0
