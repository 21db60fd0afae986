"""Recesses of fillets: the arc of the fillet goes on into the web, to a depth below its face."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.spans import Span
from cranktopo.throw.feature import Body, ThrowView
from cranktopo.throw.journal import FilletSection
from cranktopo.throw.primitives import Arc, LineSegment, Point, Revolution, Solid


@dataclass(frozen=True)
class FilletRecess(Body):
    """The groove in the web around a journal: what the tool of its radius takes of it.

    Attributes:
        into: +1 if the web lies toward +z of its face, else -1.
        axis_mm: place of the journal's axis along the throw.
        centre_mm: radius of the circle that the fillet's centres lie on.
    """

    fillet: FilletSection
    axis_mm: float
    centre_mm: float
    face_mm: float
    into: int

    def _half_chord_mm(self, z_mm: Array) -> Array:
        """Half of the groove's width at a height; 0 beyond its bottom and outside the web."""
        depth, radius = self.into * (z_mm - self.face_mm), self.fillet.radial_mm
        chord = np.sqrt(np.maximum(radius**2 - (self.fillet.reach_mm + depth) ** 2, 0.0))
        return np.where(depth >= 0, chord, 0.0)

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        half, across = self._half_chord_mm(z_mm), (y_mm - self.axis_mm) ** 2
        inner, outer = (
            np.sqrt(np.maximum((self.centre_mm + side * half) ** 2 - across, 0.0)) for side in (-1, 1)
        )
        return [(-outer, -inner), (inner, outer)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        reach = self.centre_mm + self.fillet.half_mouth_mm
        return self.axis_mm - reach, self.axis_mm + reach

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        half = self.fillet.half_mouth_mm
        radii = (self.centre_mm - half, self.centre_mm, self.centre_mm + half)
        return tuple(self.axis_mm + side * radius for radius in radii for side in (-1, 1))

    @override
    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        off = np.abs(y_mm - self.axis_mm) - self.centre_mm
        deep = np.sqrt(np.maximum(self.fillet.radial_mm**2 - off**2, 0.0)) - self.fillet.reach_mm
        bend = self.face_mm + self.into * np.clip(deep, 0.0, self.fillet.recess_mm)
        return [*(np.full(y_mm.shape, z) for z in self.z_mm), bend]

    @property
    @override
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        return (self.z_mm,)

    @override
    def solids(self) -> tuple[Solid, ...]:
        half, above = self.fillet.half_mouth_mm, self.face_mm - self.into * self.fillet.recess_mm

        def at(radius: float, z: float) -> Point:
            return radius, self.axis_mm, z

        inner, outer = self.centre_mm - half, self.centre_mm + half
        centre = at(self.centre_mm, self.face_mm - self.into * self.fillet.reach_mm)
        contour = (
            Arc(at(inner, self.face_mm), centre, at(outer, self.face_mm)),
            LineSegment(at(outer, self.face_mm), at(outer, above)),
            LineSegment(at(outer, above), at(inner, above)),
            LineSegment(at(inner, above), at(inner, self.face_mm)),
        )
        return (Revolution(contour, at(0.0, 0.0)),)


def recesses(scene: ThrowView) -> Iterator[FilletRecess]:
    """Yield the recesses of the fillets that have one, in the web of the half throw."""
    faces = zip(("main_journal", "crankpin"), scene.throw.journals, scene.web_z_mm, (1, -1), strict=True)
    for name, (journal, axis), face, into in faces:
        fillet = journal.fillet
        if fillet.recess_mm:
            low, high = sorted((face, face + into * fillet.recess_mm))
            centre = journal.radius_mm + fillet.radial_mm
            yield FilletRecess(f"throw.{name}.recess_mm", (low, high), fillet, axis, centre, face, into)


def check_recesses_apart(scene: ThrowView) -> None:
    """Refuse recesses that meet in the web."""
    deep = sum(found.fillet.recess_mm for found in recesses(scene))
    if deep >= scene.web.thickness_mm / 2:
        allowed = (
            f"both together must stay below half of the web's thickness, {scene.web.thickness_mm / 2:g} mm"
        )
        raise scene.invalid(next(recesses(scene)).key, allowed)
