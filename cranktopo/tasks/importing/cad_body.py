"""Bodies of an open CAD session: moved so that their surfaces stay exact, and cut between planes."""

from __future__ import annotations

from contextlib import AbstractContextManager
from itertools import pairwise
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.checked import NotCutError, check_parts, volume_mm3
from cranktopo.numerics.gmsh_session import DimTags, points_joined

ALIKE = 1e-6
"""Share of the volume in which both sides may differ: reading a file joins vertices that almost coincide."""
REACH = 20.0
"""Way from the axis beyond which no body reaches, over the pitch."""
_HALVES = 1e-4
"""Share of the volume, and of the pitch, in which the halves of a whole throw count as alike."""
_NO_TURN_RAD = 1e-15
_BESIDE = 1e-5
"""Way of a cut from the plane for which it stands, over the distance of two planes."""
_CONSERVED = 1e-6
"""Share of a body by which the volumes of its parts may differ from it."""
_EDGE_MM = 1e-5
"""Way that CAD systems may leave an edge beside its faces."""


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

    Raises:
        NotCutError: the three parts do not add up to the body.
    """
    whole, ends = volume_mm3(occ, body), _beyond(occ, body, reach_mm)
    outside = sum(
        _volume_between(occ, body, *slab, reach_mm)
        for slab in zip((ends[0], end_mm), (start_mm, ends[1]), strict=True)
    )
    kept = slab(occ, body, start_mm, end_mm, reach_mm)
    check_parts(outside + volume_mm3(occ, kept), whole)
    return kept


def edges_in_planes() -> AbstractContextManager[None]:
    """Let the kernel cut along planes in which edges of a body lie but for the rounding of its file.

    It takes what is nearer than its tolerance for one, by default 1e-7 mm, and may lose a part otherwise.
    """
    return points_joined(_EDGE_MM)


def slab(occ: Any, body: DimTags, start: float, end: float, reach: float) -> DimTags:
    """Return what of a body lies between two heights, near the z axis; no volume is checked."""
    box = occ.addBox(-reach, -reach, start, 2 * reach, 2 * reach, end - start)
    with edges_in_planes():
        return list(occ.intersect(body, [(3, box)])[0])


def volumes_between(occ: Any, body: DimTags, planes_mm: tuple[float, float], reach_mm: float) -> Array:
    """Return the volumes of a body before, between and after two planes, mm3, shape (3,).

    A face of the body lies in such a plane but for rounding, and a fillet touches it: the kernel then finds
    what it cuts by chance. So it cuts a little beside the planes, and slabs next to these cuts stand for what
    is between.

    Raises:
        NotCutError: the parts do not add up to the body.
    """
    ends, beside = _beyond(occ, body, reach_mm), _BESIDE * (planes_mm[1] - planes_mm[0])
    heights = (ends[0], *planes_mm, ends[1])
    found = np.array([_part_mm3(occ, body, part, ends, beside, reach_mm) for part in pairwise(heights)])
    check_parts(float(found.sum()), volume_mm3(occ, body), _CONSERVED)
    return found


def halves_apart(occ: Any, body: DimTags, pitch_mm: float) -> str:
    """Tell why the halves of a whole throw are not one; empty where they are mirror images."""
    try:
        near, far = (_bulk(occ, body, start, pitch_mm) for start in (0.0, pitch_mm / 2))
    except NotCutError:
        return "the CAD kernel cannot cut it in halves"
    far[-1] = pitch_mm - far[-1]
    share, moved = far[0] / near[0] - 1, float(np.linalg.norm(far[1:] - near[1:]))
    if abs(share) < _HALVES and moved < _HALVES * pitch_mm:
        return ""
    differ = f"its halves differ: the second has {100 * share:+z.3g} % of volume"
    return f"{differ}, its centre of mass lies {moved:.3g} mm elsewhere"


def _bulk(occ: Any, body: DimTags, start: float, pitch: float) -> Array:
    """Return volume and centre of mass of half a throw that begins at a height."""
    half = between_planes(occ, occ.copy(body), start, start + pitch / 2, REACH * pitch)
    volumes = np.array([occ.getMass(*pair) for pair in half])
    centres = np.array([occ.getCenterOfMass(*pair) for pair in half])
    occ.remove(half, recursive=True)
    return np.array([volumes.sum(), *np.average(centres, axis=0, weights=volumes)])


def sides_alike(occ: Any, body: DimTags, pitch_mm: float) -> bool:
    """Tell whether both sides of x = 0 are the whole, with the same volume, centre of mass and inertia."""
    size = REACH * pitch_mm
    properties = []
    for start, sign in ((0.0, 1.0), (-size, -1.0)):
        box = occ.addBox(start, -size, -size, size, 2 * size, 2 * size)
        side, _ = occ.intersect(occ.copy(body), [(3, box)])
        if len(side) != 1:
            return False
        volume, centre = occ.getMass(*side[0]), np.array(occ.getCenterOfMass(*side[0]))
        flip = np.array([sign, 1.0, 1.0])
        inertia = np.array(occ.getMatrixOfInertia(*side[0])).reshape(3, 3) * np.outer(flip, flip)
        length = volume ** (1 / 3)
        properties.append([*centre * flip / length, *(inertia / (volume * length**2)).ravel(), volume])
        occ.remove(side, recursive=True)
    right, left = (np.array(values) for values in properties)
    parts = (right[-1] + left[-1]) / volume_mm3(occ, body)
    right[-1], left[-1] = right[-1] / left[-1], 1.0
    return bool(max(np.abs(right - left).max(), abs(parts - 1)) < ALIKE)


def _part_mm3(
    occ: Any, body: DimTags, part: tuple[float, float], ends: tuple[float, float], beside: float, reach: float
) -> float:
    start, end = part
    inner = start + beside, end - beside
    slabs = [(inner[0], inner[0] + beside)] if start != ends[0] else []
    slabs += [(inner[1] - beside, inner[1])] if end != ends[1] else []
    return sum(_volume_between(occ, body, *slab, reach) for slab in (inner, *slabs))


def _volume_between(occ: Any, body: DimTags, start: float, end: float, reach: float) -> float:
    part = slab(occ, occ.copy(body), start, end, reach)
    volume = volume_mm3(occ, part)
    occ.remove(part, recursive=True)
    return volume


def _beyond(occ: Any, body: DimTags, reach: float) -> tuple[float, float]:
    """Return two heights between which a body certainly lies."""
    boxes = np.array([occ.getBoundingBox(*pair) for pair in body])
    return float(boxes[:, 2].min()) - reach, float(boxes[:, 5].max()) + reach
