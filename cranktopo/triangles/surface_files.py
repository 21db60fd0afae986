"""The surface as a file that CAD, meshers, printers and viewers read."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np

from cranktopo.formats import SurfaceFormat
from cranktopo.store.files import write_bytes
from cranktopo.triangles.surface_mesh import SurfaceMesh

_METRES_PER_MM = 1e-3
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
    """Write a mesh atomically.

    Args:
        path: the file.
        mesh: closed mesh, mm.
        form: binary STL or 3MF, both in mm in the frame of `cranktopo.frames`, or GLB for viewers: metres,
            as its specification demands, in the same frame.

    Raises:
        CranktopoError: the file cannot be written.
    """
    write_bytes(path, {"stl": _stl, "3mf": _3mf, "glb": _glb}[form](mesh))


def write_stl(path: Path, mesh: SurfaceMesh) -> None:
    """Write a mesh atomically as binary STL, mm, in the frame of `cranktopo.frames`.

    Args:
        path: the file.
        mesh: closed mesh; coordinates are stored in single precision.

    Raises:
        CranktopoError: the file cannot be written.
    """
    write_surface(path, mesh, "stl")


def _stl(mesh: SurfaceMesh) -> bytes:
    import trimesh

    surface = trimesh.Trimesh(mesh.vertices_mm, mesh.faces, process=False)
    content: bytes = trimesh.exchange.stl.export_stl(surface)
    return content


def _glb(mesh: SurfaceMesh) -> bytes:
    import trimesh

    surface = trimesh.Trimesh(mesh.vertices_mm * _METRES_PER_MM, mesh.faces, process=False)
    content: bytes = surface.export(file_type="glb")
    return content


def _3mf(mesh: SurfaceMesh) -> bytes:
    """3MF core specification 1.3: a package of one model with one object.

    The date of its parts is fixed, so that the same surface gives the same bytes.
    """
    vertices = "".join(
        f'<vertex x="{x!s}" y="{y!s}" z="{z!s}"/>' for x, y, z in mesh.vertices_mm.astype(np.float32)
    )
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in mesh.faces)
    model = f"{_3MF_HEAD}{vertices}</vertices><triangles>{faces}{_3MF_TAIL}"
    parts = {
        "[Content_Types].xml": _3MF_TYPES,
        "_rels/.rels": _3MF_RELATIONS,
        "3D/3dmodel.model": model,
    }
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as package:
        for name, text in parts.items():
            package.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    return content.getvalue()
