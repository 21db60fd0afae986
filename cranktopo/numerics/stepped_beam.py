"""A straight beam of steps on springs: shear-flexible elements that are exact between nodes.

Loads, deflections and moments are complex: the real part is one plane through the axis, the imaginary part
the plane across it. A round beam bends alike in both.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex


@dataclass(frozen=True)
class Beam:
    """Nodes along a beam and the stiffness between neighbours.

    Attributes:
        z_mm: nodes, increasing, shape (n,).
        bending_Nmm2: E I of each step, shape (n - 1,).
        shear_N: shear stiffness of each step, shape (n - 1,); infinite where shear does not count.
    """

    z_mm: Array
    bending_Nmm2: Array
    shear_N: Array


def round_beam(z_mm: Array, outer_mm: Array, inner_mm: Array, E_MPa: float, poisson: float) -> Beam:
    """Return a beam of hollow round steps by their diameters (n - 1,).

    Its shear stiffness is G A with Cowper's factor of a hollow circle.
    """
    nu, m2 = poisson, (inner_mm / outer_mm) ** 2
    wide = (1 + m2) ** 2
    factor = 6 * (1 + nu) * wide / ((7 + 6 * nu) * wide + (20 + 12 * nu) * m2)
    area = math.pi / 4 * (outer_mm**2 - inner_mm**2)
    bending = E_MPa * math.pi / 64 * (outer_mm**4 - inner_mm**4)
    return Beam(z_mm, bending, factor * area * E_MPa / (2 * (1 + nu)))


@dataclass(frozen=True)
class BentBeam:
    """A loaded beam, of the same shape as its loads.

    Attributes:
        deflection_mm, slope_rad: at the nodes.
        before_Nmm, after_Nmm: bending moment on both sides of each node; ends have one side.
        reaction_N: force of each support on the beam, by its node.
    """

    deflection_mm: Complex
    slope_rad: Complex
    before_Nmm: Complex
    after_Nmm: Complex
    reaction_N: dict[int, Complex]

    @property
    def moment_Nmm(self) -> Complex:
        """Return the larger moment of both sides."""
        larger = np.abs(self.before_Nmm) > np.abs(self.after_Nmm)
        return np.where(larger, self.before_Nmm, self.after_Nmm)


def bend(
    beam: Beam,
    supports: Mapping[int, float | None],
    force_N: Complex,
    couple_Nmm: Complex,
    tilt_Nmm_per_rad: float = 0.0,
) -> BentBeam:
    """Return a beam under forces and couples at its nodes, (n,) or of several states, (n, states).

    Args:
        supports: by node, the stiffness of each support in N/mm; None is rigid.
        couple_Nmm: positive turns toward a growing deflection.
        tilt_Nmm_per_rad: stiffness by which each support resists the slope.

    Raises:
        numpy.linalg.LinAlgError: the supports do not hold the beam.
    """
    count = len(beam.z_mm)
    steps = zip(np.diff(beam.z_mm), beam.bending_Nmm2, beam.shear_N, strict=True)
    parts = [_element(*map(float, step)) for step in steps]
    stiffness = np.zeros((2 * count, 2 * count))
    for first, part in enumerate(parts):
        stiffness[2 * first : 2 * first + 4, 2 * first : 2 * first + 4] += part
    load = np.stack([force_N, couple_Nmm], axis=1).reshape(2 * count, *force_N.shape[1:]).astype(complex)
    held = stiffness.copy()
    for node, spring in supports.items():
        held[2 * node, 2 * node] += spring or 0.0
        held[2 * node + 1, 2 * node + 1] += tilt_Nmm_per_rad
    fixed = {2 * node for node, spring in supports.items() if spring is None}
    free = [dof for dof in range(2 * count) if dof not in fixed]
    moved = np.zeros_like(load)
    moved[free] = np.linalg.solve(held[np.ix_(free, free)], load[free])
    ends = np.array([part @ moved[2 * n : 2 * n + 4] for n, part in enumerate(parts)])
    nothing = np.zeros_like(ends[:1, 0])
    before, after = np.concatenate([nothing, ends[:, 3]]), np.concatenate([-ends[:, 1], nothing])
    unmet = stiffness @ moved - load
    return BentBeam(moved[::2], moved[1::2], before, after, {node: unmet[2 * node] for node in supports})


def _element(length: float, bending: float, shear: float) -> Array:
    """Stiffness of a shear-flexible beam for deflection and slope of both ends."""
    phi = 12 * bending / (shear * length**2)
    a, b = 12.0, 6 * length
    c, d = (4 + phi) * length**2, (2 - phi) * length**2
    matrix = np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
    return np.asarray(bending / ((1 + phi) * length**3) * matrix)
