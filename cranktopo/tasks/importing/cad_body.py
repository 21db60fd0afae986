"""Bodies of an open CAD session: moved so that their surfaces stay exact, and cut between planes."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.shapes import DimTags

_NO_TURN_RAD = 1e-15


def moved_rigidly(occ: Any, body: DimTags, matrix: Array, shift_mm: Array) -> None:
    """Move a body, p -> matrix p + shift, by one rotation and one translation.

    A general affine map, which the kernel offers as well, turns every face into a B-spline.
    """
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(matrix).as_rotvec()
    angle = float(np.linalg.norm(turn))
    if angle > _NO_TURN_RAD:
        occ.rotate(body, 0.0, 0.0, 0.0, *(turn / angle).tolist(), angle)
    occ.translate(body, *np.asarray(shift_mm).tolist())


def between_planes(occ: Any, body: DimTags, start_mm: float, end_mm: float, reach_mm: float) -> DimTags:
    """Return what of a body lies between two heights; it reaches no farther from the axis than `reach_mm`."""
    corner, size = (-reach_mm, -reach_mm, start_mm), (2 * reach_mm, 2 * reach_mm, end_mm - start_mm)
    return list(occ.intersect(body, [(3, occ.addBox(*corner, *size))])[0])
