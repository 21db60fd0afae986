"""Bodies of triangles that were a crank: sheared, scaled across the crank, or with noise on their corners.

A rigid motion leaves journals round, parallel and square to the ends of the crank; what a fit to corners on
the body leaves of that is far below these limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.tasks.crank_import.fits import rms
from cranktopo.tasks.crank_import.mesh_walls import Wall
from cranktopo.tasks.importing.faces import Faces

SCATTER_MM = 0.02
"""Scatter of corners and ovality of journals up to which a body is taken: what dimensions are told to."""
LEAN_DEG = 0.05
"""The same of leaning faces and journals: `SCATTER_MM` over 23 mm, the length of a journal."""
_TOLD_MM = 2e-3
"""Scatter that is told: corners of a CAD system lie nearer to the body by far."""
_FACING = 0.9
"""Part along the crank of the normal of a face across it."""
_SMALL = 0.01
"""Area of a face that tells no direction, over that of all across the crank."""
_NOISE = "corners of the triangles scatter"
_SMOOTH = "Smooth the mesh (a scan, or one that was made coarser), or export the body from CAD, best as STEP."
_RIGID = "Move a body by rotations and translations only, and export it as it is in CAD."


@dataclass(frozen=True)
class Roundness:
    """Distances of the corners of a whole cylinder from it, by what makes them.

    Attributes:
        off_mm: distance of corners from it, root of the mean of squares.
        oval_mm: amplitude of the part of that which an ellipse has.
        lean_deg: angle of its axis to the crank's.
        noise_mm: what lean and ellipse leave of `off_mm`.
    """

    diameter_mm: float
    off_mm: float
    oval_mm: float
    lean_deg: float
    noise_mm: float


def roundness(wall: Wall) -> Roundness:
    """Return how far a whole cylinder is one; the axis of the crank is z."""
    off = wall.off(wall.points)
    angle = np.arctan2(*(wall.points[:, :2] - wall.centre).T[::-1])
    height = wall.points[:, 2] - wall.points[:, 2].mean()
    waves = [np.cos(angle), np.sin(angle)]
    slope = np.column_stack(
        [np.ones_like(off), *waves, *(height * wave for wave in waves), np.cos(2 * angle), np.sin(2 * angle)]
    )
    found = np.linalg.lstsq(slope, off, rcond=None)[0]
    return Roundness(
        2 * wall.radius,
        rms(off),
        float(np.hypot(*found[5:])),
        math.degrees(math.atan(np.hypot(*found[3:5]))),
        rms(off - slope @ found),
    )


def check_scatter(scatter_mm: float, name: str) -> None:
    """Refuse a body whose corners scatter, told from its triangles alone: no face would be found on it.

    Raises:
        CranktopoError: by how much, and what is allowed.
    """
    if scatter_mm > SCATTER_MM:
        raise CranktopoError(
            f"{name}: {_NOISE} by about {scatter_mm:.2g} mm (at most {SCATTER_MM:g} mm): nine tenths of "
            "them have no neighbour in their plane.",
            hint=_SMOOTH,
        )


def scatter_words(scatter_mm: float) -> list[str]:
    """Tell the scatter of corners where that is more than what a CAD system leaves."""
    return [f"{_NOISE} by about {scatter_mm:.2g} mm"] if scatter_mm > _TOLD_MM else []


def check_undistorted(faces: Faces, journals: Sequence[Roundness], axis: Array, name: str) -> None:
    """Refuse a body whose journals are oval, lean or scatter, or whose faces all lean against its axis.

    Raises:
        CranktopoError: one of these, by how much, and what is allowed.
    """
    worst = max(journals, key=lambda one: one.off_mm, default=None)
    if worst is not None and worst.off_mm > SCATTER_MM:
        raise CranktopoError(f"{name}: {_unround(worst)}.", hint=_RIGID if _is_bent(worst) else _SMOOTH)
    lean = least_lean_deg(faces, axis)
    if lean > LEAN_DEG:
        raise CranktopoError(
            f"{name}: is sheared: no face stands square to its journals, the least leaning one is off by "
            f"{lean:.3g} deg (at most {LEAN_DEG:g} deg).",
            hint=_RIGID,
        )


def _is_bent(journal: Roundness) -> bool:
    return journal.noise_mm < journal.off_mm / 2


def _unround(journal: Roundness) -> str:
    own = f"journal of {journal.diameter_mm:.4g} mm"
    if not _is_bent(journal):
        return f"{_NOISE} by {journal.off_mm:.2g} mm about a {own} (at most {SCATTER_MM:g} mm)"
    if journal.oval_mm > journal.off_mm:
        return (
            f"a {own} is oval by {journal.oval_mm:.2g} mm (at most {SCATTER_MM:g} mm): the body is sheared, "
            "or scaled in one direction"
        )
    return f"a {own} leans by {journal.lean_deg:.2g} deg to the crank axis (at most {LEAN_DEG:g} deg)"


def least_lean_deg(faces: Faces, axis: Array) -> float:
    """Return the least angle to the crank axis of the normals of faces across it; 0 without any."""
    leans = _leans_deg(faces, axis)
    total = sum(area for area, _ in leans)
    return min((lean for area, lean in leans if area > _SMALL * total), default=0.0)


def _leans_deg(faces: Faces, axis: Array) -> list[tuple[float, float]]:
    """Return areas and leans of the faces across an axis."""
    return [
        (
            plane.area_mm2,
            math.degrees(math.asin(min(1.0, float(np.linalg.norm(np.cross(plane.normal, axis)))))),
        )
        for plane in faces.planes
        if abs(plane.normal @ axis) > _FACING
    ]


def remarks(faces: Faces, journals: Iterable[Roundness], axis: Array) -> list[str]:
    """Tell what an undistorted body has of these: noise within the limit, webs whose faces lean."""
    _, lean = max(_leans_deg(faces, axis), default=(0.0, 0.0))
    found = [f"faces of the webs lean by {lean:.3g} deg, as draft does"] if lean > LEAN_DEG else []
    off = max((one.off_mm for one in journals), default=0.0)
    return found + (
        [f"{_NOISE} by {off:.2g} mm about the journals: no dimension is better"] * (off > _TOLD_MM)
    )


def noise_named(error: CranktopoError, told: Iterable[str]) -> CranktopoError:
    """Return the error of a body with the noise that was told of it as its likely cause."""
    noise = next((line for line in told if line.startswith(_NOISE)), None)
    if noise is None:
        return error
    by = noise.partition(":")[0]
    return CranktopoError(
        f"{error.message.rstrip('.')}; {by}, which may be why.", hint=_SMOOTH, code=error.code
    )
