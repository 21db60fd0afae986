"""Beams and disks of a turning shaft against closed forms: bending, torsion, axial, whirl."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.numerics.turning_body import TurningBody, modes_at_rest, whirling_modes
from cranktopo.numerics.turning_parts import RoundSection, beam, rigid_disk

Array = NDArray[np.float64]
YOUNGS, POISSON, DENSITY = 210e3, 0.3, 7.85e-9
LENGTH, OUTER, INNER = 600.0, 30.0, 12.0
"""Of a short, hollow shaft, so that shear and rotary inertia count."""
AREA = math.pi * (OUTER**2 - INNER**2)
POLAR = math.pi / 2 * (OUTER**4 - INNER**4)
SHAFT = RoundSection(AREA, POLAR, POLAR, YOUNGS, POISSON, DENSITY)
BENDING = YOUNGS * POLAR / 2
SHEAR_MPA = YOUNGS / (2 * (1 + POISSON))
RATIO = (INNER / OUTER) ** 2
SHEAR = (
    SHEAR_MPA
    * AREA
    * 6
    * (1 + POISSON)
    * (1 + RATIO) ** 2
    / ((7 + 6 * POISSON) * (1 + RATIO) ** 2 + (20 + 12 * POISSON) * RATIO)
)


def chain(section: RoundSection, length: float, elements: int) -> TurningBody:
    body, count = TurningBody.of_nothing(6 * (elements + 1)), 6 * (elements + 1)
    for index in range(elements):
        body += beam(section, length / elements).over(np.eye(count)[6 * index : 6 * index + 12])
    return body


def held(body: TurningBody, unknowns: list[int]) -> TurningBody:
    count = len(body.mass)
    return body.over(np.delete(np.eye(count), unknowns, axis=1))


def pinned(elements: int = 24) -> TurningBody:
    """On two bearings, held against rotation and axial motion at its first end."""
    last = 6 * elements
    return held(chain(SHAFT, LENGTH, elements), [0, 1, 2, 5, last, last + 1])


def pinned_timoshenko_Hz(number: int, speed: float = 0.0) -> Array:
    """Frequencies (fixed frame, forward positive) of a turning Timoshenko shaft on two bearings.

    With w + psi of the form sin, cos: (m f^2 - S k^2)(I f^2 - 2 I W f - B k^2 - S) = (S k)^2.
    """
    k = number * math.pi / LENGTH
    mass, rotary = DENSITY * AREA, DENSITY * POLAR / 2
    first = np.array([mass, 0.0, -SHEAR * k**2])
    second = np.array([rotary, -2 * rotary * speed, -BENDING * k**2 - SHEAR])
    roots = np.roots(np.polysub(np.polymul(first, second), [(SHEAR * k) ** 2]))
    assert np.abs(roots.imag).max() < 1e-6
    return np.sort(roots.real) / (2 * math.pi)


def test_bending_of_a_shaft_on_two_bearings() -> None:
    """Each frequency twice, in both planes; halved elements leave a quarter of the error."""
    expected = np.repeat([min(f for f in pinned_timoshenko_Hz(n) if f > 0) for n in (1, 2, 3)], 2)
    errors = []
    for elements in (24, 48):
        found = modes_at_rest(pinned(elements)).frequency_Hz
        nearest = [found[np.argsort(np.abs(found - f))[:2]] for f in expected[::2]]
        errors.append(np.concatenate(nearest) / expected - 1)
    assert np.abs(errors[1]).max() < 4e-4
    assert np.abs(errors[0] - 4 * errors[1]).max() < 1e-4


def test_torsion_and_stretching_of_a_free_shaft() -> None:
    """Waves of k half lengths on consistent linear elements, in closed form."""
    elements = 24
    body = chain(SHAFT, LENGTH, elements)
    for motion, speed in ((5, math.sqrt(SHEAR_MPA / DENSITY)), (2, math.sqrt(YOUNGS / DENSITY))):
        own = modes_at_rest(held(body, [i for i in range(len(body.mass)) if i % 6 != motion]))
        assert own.rigid == 1
        for k in (1, 2, 3):
            phase = math.cos(k * math.pi / elements)
            wave = speed * elements / LENGTH * math.sqrt(6 * (1 - phase) / (2 + phase))
            assert own.frequency_Hz[k] == pytest.approx(wave / (2 * math.pi), rel=1e-8)
            assert own.frequency_Hz[k] == pytest.approx(k * speed / (2 * LENGTH), rel=8e-3)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_whirl_of_a_turning_shaft(sense: float) -> None:
    """Forward whirl rises and backward whirl falls with the speed, seen from where the bearings stand."""
    speed = 1500.0  # below the first critical one
    found = whirling_modes(pinned(32), sense * speed)
    fixed = found.frequency_Hz + sense * found.whirl * speed / (2 * math.pi)
    for number in (1, 2):
        both = pinned_timoshenko_Hz(number, speed)
        forward, backward = both[both > 0].min(), np.abs(both[both < 0]).min()
        assert forward > 1.001 * backward
        for expected, sign in ((forward, sense), (backward, -sense)):
            index = int(np.argmin(np.abs(fixed - expected) + 1e6 * (sign * found.whirl < 0.99)))
            assert fixed[index] == pytest.approx(expected, rel=4.5e-4)


def test_overhung_disk() -> None:
    """Stodola: (k11 - m f^2)(k22 + Ip W f - Id f^2) = k12^2, the clamped shaft without mass."""
    mass, diametral, polar, speed, arm = 8e-3, 30.0, 55.0, 400.0, 25.0
    light = RoundSection(AREA, POLAR, POLAR, YOUNGS, POISSON, 1e-16)
    body = held(chain(light, LENGTH, 1), list(range(6))) + rigid_disk(mass, diametral, polar, arm)
    soft = np.array(
        [
            [LENGTH**3 / (3 * BENDING) + LENGTH / SHEAR, LENGTH**2 / (2 * BENDING)],
            [LENGTH**2 / (2 * BENDING), LENGTH / BENDING],
        ]
    )
    centre = np.array([[1.0, arm], [0.0, 1.0]])
    stiff = np.linalg.inv(centre @ soft @ centre.T)
    first = np.array([-mass, 0.0, stiff[0, 0]])
    second = np.array([-diametral, polar * speed, stiff[1, 1]])
    roots = np.roots(np.polysub(np.polymul(first, second), [stiff[0, 1] ** 2])).real
    found = whirling_modes(body, speed)
    sideways = np.abs(found.whirl) > 0.99
    fixed = 2 * math.pi * found.frequency_Hz[sideways] * found.whirl[sideways].round() + speed
    assert np.sort(fixed) == pytest.approx(np.sort(roots), rel=1e-6)


def test_a_free_disk_stays_where_it_is() -> None:
    """It rests, drifts, leans, or precesses at Ip / Id of its speed: in the turning frame less that speed."""
    diametral, polar, speed = 30.0, 45.0, 250.0
    body = rigid_disk(8e-3, diametral, polar)
    found = 2 * math.pi * whirling_modes(held(body, [2, 5]), speed).frequency_Hz
    precession = abs(polar / diametral - 1) * speed
    assert np.sort(found) == pytest.approx([precession, speed, speed, speed], rel=1e-6)
    turning = body.over(np.eye(6)[:, [5]])
    assert turning.lateral == turning.stiffening
