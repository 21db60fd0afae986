"""Triangles of a body with normals, neighbours and folds, and the regions that folds part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array, Int64, Mask
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, connected
from cranktopo.tasks.crank_import.fits import weighted_quantile

_SMALLEST = 2e-6
"""Area of a region that is looked at, over the body's."""


_TENTH, _OF_SCATTER = 0.1, 0.11
"""Share of the area, and the distance that it is within over the scatter of corners."""


@dataclass(frozen=True, eq=False)
class Skin:
    """Triangles of a body; corners nearer than `near_mm` to a face count as on it."""

    mesh: SurfaceMesh
    near_mm: float

    @cached_property
    def normals(self) -> Array:
        """Unit normals (m, 3); zero for a triangle without area."""
        a, b, c = np.moveaxis(self.mesh.corners_mm, 1, 0)
        cross = np.cross(b - a, c - a)
        return np.asarray(cross / np.maximum(np.linalg.norm(cross, axis=1), 1e-300)[:, None])

    @cached_property
    def areas(self) -> Array:
        """Areas (m,)."""
        return self.mesh.areas_mm2

    @cached_property
    def pairs(self) -> Int64:
        """Numbers (k, 2) of neighbours."""
        return np.asarray(self.mesh.as_trimesh().face_adjacency, np.int64)

    @cached_property
    def folds(self) -> Array:
        """Angles (k,) between neighbours."""
        one, other = (self.normals[side] for side in self.pairs.T)
        return np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), (one * other).sum(axis=1))

    def regions(self, chosen: Mask, fold_rad: float) -> Iterator[Int64]:
        """Yield numbers of chosen triangles, those together between which no sharper fold lies."""
        one, other = self.pairs.T
        within = chosen[one] & chosen[other] & (self.folds < fold_rad)
        yield from self._large(chosen, self.pairs[within])

    def _large(self, chosen: Mask, links: Int64) -> Iterator[Int64]:
        numbers, least = np.flatnonzero(chosen), _SMALLEST * self.areas.sum()
        labels = connected(len(chosen), links)[numbers]
        order = np.argsort(labels, kind="stable")
        for region in np.split(numbers[order], np.flatnonzero(np.diff(labels[order])) + 1):
            if self.areas[region].sum() > least:
                yield region

    def lonely_share(self, fold_rad: float) -> float:
        """Return the part of the area in triangles whose neighbours all lie across a sharper fold."""
        least = np.full(len(self.areas), np.pi)
        for side in self.pairs.T:
            np.minimum.at(least, side, self.folds)
        return float(self.areas[least > fold_rad].sum() / self.areas.sum())

    @property
    def scatter_mm(self) -> float:
        """Scatter of corners, as it seems; 0 where a tenth of the area has a neighbour in its plane.

        Flat faces and strips along cylinders have. Corners that scatter by s leave a tenth of the area within
        0.11 s of the nearest neighbour's plane, 0.09 to 0.13 s over bodies and s.
        """
        least = np.full(len(self.areas), np.inf)
        corners = self.mesh.corners_mm
        for one, other in (self.pairs.T, self.pairs.T[::-1]):
            apart = np.einsum("mij,mj->mi", corners[other] - corners[one][:, :1], self.normals[one])
            height = np.abs(apart).max(axis=1)
            np.minimum.at(least, one, height)
            np.minimum.at(least, other, height)
        return weighted_quantile(least, self.areas, _TENTH) / _OF_SCATTER

    def triangles(self, region: Int64) -> Array:
        """Return the corners (n, 3, 3) of triangles, those of each its own."""
        return np.asarray(self.mesh.vertices_mm[self.mesh.faces[region]])

    def corners(self, region: Int64) -> Array:
        """Return the corners (n, 3) of triangles, each once."""
        return self.mesh.vertices_mm[np.unique(self.mesh.faces[region])]

    def turned(self, matrix: Array) -> Skin:
        """Return the body turned, p -> matrix p."""
        skin = Skin(SurfaceMesh(self.mesh.vertices_mm @ matrix.T, self.mesh.faces), self.near_mm)
        vars(skin).update(pairs=self.pairs, folds=self.folds, areas=self.areas)
        return skin
