"""Thickness of a web where it takes over from its journals."""

from __future__ import annotations

import numpy as np

from cranktopo.base.frames import X, Y, Z
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of

RAYS = 61
_OUTSIDE = 1.02
_BEYOND_MM = 1.0


def transition_mm(web: SurfaceMesh, scene: Scene) -> float:
    """Return minimum axial thickness of a web around its journals, on the half turned to the other journal.

    Rays parallel to the crank axis on a circle just outside each journal; what a force takes from one
    journal to the other crosses that half circle.

    Returns:
        Thickness, mm; 0 where a ray meets no material.
    """
    body = solid_of(web, "web")
    low, high = scene.web_z_mm[0] - _BEYOND_MM, scene.web_z_mm[1] + _BEYOND_MM
    throw = scene.throw
    angles = np.linspace(-np.pi / 2, np.pi / 2, RAYS + 2)[1:-1]
    least = np.inf
    for journal, centre, side in ((throw.main_journal, 0.0, 1.0), (throw.crankpin, throw.radius_mm, -1.0)):
        radius = _OUTSIDE * journal.radius_mm
        for angle in angles:
            place = np.zeros(3)
            place[X], place[Y] = radius * np.sin(angle), centre + side * radius * np.cos(angle)
            if _in_other_bore(place, scene):
                continue
            hits = body.ray_cast((place[X], place[Y], low), (place[X], place[Y], high))
            cuts = np.array([hit.position[Z] for hit in hits]).reshape(-1, 2)
            least = min(least, float(np.diff(cuts).sum()))
    return least


def _in_other_bore(place: np.ndarray, scene: Scene) -> bool:
    """Tell whether a place lies in a bore of an overlapping journal, which is no fault of the web."""
    return any(
        np.hypot(place[X], place[Y] - centre) <= _OUTSIDE * journal.bore_radius_mm
        for journal, centre in scene.throw.journals
    )
