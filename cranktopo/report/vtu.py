"""Cell densities and fields on surfaces as unstructured VTK files for ParaView."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.files import replacing

# Corners of a hexahedron in the order of VTK_HEXAHEDRON: the lower face counter-clockwise, then the upper.
_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def write_density_vtu(
    path: Path,
    x_edges_mm: Array,
    y_edges_mm: Array,
    z_edges_mm: Array,
    cell_data: Mapping[str, Array],
    keep: NDArray[np.bool_],
) -> None:
    """Write the kept cells of a grid as hexahedra, compressed binary, atomically.

    Edges are node coordinates in the frame of `cranktopo.base.frames`, increasing, one more than cells along
    each axis; `cell_data` and `keep` have the shape of the cells. Raises CranktopoError where the file cannot
    be written and ValueError where shapes do not fit together.
    """
    import meshio

    edges = (x_edges_mm, y_edges_mm, z_edges_mm)
    shape = tuple(len(axis) - 1 for axis in edges)
    if any(field.shape != shape for field in (keep, *cell_data.values())):
        raise ValueError(f"cell_data and keep need the shape {shape} of the edges")
    points, cells = _hexahedra(edges, keep)
    data = {name: [np.ascontiguousarray(field[keep])] for name, field in cell_data.items()}
    _write(path, meshio.Mesh(points, [("hexahedron", cells)], cell_data=data))


def write_surface_vtu(
    path: Path, points_mm: Array, faces: NDArray[np.intp], point_data: Mapping[str, Array]
) -> None:
    """Write fields at nodes (n, 3) of quadratic triangles (f, 6), compressed binary, atomically.

    Raises:
        CranktopoError: the file cannot be written.
    """
    import meshio

    _write(path, meshio.Mesh(points_mm, [("triangle6", faces)], point_data=dict(point_data)))


def _write(path: Path, mesh: Any) -> None:
    import meshio

    with replacing(path) as temporary:
        meshio.write(temporary, mesh, file_format="vtu", binary=True, compression="zlib")


def _hexahedra(edges: tuple[Array, Array, Array], keep: NDArray[np.bool_]) -> tuple[Array, NDArray[np.int64]]:
    """Points in use (n, 3) and hexahedra over them (m, 8)."""
    nodes = tuple(len(axis) for axis in edges)
    cell = np.stack(np.nonzero(keep), axis=-1)
    corners = cell[:, None, :] + np.array(_CORNERS)
    number = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), nodes)
    used, hexahedra = np.unique(number, return_inverse=True)
    place = np.unravel_index(used, nodes)
    points = np.stack([axis[i] for axis, i in zip(edges, place, strict=True)], axis=-1)
    return points, hexahedra.reshape(number.shape)
