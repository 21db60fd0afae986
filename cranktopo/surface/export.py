"""The surface as a file that CAD and meshers read."""

from __future__ import annotations

from pathlib import Path

from cranktopo.store.files import write_bytes
from cranktopo.surface.mesh import SurfaceMesh


def write_stl(path: Path, mesh: SurfaceMesh) -> None:
    """Write a mesh atomically as binary STL, mm, in the frame of `cranktopo.frames`.

    Args:
        path: the file.
        mesh: closed mesh; coordinates are stored in single precision.

    Raises:
        CranktopoError: the file cannot be written.
    """
    import trimesh

    surface = trimesh.Trimesh(mesh.vertices_mm, mesh.faces, process=False)
    write_bytes(path, trimesh.exchange.stl.export_stl(surface))
