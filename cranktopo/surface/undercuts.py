"""Undercuts: what a die that parts in the plane x = 0 cannot release, by rays along x through any surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold
from numpy.typing import NDArray

from cranktopo.frames import X, Y, Z
from cranktopo.scene import Scene
from cranktopo.surface.solids import envelope_holes, web_bores, web_region
from cranktopo.triangles.surface_mesh import SurfaceMesh, mesh_of, solid_of

Array = NDArray[np.float64]
NEGLIGIBLE_SHARE = 1e-4
"""Undercuts below this share of the web are grazing slivers that the triangles themselves do not resolve."""
_BEYOND_MM = 1.0
_TOUCH_MM = 1e-3


@dataclass(frozen=True)
class Undercuts:
    """What a die cannot release.

    Attributes:
        rays: rays that met the web.
        caught: rays with void between the parting plane and solid further out.
        deepest_mm: longest such void along one ray and side.
    """

    rays: int
    caught: int
    deepest_mm: float
    volume_mm3: float
    web_mm3: float

    @property
    def negligible(self) -> bool:
        """Whether a die releases the web."""
        return self.volume_mm3 <= NEGLIGIBLE_SHARE * self.web_mm3

    def as_json(self) -> dict[str, Any]:
        """The values by name."""
        return {
            "rays": self.rays,
            "caught_rays": self.caught,
            "deepest_mm": self.deepest_mm,
            "volume_mm3": self.volume_mm3,
            "released": self.negligible,
        }


def undercuts(web: SurfaceMesh, scene: Scene, step_mm: float) -> Undercuts:
    """Undercuts of a web along x on either side of the plane x = 0, bores and drilled holes filled.

    Args:
        scene: its bores and the holes of its envelope, which are drilled after the die.
    """
    body = solid_of(web, "web") + web_bores(scene)
    holes = envelope_holes(scene)
    filled = body if holes.is_empty() else body + holes
    low, high = web.vertices_mm.min(axis=0), web.vertices_mm.max(axis=0)
    ends = low[X] - _BEYOND_MM, high[X] + _BEYOND_MM
    y, z = (_centres(low[axis], high[axis], step_mm) for axis in (Y, Z))
    area = float(y[1] - y[0]) * float(z[1] - z[0])
    met, voids = 0, []
    for v in y.tolist():
        for w in z.tolist():
            cuts = _cuts(body, ends, v, w)
            within = cuts if filled is body else _cuts(filled, ends, v, w)
            met += bool(len(cuts))
            voids += [_void_mm(cuts, within), _void_mm(-cuts[::-1], -within[::-1])]
    lengths = np.array(voids).reshape(-1, 2)
    caught = int((lengths > _TOUCH_MM).any(axis=1).sum())
    return Undercuts(met, caught, float(lengths.max()), float(lengths.sum() * area), web.volume_mm3)


def half_throw_undercuts(half_throw: SurfaceMesh, scene: Scene, step_mm: float) -> Undercuts:
    """Undercuts of the web of a half throw, from any source."""
    body = solid_of(half_throw, "half throw")
    return undercuts(mesh_of(web_region(body, scene)), scene, step_mm)


def _centres(low: float, high: float, step: float) -> Array:
    """Middles of at least two equal steps between two ends; off the round numbers that faces lie on."""
    count = max(2, round((high - low) / step))
    return np.asarray(low + (high - low) / count * (np.arange(count) + 0.5), dtype=np.float64)


def _cuts(body: Manifold, ends: tuple[float, float], y: float, z: float) -> Array:
    """Sorted x of the entries into a body and exits from it along a ray."""
    return np.array([hit.position[X] for hit in body.ray_cast((ends[0], y, z), (ends[1], y, z))])


def _void_mm(cuts: Array, within: Array) -> float:
    """Length of void between x = 0 and the outermost solid at x > 0.

    Args:
        cuts: of the web.
        within: of the web with its holes filled, which count as solid only within the web.
    """
    if len(cuts) % 2 or len(within) % 2:  # grazes an edge
        return 0.0
    outermost = float(cuts.max(initial=0.0))
    return outermost - float(np.diff(within.reshape(-1, 2).clip(min=0.0, max=outermost)).sum())
