"""A straight beam of round steps on springs: shear-flexible elements that are exact between nodes.

Loads, deflections and moments are complex: the real part is one plane through the axis, the imaginary part
the plane across it. A round beam bends alike in both.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class RoundBeam:
    """Nodes along a beam and the hollow round section between neighbours.

    Attributes:
        z_mm: nodes, increasing, shape (n,).
        outer_mm, inner_mm: diameters between them, shape (n - 1,).
    """

    z_mm: Array
    outer_mm: Array
    inner_mm: Array
    E_MPa: float
    poisson: float

    @property
    def bending_Nmm2(self) -> Array:
        """Return E I of each step."""
        return self.E_MPa * math.pi / 64 * (self.outer_mm**4 - self.inner_mm**4)

    @property
    def shear_N(self) -> Array:
        """Return the shear stiffness of each step, G A with Cowper's factor of a hollow circle."""
        nu, m2 = self.poisson, (self.inner_mm / self.outer_mm) ** 2
        wide = (1 + m2) ** 2
        factor = 6 * (1 + nu) * wide / ((7 + 6 * nu) * wide + (20 + 12 * nu) * m2)
        area = math.pi / 4 * (self.outer_mm**2 - self.inner_mm**2)
        return np.asarray(factor * area * self.E_MPa / (2 * (1 + nu)))


@dataclass(frozen=True)
class BentBeam:
    """A loaded beam.

    Attributes:
        deflection_mm, slope_rad: at the nodes, (n,).
        before_Nmm, after_Nmm: bending moment on both sides of each node, (n,); ends have one side.
        reaction_N: force of each support on the beam, by its node.
    """

    deflection_mm: Complex
    slope_rad: Complex
    before_Nmm: Complex
    after_Nmm: Complex
    reaction_N: dict[int, complex]

    @property
    def moment_Nmm(self) -> Complex:
        """Return the larger moment of both sides."""
        larger = np.abs(self.before_Nmm) > np.abs(self.after_Nmm)
        return np.where(larger, self.before_Nmm, self.after_Nmm)


def bend(
    beam: RoundBeam, supports: Mapping[int, float | None], force_N: Complex, couple_Nmm: Complex
) -> BentBeam:
    """Return a beam under forces and couples at its nodes.

    Args:
        supports: by node, the stiffness of each support in N/mm; None is rigid.
        couple_Nmm: positive turns toward a growing deflection.

    Raises:
        numpy.linalg.LinAlgError: the supports do not hold the beam.
    """
    count = len(beam.z_mm)
    parts = [_element(*values) for values in _steps(beam)]
    stiffness = np.zeros((2 * count, 2 * count))
    for first, part in enumerate(parts):
        stiffness[2 * first : 2 * first + 4, 2 * first : 2 * first + 4] += part
    load = np.stack([force_N, couple_Nmm], axis=1).ravel().astype(complex)
    held = stiffness.copy()
    for node, spring in supports.items():
        held[2 * node, 2 * node] += spring or 0.0
    fixed = {2 * node for node, spring in supports.items() if spring is None}
    free = [dof for dof in range(2 * count) if dof not in fixed]
    moved = np.zeros(2 * count, dtype=complex)
    moved[free] = np.linalg.solve(held[np.ix_(free, free)], load[free])
    ends = np.array([part @ moved[2 * n : 2 * n + 4] for n, part in enumerate(parts)])
    before = np.append(0j, ends[:, 3])
    after = np.append(-ends[:, 1], 0j)
    unmet = stiffness @ moved - load
    return BentBeam(
        moved[::2], moved[1::2], before, after, {node: complex(unmet[2 * node]) for node in supports}
    )


def _steps(beam: RoundBeam) -> list[tuple[float, float, float]]:
    lengths = np.diff(beam.z_mm)
    return [tuple(map(float, step)) for step in zip(lengths, beam.bending_Nmm2, beam.shear_N, strict=True)]  # type: ignore[misc]


def _element(length: float, bending: float, shear: float) -> Array:
    """Stiffness of a shear-flexible beam for deflection and slope of both ends."""
    phi = 12 * bending / (shear * length**2)
    a, b = 12.0, 6 * length
    c, d = (4 + phi) * length**2, (2 - phi) * length**2
    matrix = np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
    return np.asarray(bending / ((1 + phi) * length**3) * matrix)
