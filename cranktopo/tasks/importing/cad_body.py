"""Rigid motions of a CAD body that keep its exact surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

from cranktopo.base.arrays import Array

_NO_TURN_RAD = 1e-15


def moved_rigidly(occ: Any, body: list[tuple[int, int]], matrix: Array, shift_mm: Array) -> None:
    """Move a body, p -> matrix p + shift, by one rotation and one translation.

    A general affine map, which the kernel offers as well, turns every face into a B-spline.
    """
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(matrix).as_rotvec()
    angle = float(np.linalg.norm(turn))
    if angle > _NO_TURN_RAD:
        occ.rotate(body, 0.0, 0.0, 0.0, *(turn / angle).tolist(), angle)
    occ.translate(body, *np.asarray(shift_mm).tolist())
