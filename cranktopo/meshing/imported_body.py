"""Half throws that come as a file: a STEP solid, or a watertight STL remeshed as a body-fitted solid."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.cad.session import cad_session
from cranktopo.cad.throw_solid import SolidProperties, solid_properties
from cranktopo.errors import CranktopoError
from cranktopo.meshing.remesh import tetrahedralise
from cranktopo.meshing.solid_mesh import MeshedThrow, TetMesh, mesh_body, ring_size_mm
from cranktopo.scene import Scene

if TYPE_CHECKING:
    from manifold3d import Manifold

_ALIKE = 1e-6
"""Share of the volume in which both sides may differ: reading a file joins vertices that almost coincide."""
_SNAP_MM = 0.05
"""Largest distance of an end section from its plane; closer vertices are moved onto it."""


def mesh_file(path: Path, scene: Scene, element_size_mm: float) -> MeshedThrow:
    """Mesh of the half throw in an STL or STEP file.

    Args:
        path: STL or STEP, mm, frame of `cranktopo.frames`, z from 0 to half the pitch. A STEP file may also
            hold the full throw (z to the full pitch).
        scene: design of its journals.
        element_size_mm: general element size.

    Raises:
        CranktopoError: not watertight, several bodies, wrong extent, or no valid mesh.
    """
    if path.suffix.lower() == ".stl":
        return _mesh_stl(path, scene, element_size_mm)
    with cad_session(f"solid of {path}") as gmsh:
        occ = gmsh.model.occ
        body = [pair for pair in occ.importShapes(str(path)) if pair[0] == 3]
        if len(body) != 1:
            raise CranktopoError(f"{path}: holds {len(body)} solids, not one.", hint="Fuse them first.")
        low, high = (occ.getBoundingBox(*body[0])[i] for i in (2, 5))
        if abs(high - scene.pitch_mm) < _SNAP_MM:
            body = _slab(occ, body, -1.0, scene.pitch_mm / 2, scene)
            high = scene.pitch_mm / 2
        _check_extent(path, scene, low, high)
        half = solid_properties(occ, body)
        web = _slab(occ, occ.copy(body), *scene.web_z_mm, scene)
        web_volume = sum(occ.getMass(*pair) for pair in web)
        occ.remove(web, recursive=True)
        mesh = mesh_body(gmsh, scene, element_size_mm, mirrored=False)
    return MeshedThrow(mesh, half, web_volume)


def _slab(
    occ: Any, body: list[tuple[int, int]], start: float, end: float, scene: Scene
) -> list[tuple[int, int]]:
    size = 20 * scene.pitch_mm
    box = occ.addBox(-size, -size, start, 2 * size, 2 * size, end - start)
    kept, _ = occ.intersect(body, [(3, box)])
    return list(kept)


def _mesh_stl(path: Path, scene: Scene, size: float) -> MeshedThrow:
    from cranktopo.surface.solids import is_mirror_image, web_slab
    from cranktopo.triangles.surface_mesh import solid_of

    surface = read_surface(path, scene)
    body = solid_of(surface.vertices, surface.faces, str(path))
    x, y, z = (float(c) for c in surface.center_mass)
    half = SolidProperties(float(surface.volume), (x, y, z), _inertia_z(surface))
    mirrored = scene.effects.lateral_symmetry != "off" and is_mirror_image(body, _ALIKE)
    if mirrored:
        surface = _positive_x(body)
    points, cells = tetrahedralise(surface, size, partial(ring_size_mm, scene, size), str(path))
    return MeshedThrow(TetMesh(points, cells, mirrored), half, float(web_slab(body, scene).volume()))


def read_surface(path: Path, scene: Scene) -> Any:
    """The closed surface (trimesh) of the half throw in an STL file, its ends snapped onto their planes.

    Args:
        path: the STL file, mm.
        scene: the throw, whose ends the surface must have.

    Raises:
        CranktopoError: unreadable, not watertight, several bodies, or another extent than the half throw's.
    """
    import trimesh

    try:
        surface = trimesh.load_mesh(path)
    except Exception as error:
        raise CranktopoError(f"{path}: cannot be read as STL: {error}.", hint="Export it again.") from None
    if len(surface.faces) == 0:
        raise CranktopoError(f"{path}: holds no triangles.", hint="Export the surface again as STL, mm.")
    if not surface.is_watertight:
        raise CranktopoError(f"{path}: the surface is not watertight.", hint="Repair it, then try again.")
    if surface.volume < 0:
        surface.invert()
    bodies = sum(part.volume > 0 for part in surface.split(only_watertight=False))
    if bodies != 1:
        raise CranktopoError(f"{path}: holds {bodies} separate bodies.", hint="Remove the loose parts.")
    _check_extent(path, scene, *surface.bounds[:, 2])
    z = surface.vertices[:, 2].copy()
    for plane in (0.0, scene.pitch_mm / 2):
        z[np.abs(z - plane) < _SNAP_MM / 10] = plane
    surface.vertices = np.column_stack([surface.vertices[:, :2], z])
    return surface


def _check_extent(path: Path, scene: Scene, low: float, high: float) -> None:
    end = scene.pitch_mm / 2
    if abs(low) > _SNAP_MM or abs(high - end) > _SNAP_MM:
        metres = abs(low) < _SNAP_MM / 1000 and abs(1000 * high - end) < _SNAP_MM
        raise CranktopoError(
            f"{path}: reaches from z = {low:.3f} to {high:.3f} mm, "
            f"the half throw of '{scene.name}' from 0 to {end:g} mm.",
            hint="It is in metres: export it in mm."
            if metres
            else "Give the design it was made from, in mm.",
        )


def _inertia_z(surface: Any) -> float:
    """Integral of x2 + y2 over the volume, about the crank axis."""
    x, y, _ = surface.center_mass
    return float(surface.moment_inertia[2, 2] + surface.volume * (x**2 + y**2))


def _positive_x(body: Manifold) -> Any:
    import trimesh

    from cranktopo.triangles.surface_mesh import mesh_of

    half = mesh_of(body.trim_by_plane((1.0, 0.0, 0.0), 0.0))
    return trimesh.Trimesh(half.vertices_mm, half.faces, process=False)
