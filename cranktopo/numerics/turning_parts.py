"""Parts of a turning body of revolution about z: rigid disks and beams, as `TurningBody`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.numerics.turning_body import TurningBody


def rigid_disk(mass: float, diametral: float, polar: float, arm_mm: float = 0.0) -> TurningBody:
    """Return a body of revolution over the six motions of a point on its axis, `arm_mm` before its centre."""
    across, still = diametral - polar / 2, np.zeros(6)
    coriolis = np.zeros((6, 6))
    coriolis[1, 0], coriolis[4, 3] = mass, across
    motion = np.eye(6)
    motion[0, 4], motion[1, 3] = arm_mm, -arm_mm
    lateral = np.array([mass, mass, 0.0, across, across, polar])
    still[3:] = polar / 2, polar / 2, polar
    return TurningBody(
        stiffness=np.zeros((6, 6)),
        mass=np.diag([mass, mass, mass, diametral, diametral, polar]),
        coriolis=coriolis - coriolis.T,
        lateral=np.diag(lateral),
        stiffening=np.diag(still),
    ).over(motion)


@dataclass(frozen=True)
class RoundSection:
    """Section of a round beam, solid or hollow: area, polar second moment of its mass and of its torsion.

    Units mm2, mm4, MPa, tonne/mm3.
    """

    area: float
    polar: float
    torsion: float
    youngs_MPa: float
    poisson: float
    density: float

    @property
    def shear_MPa(self) -> float:
        """Shear modulus."""
        return self.youngs_MPa / (2 * (1 + self.poisson))

    @property
    def shear_area(self) -> float:
        """Area that shears (G. R. Cowper, J. Appl. Mech. 33, 1966, 335-340, of a hollow circle)."""
        mean, half = self.polar / self.area, self.area / (2 * math.pi)
        ratio = max(mean - half, 0.0) / (mean + half)  # of the squares of the radii
        whole, poisson = (1 + ratio) ** 2, self.poisson
        return (
            self.area * 6 * (1 + poisson) * whole / ((7 + 6 * poisson) * whole + (20 + 12 * poisson) * ratio)
        )


def beam(section: RoundSection, length_mm: float) -> TurningBody:
    """Return a Timoshenko beam along z over the six motions of its first and then of its last section."""
    moved, tilted, bent = _bending(section, length_mm)
    linear = np.array([[2.0, 1.0], [1.0, 2.0]]) * section.density * length_mm / 6
    rod = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length_mm
    turned = _about(section.polar * linear)
    return TurningBody(
        stiffness=_in_both_planes(bent)
        + _along(section.youngs_MPa * section.area * rod)
        + _about(section.shear_MPa * section.torsion * rod),
        mass=_in_both_planes(moved + tilted) + _along(section.area * linear) + turned,
        coriolis=_PLANE_Y.T @ moved @ _PLANE_X - _PLANE_X.T @ moved @ _PLANE_Y,
        lateral=_in_both_planes(moved) + turned,
        stiffening=_in_both_planes(tilted) + turned,
    )


def _plane(places: tuple[int, int, int, int], sign: float) -> Array:
    """Displacement and tilt of both ends in one plane by the twelve motions, (4, 12)."""
    plane = np.zeros((4, 12))
    plane[range(4), places] = 1.0, sign, 1.0, sign
    return plane


_PLANE_X, _PLANE_Y = _plane((0, 4, 6, 10), 1.0), _plane((1, 3, 7, 9), -1.0)


def _in_both_planes(matrix: Array) -> Array:
    return np.asarray(_PLANE_X.T @ matrix @ _PLANE_X + _PLANE_Y.T @ matrix @ _PLANE_Y)


def _along(matrix: Array) -> Array:
    return _of_motions(matrix, (2, 8))


def _about(matrix: Array) -> Array:
    return _of_motions(matrix, (5, 11))


def _of_motions(matrix: Array, places: tuple[int, int]) -> Array:
    whole = np.zeros((12, 12))
    whole[np.ix_(places, places)] = matrix
    return whole


def _bending(section: RoundSection, length: float) -> tuple[Array, Array, Array]:
    """Return mass of the displacement, of the tilt, and stiffness in one plane, (4, 4) each."""
    bending, shear = section.youngs_MPa * section.polar / 2, section.shear_MPa * section.shear_area
    points, weights = gauss_legendre(4)
    weights = weights / 2 * length
    shape, tilt, slope, curvature = _beam_shapes((points + 1) / 2, length, 12 * bending / (shear * length**2))

    def integral(one: Array, factor: float) -> Array:
        return np.asarray(factor * (one.T * weights) @ one)

    return (
        integral(shape, section.density * section.area),
        integral(tilt, section.density * section.polar / 2),
        integral(curvature, bending) + integral(slope - tilt, shear),
    )


def _beam_shapes(at: Array, length: float, shear: float) -> tuple[Array, Array, Array, Array]:
    """Return displacement, tilt, and their derivatives of a Timoshenko beam at shares of its length.

    Over displacement and tilt of both ends, (points, 4); `shear` is 12 E I / (k G A l^2).
    """
    s = at
    shape = [
        1 - 3 * s**2 + 2 * s**3 + shear * (1 - s),
        length * (s - 2 * s**2 + s**3 + shear / 2 * (s - s**2)),
        3 * s**2 - 2 * s**3 + shear * s,
        length * (s**3 - s**2 + shear / 2 * (s**2 - s)),
    ]
    slope = [
        (6 * s**2 - 6 * s - shear) / length,
        1 - 4 * s + 3 * s**2 + shear / 2 * (1 - 2 * s),
        (6 * s - 6 * s**2 + shear) / length,
        3 * s**2 - 2 * s + shear / 2 * (2 * s - 1),
    ]
    tilt = [
        6 / length * (s**2 - s),
        1 - 4 * s + 3 * s**2 + shear * (1 - s),
        6 / length * (s - s**2),
        3 * s**2 - 2 * s + shear * s,
    ]
    curvature = [
        6 / length**2 * (2 * s - 1),
        (6 * s - 4 - shear) / length,
        6 / length**2 * (1 - 2 * s),
        (6 * s - 2 + shear) / length,
    ]
    found = [np.stack(rows, axis=1) / (1 + shear) for rows in (shape, tilt, slope, curvature)]
    return found[0], found[1], found[2], found[3]
