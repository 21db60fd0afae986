"""Exact faces of the body in an open CAD session: planes, cylinders, cones, tori, by the kernel's numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.importing.found_fillets import sampled

_SAME = 1e-6
"""Share of a radius in which two faces count as one: what CAD systems keep of a dimension in a file."""
PARALLEL = 1e-7
"""Largest sine between directions that count as one."""
FLAT = 1e-6
"""Largest part of a direction across that counts as none, in the frame of a throw."""
DIGITS = 9
"""Decimals of a dimension that is taken from exact faces."""
_SIDEWARD = 0.3
"""Least part across the throw of the normal of a plane side."""
_FULL_TURN = 2 * math.pi * (1 - 1e-6)


@dataclass(frozen=True)
class CylinderFace:
    """A cylindrical face; `span_mm` lies along its axis from `point_mm`.

    Attributes:
        turn_rad: angle about the axis; of two halves that were joined, their sum.
        outward: True for a shaft, False for a bore.
        middle_mm: the point in the middle of the face.
        off_mm: distance of the corners that it was fitted to, root of the mean of squares; 0 of exact ones.
    """

    point_mm: Array
    axis: Array
    radius_mm: float
    span_mm: tuple[float, float]
    turn_rad: float
    outward: bool
    middle_mm: Array
    off_mm: float = 0.0

    @property
    def full(self) -> bool:
        """True if it goes all the way round."""
        return self.turn_rad >= _FULL_TURN

    @property
    def upright(self) -> bool:
        """True if it lies along z."""
        return bool(abs(self.axis[2]) > 1 - FLAT)

    @property
    def area_mm2(self) -> float:
        """Area of the whole strip that it spans."""
        return self.radius_mm * self.turn_rad * (self.span_mm[1] - self.span_mm[0])


@dataclass(frozen=True)
class PlaneFace:
    """A plane face with its outward normal, a point on it and its area; `off_mm` as of a cylinder."""

    normal: Array
    point_mm: Array
    area_mm2: float
    off_mm: float = 0.0

    @property
    def upright(self) -> bool:
        """True if it lies along z."""
        return bool(abs(self.normal[2]) < FLAT)


@dataclass(frozen=True)
class TorusFace:
    """A face of a torus: a round fillet or an edge's rounding about an axis; `off_mm` as of a cylinder."""

    centre_mm: Array
    axis: Array
    ring_mm: float
    tube_mm: float
    off_mm: float = 0.0


@dataclass(frozen=True)
class ConeFace:
    """A conical face: the middles of its ends on its axis, and their radii."""

    axis: Array
    ends_mm: tuple[Array, Array]
    radii_mm: tuple[float, float]
    full: bool
    outward: bool


@dataclass(frozen=True)
class Faces:
    """Faces of a body by kind; `others` are names of the surfaces that no web has, cones among them.

    Attributes:
        patches_mm: points (n, 3) on each of the others that is no cone.
    """

    cylinders: tuple[CylinderFace, ...]
    planes: tuple[PlaneFace, ...]
    tori: tuple[TorusFace, ...]
    others: tuple[str, ...]
    cones: tuple[ConeFace, ...] = ()
    patches_mm: tuple[Array, ...] = ()

    @property
    def sides(self) -> list[PlaneFace]:
        """Plane sides of a web at x > 0, in the frame of a throw, the largest first."""
        sides = [plane for plane in self.planes if plane.upright and plane.normal[0] > _SIDEWARD]
        return sorted(sides, key=lambda plane: -plane.area_mm2)


def exact_faces(gmsh: Any, tags: Sequence[int] | None = None) -> Faces:
    """Return faces of the open session by their tags; by default all."""
    cylinders: list[CylinderFace] = []
    planes: list[PlaneFace] = []
    tori: list[TorusFace] = []
    cones: list[ConeFace] = []
    patches: list[Array] = []
    others: list[str] = []
    for tag in [tag for _, tag in gmsh.model.getEntities(2)] if tags is None else tags:
        kind = gmsh.model.getType(2, tag)
        reals = np.array(gmsh.model.getEntityProperties(2, tag)[1])
        if kind == "Cylinder":
            cylinders.append(_cylinder(gmsh, tag, reals))
        elif kind == "Plane":
            point, normal = _middle(gmsh, tag)
            planes.append(PlaneFace(normal, point, float(gmsh.model.occ.getMass(2, tag))))
        elif kind == "Torus":
            tori.append(TorusFace(reals[:3], reals[3:6], float(reals[6]), float(reals[7])))
        else:
            others.append(kind)
            cones += [_cone(gmsh, tag, reals)] if kind == "Cone" else []
            patches += [] if kind == "Cone" else [sampled(gmsh, tag)]
    joined = tuple(_joined(cylinders))
    return Faces(joined, tuple(planes), tuple(tori), tuple(others), tuple(cones), tuple(patches))


def _cylinder(gmsh: Any, tag: int, reals: Array) -> CylinderFace:
    (first, low), (last, high) = gmsh.model.getParametrizationBounds(2, tag)
    point, normal = _middle(gmsh, tag)
    outward = bool(normal @ (point - reals[:3]) > 0)
    return CylinderFace(
        reals[:3], reals[3:6], float(reals[6]), (float(low), float(high)), float(last - first), outward, point
    )


def _cone(gmsh: Any, tag: int, reals: Array) -> ConeFace:
    (first, low), (last, high) = gmsh.model.getParametrizationBounds(2, tag)
    on_axis, axis = reals[:3], reals[3:6]
    rims = np.array(gmsh.model.getValue(2, tag, [first, low, first, high])).reshape(2, 3)
    ends = [on_axis + ((rim - on_axis) @ axis) * axis for rim in rims]
    radii = [float(np.linalg.norm(rim - end)) for rim, end in zip(rims, ends, strict=True)]
    middle, normal = _middle(gmsh, tag)
    outward = bool(normal @ (middle - on_axis - ((middle - on_axis) @ axis) * axis) > 0)
    return ConeFace(axis, (ends[0], ends[1]), (radii[0], radii[1]), bool(last - first >= _FULL_TURN), outward)


def _middle(gmsh: Any, tag: int) -> tuple[Array, Array]:
    """Return point and outward normal in the middle of a face's parameters."""
    low, high = gmsh.model.getParametrizationBounds(2, tag)
    at = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
    return np.array(gmsh.model.getValue(2, tag, at)), np.array(gmsh.model.getNormal(tag, at))


def _joined(faces: Sequence[CylinderFace]) -> Iterator[CylinderFace]:
    """Yield cylinders, those that CAD systems split into parts of a full turn as one."""
    left = list(faces)
    while left:
        face, *left = left
        parts = [other for other in left if not face.full and _same_strip(face, other)]
        whole = replace(face, turn_rad=face.turn_rad + sum(part.turn_rad for part in parts))
        if parts and whole.full:
            left = [other for other in left if not any(other is part for part in parts)]
            face = whole
        yield face


def _same_strip(one: CylinderFace, other: CylinderFace) -> bool:
    if one.outward != other.outward or not same_axis(one, other):
        return False
    near = _SAME * one.radius_mm
    span = span_along(other, one.point_mm, one.axis)
    return abs(one.radius_mm - other.radius_mm) < near and bool(
        np.abs(np.subtract(span, one.span_mm)).max() < 10 * near
    )


def same_axis(one: CylinderFace, other: CylinderFace) -> bool:
    """Tell whether two cylinders lie on one line."""
    size = max(one.radius_mm, other.radius_mm)
    return (
        parallel(one.axis, other.axis)
        and from_line_mm(other.point_mm, one.point_mm, one.axis) < 10 * _SAME * size
    )


def parallel(one: Array, other: Array) -> bool:
    """Tell whether two directions are the same or opposite."""
    return float(np.linalg.norm(np.cross(one, other))) < PARALLEL


def from_line_mm(point_mm: Array, on_mm: Array, axis: Array) -> float:
    """Return the distance of a point from a line."""
    return float(np.linalg.norm(np.cross(point_mm - on_mm, axis)))


def span_along(face: CylinderFace, origin_mm: Array, axis: Array) -> tuple[float, float]:
    """Return where a cylinder begins and ends along a parallel line, from a point on that."""
    start = float((face.point_mm - origin_mm) @ axis)
    sign = 1.0 if float(face.axis @ axis) > 0 else -1.0
    low, high = sorted(start + sign * end for end in face.span_mm)
    return low, high


def lines_of(shafts: Sequence[CylinderFace]) -> list[list[CylinderFace]]:
    """Return cylinders by the line that they lie on."""
    lines: list[list[CylinderFace]] = []
    for face in shafts:
        own = next((line for line in lines if same_axis(line[0], face)), None)
        if own is None:
            lines.append([face])
        else:
            own.append(face)
    return lines
