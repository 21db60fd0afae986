"""Mass-conserving film over a step: pressure, oil that each cell holds, and the place that a load gives.

Cavitation by Jakobsson, Floberg and Olsson. A cell whose oil does not fill it has no pressure, and keeps its
oil until the film closes on it. In a frame that turns with the mean speed of journal and bearing nothing is
carried along, so that a step over time is a linear complementarity problem, in the form of M. Giacopini et
al. (ASME J. Tribology 132, 041702, 2010), with a symmetric M-matrix:

    0 <= pressure,  0 <= A pressure + (thickness - oil before) / step = void / step,  one of the two is 0.

Flow and load are those of the middle of the step, oil and void those of its end: an implicit midpoint rule.
The full cells and the place of the journal are found at once, by Newton's method on the active set.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.numerics.bearing_film.film_cells import Conductance, FilmCells, Thickness

_CHANGES = 60
"""Most steps of Newton's method; it takes about five."""
_BALANCED = 1e-12
"""Of the load, what may be left of it, and of the oil that a cell can hold."""
_FREE, _SHORT, _SHORTER, _SHORTEST = 8, 0.5, 0.9, 0.02
"""Steps of Newton's method of any length; those after them are shorter and shorter, over the least film.

Cells that fill and empty in turn end in this way.
"""
_TOUCHED = 1e-3
"""Film over the clearance, of a tilted journal whose film does not carry, below which it touches."""
_WEAK = 1e-5
"""Least resistance to a move, over that across it: a single row of cells with pressure pushes one way."""
_ROOM, _NEARER, _MIDDLE = 0.3, 0.97, 1e-3
"""Room that a tilted journal is given that would touch, over that in the middle; steps to it; the middle."""
_CLOSER = 0.7
"""Part of the least film by which one step of Newton's method may thin it."""


class TouchingError(CranktopoError):
    """A tilted journal touches an end of its bearing: in a corner no film carries, however thin it is."""


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
        fed: flow into the film during the step.
        left_out: oil that the balance of the step does not account for, over that of a full film.
    """

    oil: Array
    pressure: Array
    eccentricity: complex
    tilt: complex = 0j
    fed: float = 0.0
    left_out: float = 0.0


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

    A film that closes by more than a midpoint rule can tell is moved by the implicit rule of Euler.

    Raises:
        TouchingError: a tilted journal that its film does not keep off the end of the bearing.
        CranktopoError: a film that finds no balance, as where no oil is left to carry the load.
    """
    least = math.inf
    for later in (0.5, 1.0):
        found, least = _balanced(cells, before, step, later)
        if found is not None:
            return found
    if step.tilt and least < _TOUCHED:
        raise TouchingError("oil film: the tilted journal touches an end of its bearing.")
    raise solver_error(
        "oil film: the mass-conserving film finds no balance with its load.",
        "Raise supply_pressure_MPa or the viscosity, or take a smaller clearance.",
    )


def _balanced(
    cells: FilmCells, before: FilmState, step: Step, later: float
) -> tuple[FilmState | None, float]:
    """Return the film after a step, with the flow of so late a part of it, None: not found; and its least."""
    weight = cells.toward * (cells.area / cells.half_widths)
    place, pressure = inside(before.eccentricity, step.tilt), before.pressure
    for number in range(_CHANGES):
        state = _Balance.of(cells, before, step, place, later)
        slack = state.outflow(pressure)
        active: Mask = pressure * state.diagonal >= slack
        left = step.load - (weight * pressure).sum()
        off = np.where(active, slack, pressure * state.diagonal)
        limit = _BALANCED * max(cells.area / step.length, float((pressure * state.diagonal).max()))
        if abs(left) <= _BALANCED * max(abs(step.load), 1e-12) and np.abs(off).max() <= limit:
            return _ended(before, state, slack, pressure), float(state.end.along.min())
        right = np.stack([-state.outflow(np.where(active, pressure, 0.0)), *state.changes(pressure)])
        own, by_x, by_y = cells.solve(state.g, step.supply.feed, active, right)
        pressure = np.where(active, pressure, 0.0) + own
        left = step.load - (weight * pressure).sum()
        move = _two((weight * by_x).sum(), (weight * by_y).sum(), left)
        move *= state.allowed(move, number)
        pressure = pressure + by_x * move.real + by_y * move.imag
        place = place + move
    return None, float(state.end.along.min())


def inside(place: complex, tilt: complex) -> complex:
    """Return the place of a journal, or one nearer to the middle where its tilt would let it touch."""
    if max(abs(place + tilt), abs(place - tilt)) < 1.0:
        return place
    most = 1 - _ROOM * (1 - abs(tilt))
    while abs(place) > _MIDDLE:
        place *= _NEARER
        if max(abs(place + tilt), abs(place - tilt)) < most:
            return place
    return 0j


def _two(by_x: complex, by_y: complex, left: complex) -> complex:
    """Return the move x + i y with x by_x + y by_y = left, less along what next to nothing resists."""
    matrix = np.array([[by_x.real, by_y.real], [by_x.imag, by_y.imag]])
    u, sizes, v = np.linalg.svd(matrix)
    if not sizes[0]:
        return left / abs(left)  # nothing carries yet
    x, y = v.T @ (u.T @ [left.real, left.imag] / np.maximum(sizes, _WEAK * sizes[0]))
    return complex(x, y)


@dataclass(frozen=True)
class _Balance:
    """Balance of oil of every cell at a place of the journal.

    Attributes:
        later: when the film flows, as part of the step.
        film, end: film at that time, and at the end of the step.
        g: conductance of the faces at that time.
        filling: oil that is missing to fill each cell, over the step.
    """

    cells: FilmCells
    step: Step
    place: complex
    later: float
    film: Thickness
    end: Thickness
    g: Conductance
    filling: Array

    @classmethod
    def of(cls, cells: FilmCells, before: FilmState, step: Step, place: complex, later: float) -> _Balance:
        end = cells.thickness(place, step.tilt)
        tilt = before.tilt + later * (step.tilt - before.tilt)
        film = cells.thickness(before.eccentricity + later * (place - before.eccentricity), tilt)
        filling = (end.cell - before.oil) * (cells.area / step.length)
        g = cells.conductance(film.around**3, film.along**3)
        return cls(cells, step, place, later, film, end, g, filling)

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
        found, film, part = [], self.film, 3 * self.later
        for way in (1 + 0j, 1j):
            moved = self.cells.thickness(way, 0j)
            g = self.cells.conductance(
                part * film.around**2 * (moved.around - 1), part * film.along**2 * (moved.along - 1)
            )
            more = (moved.cell - 1) * (self.cells.area / self.step.length)
            found.append(-(g.outflow(pressure, self.step.supply.edge) + more))
        return found[0], found[1]

    def allowed(self, move: complex, number: int) -> float:
        """Return the part of a move that keeps the film from closing, of this step of Newton's method."""
        moved, end = self.cells.thickness(move, 0j), self.end
        most = max(
            float(((1 - there) / own).max())
            for own, there in ((end.around, moved.around), (end.along, moved.along))
        )
        part = min(1.0, _CLOSER / most) if most > 0 else 1.0
        if number < _FREE or not move:
            return part
        longest = max(_SHORT * _SHORTER ** (number - _FREE), _SHORTEST) * float(end.along.min())
        return min(part, longest / abs(move))


def _ended(before: FilmState, state: _Balance, slack: Array, pressure: Array) -> FilmState:
    """The film of a balance, with what was fed and the oil that is not accounted for."""
    cells, step, g = state.cells, state.step, state.g
    void = np.where(pressure > 0, 0.0, np.maximum(slack, 0.0)) * (step.length / cells.area)
    oil, pressure = state.end.cell - void, np.maximum(pressure, 0.0)
    fed = float((step.supply.feed * (step.supply.pressure - pressure)).sum())
    begin = float((g.along[:, 0] * (step.supply.edge - pressure[:, 0])).sum())
    lost = float((g.along[:, -1] * pressure[:, -1]).sum())
    fed, lost = (fed + begin, lost) if step.supply.at_begin else (fed, lost - begin)
    grown = float((oil - before.oil).sum()) * cells.area
    kept = (fed - lost) * step.length - grown
    return FilmState(
        oil, pressure, state.place, step.tilt, fed, abs(kept) / float(state.end.cell.sum() * cells.area)
    )
