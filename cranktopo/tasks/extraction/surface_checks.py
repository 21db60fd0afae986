"""Checks that a surface passes before it is written."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.numerics.surfaces.mesh import (
    check_manifold,
    check_self_intersection,
    shell_volumes_mm3,
    surface_refusal,
)
from cranktopo.tasks.extraction.half_throw import WebSurface

_VOLUME_TOLERANCE_PERCENT = 0.5


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
        raise surface_refusal(
            f"{bodies} separate bodies instead of 1", "Raise the volume fraction or the resolution."
        )
    error = 100 * (surface.volume_mm3 / surface.target_volume_mm3 - 1)
    if not abs(error) <= _VOLUME_TOLERANCE_PERCENT:
        raise surface_refusal(
            f"the web has {surface.volume_mm3:.0f} mm3, {error:+.2f} % of the density's "
            f"{surface.target_volume_mm3:.0f} mm3 (allowed {_VOLUME_TOLERANCE_PERCENT} %; "
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
