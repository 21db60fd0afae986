"""Design envelopes given as closed surface meshes."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.errors import invalid
from cranktopo.triangles.shells import shell_volumes_mm3
from cranktopo.triangles.surface_files import read_stl
from cranktopo.triangles.surface_mesh import SurfaceMesh, solid_of

_KEY = "envelope.file"
_ALIKE = 1e-6
_LEAST_MM = 2.0
"""No web is smaller, in metres every one is."""


def envelope_from_stl(path: Path) -> Manifold:
    """The closed body in a surface mesh file, mm, in the frame of `cranktopo.frames`.

    Raises:
        CranktopoError: the file is missing, unreadable, in metres, or its surface is not that of one body.
    """
    return solid_of(_closed_surface(path), f"{_KEY} = '{path}'")


def bounds_mm(path: Path) -> tuple[float, float, float, float]:
    """Range of the body: (x_min, x_max, y_min, y_max), mm."""
    box = envelope_from_stl(path).bounding_box()
    return box[0], box[3], box[1], box[4]


def check_symmetric(path: Path) -> None:
    """Check that the body is its own mirror image in x = 0.

    Raises:
        CranktopoError: both sides differ by more than a millionth of the volume.
    """
    body = envelope_from_stl(path)
    share = mirror_difference(body)
    if share > _ALIKE:
        raise invalid(
            "envelope.symmetric",
            True,
            f"the sides of '{path}' differ by {100 * share:.3g} % of its volume",
            "Set it to false.",
        )


def mirror_difference(body: Manifold) -> float:
    """Volume of a body outside its mirror image in x = 0, over that of the body; 0 for an empty one."""
    outside = (body - body.mirror((1.0, 0.0, 0.0))).volume()
    return float(outside / body.volume()) if outside else 0.0


def section(path: Path, z_mm: float) -> list[NDArray[np.float64]]:
    """Closed contours (n, 2) of the body's cross-section at a height z, mm."""
    return [np.asarray(contour) for contour in envelope_from_stl(path).slice(z_mm).to_polygons()]


@lru_cache(maxsize=4)
def _closed_surface(path: Path) -> SurfaceMesh:
    surface = read_stl(path, f"{_KEY} = '{path}'")
    if len(surface.faces) == 0:
        raise invalid(_KEY, str(path), "holds no triangles", "Export the surface again as STL, mm.")
    largest = float(np.ptp(surface.vertices_mm, axis=0).max())
    if largest < _LEAST_MM:
        raise invalid(_KEY, str(path), f"is {largest:.3g} mm large", "It is in metres: export it in mm.")
    mesh = surface.as_trimesh()
    if not mesh.is_watertight:
        raise invalid(_KEY, str(path), "must be a closed surface", "Close its holes.")
    if not mesh.is_winding_consistent or surface.volume_mm3 <= 0:
        raise invalid(_KEY, str(path), "must be a closed, outward-oriented surface", "Repair the mesh.")
    bodies = int((shell_volumes_mm3(surface) > 0).sum())
    if bodies > 1:
        raise invalid(_KEY, str(path), f"holds {bodies} separate bodies", "Remove the loose parts.")
    return surface
