"""Elementary surfaces recognised by points, normals and curvatures, however a file gives them.

A tube of one radius has its centres on a point (sphere), a line (cylinder) or a circle (torus). A cone has
normals at one angle to its axis, and tangent planes through one point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def elementary(points: Array, normals: Array, curvatures: Array, same: float) -> str:
    """Type of the elementary surface that samples lie on; empty where they lie on none.

    Args:
        points: (n, 3), mm; `normals` likewise, of unit length.
        curvatures: principal ones (n, 2), positive where the centre lies along the normal, 1/mm.
        same: largest departure over the radius, or over the extent of the points where there is none.
    """
    size = float(np.ptp(points, axis=0).max())
    if np.abs(curvatures).max() * size < same:
        return "Plane"
    for one in curvatures.T:
        middle = float(np.median(one))
        if abs(middle) * size > same and np.abs(one / middle - 1).max() < 10 * same:
            found = _tube(points + normals / middle, same / abs(middle))
            if found:
                return found
    return "Cone" if _is_cone(points, normals, same) else ""


@dataclass(frozen=True)
class Torus:
    """A torus by its axis, a unit vector, and the radii of ring and tube."""

    axis: Array
    ring_mm: float
    tube_mm: float


def torus_of(points: Array, normals: Array, curvatures: Array) -> Torus:
    """Return the torus of samples that lie on one."""
    spread = [float(np.ptp(one) / abs(np.median(one))) for one in curvatures.T]
    middle = float(np.median(curvatures[:, int(np.argmin(spread))]))
    centres = points + normals / middle
    _, ring = _circle(centres)
    return Torus(np.linalg.svd(centres - centres.mean(axis=0))[2][2], ring, 1 / abs(middle))


def _tube(centres: Array, off: float) -> str:
    """Type of the tube around centres, within an allowed departure."""
    middle = centres.mean(axis=0)
    _, _, ways = np.linalg.svd(centres - middle)
    along = np.abs((centres - middle) @ ways.T).max(axis=0)
    if along[0] < off:
        return "Sphere"
    if along[1] < off:
        return "Cylinder"
    residual, _ = _circle(centres)
    return "Torus" if along[2] < off and residual < off else ""


def _circle(points: Array) -> tuple[float, float]:
    """Largest departure from the best circle through points, and its radius."""
    middle = points.mean(axis=0)
    _, _, ways = np.linalg.svd(points - middle)
    flat = (points - middle) @ ways[:2].T
    matrix = np.column_stack([2 * flat, np.ones(len(flat))])
    x, y, c = np.linalg.lstsq(matrix, (flat**2).sum(axis=1), rcond=None)[0]
    radius = float(np.sqrt(c + x * x + y * y))
    return float(np.abs(np.hypot(flat[:, 0] - x, flat[:, 1] - y) - radius).max()), radius


def _is_cone(points: Array, normals: Array, same: float) -> bool:
    apex = np.linalg.lstsq(normals, (normals * points).sum(axis=1), rcond=None)[0]
    through = np.abs(((points - apex) * normals).sum(axis=1)).max() < same * np.ptp(points, axis=0).max()
    _, spread, _ = np.linalg.svd(normals - normals.mean(axis=0))
    return bool(through and spread[2] < same * np.sqrt(len(normals)))
