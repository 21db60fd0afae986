"""The film that keeps its oil against closed forms: rupture, reformation, steady state, balance of oil."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from typing_extensions import override

from cranktopo.base.arrays import Array, Complex
from cranktopo.numerics.bearing_film.conserving import FilmState, Step, Supply, advanced
from cranktopo.numerics.bearing_film.film_cells import Conductance, FilmCells, Thickness

PRESSURE, WIDTH = 0.05, 0.8


class Plates(FilmCells):
    """Two pairs of parallel plates: the real part of the eccentricity closes one, the imaginary the other."""

    @cached_property
    @override
    def toward(self) -> Complex:
        return np.where(np.arange(self.around) < self.around // 2, 1.0, 1.0j)[:, None]

    @override
    def thickness(self, eccentricity: complex, tilt: complex) -> Thickness:
        film = 1 - (eccentricity * self.toward.conj()).real
        row = np.ones((1, self.along))
        return Thickness(film * row, film * row, film * np.ones((1, self.along + 1)))

    @override
    def conductance(self, around: Array, along: Array) -> Conductance:
        return super().conductance(0 * around, along)


class OpenedPlates:
    """Exact film between plates that open and close, fed at one side, with no pressure at the other.

    The film ruptures from the open side while the plates open: there its pressure ends with no slope, and a
    place keeps the oil that it held then. Later the feed fills it again; the front moves as its flow fills
    what is empty.
    """

    def __init__(self, swing: float) -> None:
        self.swing = swing
        time = np.linspace(0.0, math.pi, 4001)[1:-1]
        full = np.sqrt(2 * PRESSURE * self.thickness(time) ** 3 / (self.speed(time) * WIDTH**2))
        least = int(full.argmin())
        first = int(np.flatnonzero(full[:least] < 2.0)[0])
        self.start, self.turn, self.least = time[first], time[least], full[least]
        self.ruptured = PchipInterpolator(time[first : least + 1], full[first : least + 1])
        kept = PchipInterpolator(full[least : first - 1 : -1], self.thickness(time[least : first - 1 : -1]))

        def front(time: float, place: Array) -> Array:
            empty = self.thickness(time) - kept(min(place[0], 2.0))
            flow = (
                self.thickness(time) ** 3 / WIDTH**2 * PRESSURE / place[0] - self.speed(time) * place[0] / 2
            )
            return np.array([flow / empty])

        def whole(time: float, place: Array) -> float:
            return float(place[0]) - 2.0

        whole.terminal = True  # type: ignore[attr-defined]
        begin = self.turn + 1e-4, [self.least * (1 + 1e-7)]
        self.refilled = solve_ivp(
            front,
            (begin[0], 2 * math.pi),
            begin[1],
            method="Radau",
            rtol=1e-8,
            dense_output=True,
            events=whole,
        )

    def thickness(self, time: Array | float) -> Array:
        return np.asarray(1 - self.swing * np.cos(time))

    def speed(self, time: Array | float) -> Array:
        return np.asarray(self.swing * np.sin(time))

    def full(self, time: float) -> float:
        """Length of the full film, from 0 to 2 half widths."""
        if time < self.start or time > self.refilled.t[-1]:
            return 2.0
        if time <= self.turn:
            return float(self.ruptured(time))
        return float(self.refilled.sol(time)[0]) if time > self.turn + 1e-4 else float(self.least)

    def force(self, time: float) -> float:
        """Mean pressure over the width."""
        full = self.full(time)
        squeeze = self.speed(time) * WIDTH**2 / self.thickness(time) ** 3
        return float(PRESSURE * full / 2 - squeeze * full**3 / 12) / 2


def plates_error(along: int, steps: int, plates: tuple[OpenedPlates, OpenedPlates]) -> tuple[float, float]:
    """Largest errors of thickness and of length of the full film, where the exact forces act."""
    cells = Plates(4, along, WIDTH, "groove")
    supply = Supply(PRESSURE, np.zeros((4, along)), at_begin=True)
    start = complex(*(float(1 - one.thickness(0.0)) for one in plates))
    state = FilmState(cells.thickness(start, 0j).cell, np.zeros((4, along)), start)
    length, worst = 2 * math.pi / steps, np.zeros(2)
    for number in range(steps):
        middle, end = (number + 0.5) * length, (number + 1) * length
        load = math.pi * complex(*(one.force(middle) for one in plates))
        state = advanced(cells, state, Step(length, load, 0j, supply))
        for own, place, row in zip(
            plates, (state.eccentricity.real, state.eccentricity.imag), (0, 2), strict=True
        ):
            off = abs(1 - place - float(own.thickness(end)))
            part = 2 * (state.pressure[row] > 0).sum() / along
            worst = np.maximum(worst, [off, abs(part - own.full(middle))])
    return float(worst[0]), float(worst[1])


def test_rupture_and_reformation_between_plates() -> None:
    """Two pairs of plates that swing by 0.3 and 0.45; the error falls with the square of the cells."""
    plates = OpenedPlates(0.3), OpenedPlates(0.45)
    assert all(0.3 < one.least < 0.7 and one.refilled.t[-1] < 2 * math.pi for one in plates)
    (coarse, _), (middle, _), (fine, front) = (plates_error(n, 6 * n, plates) for n in (16, 32, 64))
    assert math.log2(coarse / middle) > 1.2
    assert math.log2(middle / fine) > 1.6
    assert fine < 0.04
    assert front < 1.2 * 2 / 64, "the front is in the cell where it belongs"


def long_journal(around: int, load: float) -> tuple[complex, Array, float]:
    """Steady state of a journal without flow along the width: eccentricity, pressure, oil that is lost.

    A line of oil stands still at the angle 0, the load acts along the imaginary axis, the journal turns.
    """
    cells = FilmCells(around, 1, 1e6, "symmetric")
    full = cells.thickness(0.5j, 0j).cell
    state, lost, length = FilmState(full, np.zeros_like(full), 0.5j), 0.0, 2 * math.pi / 90
    for number in range(540):
        turn = np.exp(0.5j * length * (number + 0.5))
        away = np.abs(np.angle(np.exp(1j * cells.angle) * turn))
        feed = 1e4 * np.clip((1.5 * cells.step - away) / cells.step, 0.0, 1.0)[:, None]
        before, state = (
            state,
            advanced(cells, state, Step(length, 1j * load / turn, 0j, Supply(0.02, feed, False))),
        )
        fed = (feed * (0.02 - state.pressure)).sum() * length
        assert fed == pytest.approx(state.fed * length)
        lost = max(lost, abs(fed - (state.oil - before.oil).sum() * cells.area))
    angle = np.angle(np.exp(1j * cells.angle) * turn)
    order = np.argsort(angle)
    middle = (before.eccentricity + state.eccentricity) / 2
    return middle * turn, np.stack([angle[order], state.pressure[order, 0]]), lost


@pytest.mark.parametrize("load", [0.6, 2.0])
def test_a_long_journal_with_a_line_of_oil(load: float) -> None:
    """Its pressure begins at the line and ends without slope: one integral of Reynolds' equation."""
    place, (angle, pressure), lost = long_journal(360, load)
    size, turn = abs(place), float(np.angle(place))

    def film(at: float) -> float:
        return 1 - size * math.cos(at - turn)

    def rise(to: float, end: float) -> float:
        """Pressure at an angle, where its slope is 0 at another: H^3 P' = (H - H_end) / 2."""
        return 0.02 + quad(lambda a: (film(a) - film(end)) / film(a) ** 3 / 2, begin, to)[0]

    begin = 2 * math.pi / 360  # the last whole cell of the line
    end = float(brentq(lambda one: rise(one, one), turn, turn + math.pi / 2))
    inside = np.linspace(begin, end, 200)
    exact = np.array([rise(float(one), end) for one in inside])
    found = np.interp(inside, angle, pressure)
    assert np.abs(found - exact).max() < 0.02 * exact.max()
    assert angle[pressure > 0].max() == pytest.approx(end, abs=1.5 * 2 * math.pi / 360)
    force = np.trapezoid(exact * np.exp(1j * inside), inside)
    assert abs(force - 1j * load) < 0.02 * load
    assert lost < 1e-10
