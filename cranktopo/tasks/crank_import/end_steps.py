"""Steps of an end of the crank: cylinders, cones and keyways that follow outwards on a main journal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.crank_import.found_crank import FoundBolts, FoundKeyway, FoundStep
from cranktopo.tasks.importing.faces import (
    FLAT,
    CylinderFace,
    Faces,
    PlaneFace,
    from_line_mm,
    parallel,
    span_along,
)

_NEAR = 1e-5
"""Share of a radius in which places count as one."""
_EVEN_RAD = 1e-5
"""Angle by which holes of one circle may be off their even spacing."""
_AREA = 1e-3
"""Share in which the floor of a keyway has the area of its width by its length."""


@dataclass(frozen=True)
class _Piece:
    """A face about the crank axis: its range along it, its radii at both ends, its keyway."""

    span_mm: tuple[float, float]
    radii_mm: tuple[float, float]
    keyway: FoundKeyway | None = None


@dataclass(frozen=True)
class EndFinder:
    """Steps about an axis; places are measured along it from the origin."""

    faces: Faces
    origin: Array
    axis: Array

    def steps_beyond(
        self, shafts: Sequence[CylinderFace], at_mm: float, outward: int
    ) -> tuple[FoundStep, ...]:
        """Return what follows from a place on, toward the higher places (1) or the lower ones (-1)."""
        whole = (_Piece(self._span(face), (face.radius_mm, face.radius_mm)) for face in shafts)
        pieces = [*whole, *self._cones(), *self._keyed()]
        steps: list[FoundStep] = []
        for piece in sorted(pieces, key=lambda one: outward * sum(one.span_mm)):
            (inner, outer), radii = piece.span_mm[::outward], piece.radii_mm[::outward]
            if abs(inner - at_mm) < _NEAR * max(radii):
                beyond = radii[1] if radii[0] != radii[1] else None
                bore = self._bore_mm((inner + outer) / 2)
                bolts = None if beyond or piece.keyway else self._bolts(piece.span_mm)
                steps.append(FoundStep(radii[0], bore, abs(outer - inner), beyond, piece.keyway, bolts))
                at_mm = outer
        return tuple(steps)

    def holes_left(self, steps: Sequence[FoundStep], at_mm: float, outward: int) -> Iterator[str]:
        """Yield, in words, the holes along the crank beyond a place that are no bolt holes of the steps."""
        known = {(bolts.radius_mm, bolts.circle_radius_mm) for step in steps if (bolts := step.bolts)}
        for hole in self._holes():
            low, high = self._span(hole)
            off = from_line_mm(hole.point_mm, self.origin, self.axis)
            like = any(
                math.isclose(hole.radius_mm, r, rel_tol=_NEAR) and math.isclose(off, c, rel_tol=_NEAR)
                for r, c in known
            )
            if outward * ((low + high) / 2 - at_mm) > 0 and not like:
                yield (
                    f"a hole of {2 * hole.radius_mm:.4g} mm in an end of the crank, {off:.4g} mm off its "
                    f"axis, from {low:.4g} to {high:.4g} mm along it: it is in no design"
                )

    def _holes(self) -> list[CylinderFace]:
        """Return full cylinders of holes along the axis that lie beside it."""
        return [
            face
            for face in self.faces.cylinders
            if face.full
            and not face.outward
            and parallel(face.axis, self.axis)
            and not self._on_axis(face.point_mm, face.axis)
        ]

    def _bolts(self, span: tuple[float, float]) -> FoundBolts | None:
        """Return the equal and evenly spaced holes that run just through a step; None without such."""
        near = _NEAR * (span[1] - span[0])
        own = [
            hole for hole in self._holes() if np.abs(np.subtract(self._span(hole), span)).max() < 10 * near
        ]
        if not own:
            return None
        away = [hole.point_mm - self.origin for hole in own]
        across = np.array([one - (one @ self.axis) * self.axis for one in away])
        arms, radii = np.linalg.norm(across, axis=1), np.array([hole.radius_mm for hole in own])
        first = across[0] / arms[0]
        angles = np.sort(np.arctan2(across @ np.cross(self.axis, first), across @ first) % (2 * math.pi))
        gaps = np.diff(angles, append=angles[0] + 2 * math.pi)
        alike = np.ptp(arms) < _NEAR * arms[0] and np.ptp(radii) < _NEAR * radii[0]
        if not alike or np.abs(gaps - 2 * math.pi / len(own)).max() > _EVEN_RAD:
            return None
        return FoundBolts(len(own), float(arms[0]), float(radii[0]), first)

    def _cones(self) -> Iterator[_Piece]:
        for cone in self.faces.cones:
            if not (cone.outward and cone.full and self._on_axis(cone.ends_mm[0], cone.axis)):
                continue
            places = [float((end - self.origin) @ self.axis) for end in cone.ends_mm]
            ends = sorted(zip(places, cone.radii_mm, strict=True))
            yield _Piece((ends[0][0], ends[1][0]), (ends[0][1], ends[1][1]))

    def _keyed(self) -> Iterator[_Piece]:
        """Yield cylinders with one gap all along, which a plane floor and its width belong to."""
        left = [
            face
            for face in self.faces.cylinders
            if face.outward and not face.full and self._on_axis(face.point_mm, face.axis)
        ]
        while left:
            face, *left = left
            own = [face, *(other for other in left if self._same(face, other))]
            left = [other for other in left if not any(other is one for one in own)]
            gap = 2 * math.pi - sum(one.turn_rad for one in own)
            span = self._span(face)
            if 0 < gap < math.pi:
                width = 2 * face.radius_mm * math.sin(gap / 2)
                for floor, off_mm in self._floors(span, face.radius_mm, width):
                    keyway = FoundKeyway(width, face.radius_mm - off_mm, floor.normal)
                    yield _Piece(span, (face.radius_mm, face.radius_mm), keyway)

    def _floors(
        self, span: tuple[float, float], radius_mm: float, width_mm: float
    ) -> Iterator[tuple[PlaneFace, float]]:
        """Yield planes with the width and length of a keyway, and their distance from the axis."""
        for plane in self.faces.planes:
            away = plane.point_mm - self.origin
            off, place = float(away @ plane.normal), float(away @ self.axis)
            area = width_mm * (span[1] - span[0])
            if (
                abs(plane.normal @ self.axis) < FLAT
                and span[0] < place < span[1]
                and 0 < off < radius_mm
                and abs(plane.area_mm2 - area) < _AREA * area
            ):
                yield plane, off

    def _bore_mm(self, place_mm: float) -> float:
        found = [
            2 * bore.radius_mm
            for bore in self.faces.cylinders
            if not bore.outward
            and bore.full
            and self._on_axis(bore.point_mm, bore.axis)
            and self._span(bore)[0] < place_mm < self._span(bore)[1]
        ]
        return max(found, default=0.0)

    def _same(self, one: CylinderFace, other: CylinderFace) -> bool:
        near = _NEAR * one.radius_mm
        spans = np.subtract(self._span(one), self._span(other))
        return abs(one.radius_mm - other.radius_mm) < near and bool(np.abs(spans).max() < near)

    def _on_axis(self, point_mm: Array, axis: Array) -> bool:
        size = max(float(np.linalg.norm(point_mm - self.origin)), 1.0)
        return parallel(axis, self.axis) and from_line_mm(point_mm, self.origin, self.axis) < _NEAR * size

    def _span(self, face: CylinderFace) -> tuple[float, float]:
        return span_along(face, self.origin, self.axis)
