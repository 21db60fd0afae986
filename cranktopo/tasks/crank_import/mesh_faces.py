"""Planes, cylinders, cones and fillets of a body of triangles, found by growing regions and least squares.

Corners of triangles lie on the body, triangles beside it: normals part the triangles into regions, and
corners alone tell dimensions. What lies along the crank is looked for in a plane across it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array, Int64, Mask
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.crank_import.distortion import Roundness, roundness
from cranktopo.tasks.crank_import.fits import (
    across,
    covered_rad,
    median_direction,
    rms,
    tangent_fillet,
    tilt,
    trimmed_circle,
    weighted_median,
)
from cranktopo.tasks.crank_import.mesh_bores import BENT_RAD, FEWEST, bore_of, drillings, of_one_bore
from cranktopo.tasks.crank_import.mesh_cones import cones_about
from cranktopo.tasks.crank_import.mesh_skin import Skin
from cranktopo.tasks.crank_import.mesh_walls import FULL_RAD, Wall, walls, whole_wall
from cranktopo.tasks.importing.faces import ConeFace, CylinderFace, Faces, PlaneFace, TorusFace

_SPREAD = 0.07
"""Sine between the crank axis and the fold of two neighbours that lie along it."""
_UPRIGHT, _ACROSS = 0.1, 1 - 1e-4
"""Parts of a normal along the crank of a wall, and of a face across."""
_COPLANAR_RAD, _FILLET_RAD = 0.02, 0.95
"""Folds within a plane, and within a fillet of few facets."""
_SHARED = 0.02
"""Distance of axes that may be one over the radius of the cylinder about them."""
_SLANTED = 1e-4
"""Area of a bevel, or of a face that is told, over the body's."""
_SQUARE = 1 - 3e-7
"""Part along the crank of the normal of a face that is square to it: 0.045 deg."""


def mesh_faces(mesh: SurfaceMesh, near_mm: float) -> tuple[Faces, tuple[Roundness, ...]]:
    """Return the faces of a body of triangles, and how far its whole cylinders are such.

    Args:
        near_mm: distance of corners from a face that they belong to.
    """
    skin = Skin(mesh, near_mm)
    axis = _direction(skin)
    if axis is None:
        return Faces((), (), (), ()), ()
    matrix = np.vstack([across(axis), axis])
    matrix = _straightened(skin.turned(matrix)) @ matrix
    faces, journals = _faces(skin.turned(matrix))
    return turned_faces(faces, matrix.T, np.zeros(3)), journals


def turned_faces(faces: Faces, matrix: Array, shift: Array) -> Faces:
    """Return faces after a rigid motion, p -> matrix p + shift."""

    def at(point: Array) -> Array:
        return np.asarray(matrix @ point + shift)

    return Faces(
        tuple(
            replace(f, point_mm=at(f.point_mm), axis=matrix @ f.axis, middle_mm=at(f.middle_mm))
            for f in faces.cylinders
        ),
        tuple(replace(f, normal=matrix @ f.normal, point_mm=at(f.point_mm)) for f in faces.planes),
        tuple(replace(f, centre_mm=at(f.centre_mm), axis=matrix @ f.axis) for f in faces.tori),
        faces.others,
        tuple(
            replace(f, axis=matrix @ f.axis, ends_mm=(at(f.ends_mm[0]), at(f.ends_mm[1])))
            for f in faces.cones
        ),
    )


def _direction(skin: Skin) -> Array | None:
    """Return the direction along which most round area lies; None where nothing is round."""
    bent = (skin.folds > BENT_RAD[0]) & (skin.folds < BENT_RAD[1])
    one, other = skin.pairs[bent].T
    folds = np.cross(skin.normals[one], skin.normals[other])
    weights = (skin.areas[one] + skin.areas[other]) * (skin.folds[bent] > 0)
    if not len(weights) or weights.sum() == 0:
        return None
    return median_direction(folds / np.linalg.norm(folds, axis=1)[:, None], weights, _SPREAD)


def _straightened(skin: Skin) -> Array:
    """Return the rotation that stands whole cylinders, which nearly lie along z, along it."""
    matrix = np.eye(3)
    for _ in range(3):
        turned = skin.turned(matrix)
        leaning, total = np.zeros(2), 0.0
        for region in turned.regions(np.abs(turned.normals[:, 2]) < _UPRIGHT, BENT_RAD[1]):
            slopes, weight = _lean(turned, region)
            leaning, total = leaning + weight * slopes, total + weight
        if total == 0:
            return matrix
        axis = np.array([*(leaning / total), 1.0])
        axis /= np.linalg.norm(axis)
        matrix = np.vstack([across(axis), axis]) @ matrix
    return matrix


def _lean(skin: Skin, region: Int64) -> tuple[Array, float]:
    """Return the slopes (2,) of the whole cylinder that a region is, and their weight; 0 where it is none.

    An ellipse goes all the way round as well: corners must lie on the cylinder once its lean is taken off.
    """
    points, weights = skin.triangles(region).reshape(-1, 3), skin.areas[region].repeat(3)
    found, near = trimmed_circle(points[:, :2], weights, skin.near_mm)
    whole = covered_rad(points[near, :2], found.centre)[0] > FULL_RAD
    height = float(np.ptp(points[near, 2]))
    if not whole or weights[near].sum() < weights.sum() / 2 or height == 0:
        return np.zeros(2), 0.0
    z = points[near, 2] - points[near, 2].mean()
    unit = (points[near, :2] - found.centre) / found.radius
    slopes = tilt(unit, z, found.off_mm[near])
    beside = np.abs(found.off_mm[near] - z * (unit @ slopes))
    on = weighted_median(beside, weights[near]) < skin.near_mm
    return slopes, float(skin.areas[region].sum()) * height**2 if on else 0.0


def _faces(skin: Skin) -> tuple[Faces, tuple[Roundness, ...]]:
    """Return the faces of a body with its crank axis along z, and how far whole cylinders are such."""
    left = np.ones(len(skin.areas), bool)
    bores = list(drillings(skin, left))
    along = skin.normals[:, 2]
    flat, upright = left & (np.abs(along) > _ACROSS), left & (np.abs(along) < _UPRIGHT)
    planes = [_plane(skin, region) for region in skin.regions(flat, _COPLANAR_RAD)]
    found, cones = _upright(skin, upright)
    journals = tuple(roundness(wall) for wall in found if wall.full)
    found = on_axes(found, skin.near_mm)
    left &= ~flat & ~upright
    rounds = [wall for wall in found if wall.full and wall.outward]
    tori: list[TorusFace] = []
    others: list[str] = []
    for whole in skin.regions(left, _FILLET_RAD):
        torus = _torus(skin, whole, rounds)
        steep, region = cones_about(skin, whole, _centres(rounds)) if torus is None else ([], whole[:0])
        bore = bore_of(skin, region) if len(region) else None
        tori += [] if torus is None else [torus]
        cones += steep
        if bore is not None:
            bores.append(bore)
        elif len(region):
            flats = list(_flats(skin, region))
            planes += flats
            small = skin.areas[region].sum() < _SLANTED * skin.areas.sum()
            others += [] if flats or small else [_kind(skin, region, rounds)]
    heights = np.array([plane.point_mm[2] for plane in planes if abs(plane.normal[2]) == 1])
    cones = [_ended_cone(cone, heights, skin.near_mm) for cone in cones]
    heights = np.append(heights, [end[2] for cone in cones for end in cone.ends_mm])
    uprights = (_ended(wall.cylinder(), heights, skin.near_mm) for wall in found if wall.radius)
    cylinders = [*uprights, *of_one_bore(bores, skin.near_mm)]
    planes += [wall.plane() for wall in found if not wall.radius]
    return Faces(tuple(cylinders), tuple(planes), tuple(tori), tuple(others), tuple(cones)), journals


def _upright(skin: Skin, chosen: Mask) -> tuple[list[Wall], list[ConeFace]]:
    """Return the walls of upright triangles, and the slender cones between them about whole ones."""
    regions = list(skin.regions(chosen, BENT_RAD[1]))
    whole = [whole_wall(skin, region) for region in regions]
    found = [wall for wall in whole if wall is not None]
    centres = _centres(on_axes([wall for wall in found if wall.outward], skin.near_mm))
    cones: list[ConeFace] = []
    for region in (region for region, wall in zip(regions, whole, strict=True) if wall is None):
        slender, rest = cones_about(skin, region, centres)
        cones += slender
        found += walls(skin, rest) if len(rest) else []
    return found, cones


def _centres(rounds: Sequence[Wall]) -> list[Array]:
    """Return the axes of walls, each once."""
    return list({tuple(wall.centre): wall.centre for wall in rounds}.values())


def on_axes(found: Sequence[Wall], near_mm: float) -> list[Wall]:
    """Return walls, those cylinders about one axis that nearly are: the larger tell it."""
    axes: list[Array] = []
    moved: list[Wall] = []
    for wall in sorted(found, key=lambda wall: (not wall.full, -wall.area)):
        own = wall
        if wall.radius:
            about = [
                wall.about(axis)
                for axis in axes
                if np.linalg.norm(axis - wall.centre) < _SHARED * wall.radius
            ]
            about = [other for other in about if other.off_mm < max(2 * wall.off_mm, near_mm)]
            own = min(about, key=lambda other: other.off_mm, default=wall)
            if own is wall and wall.full:
                axes.append(wall.centre)
        moved.append(own)
    return moved


def _plane(skin: Skin, region: Int64) -> PlaneFace:
    """Return a face across the crank: its height is that of most of its corners."""
    areas = skin.areas[region]
    heights = np.median(skin.triangles(region)[:, :, 2], axis=1)
    middle = weighted_median(heights, areas)
    x, y = np.average(skin.triangles(region).mean(axis=1)[:, :2], axis=0, weights=areas)
    normal = (skin.normals[region] * areas[:, None]).sum(axis=0)
    normal /= np.linalg.norm(normal)
    if abs(normal[2]) > _SQUARE:
        normal = np.array([0.0, 0.0, np.sign(normal[2])])
    off = rms(skin.corners(region)[:, 2] - middle)
    return PlaneFace(normal, np.array([x, y, middle]), float(areas.sum()), off)


def _ended(face: CylinderFace, heights: Array, near_mm: float) -> CylinderFace:
    """Return an upright cylinder that ends in the faces beside it: its outermost corners scatter."""
    low, high = (_nearest(heights, end, near_mm) for end in face.span_mm)
    return replace(face, span_mm=(low, high))


def _ended_cone(cone: ConeFace, heights: Array, near_mm: float) -> ConeFace:
    """Return a cone along z that ends in the planes across it."""
    low, high = (np.array([*end[:2], _nearest(heights, end[2], near_mm)]) for end in cone.ends_mm)
    return replace(cone, ends_mm=(low, high))


def _nearest(heights: Array, end: float, near_mm: float) -> float:
    """Return the nearest of heights; the end itself where none is near."""
    return float(min(heights[np.abs(heights - end) < near_mm], key=lambda z: abs(z - end), default=end))


def _flats(skin: Skin, region: Int64) -> Iterator[PlaneFace]:
    """Yield slanted planes of a region."""
    chosen = np.zeros(len(skin.areas), bool)
    chosen[region] = True
    for part in skin.regions(chosen, _COPLANAR_RAD):
        area = float(skin.areas[part].sum())
        if area > _SLANTED * skin.areas.sum():
            points = skin.corners(part)
            middle = points.mean(axis=0)
            normal = np.linalg.svd(points - middle, full_matrices=False)[2][-1]
            sign = np.sign(normal @ (skin.normals[part] * skin.areas[part, None]).sum(axis=0))
            yield PlaneFace(sign * normal, middle, area, rms((points - middle) @ normal))


def _torus(skin: Skin, region: Int64, rounds: Sequence[Wall]) -> TorusFace | None:
    """Return the fillet that all of a region lies on best, of a whole cylinder; None where it is none."""
    tori = (_fillet(skin.corners(region), wall, skin.near_mm) for wall in rounds)
    return min((torus for torus in tori if torus), key=lambda torus: torus.off_mm, default=None)


def _fillet(points: Array, wall: Wall, near_mm: float) -> TorusFace | None:
    """Return the fillet of one cylinder that corners (n, 3) lie on; None where they do not."""
    out = np.linalg.norm(points[:, :2] - wall.centre, axis=1)
    if abs(float(out.min()) - wall.radius) > wall.radius * _SHARED or len(points) < FEWEST:
        return None
    tube, height = tangent_fillet(out, points[:, 2], wall.radius)
    off = np.abs(np.hypot(out - wall.radius - tube, points[:, 2] - height) - abs(tube))
    if not (0 < tube < wall.radius and np.median(off) < near_mm and (off < 2 * near_mm).mean() > 0.9):
        return None
    centre = np.array([*wall.centre, height])
    return TorusFace(centre, np.array([0.0, 0.0, 1.0]), wall.radius + tube, tube, rms(off))


def _kind(skin: Skin, region: Int64, rounds: Sequence[Wall]) -> str:
    """Return what a region is that no design says: a cone about a journal, or another face."""
    points = skin.corners(region)
    for centre in (wall.centre for wall in rounds):
        out = np.linalg.norm(points[:, :2] - centre, axis=1)
        line = np.polyfit(points[:, 2], out, 1) if np.ptp(points[:, 2]) > 0 else np.zeros(2)
        if np.abs(np.polyval(line, points[:, 2]) - out).max() < 2 * skin.near_mm:
            return "Cone"
    return "Free-form surface"
