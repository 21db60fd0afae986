"""Pressure of the oil film between a journal that moves sideways and its bearing, by Reynolds' equation.

Dimensionless: film thickness H = 1 - e cos a at the angle a from the eccentricity e (over the radial
clearance c), pressure P = p c^3 / (12 mu V R^2) for a journal's centre that moves with V; a pressure is never
negative (Reynolds' condition: the film ends where its slope is zero). Without rotation: a turning journal is
the same in a frame that turns with the mean of journal and bearing (J. F. Booker, ASME J. Basic Eng. 87,
1965).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import solver_error

_CHANGES = 60
"""Most changes of the ruptured part; it settles within ten."""
_AROUND, _ALONG = 144, 12
_WIDE = 1.5
"""The cells are this much narrower than evenly spaced at the thinnest film, per root of its thickness."""


@dataclass(frozen=True)
class FilmForce:
    """Force of a film whose journal moves with a unit velocity.

    Attributes:
        radial, across: integral of the pressure along the eccentricity and ahead of it by 90 deg, over angle
            and over the half width as unit.
        peak: largest pressure.
    """

    radial: float
    across: float
    peak: float


@dataclass(frozen=True)
class Film:
    """The film of a bearing at an eccentricity: cells around the journal and along half of its width."""

    angle: Array
    width: Array
    matrix: sp.csr_matrix

    def force(self, direction: float) -> FilmForce:
        """Return the force where the centre moves at an angle, rad, from the eccentricity."""
        approach = np.cos(self.angle - direction) * self.width
        pressure = _never_negative(self.matrix, np.repeat(approach, _ALONG) / _ALONG).reshape(-1, _ALONG)
        along = 2 * pressure.mean(axis=1) * self.width
        return FilmForce(
            float(along @ np.cos(self.angle)), float(along @ np.sin(self.angle)), float(pressure.max())
        )


def film(eccentricity: float, width_over_diameter: float) -> Film:
    """Return the film of a bearing open at both ends, by finite volumes, narrow where the film is thin."""
    edges = _edges(eccentricity)
    angle, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    cubed = (1 - eccentricity * np.cos(angle)) ** 3
    at_edge = (1 - eccentricity * np.cos(edges[:-1])) ** 3  # between a cell and the one before it
    apart = (width + np.roll(width, 1)) / 2
    around = _chain(at_edge / apart, periodic=True)
    half = 1.0 / _ALONG
    along = _chain(np.full(_ALONG, 1 / half), periodic=False)
    along[-1, -1] += 2 / half  # the open end, half a cell away
    cells = sp.diags(cubed * width / width_over_diameter**2)
    matrix = sp.kron(around, sp.identity(_ALONG) * half) + sp.kron(cells, along)
    return Film(angle, width, sp.csr_matrix(matrix))


def _edges(eccentricity: float) -> Array:
    """Edges of the cells around the journal, from -pi to pi, close together at the thinnest film."""
    even = np.linspace(-1.0, 1.0, _AROUND + 1)
    narrow = np.arcsinh(np.pi / (_WIDE * np.sqrt(2 * (1 - eccentricity))))
    return np.asarray(np.pi * np.sinh(narrow * even) / np.sinh(narrow))


def _chain(links: Array, *, periodic: bool) -> sp.lil_matrix:
    """Conductances of cells in a row, each joined to the one before it; the first to the last if periodic."""
    count = len(links)
    if not periodic:
        links = np.concatenate([[0.0], links[1:]])
    behind = np.roll(links, -1)
    chain = sp.diags([links + behind, -links[1:], -links[1:]], [0, -1, 1]).tolil()
    if periodic:
        chain[0, count - 1] = chain[count - 1, 0] = -links[0]
    return chain


def _never_negative(matrix: sp.csr_matrix, right: Array) -> Array:
    """Solve A p = b where p > 0, with p = 0 where the film is ruptured: exact, by changing that part.

    A is an M-matrix, so that the changes end (policy iteration).
    """
    full: NDArray[np.bool_] = right > -np.inf
    for _ in range(_CHANGES):
        pressure = np.zeros_like(right)
        inside = np.flatnonzero(full)
        pressure[inside] = sla.spsolve(matrix[inside][:, inside].tocsc(), right[inside])
        filled = pressure > matrix @ pressure - right
        if (filled == full).all():
            return pressure
        full = filled
    raise solver_error("oil film: its ruptured part does not settle.", "Report this as a defect.")
