"""Facets of a body as an STL file holds them: closed, or told where they are open."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.bodies.solid.step import WELD_MM, closed_surface

if TYPE_CHECKING:
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

OTHER_SIZES = (0.9, 1.15)
"""Facets that are tried in place of some that do not close, over their size."""


def closed_facets(mesh: SurfaceMesh) -> SurfaceMesh | None:
    """Return facets that are closed and turned alike in single precision, as they are or joined; else None.

    Faces of the kernel may end in two edges up to their tolerance apart, where bores share a mouth say.
    """
    from cranktopo.numerics.surfaces.mesh import welded

    if _is_closed(mesh):
        return mesh
    joined = closed_surface(welded(mesh, WELD_MM))
    return joined if _is_closed(joined) else None


def open_error(name: str, mesh: SurfaceMesh, facets_mm: list[float]) -> CranktopoError:
    """Return the error of facets that do not close at any of some sizes, the first of which is `mesh`."""
    sizes = ", ".join(f"{size:.3g}" for size in facets_mm)
    return solver_error(
        f"{name}: its facets of {sizes} mm are no closed surface: {_where_open(mesh)}; nothing is written.",
        "Give another --facet-mm, or export STEP, which has the exact faces.",
    )


def _is_closed(mesh: SurfaceMesh) -> bool:
    from cranktopo.numerics.surfaces.files import as_stored

    surface = as_stored(mesh).as_trimesh()
    return bool(surface.is_watertight and surface.is_winding_consistent and surface.volume > 0)


def _where_open(mesh: SurfaceMesh) -> str:
    from cranktopo.numerics.surfaces.files import as_stored

    stored = as_stored(mesh)
    sides = np.sort(np.concatenate([stored.faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    wrong = edges[count != 2]
    if not len(wrong):
        return "faces are not turned alike"
    place = ", ".join(f"{value:.1f}" for value in stored.vertices_mm[wrong[0]].mean(axis=0))
    return f"{len(wrong)} edges have not two faces, one of them at ({place}) mm"
