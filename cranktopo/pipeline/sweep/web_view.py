"""The web of a point for the sweep's page: the body that was judged, in some kilobytes."""

from __future__ import annotations

from cranktopo.cad.solid_files import coarse_facet_mm, surface_of
from cranktopo.evaluate.targets import Target
from cranktopo.meshing.imported_body import half_throw_surface
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.report.viewer.small_web import packed_web

VIEW = "view"
"""What a result calls it; only the page shows it, tables leave it out."""
_COARSER = 2
"""Than what a page shows of a single web: a quarter of the triangles, in half the time."""


def web_view(target: Target) -> str:
    """The half throw of a target as text that a browser draws."""
    scene = target.scene
    if target.file is not None:
        mesh = half_throw_surface(target.file, scene)
    else:
        mesh = surface_of(scene, "half", _COARSER * coarse_facet_mm(scene))
    return packed_web(ShownBody(target.name, mesh, scene.web_z_mm, scene.pitch_mm / 2))
