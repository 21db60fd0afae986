"""Meshes of ten-node tetrahedra: made in a closed triangle surface, whatever its topology, and kept valid.

MMG remeshes the triangles (slivers of a boolean or an iso-surface go, sharp edges stay, the shape is kept
within a tolerance), gmsh fills them, and MMG grades the tetrahedra. Where bending an element to the surface
folds it, it is unbent.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Int64
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.base.notes import at_work, note
from cranktopo.numerics.gmsh_session import cad_session, tetrahedra
from cranktopo.numerics.surfaces.mesh import (
    SurfaceMesh,
    self_intersections_mm,
    shells,
    solid_of,
    unrounded_mesh_of,
)

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
"""Corners of the edges of a ten-node tetrahedron, VTK order."""
RATIO = 1.5
"""Element size of the coarse mesh over that of the fine one where two are compared."""
_LEAST_RATIO = 0.1
"""Least Jacobian of a curved element over that of its straight counterpart."""
_UNBENT = 1e-6
"""Way of an edge node off its straight edge, over the size of an element, that cannot fold it."""
_ROUNDS = 20


def straighten_folded(points_mm: Array, cells: NDArray[np.int64]) -> tuple[Array, int]:
    """Put edge nodes of nearly folded elements back on their straight edges; count these elements.

    Moving an edge node touches the neighbours too, so this repeats until every element is sound. Raises
    CranktopoError where an element is inverted even with straight edges. Nodes (3, nodes), cells (10,
    elements).
    """
    points = points_mm.copy()
    straight = _straight(points, cells)
    volume = _determinant(straight[:, 1:4] - straight[:, :1])
    if volume.min() <= 0:
        raise solver_error("mesh: an element is flat or inverted.", "Choose another element size.")
    away = np.abs(points[:, cells[4:]] - straight[:, 4:]).max(axis=(0, 1))
    curved = np.flatnonzero(away**3 > _UNBENT**3 * volume)
    straightened = np.zeros(cells.shape[1], dtype=bool)
    for _ in range(_ROUNDS):
        folded = _jacobians(points[:, cells[:, curved]]).min(axis=0) < _LEAST_RATIO * volume[curved]
        if not folded.any():
            break
        bad = curved[folded]
        straightened[bad] = True
        chosen = cells[:, bad]
        points[:, chosen[4:]] = _straight(points, chosen)[:, 4:]
    return points, int(straightened.sum())


def least_jacobian_ratio(points_mm: Array, before_mm: Array, cells: NDArray[np.int64]) -> float:
    """Return the minimum Jacobian of moved elements over that of the same one before, the worst of all."""
    now, was = (_jacobians(points[:, cells]).min(axis=0) for points in (points_mm, before_mm))
    return float((now / was).min())


def volume_ratios(points_mm: Array, before_mm: Array, cells: NDArray[np.int64]) -> Array:
    """Return the volumes of moved elements, their edges taken as straight, over those before, (elements,)."""
    now, was = (_determinant(at[:, cells[1:4]] - at[:, cells[:1]]) for at in (points_mm, before_mm))
    return np.asarray(now / was)


def edge_ends(cells: NDArray[np.int64]) -> NDArray[np.intp]:
    """Return both corners of the edge of each middle node, (2, nodes); zero of corners."""
    ends = np.zeros((2, int(cells.max()) + 1), dtype=np.intp)
    for k, pair in enumerate(EDGES):
        ends[:, cells[4 + k]] = cells[list(pair)]
    return ends


def _straight(points: Array, cells: NDArray[np.int64]) -> Array:
    nodes = points[:, cells]
    for k, (a, b) in enumerate(EDGES):
        nodes[:, 4 + k] = (nodes[:, a] + nodes[:, b]) / 2
    return nodes


def _jacobians(nodes: Array) -> Array:
    """Jacobian determinant at 15 points of each element, shape (15, elements); nodes as `_straight`."""
    gradients = shape_gradients(_check_points())
    matrix = np.einsum("ine,pnj->ijpe", nodes, gradients, optimize=True)
    return _determinant(matrix)


def _determinant(columns: Array) -> Array:
    """Return the determinant of matrices (3, 3, ...) by their columns."""
    return np.asarray((columns[:, 0] * np.cross(columns[:, 1], columns[:, 2], axis=0)).sum(axis=0))


def _check_points() -> Array:
    """Barycentric points: corners, edge middles, four quadrature points, centre; shape (15, 4)."""
    a, b = 0.5854101966249685, 0.1381966011250105
    inner = b + (a - b) * np.eye(4)
    return np.vstack([node_points(), inner, np.full((1, 4), 0.25)])


def node_points() -> Array:
    """Return barycentric coordinates of the ten nodes, shape (10, 4)."""
    corners = np.eye(4)
    return np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in EDGES]])


TRIANGLE_EDGES = ((0, 1), (1, 2), (0, 2))
"""Edges of a six-node triangle in the order of its edge nodes."""


def shape_gradients(barycentric: Array, edges: tuple[tuple[int, int], ...] = EDGES) -> Array:
    """Return the gradients of the quadratic shape functions in (xi, eta, zeta), shape (points, nodes, 3).

    Of tetrahedra (points, 10, 3), or, with the edges of one, of a triangle (points, 6, 2).
    """
    axes = barycentric.shape[1] - 1
    slope = np.vstack([-np.ones(axes), np.eye(axes)])
    corner = (4 * barycentric - 1)[:, :, None] * slope
    edge = [4 * (barycentric[:, a, None] * slope[b] + barycentric[:, b, None] * slope[a]) for a, b in edges]
    return np.concatenate([corner, np.stack(edge, axis=1)], axis=1)


def shape_values(barycentric: Array, edges: tuple[tuple[int, int], ...] = EDGES) -> Array:
    """Return the quadratic shape functions at points (points, 4) of a tetrahedron, shape (points, 10).

    Or, with the edges of one, at points (points, 3) of a triangle, shape (points, 6).
    """
    middles = [4 * barycentric[:, a] * barycentric[:, b] for a, b in edges]
    return np.column_stack([barycentric * (2 * barycentric - 1), *middles])


@dataclass(frozen=True)
class TetMesh:
    """A mesh of ten-node tetrahedra.

    Attributes:
        points_mm: nodes, shape (3, nodes).
        cells: node numbers, shape (10, elements), VTK order (corners, then edges 01 12 02 03 13 23).
        mirrored: the mesh is the half x >= 0 of a body symmetric in x.
        off_surface_mm: from each node to where the surface would have it, but for elements that would fold,
            shape (3, nodes); None: all nodes are there.
    """

    points_mm: NDArray[np.float64]
    cells: NDArray[np.int64]
    mirrored: bool
    off_surface_mm: NDArray[np.float64] | None = None


_SizeField = Callable[[Array], Array]

_TET4 = 4
_DISTANCES = (1 / 40, 1 / 20, 1 / 80)
"""Largest distance between the new surface and the old one over the element size; the second and third
where the first gives a surface that meets itself."""
_JOINED, _CUT, _AGAIN = (0.0, 1 / 2000, 1 / 200), (1 / 2, 1 / 8), (1 / 40, 1 / 20)
"""Settings where all of them do: distance over the element size within which small triangles are joined
first, longest edge over it that all are cut to then, and distances of the new surface from that. MMG turns
triangles over beside slivers, and beside long narrow ones such as the chords of a bore."""
_GRADATION = 1.7
_SHARP_DEG = 40.0
_VOLUME_TOLERANCE = 5e-3
_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")
_MEETS = 0.01
"""Places where a surface meets itself over its triangles, beyond which nothing is filled."""
_FLATTEST = 1e-5
"""Least volume of an element over that of the regular one with its longest edge; flatter ones leave the
solver a residual."""
_REGULAR = 6 * np.sqrt(2.0)
"""Cube of the edge of a regular tetrahedron over its volume."""


def tetrahedralise(
    surface: SurfaceMesh, element_size_mm: float, size_at: _SizeField, name: str
) -> tuple[Array, Int64]:
    """Return nodes (3, nodes), mm, and straight ten-node cells of a closed surface, with hollows or not.

    The surface is oriented outwards, hollows inwards; `size_at` gives the element size at points (n, 3).
    Raises CranktopoError: the surface cannot be filled, or its volume is not kept.
    """
    with at_work(f"mesh of {name}"):
        return quadratic(*_fill(surface, element_size_mm, size_at, name))


def _fill(surface: SurfaceMesh, size: float, size_at: _SizeField, name: str) -> tuple[Array, Int64]:
    failures = list[str]()
    tries = [(0.0, 0.0, distance) for distance in _DISTANCES] + list(product(_JOINED, _CUT, _AGAIN))
    for joined, cut, distance in tries:
        try:
            prepared = _prepared(surface, size * joined, size * cut, name)
            clean = _apart(_resurfaced(prepared, size, size * distance))
            found = _improved(*_inside(clean, size, name), size, size * distance, size_at)
            _check(surface, *found)
        except (CranktopoError, RuntimeError) as error:  # MMG raises the latter
            failures.append(error.message if isinstance(error, CranktopoError) else str(error))
            continue
        if joined:
            note(f"{name}: meshed after its small triangles were joined within {size * joined:.2g} mm")
        return found
    where = _where_it_meets_itself(_resurfaced(surface, size, size * _DISTANCES[0]))
    raise solver_error(
        f"{name}: the surface cannot be meshed{where}, {len(tries)} tries: {reasons_of(failures)}.",
        "Choose another element size, or repair thin spots of the surface.",
    )


def reasons_of(failures: Sequence[str]) -> str:
    """Return the distinct reasons of failed tries and how often each came; numbers make no difference."""
    found = dict[str, list[str]]()
    for failure in failures:
        found.setdefault(_NUMBER.sub("#", failure), []).append(failure.strip().rstrip("."))
    return "; ".join(f"{same[0]} ({len(same)} of {len(failures)})" for same in found.values())


def _apart(surface: SurfaceMesh) -> SurfaceMesh:
    """Refuse a surface that meets itself at many places: gmsh may not survive it."""
    meets = len(self_intersections_mm(surface))
    if meets > _MEETS * len(surface.faces):
        raise solver_error(f"the remeshed surface meets itself at {meets} places.", "Choose another size.")
    return surface


def _where_it_meets_itself(mesh: SurfaceMesh) -> str:
    """Return the first place in words; nothing where there is none, or the mesh is not closed."""
    with suppress(CranktopoError):
        for place in self_intersections_mm(mesh)[:1]:
            return f" near ({', '.join(f'{x:.1f}' for x in place)}) mm"
    return ""


def _check(surface: SurfaceMesh, points: Array, tets: Int64) -> None:
    corners = points[tets.T]
    a, b, c, d = corners
    volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    error = volume.sum() / surface.volume_mm3 - 1
    if volume.min() <= 0 or abs(error) > _VOLUME_TOLERANCE:
        raise solver_error(
            f"the remeshed body is {100 * error:+z.2g} % off in volume.", "Choose a smaller element size."
        )
    longest = np.max([np.linalg.norm(corners[i] - corners[j], axis=1) for i, j in EDGES], axis=0)
    flattest = float((_REGULAR * volume / longest**3).min())
    if flattest < _FLATTEST:
        raise solver_error(
            f"an element has {flattest:.1g} of the volume of a regular one.", "Choose a smaller element size."
        )


def _prepared(surface: SurfaceMesh, joined_mm: float, edge_mm: float, name: str) -> SurfaceMesh:
    """Return the same shape in triangles without longer edges, small ones joined; 0: as they are."""
    if not edge_mm:
        return surface
    body = solid_of(surface, name)
    return unrounded_mesh_of((body.simplify(joined_mm) if joined_mm else body).refine_to_length(edge_mm))


def _resurfaced(surface: SurfaceMesh, size: float, distance: float) -> SurfaceMesh:
    from mmgpy import MmgMeshS

    mesh = MmgMeshS(surface.vertices_mm, surface.faces.astype(np.int32))
    mesh.remesh(**_options(size, distance))
    return SurfaceMesh(np.asarray(mesh.get_vertices()), np.asarray(mesh.get_triangles(), np.int64))


def _inside(surface: SurfaceMesh, size: float, name: str) -> tuple[Array, Int64]:
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
    points: Array, tets: Int64, size: float, distance: float, size_at: _SizeField
) -> tuple[Array, Int64]:
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


def quadratic(points: Array, tets: Int64) -> tuple[Array, Int64]:
    """Return nodes (3, nodes), corners first, and cells (10, elements) with nodes midway on edges."""
    ends = np.sort(np.concatenate([tets[:, list(edge)] for edge in EDGES]), axis=1)
    edges, inverse = np.unique(ends, axis=0, return_inverse=True)
    middles = len(points) + inverse.reshape(len(EDGES), -1)
    nodes = np.concatenate([points, points[edges].mean(axis=1)])
    return np.ascontiguousarray(nodes.T), np.ascontiguousarray(np.concatenate([tets.T, middles]))
