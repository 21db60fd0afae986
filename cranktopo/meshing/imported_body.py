"""Half throws that come as a file: a STEP solid, or a watertight STL remeshed as a body-fitted solid."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.cad.session import cad_session
from cranktopo.cad.throw_solid import SolidProperties, solid_properties
from cranktopo.errors import CranktopoError
from cranktopo.frames import Z
from cranktopo.meshing.remesh import tetrahedralise
from cranktopo.meshing.solid_mesh import MeshedThrow, TetMesh, mesh_body, ring_size_mm
from cranktopo.scene import Scene
from cranktopo.surface.solids import is_mirror_image, web_region
from cranktopo.triangles.shells import shell_volumes_mm3
from cranktopo.triangles.surface_files import read_stl
from cranktopo.triangles.surface_mesh import SurfaceMesh, mesh_of, solid_of

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
            body = _between(occ, body, -1.0, scene.pitch_mm / 2, scene)
            high = scene.pitch_mm / 2
        _check_extent(path, scene, low, high)
        half = solid_properties(occ, body)
        web = _between(occ, occ.copy(body), *scene.web_z_mm, scene)
        web_volume = sum(occ.getMass(*pair) for pair in web)
        occ.remove(web, recursive=True)
        mesh = mesh_body(gmsh, scene, element_size_mm, mirrored=False)
    return MeshedThrow(mesh, half, web_volume)


def _between(
    occ: Any, body: list[tuple[int, int]], start: float, end: float, scene: Scene
) -> list[tuple[int, int]]:
    size = 20 * scene.pitch_mm
    box = occ.addBox(-size, -size, start, 2 * size, 2 * size, end - start)
    kept, _ = occ.intersect(body, [(3, box)])
    return list(kept)


def _mesh_stl(path: Path, scene: Scene, size: float) -> MeshedThrow:
    surface = read_half_throw(path, scene)
    body = solid_of(surface, str(path))
    half = _properties(surface)
    mirrored = scene.effects.lateral_symmetry != "off" and is_mirror_image(body, _ALIKE)
    if mirrored:
        surface = mesh_of(body.trim_by_plane((1.0, 0.0, 0.0), 0.0))
    points, cells = tetrahedralise(surface, size, partial(ring_size_mm, scene, size), str(path))
    return MeshedThrow(TetMesh(points, cells, mirrored), half, float(web_region(body, scene).volume()))


def read_half_throw(path: Path, scene: Scene) -> SurfaceMesh:
    """The closed surface of the half throw in an STL file, its ends snapped onto their planes.

    Raises:
        CranktopoError: unreadable, not watertight, several bodies, or another extent than the half throw's.
    """
    surface = read_stl(path, str(path))
    if len(surface.faces) == 0:
        raise CranktopoError(f"{path}: holds no triangles.", hint="Export the surface again as STL, mm.")
    if not surface.as_trimesh().is_watertight:
        raise CranktopoError(f"{path}: the surface is not watertight.", hint="Repair it, then try again.")
    faces = surface.faces if surface.volume_mm3 > 0 else surface.faces[:, ::-1]
    bodies = int((shell_volumes_mm3(SurfaceMesh(surface.vertices_mm, faces)) > 0).sum())
    if bodies != 1:
        raise CranktopoError(f"{path}: holds {bodies} separate bodies.", hint="Remove the loose parts.")
    vertices = surface.vertices_mm.copy()
    z = vertices[:, Z]
    _check_extent(path, scene, float(z.min()), float(z.max()))
    for plane in (0.0, scene.pitch_mm / 2):
        z[np.abs(z - plane) < _SNAP_MM / 10] = plane
    return SurfaceMesh(vertices, faces)


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


def _properties(surface: SurfaceMesh) -> SolidProperties:
    body = surface.as_trimesh()
    x, y, z = (float(c) for c in body.center_mass)
    volume = float(body.volume)
    return SolidProperties(volume, (x, y, z), float(body.moment_inertia[2, 2] + volume * (x**2 + y**2)))
