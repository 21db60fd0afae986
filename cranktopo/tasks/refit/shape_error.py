"""Shape error between two bodies: overlap of their volumes, distances between their surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.reproducible import SEED
from cranktopo.bodies.prisms import web_region
from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.tasks.extraction.cutter import distances_mm

if TYPE_CHECKING:
    from manifold3d import Manifold

_SAMPLES = 10_000


@dataclass(frozen=True)
class ShapeError:
    """Fitted against extracted body; web means the part between the web faces, distances go both ways."""

    iou: float
    web_iou: float
    mean_distance_mm: float
    max_distance_mm: float
    farthest_mm: tuple[float, float, float]
    web_volume_mm3: float
    body_web_volume_mm3: float


def shape_error(scene: Scene, surface: SurfaceMesh) -> ShapeError:
    """Return how the exact solid of a scene differs from an extracted half throw."""
    body = solid_of(surface, "surface to be re-modelled")
    half, web = (_solid(scene, part) for part in ("half", "web"))
    region = web_region(body, scene)
    mean, largest, where = surface_distance_mm(mesh_of(web), mesh_of(region))
    return ShapeError(
        overlap(half, body),
        overlap(web, region),
        mean,
        largest,
        where,
        float(web.volume()),
        float(region.volume()),
    )


def web_overlap(scene: Scene, surface: SurfaceMesh) -> float:
    """Return the overlap of the web of a scene with that of an extracted half throw, 0 to 1."""
    body = solid_of(surface, "surface to be re-modelled")
    return overlap(_solid(scene, "web"), web_region(body, scene))


def overlap(one: Manifold, other: Manifold) -> float:
    """Return the intersection over union of two solids, 0 to 1."""
    both = (one ^ other).volume()
    return float(both / (one.volume() + other.volume() - both))


def surface_distance_mm(
    one: SurfaceMesh, other: SurfaceMesh
) -> tuple[float, float, tuple[float, float, float]]:
    """Return mean and largest distance of two surfaces from even samples, and the farthest point, mm."""
    random = np.random.default_rng(SEED)
    points, others = (_samples(mesh, random) for mesh in (one, other))
    places = np.vstack([points, others])
    distances = np.concatenate([distances_mm(points, other), distances_mm(others, one)])
    x, y, z = places[int(distances.argmax())]
    return float(distances.mean()), float(distances.max()), (float(x), float(y), float(z))


def _solid(scene: Scene, part: str) -> Manifold:
    mesh = surface_of(scene, "half" if part == "half" else "web")
    return solid_of(mesh, f"fitted {part}")


def _samples(mesh: SurfaceMesh, random: np.random.Generator) -> Array:
    a, b, c = np.moveaxis(mesh.corners_mm, 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    face = np.searchsorted(np.cumsum(area) / area.sum(), (np.arange(_SAMPLES) + 0.5) / _SAMPLES)
    u, v = random.random((2, _SAMPLES, 1))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    return np.asarray(a[face] + u * (b - a)[face] + v * (c - a)[face])
