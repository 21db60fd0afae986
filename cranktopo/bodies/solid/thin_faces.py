"""Faces that are thinner than another CAD kernel may mesh.

A pocket whose corner just reaches the outline, or drillings of unlike webs whose mouths nearly agree in the
middle of the crankpin, leave faces some micrometres wide. They are as designed, and a file with them is
valid, but triangles of another kernel may not close there (`python -m tests.studies.second_kernel`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cranktopo.base.units import plain_number
from cranktopo.bodies.solid.boundaries import edges_of, faces_of
from cranktopo.numerics.gmsh_session import DimTags

_THIN_MM = 0.01
"""Width of a face, on a throw of usual size."""


@dataclass(frozen=True)
class ThinFace:
    """A thin face: twice its area over its circumference, and its middle, mm."""

    width_mm: float
    middle_mm: tuple[float, float, float]


def thin_faces(occ: Any, body: DimTags, scale: float) -> list[ThinFace]:
    """Return the faces of a body that are too thin, the thinnest first.

    Args:
        scale: factor that brings the throw to usual size.
    """
    found = (_measured(occ, face) for face in faces_of(occ, body))
    return sorted((one for one in found if one.width_mm < _THIN_MM / scale), key=lambda one: one.width_mm)


def thin_face_words(thin: list[ThinFace]) -> str:
    """Return what is to be known of thin faces, which must be some."""
    place = ", ".join(plain_number(value, 4) for value in thin[0].middle_mm)
    which = "a face is only" if len(thin) == 1 else f"{len(thin)} faces are very thin, the thinnest"
    width = plain_number(1e3 * thin[0].width_mm, 2)
    return (
        f"{which} {width} um wide, at ({place}) mm: other CAD may leave gaps in their triangles there. "
        "Move what meets there by 0.1 mm"
    )


def _measured(occ: Any, face: int) -> ThinFace:
    around = sum(float(occ.getMass(1, edge)) for edge in edges_of(occ, face))
    x, y, z = map(float, occ.getCenterOfMass(2, face))
    return ThinFace(2 * float(occ.getMass(2, face)) / around, (x, y, z))
