"""Surfaces read from and written to the files of CAD, meshers, printers and viewers."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import BinaryIO

import numpy as np

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import GEOMETRY_LIMIT_MIB, as_path, check_input, write_bytes
from cranktopo.base.formats import SurfaceFormat
from cranktopo.base.notes import note
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, welded, without_doubles

_METRES_PER_MM = 1e-3
_FARTHEST_MM = 1e6
_WELD = 1e-7
"""Distance of vertices over the size of a surface below which they may be one: single precision."""
_3MF_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>"
)
_3MF_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
_3MF_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<model unit="millimeter" xml:lang="en-US" '
    'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
    '<object id="1" type="model"><mesh><vertices>'
)
_3MF_TAIL = '</triangles></mesh></object></resources><build><item objectid="1"/></build></model>'


def write_surface(path: Path, mesh: SurfaceMesh, form: SurfaceFormat) -> None:
    """Write a mesh atomically in mm (STL in single precision, 3MF), or, as GLB demands, in metres."""
    write_bytes(path, {"stl": _stl, "3mf": _3mf, "glb": _glb}[form](mesh))


def write_stl(path: Path | str, mesh: SurfaceMesh) -> None:
    """Write a mesh as `write_surface` does, as STL."""
    path = as_path(path)
    write_surface(path, mesh, "stl")


def read_stl(path: Path, name: str = "") -> SurfaceMesh:
    """Return the surface in an STL file, mm, vertices joined, triangles with a vertex twice left out.

    Raises:
        CranktopoError: it cannot be read, holds no triangles, or coordinates that are no numbers.
    """
    name = name or f"'{path}'"
    check_input(path, name, GEOMETRY_LIMIT_MIB, "Give a closed STL in mm.")
    try:
        with path.open("rb") as file:
            surface = _of_stl(file)
    except Exception as error:  # trimesh raises what its parsers raise, all meaning this
        raise CranktopoError(
            f"{name}: cannot be read as STL: {quoted(str(error))}.", hint="Export it again as STL, mm."
        ) from None
    if not (np.abs(surface.vertices_mm) <= _FARTHEST_MM).all():  # false for NaN as well
        raise CranktopoError(
            f"{name}: holds coordinates that are no numbers or beyond {_FARTHEST_MM:g} mm.",
            hint="Export it again as STL, mm.",
        )
    surface = without_flat(surface, name)
    if not len(surface.faces):
        raise CranktopoError(f"{name}: holds no triangles.", hint="Export it again as STL, mm.")
    return surface if surface.as_trimesh().is_watertight else _welded(surface, name)


def _welded(surface: SurfaceMesh, name: str) -> SurfaceMesh:
    """Return a surface with vertices joined that rounding alone keeps apart, where that closes it."""
    apart = _WELD * float(np.ptp(surface.vertices_mm, axis=0).max())
    joined = welded(surface, apart)
    fewer = len(surface.vertices_mm) - len(joined.vertices_mm)
    if not fewer or not joined.as_trimesh().is_watertight:
        return surface
    note(f"{name}: {fewer} vertices within {apart:.2g} mm of others are joined with them.")
    return joined


def as_stored(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return what `read_stl` reads of a mesh that was written: single precision, vertices joined."""
    return without_doubles(_of_stl(io.BytesIO(_stl(mesh))))


def without_flat(surface: SurfaceMesh, name: str) -> SurfaceMesh:
    """Return the surface of a file without triangles that have a vertex twice, and tell their number."""
    found = without_doubles(surface)
    fewer = len(surface.faces) - len(found.faces)
    if fewer:
        note(f"{name}: {fewer} triangle{'s' * (fewer > 1)} without area left out")
    return found


def _of_stl(file: BinaryIO) -> SurfaceMesh:
    import trimesh

    mesh = trimesh.load_mesh(file, file_type="stl")
    return SurfaceMesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64))


def _stl(mesh: SurfaceMesh) -> bytes:
    import trimesh

    content: bytes = trimesh.exchange.stl.export_stl(mesh.as_trimesh())
    return content


def _glb(mesh: SurfaceMesh) -> bytes:
    in_metres = SurfaceMesh(mesh.vertices_mm * _METRES_PER_MM, mesh.faces)
    content: bytes = in_metres.as_trimesh().export(file_type="glb")
    return content


def _3mf(mesh: SurfaceMesh) -> bytes:
    """Return a package of one model (3MF core specification 1.3); a fixed date gives the same bytes again."""
    vertices = "".join(
        f'<vertex x="{x!s}" y="{y!s}" z="{z!s}"/>' for x, y, z in mesh.vertices_mm.astype(np.float32)
    )
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.faces)
    model = f"{_3MF_HEAD}{vertices}</vertices><triangles>{faces}{_3MF_TAIL}"
    parts = {"[Content_Types].xml": _3MF_TYPES, "_rels/.rels": _3MF_RELATIONS, "3D/3dmodel.model": model}
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as package:
        for name, text in parts.items():
            package.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    return content.getvalue()
