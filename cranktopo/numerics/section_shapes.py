"""Deformations of a round section beyond its rigid motions: polynomials over it, orthogonal to these."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre


@dataclass(frozen=True)
class SectionShapes:
    """Displacements (x, y, z) of a round section across z, as polynomials of its own x and y up to a degree.

    Two bodies that meet in a section, turned against each other or not, share all of its deformation that
    these have.

    Attributes:
        radius_mm, bore_mm: outer and inner radius.
        degree: largest of the polynomials; 0: none, the section stays rigid.
    """

    radius_mm: float
    bore_mm: float
    degree: int

    @property
    def count(self) -> int:
        """Number of shapes."""
        return self._coefficients.shape[1]

    def at(self, x: Array, y: Array) -> Array:
        """Return the displacements of points, (3, points, shapes)."""
        terms = self._monomials(x, y)
        return np.asarray(np.einsum("pm,imk->ipk", terms, self._by_axis))

    def turned(self, angle_rad: float) -> Array:
        """Return what amplitudes become of a section that is turned about z, (shapes, shapes)."""
        x, y = self._points[:2]
        c, s = math.cos(angle_rad), math.sin(angle_rad)
        own = self.at(c * x + s * y, c * y - s * x)
        moved = np.stack([c * own[0] - s * own[1], s * own[0] + c * own[1], own[2]])
        here, flat = self.at(x, y), (3 * len(x), self.count)
        return np.asarray(np.linalg.lstsq(here.reshape(flat), moved.reshape(flat), rcond=None)[0])

    @property
    def axial(self) -> NDArray[np.bool_]:
        """Mask of the shapes that move along z, (shapes,); the others move across it."""
        return np.asarray(np.abs(self._by_axis[2]).max(axis=0) > 0)

    def having(self, lateral: Literal["even", "odd", "none"]) -> NDArray[np.intp]:
        """Return which shapes are even or odd in the mirror x -> -x; all of them for "none"."""
        if lateral == "none":
            return np.arange(self.count)
        x, y = self._points[:2]
        mirrored = self.at(-x, y) * np.array([-1.0, 1.0, 1.0])[:, None, None]
        alike = np.abs(mirrored - self.at(x, y)).max(axis=(0, 1)) < 1e-6
        return np.flatnonzero(alike == (lateral == "even"))

    @cached_property
    def _coefficients(self) -> Array:
        """Shapes by components and monomials, (3 monomials, shapes), each of one component parity."""
        x, y, weight = self._points
        terms = self._monomials(x, y)
        zero = np.zeros_like(terms)
        every = np.stack(
            [np.hstack(row) for row in ((terms, zero, zero), (zero, terms, zero), (zero, zero, terms))]
        )
        flat = every.reshape(-1, every.shape[2]) * np.sqrt(np.tile(weight, 3))[:, None]
        rigid = self._rigid(x, y).reshape(-1, 6) * np.sqrt(np.tile(weight, 3))[:, None]
        found = []
        for group in self._groups():
            inside = flat[:, group]
            basis = np.linalg.qr(rigid)[0]
            left = inside - basis @ (basis.T @ inside)
            sizes, axes = np.linalg.eigh(left.T @ left)
            for axis, size in zip(axes.T, sizes, strict=True):
                if size > 1e-9 * np.trace(inside.T @ inside):
                    column = np.zeros(every.shape[2])
                    rest = np.linalg.lstsq(flat[:, group], left @ axis, rcond=None)[0]
                    column[group] = rest / math.sqrt(size)
                    found.append(column)
        return np.array(found).reshape(-1, every.shape[2]).T

    @property
    def _by_axis(self) -> Array:
        """Coefficients, (3, monomials, shapes)."""
        return self._coefficients.reshape(3, len(self._powers()), self.count)

    def _groups(self) -> list[NDArray[np.intp]]:
        """Terms of one parity in x, moving across z or along it."""
        powers = self._powers()
        across = [(0, a) for a, _ in powers] + [(1, a) for a, _ in powers]
        parity = np.array([(a + (axis == 0)) % 2 for axis, a in across] + [a % 2 for a, _ in powers])
        axial = np.arange(len(parity)) >= 2 * len(powers)
        if self.degree == 0:
            return []
        return [np.flatnonzero((parity == p) & (axial == z)) for z in (False, True) for p in (0, 1)]

    def _powers(self) -> list[tuple[int, int]]:
        return [(a, total - a) for total in range(self.degree + 1) for a in range(total + 1)]

    def _monomials(self, x: Array, y: Array) -> Array:
        return np.stack(
            [(x / self.radius_mm) ** a * (y / self.radius_mm) ** b for a, b in self._powers()], axis=1
        )

    def _rigid(self, x: Array, y: Array) -> Array:
        one, zero = np.ones_like(x), np.zeros_like(x)
        u, v = x / self.radius_mm, y / self.radius_mm
        return np.stack(
            [
                np.stack([one, zero, zero, zero, zero, -v], axis=1),
                np.stack([zero, one, zero, zero, zero, u], axis=1),
                np.stack([zero, zero, one, v, -u, zero], axis=1),
            ]
        )

    @cached_property
    def _points(self) -> tuple[Array, Array, Array]:
        """Points of the section, x and y, and their weights."""
        nodes, weights = gauss_legendre(8)
        radius = self.bore_mm + (self.radius_mm - self.bore_mm) * (nodes + 1) / 2
        angle = 2 * math.pi * np.arange(24) / 24
        x, y = np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle))
        return x.ravel(), y.ravel(), np.repeat(weights * radius / radius.sum(), 24)


WARPS = 6
"""Number of `WarpShapes`."""
_INWARD, _THREEFOLD = 0.57, 0.15
"""Of the ovals of hollow cylinders as long as their radius, which others have nearly as well."""


@dataclass(frozen=True)
class WarpShapes:
    """Displacements (x, y, z) by which a round section mainly deforms, two of each kind.

    It grows oval in its plane, becomes a saddle along z, or warps along z as under a shear force. Complex,
    with the radius as unit, an amplitude c displaces the place w = x + iy by c w* (1 - a w w*) + c* b w^3 in
    the plane, by the real part of c* w^2 along z, or by that of c* w (w w* - m). All are orthogonal to rigid
    motions, and a section that is turned has the same ones.

    Attributes:
        radius_mm, bore_mm: outer and inner radius.
    """

    radius_mm: float
    bore_mm: float

    @property
    def count(self) -> int:
        """Number of shapes."""
        return WARPS

    @property
    def axial(self) -> NDArray[np.bool_]:
        """Mask of the shapes that move along z, (shapes,)."""
        return np.arange(WARPS) >= 2

    def at(self, x: Array, y: Array) -> Array:
        """Return the displacements of points, (3, points, shapes)."""
        place = (x + 1j * y) / self.radius_mm
        square, hollow = np.abs(place) ** 2, self.bore_mm / self.radius_mm
        upright = 2 / 3 * (1 - hollow**6) / (1 - hollow**4)  # it does not tilt
        found = np.zeros((3, len(place), WARPS))
        for number, own in enumerate((1, 1j)):
            across = own * place.conj() * (1 - _INWARD * square) + np.conj(own) * _THREEFOLD * place**3
            found[0, :, number], found[1, :, number] = across.real, across.imag
            found[2, :, 2 + number] = (np.conj(own) * place**2).real
            found[2, :, 4 + number] = (np.conj(own) * place).real * (square - upright)
        return found

    def turned(self, angle_rad: float) -> Array:
        """Return what amplitudes become of a section that is turned about z, (shapes, shapes)."""
        return warps_turned(angle_rad)

    def having(self, lateral: Literal["even", "odd", "none"]) -> NDArray[np.intp]:
        """Return which shapes are even or odd in the mirror x -> -x; all of them for "none"."""
        return np.array({"even": [0, 2, 5], "odd": [1, 3, 4], "none": range(WARPS)}[lateral])


def warps_turned(angle_rad: float) -> Array:
    """Return what amplitudes of `WarpShapes` become of a section that is turned about z, (shapes, shapes)."""
    found = np.zeros((WARPS, WARPS))
    for first, times in ((0, 2), (2, 2), (4, 1)):
        c, s = math.cos(times * angle_rad), math.sin(times * angle_rad)
        found[first : first + 2, first : first + 2] = [[c, -s], [s, c]]
    return found
