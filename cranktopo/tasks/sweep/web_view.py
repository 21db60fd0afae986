"""The web of a point for the sweep's page: the body that was judged, in some kilobytes."""

from __future__ import annotations

from cranktopo.bodies.solid.files import coarse_facet_mm, half_surfaces, surface_of
from cranktopo.design.halves import difference, halves
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.viewer.scene3d import PARTNERS, ShownBody
from cranktopo.report.viewer.small_web import packed_web
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.importing.imported_body import half_throw_surface

_COARSER = 2
"""Than what a page shows of a single web: a quarter of the triangles, in half the time."""


def web_view(target: Target) -> str:
    """Return the half throw of a target, or both where they differ, as text that a browser draws."""
    scene = target.scene
    facet_mm = _COARSER * coarse_facet_mm(scene)
    meshes: tuple[SurfaceMesh, ...]
    if difference(scene):
        meshes = half_surfaces(scene, facet_mm)
    elif target.file is not None:
        meshes = (half_throw_surface(target.file, scene),)
    else:
        meshes = (surface_of(scene, "half", facet_mm),)
    shown = zip(meshes, halves(scene), PARTNERS[len(meshes)], strict=False)
    return packed_web(
        *(
            ShownBody(target.name, mesh, half.web_z_mm, half.pitch_mm / 2, partner=partner)
            for mesh, half, partner in shown
        )
    )
