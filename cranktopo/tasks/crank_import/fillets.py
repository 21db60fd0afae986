"""Fillets of a half throw, read from its faces: round ones, ones with a recess, and ellipses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cranktopo.tasks.crank_import.fits import centred_ellipse
from cranktopo.tasks.importing.faces import Faces, TorusFace, from_line_mm, parallel
from cranktopo.tasks.importing.found_fillets import FilletRing, ring_of

_TANGENT = 1e-5
"""Allowed distance of a fillet from the journal's cylinder, over its radius."""
_TOUCH = 1e-3
"""Allowed distance of a sampled fillet from cylinder and face, over its semi-axis."""
_RECESS, _FACETS = 1e-3, 5.0
"""Least depth of a recess over the fillet's radius, and over the distance of triangles from their body."""


def fillet_keys(
    faces: Faces, radius_mm: float, y_mm: float, face: tuple[float, int], beside_mm: float = 0.0
) -> dict[str, float]:
    """Return the keys of the fillet between a journal and the web; empty where its corner is sharp.

    Args:
        faces: of the half throw, in its frame.
        radius_mm, y_mm: of the journal and its axis.
        face: z of the web's face at the journal, and the sign of z into the web.
        beside_mm: distance of triangles from the body, where the faces are fitted to such.
    """
    for torus in _tangent(faces, radius_mm, y_mm):
        deep = torus.tube_mm + face[1] * (float(torus.centre_mm[2]) - face[0])
        least = _RECESS * torus.tube_mm + _FACETS * beside_mm
        recess = {"recess_mm": deep} if least < deep < torus.tube_mm else {}
        return {"fillet_mm": torus.tube_mm, **recess}
    for ring in _rings(faces, radius_mm, y_mm, face):
        return {"fillet_mm": ring.section.radial_mm, "fillet_axial_mm": ring.section.axial_mm}
    return {}


def unread_patches(faces: Faces, radius_mm: float) -> int:
    """Return how many of the other faces are no ring about a journal and no elliptic side of a web."""
    middle = np.array([0.0, radius_mm / 2])
    return sum(
        not any(ring_of(points, y) for y in (0.0, radius_mm))
        and centred_ellipse(points[:, :2] - middle) is None
        for points in faces.patches_mm
    )


def _tangent(faces: Faces, radius_mm: float, y_mm: float) -> Iterator[TorusFace]:
    """Yield the tori that run from a journal's cylinder into the web."""
    on, z, near = np.array([0.0, y_mm, 0.0]), np.array([0.0, 0.0, 1.0]), _TANGENT * radius_mm
    for torus in faces.tori:
        about = parallel(torus.axis, z) and from_line_mm(torus.centre_mm, on, z) < near
        if about and abs(torus.ring_mm - torus.tube_mm - radius_mm) < near:
            yield torus


def _rings(faces: Faces, radius_mm: float, y_mm: float, face: tuple[float, int]) -> Iterator[FilletRing]:
    """Yield the rings of other faces that are tangent to a journal's cylinder and to the web's face."""
    for points in faces.patches_mm:
        ring = ring_of(points, y_mm)
        if ring is None:
            continue
        radial, axial = ring.section.radial_mm, ring.section.axial_mm
        foot = abs(ring.centre_radius_mm - radial - radius_mm)
        top = abs(ring.centre_z_mm + face[1] * axial - face[0])
        if foot < _TOUCH * radial and top < _TOUCH * axial:
            yield ring
