"""The solids of a step: half throw as STEP and STL, web as the next step's envelope."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import NamedTuple

import numpy as np
from manifold3d import Manifold

from cranktopo.base.frames import X, Y, Z
from cranktopo.bodies.prisms import snapped_to_mirror_plane, web_region
from cranktopo.bodies.solid.files import coarse_facet_mm, export_solid, surface_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import as_stored, read_stl, write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, manifold_fault, mesh_of, solid_of
from cranktopo.tasks.importing.imported_body import half_throw_surface

_RAYS = 61
_OUTSIDE = 1.02
_BEYOND_MM = 1.0

WEB = "web_only.stl"
HALF = "web"
_X_AXIS = (1.0, 0.0, 0.0)
_SIMPLIFY_MM = (2e-3, 4e-3, 1e-3, 8e-3)
"""How far simplification may move the surface, from attempt to attempt."""


class Solids(NamedTuple):
    """Surfaces of the half throw and of the web alone, mm, as their files hold them."""

    half: SurfaceMesh
    web: SurfaceMesh


def write_solids(scene: Scene, folder: Path, started: datetime | None = None) -> Solids:
    """Write web.step and web.stl (half throw, exact solid) and the web alone.

    `started` dates the STEP file, so that a loop that is resumed writes the same bytes; by default it is now.

    Raises:
        CranktopoError: the CAD kernel cannot build the solid, or a file cannot be written.
    """
    facet = coarse_facet_mm(scene)
    export_solid(scene, "half", folder / f"{HALF}.step", started=started)
    return _written(surface_of(scene, "half", facet), surface_of(scene, "web", facet), folder)


def write_original(path: Path, scene: Scene, folder: Path) -> Solids:
    """Write the half throw of a body from CAD and its web as the solids of a step.

    Raises:
        CranktopoError: it is no half throw where the journals are, or a file cannot be written.
    """
    surface = half_throw_surface(path, scene)
    return _written(surface, mesh_of(web_region(solid_of(surface, str(path)), scene)), folder)


def _written(half: SurfaceMesh, web: SurfaceMesh, folder: Path) -> Solids:
    write_stl(folder / f"{HALF}.stl", half)
    write_stl(folder / WEB, web)
    return Solids(as_stored(half), as_stored(web))


def read_solids(folder: Path) -> Solids:
    """Return the solids of a step that an earlier go of the loop wrote."""
    return Solids(read_stl(folder / f"{HALF}.stl"), read_stl(folder / WEB))


def write_envelope(web: SurfaceMesh, folder: Path) -> Path:
    """Write the web of a step as an envelope that is exactly its own mirror image, once; return its path."""
    path = folder / "envelope.stl"
    if not path.is_file():
        write_stl(path, _symmetric(solid_of(web, f"web of {folder.name}")))
    return path


def _symmetric(body: Manifold) -> SurfaceMesh:
    """Return the surface of the side x >= 0 and its mirror image.

    It is simplified before it is mirrored, else it is lopsided. Points that are put on x = 0 may leave a
    crack without width there: then it is simplified otherwise.
    """
    for tolerance_mm in _SIMPLIFY_MM:
        half = (
            body.trim_by_plane(_X_AXIS, 0.0)
            .warp_batch(snapped_to_mirror_plane)
            .simplify(tolerance_mm)
            .warp_batch(snapped_to_mirror_plane)
        )
        mesh = mesh_of(half + half.mirror(_X_AXIS))
        if not manifold_fault(mesh):
            break
    return mesh


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
    angles = np.linspace(-np.pi / 2, np.pi / 2, _RAYS + 2)[1:-1]
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
