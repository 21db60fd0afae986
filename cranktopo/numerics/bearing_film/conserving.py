"""Mass-conserving film over a step: pressure, oil that each cell holds, and the place that a load gives.

Cavitation by Jakobsson, Floberg and Olsson. A cell whose oil does not fill it has no pressure, and keeps its
oil until the film closes on it. In a frame that turns with the mean speed of journal and bearing nothing is
carried along, so that a step over time is a linear complementarity problem, in the form of M. Giacopini et
al. (ASME J. Tribology 132, 041702, 2010), with a symmetric M-matrix:

    0 <= pressure,  0 <= A pressure + (thickness - oil before) / step = void / step,  one of the two is 0.

Flow and load are those of the middle of the step, oil and void those of its end: an implicit midpoint rule.
Of a film that closes on a void it tells too little resistance; such a step takes the implicit rule of Euler.
The full cells and the place of the journal are found at once, by Newton's method on the active set.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.numerics.bearing_film.film_cells import Conductance, FilmCells, Thickness

MIDPOINT, EULER = 0.5, 1.0
"""Rules of a step, by when the film flows: in its middle, or, which is less exact and never goes too far, at
its end."""
_FAST = 60
"""Most steps of Newton's method on cells and place at once; it takes about five, more where a front runs."""
_SAFE = 60
"""Most steps of that on the place alone, each so short that the force along it falls."""
_FILLINGS = 120
"""Most changes of the full cells at a place."""
_SHORTEST, _BETTER = 1e-4, 0.1
"""Shortest part of such a step, and how much of what it promises it must keep."""
_BALANCED = 1e-12
"""Of the load, what may be left of it, and of the oil that a cell can hold."""
_TOUCHED = 1e-3
"""Film over the clearance, of a tilted journal whose film does not carry, below which it touches."""
_WEAK = 1e-5
"""Least resistance to a move, over that across it: a single row of cells with pressure pushes one way."""
_ROOM, _NEARER, _MIDDLE = 0.3, 0.97, 1e-3
"""Room that a tilted journal is given that would touch, over that in the middle; steps to it; the middle."""
_CLOSER, _CLOSED = 0.7, 1e-12
"""Part of the least film by which one step of Newton's method may thin it, and a film that is closed."""


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
class FilmStep:
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


def advanced(
    cells: FilmCells, before: FilmState, step: FilmStep, rules: tuple[float, ...] = (MIDPOINT, EULER)
) -> FilmState:
    """Return the film after a step.

    Args:
        rules: tried in this order: when the film flows, as part of the step.

    Raises:
        TouchingError: a tilted journal that its film does not keep off the end of the bearing.
        CranktopoError: a film that finds no balance, as where no oil is left to carry the load.
    """
    least = math.inf
    for later in rules:
        for method in (_at_once, _in_turn):
            found, state = method(cells, before, step, later)
            if found:
                return _ended(before, state)
            least = min(least, float(state.end.along.min()))
    if step.tilt and least < _TOUCHED:
        raise TouchingError("oil film: the tilted journal touches an end of its bearing.")
    raise solver_error(
        "oil film: the mass-conserving film finds no balance with its load.",
        "Raise supply_pressure_MPa or the viscosity, or take a smaller clearance.",
    )


def _at_once(cells: FilmCells, before: FilmState, step: FilmStep, later: float) -> tuple[bool, _Balance]:
    """Newton's method on full cells and place; whether it ended in a balance, and the last one."""
    state = _Balance.of(cells, before, step, inside(before.eccentricity, step.tilt), later, before.pressure)
    for _ in range(_FAST):
        if state.settled and state.balanced:
            return True, state
        own, by_x, by_y = state.solved(state.outflow(np.where(state.active, state.pressure, 0.0)))
        pressure = np.where(state.active, state.pressure, 0.0) + own
        move = state.move(by_x, by_y, step.load - state.force_of(pressure))
        pressure = pressure + by_x * move.real + by_y * move.imag
        state = _Balance.of(cells, before, step, state.place + move, later, pressure)
    return False, state


def _in_turn(cells: FilmCells, before: FilmState, step: FilmStep, later: float) -> tuple[bool, _Balance]:
    """Newton's method on the place, where the full cells settle at every place; as `_at_once`."""

    def settled(place: complex, pressure: Array) -> _Balance:
        state = _Balance.of(cells, before, step, place, later, pressure)
        for _ in range(_FILLINGS):
            if state.settled:
                break
            (own,) = state.solved(state.outflow(np.zeros_like(pressure)), moving=False)
            state = _Balance.of(cells, before, step, place, later, own)
        return state

    state = settled(inside(before.eccentricity, step.tilt), before.pressure)
    for _ in range(_SAFE):
        if state.settled and state.balanced:
            return True, state
        _, by_x, by_y = state.solved(state.outflow(state.pressure))
        whole, part = state.move(by_x, by_y, state.left), 1.0
        pull = (whole.conjugate() * state.left).real
        while part > _SHORTEST:
            tried = settled(state.place + part * whole, state.pressure)
            if abs((whole.conjugate() * tried.left).real) <= (1 - _BETTER * part) * pull:
                break
            part /= 2
        else:
            return False, state
        state = tried
    return False, state


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
    if not sizes[0]:  # nothing carries yet
        return left / abs(left) if left else 0j
    x, y = v.T @ (u.T @ [left.real, left.imag] / np.maximum(sizes, _WEAK * sizes[0]))
    return complex(x, y)


@dataclass(frozen=True)
class _Balance:
    """Balance of oil of every cell, and of the journal, at a place and with a pressure.

    Attributes:
        later: when the film flows, as part of the step.
        film, end: film at that time, and at the end of the step.
        g: conductance of the faces at that time.
        filling: oil that is missing to fill each cell, over the step.
    """

    cells: FilmCells
    step: FilmStep
    place: complex
    later: float
    film: Thickness
    end: Thickness
    g: Conductance
    filling: Array
    pressure: Array

    @classmethod
    def of(
        cls,
        cells: FilmCells,
        before: FilmState,
        step: FilmStep,
        place: complex,
        later: float,
        pressure: Array,
    ) -> _Balance:
        end = cells.thickness(place, step.tilt)
        tilt = before.tilt + later * (step.tilt - before.tilt)
        film = cells.thickness(before.eccentricity + later * (place - before.eccentricity), tilt)
        filling = (end.cell - before.oil) * (cells.area / step.length)
        g = cells.conductance(film.around**3, film.along**3)
        return cls(cells, step, place, later, film, end, g, filling, pressure)

    @cached_property
    def diagonal(self) -> Array:
        return np.asarray(self.g.diagonal + self.step.supply.feed)

    @cached_property
    def slack(self) -> Array:
        """Growth of the void of each cell, which full cells must not have."""
        return self.outflow(self.pressure)

    @cached_property
    def active(self) -> Mask:
        """The cells that are taken as full."""
        return np.asarray(self.pressure * self.diagonal >= self.slack)

    @cached_property
    def settled(self) -> bool:
        """True where every cell has a pressure or a void, and neither is negative."""
        push = self.pressure * self.diagonal
        limit = _BALANCED * max(self.cells.area / self.step.length, float(push.max()))
        return bool(np.abs(np.where(self.active, self.slack, push)).max() <= limit)

    @cached_property
    def left(self) -> complex:
        """Part of the load that the pressure does not carry."""
        return self.step.load - self.force_of(self.pressure)

    @property
    def balanced(self) -> bool:
        return abs(self.left) <= _BALANCED * max(abs(self.step.load), 1e-12)

    def force_of(self, pressure: Array) -> complex:
        """Return the integral of a pressure over angle and width, as part of the whole width."""
        return complex((self.cells.toward * pressure).sum()) * self.cells.area / self.cells.half_widths

    def outflow(self, pressure: Array) -> Array:
        """Return what flows out of each cell more than its thinning gives: the growth of its void."""
        supply = self.step.supply
        fed = supply.feed * (pressure - supply.pressure)
        return np.asarray(self.g.outflow(pressure, supply.edge) + fed + self.filling)

    def solved(self, outflow: Array, *, moving: bool = True) -> Array:
        """Return the change of pressure in active cells against an outflow, and by moves along both axes."""
        right = np.stack([-outflow, *(self._changes() if moving else ())])
        return self.cells.solve(self.g, self.step.supply.feed, self.active, right)

    def _changes(self) -> tuple[Array, Array]:
        """Return what a move of the journal along both axes takes from the outflow."""
        found, film, part = [], self.film, 3 * self.later
        pressure = np.where(self.active, self.pressure, 0.0)
        around, along = part * film.around**2, part * film.along**2
        for moved in self.cells.unit_moves:
            g = self.cells.conductance(around * moved.around, along * moved.along)
            more = moved.cell * (self.cells.area / self.step.length)
            found.append(-(g.outflow(pressure, self.step.supply.edge) + more))
        return found[0], found[1]

    def move(self, by_x: Array, by_y: Array, left: complex) -> complex:
        """Return the move whose pressure carries what is left, as far as it keeps the film from closing."""
        whole = _two(self.force_of(by_x), self.force_of(by_y), left)
        moved, end = self.cells.thickness(whole, 0j), self.end
        most = max(
            float(((1 - there) / np.maximum(own, _CLOSED)).max())
            for own, there in ((end.around, moved.around), (end.along, moved.along))
        )
        return whole * (min(1.0, _CLOSER / most) if most > 0 else 1.0)


def _ended(before: FilmState, state: _Balance) -> FilmState:
    """The film of a balance, with what was fed and the oil that is not accounted for."""
    cells, step, g = state.cells, state.step, state.g
    void = np.where(state.pressure > 0, 0.0, np.maximum(state.slack, 0.0)) * (step.length / cells.area)
    oil, pressure = state.end.cell - void, np.maximum(state.pressure, 0.0)
    fed = float((step.supply.feed * (step.supply.pressure - pressure)).sum())
    begin = float((g.along[:, 0] * (step.supply.edge - pressure[:, 0])).sum())
    lost = float((g.along[:, -1] * pressure[:, -1]).sum())
    fed, lost = (fed + begin, lost) if step.supply.at_begin else (fed, lost - begin)
    grown = float((oil - before.oil).sum()) * cells.area
    kept = (fed - lost) * step.length - grown
    return FilmState(
        oil, pressure, state.place, step.tilt, fed, abs(kept) / float(state.end.cell.sum() * cells.area)
    )
