"""What a surface must satisfy before it is written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.surface.half_throw import WebSurface
from cranktopo.triangles.self_intersections import self_intersections_mm
from cranktopo.triangles.shells import connected, shell_volumes_mm3
from cranktopo.triangles.surface_mesh import DEGENERATE_MM2, SurfaceMesh

VOLUME_TOLERANCE_PERCENT = 0.5


@dataclass(frozen=True)
class SurfaceReport:
    """Measured values of a surface that passed.

    Attributes:
        bodies: outer shells.
        cavities: inner shells (closed hollows).
        web_volume_error_percent: against the volume of the density, with sign.
    """

    vertices: int
    faces: int
    bodies: int
    cavities: int
    volume_mm3: float
    web_volume_mm3: float
    web_volume_error_percent: float


def surface_json(surface: WebSurface, report: SurfaceReport) -> dict[str, Any]:
    """What a checked surface is, as metrics.json and `extract --json` hold it."""
    return {
        "iso_value": surface.iso_value,
        "web_volume_mm3": surface.volume_mm3,
        "web_volume_error_percent": report.web_volume_error_percent,
        "faces": report.faces,
        "bodies": report.bodies,
        "cavities": report.cavities,
        "dropped_islands": surface.dropped_islands,
        "dropped_volume_mm3": surface.dropped_volume_mm3,
        "x_symmetric": surface.x_symmetric,
    }


def check_surface(surface: WebSurface) -> SurfaceReport:
    """Check that the surface is one sound body with the volume of the density.

    Returns:
        The measured values.

    Raises:
        CranktopoError: first check that fails, with code CRITERION_NOT_MET.
    """
    mesh = surface.half_throw
    check_manifold(mesh)
    check_self_intersection(mesh)
    shells = shell_volumes_mm3(mesh)
    bodies = int((shells > 0).sum())
    if bodies != 1:
        raise _failed(
            f"{bodies} separate bodies instead of 1", "Raise the volume fraction or the resolution."
        )
    error = 100 * (surface.volume_mm3 / surface.target_volume_mm3 - 1)
    if not abs(error) <= VOLUME_TOLERANCE_PERCENT:
        raise _failed(
            f"the web has {surface.volume_mm3:.0f} mm3, {error:+.2f} % of the density's "
            f"{surface.target_volume_mm3:.0f} mm3 (allowed {VOLUME_TOLERANCE_PERCENT} %; "
            f"{surface.dropped_islands} islands with {surface.dropped_volume_mm3:.0f} mm3 left out)",
            "Run more iterations, or raise the filter radius so that no islands form.",
        )
    return SurfaceReport(
        vertices=len(mesh.vertices_mm),
        faces=len(mesh.faces),
        bodies=bodies,
        cavities=len(shells) - bodies,
        volume_mm3=mesh.volume_mm3,
        web_volume_mm3=surface.volume_mm3,
        web_volume_error_percent=error,
    )


def check_manifold(mesh: SurfaceMesh) -> None:
    """Check that a mesh is a closed, outward-oriented 2-manifold without degenerate faces.

    Raises:
        CranktopoError: first property that fails, with code CRITERION_NOT_MET.
    """
    remedy = "Extract again at another resolution."
    surface = mesh.as_trimesh()
    if not surface.is_watertight:
        raise _failed("not watertight, or more than two faces at an edge", remedy)
    if not surface.is_winding_consistent:
        raise _failed("its faces are not oriented alike", remedy)
    if mesh.volume_mm3 <= 0:
        raise _failed(f"inside out (volume {mesh.volume_mm3:.3g} mm3)", "Reverse the faces.")
    pinched = _pinched_vertices(surface)
    if pinched:
        raise _failed(f"not a 2-manifold, surfaces touch in {pinched} single vertices", remedy)
    degenerate = int((mesh.areas_mm2 <= DEGENERATE_MM2).sum())
    if degenerate:
        raise _failed(f"{degenerate} degenerate faces", remedy)


def check_self_intersection(mesh: SurfaceMesh) -> None:
    """Check that no edge of a closed mesh pierces a face that it does not touch.

    Raises:
        CranktopoError: the surface intersects itself, with code CRITERION_NOT_MET.
    """
    places = self_intersections_mm(mesh)
    if len(places):
        where = ", ".join(f"{value:.2f}" for value in places[0])
        raise _failed(f"it intersects itself near ({where}) mm", "Extract again at another resolution.")


def _pinched_vertices(surface: Any) -> int:
    """How many more fans of faces there are than vertices: 0 for a 2-manifold."""
    faces = np.asarray(surface.faces)
    links = []
    for end in (0, 1):
        shared = surface.face_adjacency_edges[:, end]
        # corner number = 3 * face + place of the shared vertex in it
        places = [np.argmax(faces[f] == shared[:, None], axis=1) for f in surface.face_adjacency.T]
        links.append(3 * surface.face_adjacency + np.stack(places, axis=1))
    fans = connected(faces.size, np.concatenate(links)).max() + 1
    return int(fans - len(np.unique(faces)))


def _failed(what: str, remedy: str) -> CranktopoError:
    return CranktopoError(f"surface: {what}.", hint=remedy, code=ExitCode.CRITERION_NOT_MET)
