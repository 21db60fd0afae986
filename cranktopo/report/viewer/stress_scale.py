"""How far the colours of stresses reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.evaluate.case_stress import CaseStress
from cranktopo.loads.load_case import LoadCase
from cranktopo.report.viewer.scene3d import FACES_ALONG
from cranktopo.triangles.surface_mesh import SurfaceMesh, mesh_of, solid_of

SHARE = 0.99
"""Part of a surface that the colours tell apart: the rest lies at sharp edges, where stress has no limit."""
_LARGE = 1000


@dataclass(frozen=True)
class StressScale:
    """Colours of one load case.

    Attributes:
        top_MPa: von Mises stress from which the colour stays the same.
    """

    case: LoadCase
    top_MPa: float

    @property
    def label(self) -> str:
        """Name and load, as in `bending, 32,377 N`."""
        case = self.case
        loads = (
            ("N", case.radial_N or case.tangential_N),
            ("N m", case.torque_Nm),
            ("rpm", case.speed_rpm),
        )
        return ", ".join([case.name, *(f"{_rounded(value)} {unit}" for unit, value in loads if value)])


def _rounded(value: float) -> str:
    return f"{value:,.0f}" if abs(value) >= _LARGE else f"{value:.4g}"


def stress_scales(bodies: Sequence[tuple[SurfaceMesh, CaseStress]]) -> tuple[StressScale, ...]:
    """One scale per load case for all bodies, so that a colour means the same on each.

    Args:
        bodies: surface and stresses of each body, all of the same load cases.
    """
    if not bodies:
        return ()
    tops = np.max([quantiles_MPa(mesh, stress, SHARE)[0] for mesh, stress in bodies], axis=0)
    return tuple(StressScale(case, float(top)) for case, top in zip(bodies[0][1].cases, tops, strict=True))


def quantiles_MPa(mesh: SurfaceMesh, stress: CaseStress, *shares: float) -> NDArray[np.float64]:
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
