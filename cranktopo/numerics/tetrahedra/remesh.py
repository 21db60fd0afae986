"""Body-fitted tetrahedra of a closed triangle surface, whatever its topology.

MMG remeshes the triangles (slivers of a boolean or an iso-surface go, sharp edges stay, the shape is kept
within a tolerance), gmsh fills them, and MMG grades the tetrahedra.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.gmsh_session import cad_session, tetrahedra
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, shells
from cranktopo.numerics.tetrahedra.mesh import EDGES

Tetrahedra = NDArray[np.int64]
_SizeField = Callable[[Array], Array]

_TET4 = 4
_DISTANCES = (1 / 40, 1 / 20, 1 / 80)
"""Largest distance between the new surface and the old one over the element size; the second and third
where the first gives a surface that meets itself."""
_GRADATION = 1.7
_SHARP_DEG = 40.0
_VOLUME_TOLERANCE = 5e-3


def tetrahedralise(
    surface: SurfaceMesh, element_size_mm: float, size_at: _SizeField, name: str
) -> tuple[Array, Tetrahedra]:
    """Return nodes (3, nodes), mm, and straight ten-node cells of a closed surface, with hollows or not.

    The surface is oriented outwards, hollows inwards; `size_at` gives the element size at points (n, 3).
    Raises CranktopoError: the surface cannot be filled, or its volume is not kept.
    """
    points, tets = _fill(surface, element_size_mm, size_at, name)
    volume = _volumes(points, tets)
    error = volume.sum() / surface.volume_mm3 - 1
    if volume.min() <= 0 or abs(error) > _VOLUME_TOLERANCE:
        raise CranktopoError(
            f"{name}: the remeshed body is {100 * error:+.2g} % off in volume.",
            hint="Choose a smaller element size.",
            code=ExitCode.SOLVER,
        )
    return quadratic(points, tets)


def _fill(surface: SurfaceMesh, size: float, size_at: _SizeField, name: str) -> tuple[Array, Tetrahedra]:
    failure = ""
    for distance in _DISTANCES:
        try:
            clean = _resurfaced(surface, size, size * distance)
            return _improved(*_inside(clean, size, name), size, size * distance, size_at)
        except (CranktopoError, RuntimeError) as error:  # MMG raises the latter
            failure = failure or str(error)
    raise CranktopoError(
        f"{name}: the surface cannot be meshed: {failure}",
        hint="Choose another element size, or repair thin spots of the surface.",
        code=ExitCode.SOLVER,
    )


def _resurfaced(surface: SurfaceMesh, size: float, distance: float) -> SurfaceMesh:
    from mmgpy import MmgMeshS

    mesh = MmgMeshS(surface.vertices_mm, surface.faces.astype(np.int32))
    mesh.remesh(**_options(size, distance))
    return SurfaceMesh(np.asarray(mesh.get_vertices()), np.asarray(mesh.get_triangles(), np.int64))


def _inside(surface: SurfaceMesh, size: float, name: str) -> tuple[Array, Tetrahedra]:
    with cad_session(f"surface of {name}") as gmsh:
        loops = [gmsh.model.geo.addSurfaceLoop([_add_shell(gmsh, shell)]) for shell in shells(surface)]
        gmsh.model.geo.addVolume(loops)
        gmsh.model.geo.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 2 * size)
        gmsh.option.setNumber("Mesh.Optimize", 0)
        for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber(f"Mesh.{option}", 0)
        gmsh.model.mesh.generate(3)
        return tetrahedra(gmsh, _TET4, 4)


def _add_shell(gmsh: Any, shell: SurfaceMesh) -> int:
    tag: int = gmsh.model.addDiscreteEntity(2)
    first = gmsh.model.mesh.getMaxNodeTag() + 1
    gmsh.model.mesh.addNodes(
        2, tag, np.arange(first, first + len(shell.vertices_mm)), shell.vertices_mm.ravel()
    )
    gmsh.model.mesh.addElementsByType(tag, 2, [], (shell.faces + first).ravel())
    return tag


def _improved(
    points: Array, tets: Tetrahedra, size: float, distance: float, size_at: _SizeField
) -> tuple[Array, Tetrahedra]:
    from mmgpy import MmgMesh3D

    mesh = MmgMesh3D(points, tets.astype(np.int32))
    mesh["metric"] = size_at(points)[:, None]
    mesh.remesh(**_options(size, distance))
    return np.asarray(mesh.get_vertices()), np.asarray(mesh.get_tetrahedra(), dtype=np.int64)


def _options(size: float, distance: float) -> dict[str, float | int]:
    return {
        "hmax": size,
        "hmin": size / 20,
        "hausd": distance,
        "hgrad": _GRADATION,
        "ar": _SHARP_DEG,
        "verbose": -1,
    }


def _volumes(points: Array, tets: Tetrahedra) -> Array:
    a, b, c, d = (points[tets[:, corner]] for corner in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def quadratic(points: Array, tets: Tetrahedra) -> tuple[Array, Tetrahedra]:
    """Return nodes (3, nodes), corners first, and cells (10, elements) with nodes midway on edges."""
    ends = np.sort(np.concatenate([tets[:, list(edge)] for edge in EDGES]), axis=1)
    edges, inverse = np.unique(ends, axis=0, return_inverse=True)
    middles = len(points) + inverse.reshape(len(EDGES), -1)
    nodes = np.concatenate([points, points[edges].mean(axis=1)])
    return np.ascontiguousarray(nodes.T), np.ascontiguousarray(np.concatenate([tets.T, middles]))
