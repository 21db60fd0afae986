"""A rigid rotor with mass in its oil film: against integrators of its equations, and its stability."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.bearing_film.in_motion import CarriedShaft, MovingJournals, moving_journals
from cranktopo.numerics.bearing_film.mobility import mobility
from cranktopo.numerics.bearing_film.orbit import JournalBearing
from cranktopo.numerics.bearing_film.whirl import multipliers
from cranktopo.numerics.harmonic_balance import DampedBody, harmonics_of
from cranktopo.numerics.turning_body import TurningBody

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
BEARING = JournalBearing(50.0, 20.0, 1, 0.03, 0.008)
SPEED, CYCLE, STATES = 300.0, 2 * np.pi, 360
ANGLE = CYCLE * np.arange(STATES) / STATES
AROUND = np.array([[0.0, -1.0], [1.0, 0.0]])
PULSE = 2000.0 + 9000.0 * np.exp(-(((ANGLE - 1.2) / 0.25) ** 2)) + 1500.0 * np.exp(1j * ANGLE)
"""Weight, a push of 30 degrees and an unbalance, N, in the frame that stands still."""


def shaft(force_N: Complex, mass_t: float) -> CarriedShaft:
    """Mass times acceleration in the turning frame, by harmonics."""
    turning = force_N * np.exp(-1j * ANGLE)
    held = harmonics_of(np.stack([turning.real, turning.imag]))
    order = np.arange(held.shape[1])[:, None, None] * 2 * np.pi / CYCLE
    return CarriedShaft(held, mass_t * SPEED**2 * (-(order**2 + 1) * np.eye(2) + 2j * order * AROUND))


def moving(force_N: Complex, mass_t: float, start: complex = 0.5) -> MovingJournals:
    """The rotor, from a journal that stands still on."""
    at = start * np.exp(-1j * ANGLE)[None]
    still = shaft(force_N, 0.0)
    return moving_journals([BEARING], SPEED, CYCLE, still, shaft(force_N, mass_t), at)


def film_force(place: complex, velocity: complex) -> complex:
    """The force that moves a journal so, N; place over the clearance, velocity over clearance and speed.

    The direction in which the map moves it as asked is looked for twice, each time among many.
    """
    b, aim = BEARING, velocity - 0.5j * place
    per_load = (b.clearance_mm / 1e3) ** 2 / (
        6 * b.viscosity_Pas * (b.diameter_mm / 2e3) ** 3 * (b.width_mm / 1e3) * SPEED * b.films
    )
    low, high = -np.pi, np.pi
    for _ in range(4):
        load = place / abs(place) * np.exp(1j * np.linspace(low, high, 17))
        moved = MAP.velocity(np.full(17, place), load)
        off = np.angle(moved / aim)
        crossed = np.flatnonzero((off[:-1] <= 0) & (off[1:] > 0) & (off[1:] - off[:-1] < np.pi))
        one = int(crossed[0])
        angles = np.linspace(low, high, 17)
        low, high = angles[one], angles[one + 1]
    part = -off[one] / (off[one + 1] - off[one])
    size = abs(aim) / (per_load * abs(moved[one] + part * (moved[one + 1] - moved[one])))
    return complex(size * place / abs(place) * np.exp(1j * (low + part * (high - low))))


MAP = mobility([BEARING.width_mm / BEARING.diameter_mm])


def slope_of(force_N: Callable[[float], complex], mass_t: float) -> Callable[[float, Array], Array]:
    """Change of place and velocity over the angle, in the frame that stands still."""

    def slope(angle: float, state: Array) -> Array:
        place, velocity = complex(*state[:2]), complex(*state[2:])
        left = force_N(angle) - film_force(place, velocity)
        gained = left / (mass_t * SPEED**2 * BEARING.clearance_mm)
        return np.array([velocity.real, velocity.imag, gained.real, gained.imag])

    return slope


def standing(found: MovingJournals) -> Complex:
    """The orbit in the frame that stands still."""
    return np.asarray(found.eccentricity[0] * np.exp(1j * ANGLE))


def test_a_rotor_moves_as_another_integrator_has_it() -> None:
    """Its equations step by step from its own place and velocity on: it stays on its orbit."""
    mass_t = 0.5
    found, light = moving(PULSE, mass_t), moving(PULSE, 1e-9)
    orbit = standing(found)
    number = np.fft.fftfreq(STATES, 1 / STATES)
    velocity = np.fft.ifft(1j * number * np.fft.fft(orbit))[0]

    def force_N(angle: float) -> complex:
        return complex(np.interp(angle % CYCLE, np.r_[ANGLE, CYCLE], np.r_[PULSE, PULSE[0]]))

    begin = np.array([orbit[0].real, orbit[0].imag, velocity.real, velocity.imag])
    ran = solve_ivp(
        slope_of(force_N, mass_t), (0.0, CYCLE), begin, method="LSODA", t_eval=ANGLE, rtol=1e-5, atol=1e-6
    )
    own = ran.y[0] + 1j * ran.y[1]
    assert np.abs(own - orbit).max() < 2e-3
    least, expected = 1 - np.abs(orbit).max(), 1 - np.abs(own).max()
    assert least == pytest.approx(expected, rel=5e-3)
    assert np.abs(orbit - standing(light)).max() > 0.1, "mass matters here"


def weight(size_N: float) -> Complex:
    return np.full(STATES, size_N, dtype=complex)


def grown(found: MovingJournals, mass_t: float) -> Complex:
    """Growth of disturbances over a turn."""
    none, mass = np.zeros((2, 2)), mass_t * np.eye(2)
    body = TurningBody(none, mass, mass_t * AROUND, mass, none)
    step_s = CYCLE / SPEED / STATES
    return multipliers(DampedBody(body, none, none), SPEED, np.array([0, 1]), found.slopes, step_s)


@pytest.mark.parametrize(("size_N", "mass_t", "whirls"), [(3000.0, 0.002, False), (60.0, 0.2, True)])
def test_growth_of_a_disturbance_is_that_of_the_rotor_at_rest_under_its_weight(
    size_N: float, mass_t: float, whirls: bool
) -> None:
    """The journal stands still: exponents of its equations there, by differences."""
    found = moving(weight(size_N), mass_t, start=0.1 - 0.3j)
    orbit = standing(found)
    assert np.abs(orbit - orbit[0]).max() < 1e-6
    slope = slope_of(lambda _: complex(size_N), mass_t)
    at, by = np.array([orbit[0].real, orbit[0].imag, 0.0, 0.0]), 1e-4
    assert np.abs(slope(0.0, at)[2:]).max() * mass_t * SPEED**2 * BEARING.clearance_mm < 2e-3 * size_N
    matrix = np.stack(
        [(slope(0.0, at + by * e) - slope(0.0, at - by * e)) / (2 * by) for e in np.eye(4)], axis=1
    )
    exponents = np.linalg.eigvals(matrix)
    most = exponents[exponents.real.argmax()]
    largest = grown(found, mass_t)[0]
    assert np.log(np.abs(largest)) == pytest.approx(CYCLE * most.real, rel=0.05, abs=0.02)
    assert bool(np.abs(largest) > 1.001) is whirls


def test_work_of_the_force_is_what_the_film_takes() -> None:
    """Force times velocity of the rotor in the frame that stands still; the film also brakes the rotation."""
    found = moving(PULSE, 0.5)
    orbit = standing(found) * BEARING.clearance_mm
    number = np.fft.fftfreq(STATES, 1 / STATES)
    velocity = np.fft.ifft(1j * number * np.fft.fft(orbit))
    work_J = float((PULSE.conj() * velocity).real.mean() * CYCLE / 1e3)
    load = found.load_N[0] * np.exp(1j * ANGLE)
    moment_J = float((load.conj() * 1j * orbit).real.mean() * CYCLE / 1e3)
    assert work_J - moment_J == pytest.approx(found.film_work_J, rel=1e-4)


def test_no_cycle_is_told() -> None:
    """A load that no film carries."""
    with pytest.raises(CranktopoError, match="no steady cycle"):
        moving(weight(1e12), 1e-9)
