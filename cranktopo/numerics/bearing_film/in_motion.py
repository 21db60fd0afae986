"""Journals of a shaft that vibrates in their oil films: the steady cycle in which forces of both are equal.

In the frame that turns with the shaft, real to imaginary axis, the place z of each journal over its clearance
changes by the mobility of its film under the force L of the shaft, over the angle of the shaft,

    dz/da = squeeze(z, L) - i z / 2,    L_k = held_k - bent_k z_k  of each harmonic k,

as the oil turns with half the speed. All harmonics are solved at once by Newton's method, the films at every
state (alternating frequency and time: T. M. Cameron, J. H. Griffin, ASME J. Appl. Mech. 56, 1989).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import solver_error
from cranktopo.numerics.bearing_film.orbit import LEAST_SHARE, Films, JournalBearing
from cranktopo.numerics.harmonic_balance import curves_of, harmonics_of

_STATES_PER_HARMONIC = 6
"""States of the films over harmonics of the places that are solved."""
_TOLERANCE = 1e-7
"""Of the places, a step."""
_STEPS = 40
_SLOW = 0.3
"""Part of an error that may be left by a step with matrices of a step before."""
_LEAST_STEP = 1e-3
"""Part of a step by Newton's method that is tried at last."""
_LEAST_SHARE_OF_MASS = 0.01
_PLACE, _LOAD = 1e-7, 1e-6
"""Differences of which slopes are taken: of a place, and of a load over itself."""
_LEAST_LOAD_N = 1e-3
STEADIER = "Take --bearings rigid or spring, another speed, a smaller clearance or narrower bearings."
"""Remedy where journals are not steady."""


@dataclass(frozen=True)
class CarriedShaft:
    """Forces of a shaft on its bearings in the frame that turns with it, by harmonics as of `harmonics_of`.

    Of every bearing there is a row of the real axis and one of the imaginary axis.

    Attributes:
        held_N: with all journals in the middle of their bearings, (2 bearings, harmonics).
        bent_N_per_mm: by how much motions of the journals lessen them, (harmonics, 2 bearings, 2 bearings).
    """

    held_N: Complex
    bent_N_per_mm: Complex

    def toward(self, other: CarriedShaft, share: float) -> CarriedShaft:
        """Return a shaft between this one and another, the other at a share of 1."""
        return CarriedShaft(
            self.held_N + share * (other.held_N - self.held_N),
            self.bent_N_per_mm + share * (other.bent_N_per_mm - self.bent_N_per_mm),
        )


@dataclass(frozen=True)
class FilmSlopes:
    """Change of the velocities of journals in their films at every state; real and imaginary axes, 1/s.

    Attributes:
        by_place: over their places, 1/s, (states, bearings, 2, 2).
        by_load: over the forces on them, mm/(N s), (states, bearings, 2, 2).
    """

    by_place: Array
    by_load: Array


@dataclass(frozen=True)
class MovingJournals:
    """A shaft in its films over a steady cycle.

    Attributes:
        eccentricity: places over the clearance in the turning frame, (bearings, states).
        load_N: force of the shaft on each, (bearings, states).
        film_work_J: what the films take of the vibration in the turning frame over the cycle.
        slopes: of the films.
    """

    eccentricity: Complex
    load_N: Complex
    film_work_J: float
    slopes: FilmSlopes


def moving_journals(
    bearings: Sequence[JournalBearing],
    speed_rad_s: float,
    cycle_rad: float,
    still: CarriedShaft,
    moving: CarriedShaft,
    start: Complex,
) -> MovingJournals:
    """Return the steady cycle of a shaft with mass; its stability is another matter (`whirl`).

    Where Newton's method does not get there at once, the mass is added in parts.

    Args:
        still: the shaft without mass.
        start: its eccentricities in the turning frame, (bearings, states).

    Raises:
        CranktopoError: no steady cycle is found.
    """
    films, states = Films.of(bearings, np.full(len(bearings), speed_rad_s)), start.shape[1]
    clearance = np.repeat([bearing.clearance_mm for bearing in bearings], 2)
    count, per_rad = states // _STATES_PER_HARMONIC, 2 * np.pi / cycle_rad
    place, share, step = harmonics_of(axis_rows(start))[:, : count + 1], 0.0, 1.0
    while share < 1.0:
        tried = min(1.0, share + step)
        balance = _FilmHarmonics(films, still.toward(moving, tried), clearance, states, count, per_rad)
        found = balance.solved(place)
        if found is not None:
            place, share = found, tried
        else:
            step /= 2
        if step < _LEAST_SHARE_OF_MASS:
            raise solver_error("oil film: no steady cycle of the shaft with its mass is found.", STEADIER)
    at, load, _ = balance.state(place)
    by_place, by_load = balance.slopes(at, load)
    velocity = balance.velocity(at, load) * clearance[::2, None]
    work_Nmm = (load.conj() * velocity).real.mean(axis=1).sum() * cycle_rad
    slopes = FilmSlopes(speed_rad_s * by_place, speed_rad_s * by_load * clearance[::2, None, None])
    return MovingJournals(at, load, float(work_Nmm) / 1e3, slopes)


@dataclass(frozen=True)
class _FilmHarmonics:
    """A shaft and its films.

    Attributes:
        clearance: of each row, mm.
        count: highest harmonic of the places.
        per_rad: of the first harmonic.
    """

    films: Films
    shaft: CarriedShaft
    clearance: Array
    states: int
    count: int
    per_rad: float

    def state(self, place: Complex) -> tuple[Complex, Complex, Complex]:
        """Return places and loads of the journals at all states, and what is left of each harmonic."""
        forces = self.shaft.held_N.copy()
        kept = slice(0, self.count + 1)
        forces[:, kept] -= np.einsum("kab,bk->ak", self._bent, place)
        at, load = _complex(curves_of(place, self.states)), _complex(curves_of(forces, self.states))
        order = 1j * self.per_rad * np.arange(self.count + 1)
        found = harmonics_of(axis_rows(self.velocity(at, load)))
        return at, load, np.asarray(order * place - found[:, kept])

    @property
    def _bent(self) -> Complex:
        return self.shaft.bent_N_per_mm[: self.count + 1] * self.clearance

    def velocity(self, at: Complex, load: Complex) -> Complex:
        """Return the change of the places over the angle of the shaft."""
        which = np.arange(len(at))
        return np.asarray(self.films.squeeze(at.T, load.T, which).T - 0.5j * at)

    def slopes(self, at: Complex, load: Complex) -> tuple[Array, Array]:
        """Return the change of `velocity` over places and loads, (states, bearings, 2, 2) each."""
        by_place = [
            (self.velocity(at + way * _PLACE, load) - self.velocity(at - way * _PLACE, load)) / (2 * _PLACE)
            for way in (1.0, 1j)
        ]
        size = np.maximum(_LOAD * np.abs(load), _LEAST_LOAD_N)
        by_load = [
            (self.velocity(at, load + way * size) - self.velocity(at, load - way * size)) / (2 * size)
            for way in (1.0, 1j)
        ]
        first, second = (
            np.moveaxis(np.array([[one.real for one in slope], [one.imag for one in slope]]), (3, 2), (0, 1))
            for slope in (by_place, by_load)
        )
        return first, second

    def solved(self, place: Complex) -> Complex | None:
        """Return the places where nothing is left; None where they are not found."""
        solver, (at, load, left) = None, self.state(place)
        for _ in range(_STEPS):
            fresh = solver is None
            if solver is None:
                solver = _Linear(self, at, load)
            way, size = solver.step(left), 1.0
            while size > _LEAST_STEP:
                tried = place + size * way
                if np.abs(_complex(curves_of(tried, self.states))).max() < 1 - LEAST_SHARE:
                    at, load, rest = self.state(tried)
                    if np.linalg.norm(rest) < np.linalg.norm(left):
                        break
                size /= 2
            else:
                if fresh:
                    return None
                at, load, left = self.state(place)
                solver = None
                continue
            slow = np.linalg.norm(rest) > _SLOW * np.linalg.norm(left)
            place, left, solver = tried, rest, None if slow else solver
            if size == 1.0 and np.abs(curves_of(way, self.states)).max() < _TOLERANCE:
                return place
        return None


class _Linear:
    """Newton's step of all harmonics: real parts of all, then imaginary parts of all but the mean."""

    def __init__(self, balance: _FilmHarmonics, at: Complex, load: Complex) -> None:
        from scipy.linalg import lu_factor

        rows = len(balance.clearance)
        self._size = (balance.count + 1) * rows
        self._kept = np.r_[0 : self._size, self._size + rows : 2 * self._size]
        plus, minus = self._parts(balance, *balance.slopes(at, load))
        real, imaginary = plus + minus, 1j * (plus - minus)
        real[:, :rows] /= 2  # the mean is counted once
        whole = np.block([[real.real, imaginary.real], [real.imag, imaginary.imag]])
        matrix = whole[np.ix_(self._kept, self._kept)].astype(np.float32)
        self._factors = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def _parts(self, balance: _FilmHarmonics, by_place: Array, by_load: Array) -> tuple[Complex, Complex]:
        """Return what a harmonic does to each harmonic, and its conjugate to it, (unknowns, unknowns)."""
        number, rows = np.arange(balance.count + 1), len(balance.clearance)
        place, load = (np.fft.fft(one, axis=0) / balance.states for one in (by_place, by_load))
        found = []
        for sign in (1, -1):
            between = (sign * number[:, None] - number) % balance.states
            part = np.zeros((len(number), rows, len(number), rows), dtype=complex)
            for one in range(rows // 2):
                own = slice(2 * one, 2 * one + 2)
                bent = balance._bent[:, own]
                part[:, own] = np.einsum("klab,lbc->kalc", load[between, one], bent)
                part[:, own, :, own] -= np.moveaxis(place[between, one], 2, 1)
            found.append(part)
        turns = 1j * balance.per_rad * number
        found[0][number, :, number] += turns[:, None, None] * np.eye(rows)
        plus, minus = (part.reshape(self._size, self._size) for part in found)
        return plus, minus.conj()

    def step(self, left: Complex) -> Complex:
        """Return the change of the places that leaves nothing of linear films."""
        from scipy.linalg import lu_solve

        column = np.concatenate([left.T.real.ravel(), left.T.imag.ravel()])
        scale = np.abs(column).max()  # single precision holds small numbers, but not their squares
        found = np.zeros(2 * self._size)
        right = (-column[self._kept] / scale).astype(np.float32)
        found[self._kept] = scale * lu_solve(self._factors, right, check_finite=False).astype(np.float64)
        real, imaginary = found.reshape(2, -1, left.shape[0])
        return np.asarray((real + 1j * imaginary).T)


def axis_rows(values: Complex) -> Array:
    """Return real and imaginary part of each row, one below the other."""
    return np.stack([values.real, values.imag], axis=1).reshape(2 * len(values), -1)


def _complex(rows: Array) -> Complex:
    return np.asarray(rows[::2] + 1j * rows[1::2])
