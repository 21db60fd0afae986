"""Sharp inner edges of a surface, where stress is singular and its value follows from the mesh alone."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.stress import Surface, face_normals

_SHARP = math.cos(math.radians(30.0))
"""Cosine between normals at an edge below which it is sharp; curved faces of an arc stay above it."""


def near_sharp_edges(surface: Surface) -> NDArray[np.bool_]:
    """Return which nodes (n,) lie within two faces of a sharp inner edge, where stress is singular."""
    faces = surface.faces
    near = np.zeros(len(surface.nodes), dtype=bool)
    near[_inner_edges(surface)[1]] = True
    for _ in range(2):
        near[faces[:, near[faces].any(axis=0)]] = True
    return near


def from_sharp_edges_mm(surface: Surface) -> Array:
    """Return the distance of nodes (n,) from the nearest node of a sharp inner edge; inf where none is."""
    edges = np.unique(_inner_edges(surface))
    if not len(edges):
        return np.full(len(surface.nodes), np.inf)
    return np.asarray(cKDTree(surface.points_mm[:, edges].T).query(surface.points_mm.T)[0])


def _inner_edges(surface: Surface) -> Index:
    """Return the nodes of sharp inner edges as positions in the surface: end, middle, end, shape (3, edges).

    An edge is sharp where the curved faces beside it meet at more than 30 degrees; it is an inner one where
    the material fills more than half of the space around it (Williams, 1952: no other edge is singular).
    """
    faces = surface.faces
    at = surface.points_mm[:, faces]  # (3, 6, f)
    normal = face_normals(at)[:, 3:]
    normal /= np.linalg.norm(normal, axis=0)
    outward = surface.normals[faces].mean(axis=0).T
    normal *= np.sign(np.einsum("ipf,if->pf", normal, outward))
    middles = faces[3:].ravel()
    order = np.argsort(middles, kind="stable")
    pairs = np.flatnonzero(middles[order][1:] == middles[order][:-1])
    one, other = order[pairs], order[pairs + 1]
    normals, centres = normal.reshape(3, -1), np.tile(at[:, :3].mean(axis=1), 3)
    turned = (normals[:, one] * normals[:, other]).sum(axis=0) < _SHARP
    beyond = centres[:, other] - surface.points_mm[:, middles[one]]
    inner = one[turned & ((beyond * normals[:, one]).sum(axis=0) > 0)]
    ends = faces[:3].ravel(), np.roll(faces[:3], -1, axis=0).ravel()
    return np.stack([ends[0][inner], middles[inner], ends[1][inner]])
