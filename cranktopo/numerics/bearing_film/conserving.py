"""Mass-conserving film of a moment: pressure, oil that each cell holds, and place of the journal that its load asks.

Cavitation by Jakobsson, Floberg and Olsson. A cell whose oil does not fill it has no pressure, and keeps its oil
until the film closes on it. In a frame that turns with the mean speed of journal and bearing nothing is
carried along, so that a step over time is a linear complementarity problem, in the form of M. Giacopini et al.
(ASME J. Tribology 132, 041702, 2010), with a symmetric M-matrix:

    0 <= pressure,  0 <= A pressure + (thickness - oil before) / step = void / step,  one of the two is 0.

Flow and load are those of the middle of the step, oil and void those of its end: an implicit midpoint rule.
The full cells and the place of the journal are found at once, by Newton's method on the active set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import solver_error
from cranktopo.numerics.bearing_film.film_cells import Conductance, FilmCells, Thickness

_CHANGES = 60
"""Most steps of Newton's method; it takes about five."""
_BALANCED = 1e-12
"""Of the load, what may be left of it, and of the oil that a cell can hold."""
_CLOSER = 0.7
"""Part of the least film by which one step of Newton's method may thin it."""


@dataclass(frozen=True)
class Supply:
    """Oil that is fed at a pressure.

    Attributes:
        pressure: dimensionless.
        feed: conductance of a hole into each cell, shape (around, along).
        at_begin: whether the film begins at a groove of this pressure.
    """

    pressure: float
    feed: Array
    at_begin: bool

    @property
    def edge(self) -> float:
        """Pressure where the film begins."""
        return self.pressure if self.at_begin else 0.0


@dataclass(frozen=True)
class FilmState:
    """The film at the end of a step over time.

    Attributes:
        oil: that each cell holds, as thickness, (around, along).
        pressure: of each cell in the middle of the step; the cells with a pressure are full.
        eccentricity: of the journal in the middle of the width, in the frame of the cells.
        tilt: what is added to it at the end of the width.
    """

    oil: Array
    pressure: Array
    eccentricity: complex
    tilt: complex = 0j


@dataclass(frozen=True)
class Step:
    """A step over time that is to be done, with what acts in its middle.

    Attributes:
        length: angle of the shaft, rad.
        load: force on the journal: integral of the pressure over angle and width, as part of the whole width.
        tilt: at its end.
    """

    length: float
    load: complex
    tilt: complex
    supply: Supply


def advanced(cells: FilmCells, before: FilmState, step: Step) -> FilmState:
    """Return the film after a step.

    Raises:
        CranktopoError: a film that finds no balance, as where no oil is left to carry the load.
    """
    weight = cells.toward * (cells.area / cells.half_widths)
    place, pressure = before.eccentricity, before.pressure
    for _ in range(_CHANGES):
        state = _Balance.of(cells, before, step, place)
        slack = state.outflow(pressure)
        active = pressure * state.diagonal >= slack
        left = step.load - (weight * pressure).sum()
        off = np.where(active, slack, pressure * state.diagonal)
        limit = _BALANCED * max(cells.area / step.length, float((pressure * state.diagonal).max()))
        if abs(left) <= _BALANCED * max(abs(step.load), 1e-12) and np.abs(off).max() <= limit:
            return _ended(cells, state, slack, pressure, step)
        right = np.stack([-state.outflow(np.where(active, pressure, 0.0)), *state.changes(pressure)])
        own, by_x, by_y = cells.solve(state.g, step.supply.feed, active, right)
        pressure = np.where(active, pressure, 0.0) + own
        left = step.load - (weight * pressure).sum()
        push_x, push_y = (weight * by_x).sum(), (weight * by_y).sum()
        move = _two(push_x, push_y, left)
        move *= state.allowed(move)
        pressure = pressure + by_x * move.real + by_y * move.imag
        place = place + move
    raise solver_error(
        "oil film: the mass-conserving film finds no balance with its load.",
        "Raise supply_pressure_MPa or the viscosity, or take a smaller clearance.",
    )


def _two(by_x: complex, by_y: complex, left: complex) -> complex:
    """Solve x by_x + y by_y = left for real x and y, as x + i y."""
    determinant = by_x.real * by_y.imag - by_y.real * by_x.imag
    x = (left.real * by_y.imag - by_y.real * left.imag) / determinant
    y = (by_x.real * left.imag - left.real * by_x.imag) / determinant
    return complex(x, y)


@dataclass(frozen=True)
class _Balance:
    """Balance of oil of every cell at a place of the journal.

    Attributes:
        film, end: in the middle of the step, and at its end.
        g: conductance of the faces, in the middle.
        filling: oil that is missing to fill each cell, over the step.
    """

    cells: FilmCells
    step: Step
    place: complex
    film: Thickness
    end: Thickness
    g: Conductance
    filling: Array

    @classmethod
    def of(cls, cells: FilmCells, before: FilmState, step: Step, place: complex) -> _Balance:
        end = cells.thickness(place, step.tilt)
        film = cells.thickness((before.eccentricity + place) / 2, (before.tilt + step.tilt) / 2)
        filling = (end.cell - before.oil) * (cells.area / step.length)
        g = cells.conductance(film.around**3, film.along**3)
        return cls(cells, step, place, film, end, g, filling)

    @property
    def diagonal(self) -> Array:
        return np.asarray(self.g.diagonal + self.step.supply.feed)

    def outflow(self, pressure: Array) -> Array:
        """Return what flows out of each cell more than its thinning gives: the growth of its void."""
        supply = self.step.supply
        fed = supply.feed * (pressure - supply.pressure)
        return np.asarray(self.g.outflow(pressure, supply.edge) + fed + self.filling)

    def changes(self, pressure: Array) -> tuple[Array, Array]:
        """Return what a move of the journal along both axes takes from this outflow."""
        found, film = [], self.film
        for way in (1 + 0j, 1j):
            moved = self.cells.thickness(way, 0j)
            g = self.cells.conductance(
                1.5 * film.around**2 * (moved.around - 1), 1.5 * film.along**2 * (moved.along - 1)
            )
            more = (moved.cell - 1) * (self.cells.area / self.step.length)
            found.append(-(g.outflow(pressure, self.step.supply.edge) + more))
        return found[0], found[1]

    def allowed(self, move: complex) -> float:
        """Return the part of a move that keeps the film from closing."""
        moved, end = self.cells.thickness(move, 0j), self.end
        most = max(
            float(((1 - there) / own).max())
            for own, there in ((end.around, moved.around), (end.along, moved.along))
        )
        return min(1.0, _CLOSER / most) if most > 0 else 1.0


def _ended(cells: FilmCells, state: _Balance, slack: Array, pressure: Array, step: Step) -> FilmState:
    void = np.where(pressure > 0, 0.0, np.maximum(slack, 0.0)) * (step.length / cells.area)
    return FilmState(state.end.cell - void, np.maximum(pressure, 0.0), state.place, step.tilt)
