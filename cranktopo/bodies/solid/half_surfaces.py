"""Surfaces of the two halves of a throw that differ, cut out of the whole: a drilling may reach across."""

from __future__ import annotations

from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of


def half_surfaces(scene: Scene, facet_mm: float | None = None) -> tuple[SurfaceMesh, SurfaceMesh]:
    """Closed triangle meshes of both half throws, each in the frame of its half.

    Args:
        facet_mm: edge length of the triangles; by default as `surface_of`.

    Raises:
        CranktopoError: impossible dimensions.
    """
    throw, middle = solid_of(surface_of(scene, "throw", facet_mm), "throw"), halves(scene)[0].pitch_mm / 2
    first = throw.trim_by_plane((0.0, 0.0, -1.0), -middle)
    second = throw.trim_by_plane((0.0, 0.0, 1.0), middle).mirror((0.0, 0.0, 1.0))
    return mesh_of(first), mesh_of(second.translate((0.0, 0.0, scene.pitch_mm)))
