"""Lit, depth-sorted pictures of a closed mesh in plain matplotlib axes.

Faces are cut small, sorted from back to front and filled with interpolated colours (Gouraud, 1971). Normals
are averaged over smooth regions and kept apart at sharp edges.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of

_Colour = tuple[float, float, float]
WEB_COLOUR = (0.30, 0.52, 0.80)
JOURNAL_COLOUR = (0.78, 0.79, 0.81)
STRESS_COLOURS = (
    (0.275, 0.196, 0.494),
    (0.212, 0.361, 0.553),
    (0.153, 0.498, 0.557),
    (0.122, 0.631, 0.529),
    (0.290, 0.757, 0.427),
    (0.627, 0.855, 0.224),
    (0.992, 0.906, 0.145),
)
"""Viridis without its darkest end: readable with any colour vision and on any page."""
_FACES_ALONG = 40
"""Faces that a body's longest extent is cut into at least, for sorting by depth."""
_BEYOND_MM = 0.06
"""Distance beyond its sides within which the web still is web: a body from CAD may lie off by 0.05 mm."""
_INSET = 0.01
"""Way of a journal's cap into it, over the body's extent: near an outer face it would show in stripes."""
_HIDDEN = 0.01
"""Depth of a point below a face that hides it, over the body's extent."""
SHARP_DEGREES = 35.0
_QUARTERS = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
"""Nodes of the four flat triangles of a six-node face."""
_AMBIENT = 0.30
# Direction to each light in the axes of the picture (right, up, to the viewer), and its strength.
_LIGHTS = (((-0.45, 0.60, 0.65), 0.42), ((0.10, 0.00, 1.00), 0.26), ((0.95, -0.10, 0.30), 0.16))


@dataclass(frozen=True)
class ShadedMesh:
    """A mesh made ready for drawing from any side.

    Attributes:
        normals: (n, 3) unit normals, one per vertex and smooth region.
        colours: (m, 3) red, green, blue of each face, 0 to 1.
    """

    vertices_mm: Array
    normals: Array
    faces: NDArray[np.int64]
    colours: Array


def shaded(
    mesh: SurfaceMesh, web_z_mm: tuple[float, float], faces_along: int | None = _FACES_ALONG
) -> ShadedMesh:
    """Make a half throw ready for drawing, journals in another colour than the web.

    Args:
        web_z_mm: axial range of the web; what lies outside is a journal.
        faces_along: the body's longest extent over the longest edge; None keeps the faces as they are.
    """
    largest = mesh.extent_mm / faces_along if faces_along else None
    whole = solid_of(mesh).as_original()
    low, high = web_sides_mm(web_z_mm)
    main, rest = whole.split_by_plane((0.0, 0.0, -1.0), -low)
    web, pin = rest.split_by_plane((0.0, 0.0, -1.0), -high)
    coloured = ((main, JOURNAL_COLOUR, 1.0), (web, WEB_COLOUR, 0.0), (pin, JOURNAL_COLOUR, -1.0))
    parts = [
        _coloured(solid, colour, largest, whole.original_id(), -outward * _INSET * mesh.extent_mm)
        for solid, colour, outward in coloured
        if not solid.is_empty()
    ]
    before = np.cumsum([0, *(len(part.vertices_mm) for part in parts)])
    return ShadedMesh(
        vertices_mm=np.concatenate([part.vertices_mm for part in parts]),
        normals=np.concatenate([part.normals for part in parts]),
        faces=np.concatenate([part.faces + shift for part, shift in zip(parts, before, strict=False)]),
        colours=np.concatenate([part.colours for part in parts]),
    )


def shaded_faces(
    points_mm: Array, normals: Array, faces: NDArray[np.intp], paint: Callable[[NDArray[np.intp]], Array]
) -> ShadedMesh:
    """Make curved six-node faces (f, 6) ready for drawing, each as four flat triangles.

    Args:
        normals: of the nodes, (n, 3).
        paint: gives the colours (m, 3) of triangles (m, 3) of nodes.
    """
    triangles = np.concatenate([faces[:, quarter] for quarter in _QUARTERS])
    return ShadedMesh(points_mm, normals, triangles, paint(triangles))


def web_sides_mm(web_z_mm: tuple[float, float]) -> tuple[float, float]:
    """Return the axial range that has the colour of the web, mm."""
    return web_z_mm[0] - _BEYOND_MM, web_z_mm[1] + _BEYOND_MM


def view_axes(towards_viewer: tuple[float, float, float], up: tuple[float, float, float]) -> Array:
    """Return the axes of a picture (right, up, to the viewer) as rows, (3, 3), in the frame of the throw.

    `up` points up in the picture as far as it can.
    """
    out = np.array(towards_viewer) / np.linalg.norm(towards_viewer)
    right = np.cross(up, out)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(out, right), out])


def extent_mm(body: ShadedMesh, view: Array) -> Array:
    """Return lower and upper corner of a body as seen along a view, (2, 2): rows (right, up), mm."""
    points = body.vertices_mm @ view[:2].T
    return np.stack([points.min(axis=0), points.max(axis=0)])


def draw(axes: Any, body: ShadedMesh, view: Array) -> None:
    """Draw a body in matplotlib axes as seen along a view from `view_axes`, in mm to scale."""
    from matplotlib.collections import TriMesh
    from matplotlib.tri import Triangulation

    points = body.vertices_mm @ view.T
    corners = points[body.faces]
    edges = corners[:, 1:, :2] - corners[:, :1, :2]
    facing = edges[:, 0, 0] * edges[:, 1, 1] > edges[:, 0, 1] * edges[:, 1, 0]
    order = np.flatnonzero(facing)
    order = order[np.argsort(corners[order, :, 2].mean(axis=1), kind="stable")]
    light = _brightness(body.normals @ view.T)[body.faces[order]]
    colours = np.clip(body.colours[order][:, None, :] * light[:, :, None], 0, 1)
    flat = corners[order].reshape(-1, 3)
    triangles = Triangulation(flat[:, 0], flat[:, 1], np.arange(len(flat)).reshape(-1, 3))
    # Without autolim: matplotlib would build a path per triangle to find the limits.
    axes.add_collection(TriMesh(triangles, facecolors=colours.reshape(-1, 3)), autolim=False)
    lower, upper = extent_mm(body, view)
    axes.set_xlim(lower[0], upper[0])
    axes.set_ylim(lower[1], upper[1])
    axes.set_aspect("equal")


def visible(body: ShadedMesh, view: Array, point_mm: Array) -> bool:
    """Tell whether no face of a body hides a point on it from the viewer."""
    x, y, depth = view @ point_mm
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (body.vertices_mm @ view.T)[body.faces].transpose(1, 2, 0)
    twice_area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    with np.errstate(divide="ignore", invalid="ignore"):
        b = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / twice_area
        c = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / twice_area
    over = (b >= 0) & (c >= 0) & (b + c <= 1)
    height = az + b * (bz - az) + c * (cz - az)
    return not bool((height[over] > depth + _HIDDEN * np.ptp(body.vertices_mm, axis=0).max()).any())


def _coloured(
    solid: Manifold, colour: _Colour, largest_face_mm: float | None, whole: int, inset_mm: float
) -> ShadedMesh:
    """Return those faces of a part that are faces of the whole, the original of this number, and its cap.

    The face of its cut is drawn an inset along z into the part; 0 leaves that out.
    """
    with_normals = solid.calculate_normals(0, SHARP_DEGREES)
    fine = (with_normals.refine_to_length(largest_face_mm) if largest_face_mm else with_normals).to_mesh64(0)
    table, faces = np.asarray(fine.vert_properties), np.asarray(fine.tri_verts).astype(np.int64)
    own = np.repeat(fine.run_original_id, np.diff(fine.run_index) // 3) == whole
    if inset_mm:
        capped, corners = np.unique(faces[~own], return_inverse=True)
        moved = table[capped] + inset_mm * np.eye(table.shape[1])[2]
        faces = np.concatenate([faces[own], corners.reshape(-1, 3) + len(table)])
        table = np.concatenate([table, moved])
    else:
        faces = faces[own]
    return ShadedMesh(table[:, :3], table[:, 3:6], faces, np.tile(colour, (len(faces), 1)))


def _brightness(normals: Array) -> Array:
    total = np.full(len(normals), _AMBIENT)
    for direction, strength in _LIGHTS:
        total += strength * np.clip(normals @ (np.array(direction) / np.linalg.norm(direction)), 0, None)
    return total


def sharp_edges(points_mm: NDArray[np.float64], faces: NDArray[Any]) -> NDArray[np.uint32]:
    """Return the corners of every edge of a closed surface at which two faces meet sharply, (edges, 2)."""
    a, b, c = (points_mm[faces[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    normals = across / np.maximum(np.linalg.norm(across, axis=1), np.finfo(float).tiny)[:, None]
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    both = np.lexsort(edges.T).reshape(-1, 2)
    one, other = normals[both // 3].swapaxes(0, 1)
    turned = np.einsum("ij,ij->i", one, other) < math.cos(math.radians(SHARP_DEGREES))
    return edges[both[turned, 0]].astype(np.uint32)
