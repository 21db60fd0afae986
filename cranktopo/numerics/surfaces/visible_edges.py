"""Edges of triangle meshes that a viewer sees: sharp ones and outlines, hidden parts left out.

Coordinates are (right, up, toward the viewer), mm. What hides an edge is found in a depth buffer, so that an
edge ends within a pixel or two of where another face begins to cover it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Int64
from cranktopo.numerics.surfaces.mesh import SurfaceMesh

_SHARP_COS = np.cos(np.radians(22.0))
"""Faces that meet at less are one smooth face: facets of a fillet are 6 deg apart."""
_BIAS = 2.0
"""Pixels by which a face must lie before an edge to hide it."""
_LEAST = 3
"""Samples of the shortest run of an edge that is drawn."""


def visible_edges(mesh: SurfaceMesh, pixel_mm: float, lines: Sequence[Array] = ()) -> list[Array]:
    """Return chains of points (n, 2) of the edges that are seen along the third axis, from its positive side.

    Edges with one face are none: there the body goes on.

    Args:
        lines: on the surface, (n, 3), drawn where they are seen although no edge is there.
    """
    normals = _normals(mesh)
    found = mesh.vertices_mm[_candidates(mesh.faces, normals)]
    edges = np.concatenate([found, *(np.stack([line[:-1], line[1:]], axis=1) for line in lines)])
    if not len(edges):
        return []
    depth = _Depth(mesh, normals[:, 2] > 0, pixel_mm)
    return _chains(_merged(_seen(edges, depth, pixel_mm), pixel_mm / 4), pixel_mm / 4)


def _normals(mesh: SurfaceMesh) -> Array:
    a, b, c = np.moveaxis(mesh.corners_mm, 1, 0)
    normals = np.cross(b - a, c - a)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None])


def _candidates(faces: Int64, normals: Array) -> Int64:
    """Vertices of edges between two faces that are sharp or an outline, and not turned away."""
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    ordered, owner = sides[order], (np.arange(len(sides)) % len(faces))[order]
    pair = np.flatnonzero((ordered[1:] == ordered[:-1]).all(axis=1))
    one, other = normals[owner[pair]], normals[owner[pair + 1]]
    front = one[:, 2] > _FLAT, other[:, 2] > _FLAT
    sharp = (one * other).sum(axis=1) < _SHARP_COS
    return np.asarray(ordered[pair[(sharp & (front[0] | front[1])) | (front[0] != front[1])]])


_FLAT = 1e-6
"""A face seen from its edge is turned away, whatever rounding says."""


class _Depth:
    """Nearest depth of the front faces at pixels."""

    def __init__(self, mesh: SurfaceMesh, front: NDArray[np.bool_], pixel_mm: float) -> None:
        points = mesh.vertices_mm
        self._low, self._pixel = points[:, :2].min(axis=0) - 2 * pixel_mm, pixel_mm
        self._shape = tuple(np.ceil((points[:, :2].max(axis=0) - self._low) / pixel_mm).astype(int) + 3)
        self._nearest = np.full(self._shape[0] * self._shape[1], -np.inf)
        corners = mesh.corners_mm[front].copy()
        corners[..., :2] = (corners[..., :2] - self._low) / pixel_mm
        for part in np.array_split(corners, max(1, len(corners) // 20_000)):
            self._add(part)

    def _add(self, corners: Array) -> None:
        """Put triangles in, row by row: the pixels between their two crossings with a row."""
        first = np.ceil(corners[..., 1].min(axis=1)).astype(int)
        rows = np.maximum(np.floor(corners[..., 1].max(axis=1)).astype(int) - first + 1, 0)
        which, row = _expanded(first, rows)
        left, right = _crossings(corners[which], row)
        begin = np.ceil(left).astype(int)
        count = np.maximum(np.floor(right).astype(int) - begin + 1, 0)
        span, column = _expanded(begin, count)
        which, row = which[span], row[span]
        base, slope = _planes(corners)
        depth = base[which] + slope[which, 0] * column + slope[which, 1] * row
        np.maximum.at(self._nearest, column * self._shape[1] + row, depth)

    def farthest_around(self, points: Array) -> Array:
        """Return the farthest of the depths at the nine pixels around points (n, 2 or 3)."""
        column, row = np.rint((points[:, :2] - self._low) / self._pixel).astype(int).T
        around = [
            self._nearest[(column + i) * self._shape[1] + row + j] for i in (-1, 0, 1) for j in (-1, 0, 1)
        ]
        return np.asarray(np.min(around, axis=0))


def _expanded(first: Int64, counts: Int64) -> tuple[Int64, Int64]:
    """Return owner and value of every number that runs from `first`, so many for each owner."""
    owner = np.repeat(np.arange(len(counts)), counts)
    begin = np.repeat(np.cumsum(counts) - counts, counts)
    return owner, np.repeat(first, counts) + np.arange(len(owner)) - begin


def _crossings(corners: Array, row: Int64) -> tuple[Array, Array]:
    """Least and greatest place at which the sides of triangles cross a row."""
    left, right = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        (x0, y0), (x1, y1) = corners[:, i, :2].T, corners[:, j, :2].T
        rise = y1 - y0
        share = np.where(rise == 0, 0.0, (row - y0) / np.where(rise == 0, 1.0, rise))
        at = x0 + share * (x1 - x0)
        inside = (np.minimum(y0, y1) <= row) & (row <= np.maximum(y0, y1))
        left = np.where(inside, np.minimum(left, at), left)
        right = np.where(inside, np.maximum(right, at), right)
    return left, right


def _planes(corners: Array) -> tuple[Array, Array]:
    """Depth at the pixel (0, 0) and its slopes, of each triangle."""
    a, b, c = np.moveaxis(corners, 1, 0)
    normal = np.cross(b - a, c - a)
    steep = np.where(np.abs(normal[:, 2]) < 1e-12, 1e-12, normal[:, 2])
    slope = -normal[:, :2] / steep[:, None]
    return a[:, 2] - (slope * a[:, :2]).sum(axis=1), slope


def _seen(ends: Array, depth: _Depth, pixel_mm: float) -> list[Array]:
    """Return the visible parts (2, 2) of edges (n, 2 ends, 3)."""
    lengths = np.linalg.norm(ends[:, 1, :2] - ends[:, 0, :2], axis=1)
    counts = np.ceil(lengths / pixel_mm).astype(int) + 1
    owner, step = _expanded(np.zeros(len(counts), dtype=int), counts)
    share = (step + 0.5) / counts[owner]
    points = ends[owner, 0] + share[:, None] * (ends[owner, 1] - ends[owner, 0])
    seen = depth.farthest_around(points) <= points[:, 2] + _BIAS * pixel_mm
    change = np.flatnonzero(np.r_[True, (owner[1:] != owner[:-1]) | (seen[1:] != seen[:-1])])
    stop = np.r_[change[1:], len(owner)]
    runs = [(i, j) for i, j in zip(change, stop, strict=True) if seen[i]]
    parts = []
    for i, j in runs:
        edge, many = owner[i], counts[owner[i]]
        if j - i >= min(_LEAST, many) and lengths[edge] > 0:
            ab = np.array([step[i], step[j - 1] + 1]) / many
            parts.append(ends[edge, 0, :2] + ab[:, None] * (ends[edge, 1, :2] - ends[edge, 0, :2]))
    return parts


def _merged(parts: list[Array], near_mm: float) -> list[Array]:
    """Join parts of one straight line that overlap or touch: a circle seen from its edge is many."""
    lines: dict[tuple[int, int], list[tuple[float, float, Array]]] = defaultdict(list)
    for part in parts:
        way = (part[1] - part[0]) / np.linalg.norm(part[1] - part[0])
        way = way if (way[0], way[1]) > (1e-9, -1.0) else -way
        off = float(part[0, 0] * way[1] - part[0, 1] * way[0])
        key = round(float(np.arctan2(way[1], way[0])) / 1e-3), round(off / near_mm)
        along = part @ way
        order = np.argsort(along)
        lines[key].append((float(along[order[0]]), float(along[order[1]]), part[order]))
    return [joined for spans in lines.values() for joined in _joined(spans, near_mm / 10)]


def _joined(spans: list[tuple[float, float, Array]], near_mm: float) -> list[Array]:
    found: list[tuple[float, float, Array]] = []
    for low, high, ends in sorted(spans, key=lambda span: span[:2]):
        if found and low <= found[-1][1] + near_mm:
            if high > found[-1][1]:
                found[-1] = (found[-1][0], high, np.array([found[-1][2][0], ends[1]]))
        else:
            found.append((low, high, ends))
    return [ends for _, _, ends in found]


def _chains(parts: list[Array], near_mm: float) -> list[Array]:
    """Join parts end to end where two ends meet alone."""
    keys = [tuple((tuple(np.rint(end / near_mm).astype(int))) for end in part) for part in parts]
    at: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for index, pair in enumerate(keys):
        for key in pair:
            at[key].append(index)
    used, chains = [False] * len(parts), []
    for start in range(len(parts)):
        if used[start]:
            continue
        used[start] = True
        chain = [parts[start][0], parts[start][1]]
        for forward in (True, False):
            index, key = start, keys[start][1 if forward else 0]
            while len(at[key]) == 2:
                index = at[key][1] if at[key][0] == index else at[key][0]
                if used[index]:
                    break
                used[index] = True
                far = 1 if keys[index][0] == key else 0
                chain.insert(len(chain) if forward else 0, parts[index][far])
                key = keys[index][far]
        chains.append(np.array(chain))
    return chains
