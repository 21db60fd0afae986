"""Cells of an oil film unrolled around a journal: thickness, flow between them, and their linear equations.

Dimensionless: film thickness H over the radial clearance c, shaft angle as time, pressure
P = p c^2 / (12 mu w R^2), place along the width from -1 to 1. A film alike in both halves has cells in one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
import scipy.linalg as sl
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Complex, Index, Mask
from cranktopo.base.errors import solver_error

Sides = Literal["symmetric", "open", "groove"]
"""Begin of a film along the width: the middle of a symmetric one, an open end, or a groove."""


@dataclass(frozen=True)
class FilmCells:
    """Even cells around a journal and along a film.

    Attributes:
        around, along: their numbers; an even one around.
        width_over_diameter: of this film.
        sides: its begin; its end is always open, at no pressure.
    """

    around: int
    along: int
    width_over_diameter: float
    sides: Sides

    @property
    def step(self) -> float:
        """Angle of a cell, rad."""
        return 2 * math.pi / self.around

    @property
    def half_widths(self) -> int:
        """Half widths that the cells cover: 1 of a symmetric film, else 2."""
        return 1 if self.sides == "symmetric" else 2

    @property
    def length(self) -> float:
        """Length of a cell along the width, over half of it."""
        return self.half_widths / self.along

    @property
    def area(self) -> float:
        """Area of a cell, rad and half widths."""
        return self.step * self.length

    @cached_property
    def angle(self) -> Array:
        """Angles of the middles of the cells, rad."""
        return np.asarray(self.step * (np.arange(self.around) + 0.5))

    @cached_property
    def toward(self) -> Complex:
        """Mean over each cell of the unit vector toward it, shape (around, 1)."""
        return np.asarray(np.exp(1j * self.angle) * np.sinc(self.step / 2 / np.pi))[:, None]

    @cached_property
    def _across(self) -> tuple[Array, Array, Array]:
        """Unit vectors, (2, around, 1): means over cells, between a cell and the next one, in the middles."""
        between, own = (np.exp(1j * (self.angle + turn))[:, None] for turn in (self.step / 2, 0.0))
        mean, edge, middle = (np.stack([way.real, way.imag]) for way in (self.toward, between, own))
        return mean, edge, middle

    @cached_property
    def edges(self) -> Array:
        """Places of the edges along the width, (along + 1)."""
        first = 0.0 if self.sides == "symmetric" else -1.0
        return np.linspace(first, 1.0, self.along + 1, dtype=np.float64)

    @cached_property
    def middles(self) -> Array:
        """Places of the middles of the cells along the width."""
        return np.asarray((self.edges[1:] + self.edges[:-1]) / 2)

    @cached_property
    def _folded(self) -> Index:
        """Rows around with neighbours two places apart at most: 0, n - 1, 1, n - 2, ..."""
        half = np.arange(self.around // 2)
        return np.stack([half, self.around - 1 - half], axis=1).ravel()

    def thickness(self, eccentricity: complex, tilt: complex) -> Thickness:
        """Return the film where the axis of the journal is at eccentricity + place * tilt."""

        def at(toward: Array, place: Array) -> Array:
            x, y = eccentricity.real + tilt.real * place, eccentricity.imag + tilt.imag * place
            return np.asarray(1 - (toward[0] * x + toward[1] * y))

        mean, edge, own = self._across
        return Thickness(at(mean, self.middles), at(edge, self.middles), at(own, self.edges))

    @cached_property
    def unit_moves(self) -> tuple[Thickness, Thickness]:
        """Change of the film by a move of 1 along either axis."""
        x, y = (self.thickness(way, 0j) for way in (1 + 0j, 1j))
        return x.less(1.0), y.less(1.0)

    def conductance(self, around: Array, along: Array) -> Conductance:
        """Return that of every face, of the cubed thickness at the faces (`Thickness`).

        It is linear in them, so that it also takes their derivatives.
        """
        across = along * (self.step / self.length / self.width_over_diameter**2)
        across[:, 0] *= 0.0 if self.sides == "symmetric" else 2.0
        across[:, -1] *= 2.0
        return Conductance(around * (self.length / self.step), across)

    def solve(self, g: Conductance, feed: Array, active: Mask, right: Array) -> Array:
        """Solve the balance of the active cells, in the others 0; right of shape (values, around, along)."""
        m, order = self.along, self._folded
        diagonal = g.diagonal + feed
        on = active[order]
        links = np.where(active & _next(active), -g.around, 0.0)
        band = np.zeros((2 * m + 1, self.around, m))
        band[0] = np.where(on, diagonal[order], 1.0)
        if m > 1:
            band[1, :, :-1] = np.where(on[:, 1:] & on[:, :-1], -g.along[order][:, 1:-1], 0.0)
        band[2 * m, :-2:2], band[2 * m, 1:-2:2] = links[order[:-2:2]], links[order[3::2]]
        band[m, 0], band[m, -2] = links[-1], links[order[-2]]
        sides = np.where(active, right, 0.0)[:, order].reshape(len(right), -1).T
        try:
            found = sl.solveh_banded(band.reshape(2 * m + 1, -1), sides, lower=True, check_finite=False)
        except np.linalg.LinAlgError as error:
            raise solver_error(f"oil film: {error}", "Report this as a defect.") from error
        back = np.empty((len(right), self.around, m))
        back[:, order] = found.T.reshape(len(right), self.around, m)
        return back


@dataclass(frozen=True)
class Thickness:
    """Film thickness over the clearance.

    Attributes:
        cell: mean over each cell, (around, along).
        around: between a cell and the next one around, (around, along).
        along: at the edges along the width, (around, along + 1).
    """

    cell: Array
    around: Array
    along: Array

    def less(self, film: float) -> Thickness:
        """Return what is more than an even film."""
        return Thickness(self.cell - film, self.around - film, self.along - film)


@dataclass(frozen=True)
class Conductance:
    """Flow per difference of pressure through the faces, in the shapes of `Thickness`."""

    around: Array
    along: Array

    @property
    def diagonal(self) -> Array:
        """Flow out of each cell per its own pressure."""
        both = self.around + _last(self.around)
        return np.asarray(both + self.along[:, 1:] + self.along[:, :-1])

    def outflow(self, pressure: Array, at_begin: float) -> Array:
        """Return the flow out of every cell, where the film begins at a pressure."""
        ahead = self.around * (pressure - _next(pressure))
        right = np.empty_like(self.along)
        right[:, 1:-1] = self.along[:, 1:-1] * (pressure[:, :-1] - pressure[:, 1:])
        right[:, 0] = self.along[:, 0] * (at_begin - pressure[:, 0])
        right[:, -1] = self.along[:, -1] * pressure[:, -1]
        return np.asarray(ahead - _last(ahead) + right[:, 1:] - right[:, :-1])


def _next(cells: NDArray[Any]) -> NDArray[Any]:
    """Return for each cell the value of the next one around; `numpy.roll` takes several times as long."""
    return np.concatenate((cells[1:], cells[:1]))


def _last(cells: NDArray[Any]) -> NDArray[Any]:
    """Return for each cell the value of the one before it around."""
    return np.concatenate((cells[-1:], cells[:-1]))
