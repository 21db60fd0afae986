"""Envelopes and original webs given as STL, or as STEP, which becomes a surface here, and their holes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, reduce
from pathlib import Path

import numpy as np
from manifold3d import CrossSection, FillRule, Manifold
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.frames import Z
from cranktopo.base.spans import Section, polygon_area, polygon_section
from cranktopo.bodies.solid.step import STEP_SUFFIXES, step_surface
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, shell_volumes_mm3, snapped, solid_of
from cranktopo.throw.envelope import Envelope

_KEY = "envelope.file"
_ALIKE = 1e-6
"""Difference of the sides, over the volume, that is rounding."""
_MESHED = 5e-4
"""The same for two sides of one shape that were triangulated differently."""
_ROUNDED_MM = 1e-4
"""Largest distance that the digits of a file, of metres even, may move a face by."""
_LEAST_MM = 2.0
"""No web is smaller, in metres every one is."""

SECTIONS = 32
"""Layers of a body of triangles, whose section changes along the crank axis."""


def envelope_from_file(path: Path, symmetric: bool = False, key: str = _KEY) -> Manifold:
    """Return the closed body in an STL or STEP file, mm, in the frame of `cranktopo.base.frames`.

    Args:
        symmetric: the body is its own mirror image in x = 0; sides that differ by their triangles are made so
            from the side x >= 0.
        key: of the file in the scene, for messages.

    Raises CranktopoError: the file is missing, unreadable, in metres, not one body with a closed surface, or
    not symmetric though it should be.
    """
    return _body((_symmetric_surface(path, key)[0] if symmetric else _closed_surface(path, key)), path, key)


def with_faces_at(body: Manifold, *heights_mm: float) -> Manifold:
    """Return a body whose corners that a file rounds beside a height (mm) are moved onto it.

    An STL holds 85.605 mm as 85.605003: what is cut or joined at that height would leave slivers.
    """

    def moved(points_mm: Array) -> Array:
        for height in heights_mm:
            snapped(points_mm, Z, height, _ROUNDED_MM)
        return points_mm

    return body.warp_batch(moved)


@lru_cache(maxsize=4)
def bounds_mm(path: Path, symmetric: bool = False, key: str = _KEY) -> tuple[float, float, float, float]:
    """Return the range of the body: (x_min, x_max, y_min, y_max), mm; a plan asks for it seven times."""
    box = envelope_from_file(path, symmetric, key).bounding_box()
    return box[0], box[3], box[1], box[4]


def symmetrised(path: Path) -> str:
    """Tell what was done to make a body its own mirror image in x = 0, in words; empty for nothing."""
    share = _symmetric_surface(path, _KEY)[1]
    if share <= _ALIKE:
        return ""
    return (
        f"envelope '{path.name}': its sides differ by {100 * share:.2g} % of its volume; the side x >= 0 and "
        "its mirror image are taken"
    )


def mirror_difference(body: Manifold) -> float:
    """Return the volume of a body outside its mirror image in x = 0, over its own; 0 for an empty one."""
    outside = (body - body.mirror((1.0, 0.0, 0.0))).volume()
    return float(outside / body.volume()) if outside else 0.0


def section(path: Path, z_mm: float, symmetric: bool = False) -> list[NDArray[np.float64]]:
    """Return closed contours (n, 2) of the body's cross-section at a height z, mm."""
    return [np.asarray(contour) for contour in envelope_from_file(path, symmetric).slice(z_mm).to_polygons()]


def envelope_section(envelope: Envelope, z_mm: float) -> Section:
    """Return the envelope's cross-section at a height; only a mesh changes along the crank axis."""
    return (
        polygon_section(section(envelope.stl_file, z_mm, not envelope.asymmetry))
        if envelope.stl_file
        else envelope.spans
    )


def envelope_sections(envelope: Envelope) -> int:
    """Return the number of layers that the envelope is cut into."""
    return SECTIONS if envelope.stl_file else 1


def envelope_bounds_mm(envelope: Envelope) -> tuple[float, float, float, float]:
    """Return ranges that hold the envelope: (x_min, x_max, y_min, y_max), mm."""
    return bounds_mm(envelope.stl_file, not envelope.asymmetry) if envelope.stl_file else envelope.bounds_mm


def _body(surface: SurfaceMesh, path: Path, key: str) -> Manifold:
    return solid_of(surface, f"{key} = '{path}'")


@lru_cache(maxsize=4)
def _symmetric_surface(path: Path, key: str) -> tuple[SurfaceMesh, float]:
    surface = _closed_surface(path, key)
    body = _body(surface, path, key)
    share = mirror_difference(body)
    if share > _MESHED:
        raise invalid(
            f"{key.removesuffix('.file')}.symmetric",
            True,
            f"the sides of '{path}' differ by {100 * share:.3g} % of its volume",
            "Set it to false.",
        )
    if share > _ALIKE:
        half = body.trim_by_plane((1.0, 0.0, 0.0), 0.0)
        surface = mesh_of(half + half.mirror((1.0, 0.0, 0.0)))
    return surface, share


@lru_cache(maxsize=4)
def _closed_surface(path: Path, key: str) -> SurfaceMesh:
    name = f"{key} = '{path}'"
    surface = step_surface(path, name) if path.suffix.lower() in STEP_SUFFIXES else read_stl(path, name)
    if len(surface.faces) == 0:
        raise invalid(key, str(path), "holds no triangles", "Export the surface again as STL, mm.")
    largest = float(np.ptp(surface.vertices_mm, axis=0).max())
    if largest < _LEAST_MM:
        raise invalid(key, str(path), f"is {largest:.3g} mm large", "It is in metres: export it in mm.")
    mesh = surface.as_trimesh()
    if not mesh.is_watertight:
        raise invalid(key, str(path), "must be a closed surface", "Close its holes.")
    if not mesh.is_winding_consistent or surface.volume_mm3 <= 0:
        raise invalid(key, str(path), "must be a closed, outward-oriented surface", "Repair the mesh.")
    bodies = int((shell_volumes_mm3(surface) > 0).sum())
    if bodies > 1:
        raise invalid(key, str(path), f"holds {bodies} separate bodies", "Remove the loose parts.")
    return surface


def envelope_z_mm(scene: Scene) -> tuple[float, float]:
    """Return the axial range that the envelope may fill: that of the web less the clearances."""
    start, end = scene.web_z_mm
    envelope = scene.envelope
    if envelope is None:
        return start, end
    return start + envelope.bearing_clearance_mm, end - envelope.rod_clearance_mm


def through_holes(scene: Scene, heights_mm: Sequence[float]) -> list[list[Array]]:
    """Return contours (n, 2), mm, of the holes at each height; none where the envelope may not be.

    A hole counts with all its steps and chamfers if some line along the crank axis passes through it at all
    the heights.
    """
    low, high = envelope_z_mm(scene)
    inside = [low < z < high for z in heights_mm]
    layers = [_holes(scene, z) if within else [] for z, within in zip(heights_mm, inside, strict=True)]
    regions = [_region(layer) for layer, within in zip(layers, inside, strict=True) if within]
    if not regions or any(region.is_empty() for region in regions):
        return [[] for _ in heights_mm]
    through = reduce(lambda a, b: a ^ b, regions)
    return [[c for c in layer if not (_region([c]) ^ through).is_empty()] for layer in layers]


def _holes(scene: Scene, z_mm: float) -> list[Array]:
    """Inner contours of the envelope's cross-section; none where its file is gone."""
    envelope = scene.envelope
    if envelope is None or envelope.stl_file is None or not envelope.stl_file.is_file():
        return []
    contours = section(envelope.stl_file, z_mm, not envelope.asymmetry)
    return [contour for contour in contours if polygon_area(contour) < 0]


def _region(contours: list[Array]) -> CrossSection:
    return CrossSection(contours, FillRule.NonZero) if contours else CrossSection()
