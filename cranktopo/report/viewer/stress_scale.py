"""How far the colours of stresses reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of

SHARE = 0.99
"""Part of a surface that the colours tell apart: the rest lies at sharp edges, where stress has no limit."""
FACES_ALONG = 48
"""Longest extent of a body over the longest edge of a face that one colour or one value stands for."""


class LoadedCase(Protocol):
    """A load case under which a surface is stressed."""

    @property
    def name(self) -> str:
        """Name."""

    @property
    def label(self) -> str:
        """Name and load."""


class StressedBody(Protocol):
    """Stresses of load cases that can be told at any point of a surface."""

    @property
    def cases(self) -> Sequence[LoadedCase]:
        """The load cases."""

    @property
    def element_size_mm(self) -> float:
        """General size of the elements that they were solved on."""

    def at(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the stress at points (points, 3), MPa, shape (cases, points)."""


@dataclass(frozen=True)
class StressScale:
    """Colours of one load case.

    Attributes:
        case: name of the load case.
        label: its name and load.
        top_MPa: von Mises stress from which the colour stays the same.
    """

    case: str
    label: str
    top_MPa: float


def stress_scales(bodies: Sequence[tuple[SurfaceMesh, StressedBody]]) -> tuple[StressScale, ...]:
    """Return one scale per load case for all bodies, so that a colour means the same on each.

    Args:
        bodies: surface and stresses of each body, all of the same load cases.
    """
    if not bodies:
        return ()
    tops = np.max([quantiles_MPa(mesh, stress, SHARE)[0] for mesh, stress in bodies], axis=0)
    cases = zip(bodies[0][1].cases, tops, strict=True)
    return tuple(StressScale(case.name, case.label, float(top)) for case, top in cases)


def quantiles_MPa(mesh: SurfaceMesh, stress: StressedBody, *shares: float) -> NDArray[np.float64]:
    """Von Mises stress that parts of the surface's area stay below, MPa, shape (shares, load cases).

    Args:
        shares: parts of the area.
    """
    fine = mesh_of(solid_of(mesh).refine_to_length(mesh.extent_mm / FACES_ALONG))
    values = stress.at(fine.corners_mm.mean(axis=1))
    order = np.argsort(values, axis=1)
    below = np.cumsum(fine.areas_mm2[order], axis=1) / fine.areas_mm2.sum()
    least = np.array(shares)[:, None, None]
    at = np.minimum((below < least).sum(axis=2), values.shape[1] - 1)
    rising = np.take_along_axis(values, order, axis=1)
    return np.take_along_axis(rising, at.T, axis=1).T
