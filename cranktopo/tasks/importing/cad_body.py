"""Bodies of an open CAD session: moved so that their surfaces stay exact, and cut between planes."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.shapes import DimTags

_NO_TURN_RAD = 1e-15
_NEAR = 0.05
"""Share of a distance between planes that a box may be wider than the curved faces in it."""


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
    """Return what of a body lies between two heights; it reaches no farther from the axis than `reach_mm`.

    Where faces of the body meet in one of those planes, the kernel's intersection can be empty or the part
    beyond it: the body is then parted by the planes, which finds all parts there.
    """
    corner, size = (-reach_mm, -reach_mm, start_mm), (2 * reach_mm, 2 * reach_mm, end_mm - start_mm)
    box = occ.addBox(*corner, *size)
    between = list(occ.intersect(body, [(3, box)], removeObject=False)[0])
    if _lie_between(occ, between, start_mm, end_mm):
        # A body that lies wholly between the planes comes back under its own tag.
        occ.remove([one for one in body if one not in between], recursive=True)
        return between
    occ.remove(between, recursive=True)
    below = _beyond(occ, body, end_mm, reach_mm, -1)
    return _beyond(occ, below, start_mm, reach_mm, 1)


def _beyond(occ: Any, body: DimTags, height_mm: float, reach_mm: float, toward: int) -> DimTags:
    """Part a body by the plane at a height; return what lies above (toward = 1) or below it (-1)."""
    plane = occ.addRectangle(-reach_mm, -reach_mm, height_mm, 2 * reach_mm, 2 * reach_mm)
    parts = occ.fragment(body, [(2, plane)])[0]
    kept = [
        part for part in parts if part[0] == 3 and toward * (occ.getCenterOfMass(*part)[2] - height_mm) > 0
    ]
    occ.remove([part for part in parts if part not in kept], recursive=True)
    return kept


def _lie_between(occ: Any, bodies: DimTags, start_mm: float, end_mm: float) -> bool:
    """Tell whether there are bodies and all lie between two heights, as near as their boxes tell it."""
    slack = _NEAR * (end_mm - start_mm)
    boxes = [occ.getBoundingBox(*body) for body in bodies]
    return bool(boxes) and all(box[2] > start_mm - slack and box[5] < end_mm + slack for box in boxes)
