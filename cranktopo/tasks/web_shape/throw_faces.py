"""Faces of the throw around the outline of its web and its features: distances by scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.moving_faces import STEP, Contact, LeadingFace, MovingFace, contact_of
from cranktopo.tasks.refit.family import Layout, scene_at
from cranktopo.throw.counterweight.edge import EdgeCut
from cranktopo.throw.counterweight.holes import AxialHole, RadialHole
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.journal import FilletSection

_DistanceOf = Callable[[Scene, Array], Array]
"""Of a scene and points (3, n), mm; zero on the face."""
_BESIDE_MM = 1e-3
"""Distance beyond its rims at which a point still counts as on a fillet."""


@dataclass(frozen=True)
class ThrowFace(MovingFace):
    """A face that only the dimensions of the throw move: web faces, bores, journals, planes of symmetry."""

    scene: Scene
    layout: Layout
    distance_mm: _DistanceOf

    @override
    def contact(self, points_mm: Array, values: Array) -> Contact:
        return contact_of(partial(self.distance_mm, scene_at(self.scene, self.layout, values)), points_mm)

    @override
    def gradients(self, points_mm: Array, values: Array) -> Array:
        def distance(values: Array) -> Array:
            return self.distance_mm(scene_at(self.scene, self.layout, values), points_mm)

        first = len(values) - len(self.layout.dimensions)
        return central_difference(distance, values, STEP, range(first, len(values)))


@dataclass(frozen=True)
class FilletFace(ThrowFace, LeadingFace):
    """A fillet, at the main journal or the pin, whose nodes keep their angles around it and along its arc.

    Of a fillet with a recess they keep their share of the arc, which is longer the less its radius.
    """

    number: int

    @override
    def moved(self, points_mm: Array, start: Array, values: Array) -> Array:
        _, y = self.scene.throw.journals[self.number]
        section, distance, height = self._centre(start)
        across = np.stack([points_mm[0], points_mm[1] - y])
        far = np.hypot(*across)
        out, up = (far - distance) / section.radial_mm, (points_mm[2] - height) / section.axial_mm
        out, up = np.stack([out, up]) / np.hypot(out, up)  # the kernel's edges are off an ellipse by 1e-8 mm
        before, (section, distance, height) = section, self._centre(values)
        if section.recess_mm:
            along = np.arctan2(-_side(self.number) * up, -out) * (section.arc_rad / before.arc_rad)
            out, up = -np.cos(along), -_side(self.number) * np.sin(along)
        x_mm, y_mm = (distance + section.radial_mm * out) * (across / far)
        return np.stack([x_mm, y + y_mm, height + section.axial_mm * up])

    @override
    def velocities(self, points_mm: Array, start: Array, values: Array) -> Array:
        if not self.scene.throw.journals[self.number][0].recess_mm:
            return super().velocities(points_mm, start, values)
        sizes = range(len(values) - len(self.layout.dimensions), len(values))
        return central_difference(lambda to: self.moved(points_mm, start, to).T, values, STEP, sizes)

    def _centre(self, values: Array) -> tuple[FilletSection, float, float]:
        """Return the fillet's section, and radius and height of its centre circle."""
        scene = scene_at(self.scene, self.layout, values)
        journal, _ = scene.throw.journals[self.number]
        section = journal.fillet
        height = scene.web_z_mm[self.number] + _side(self.number) * section.reach_mm
        return section, journal.radius_mm + section.radial_mm, height


def throw_faces(scene: Scene, mirrored: bool, with_journals: bool) -> Iterator[_DistanceOf]:
    """Yield the distance from each face that only dimensions of the throw move."""
    if mirrored:
        yield lambda _, at: at[0]
    yield from (partial(_above_web_face, k) for k in range(2))
    bored = (k for k, (journal, _) in enumerate(scene.throw.journals) if journal.bore_radius_mm)
    yield from (partial(_off_cylinder, k, True) for k in bored)
    yield from (partial(_off_drilling, k) for k in range(len(drill_bores(scene))))
    yield from _counterweight_faces(scene)
    if with_journals:
        yield lambda _, at: at[2]
        yield lambda scene, at: at[2] - scene.pitch_mm / 2
        yield from (partial(_off_cylinder, k, False) for k in range(2))


def _counterweight_faces(scene: Scene) -> Iterator[_DistanceOf]:
    """Yield rim and sharp flank of a counterweight of one piece with the web, its face if thinner."""
    weight = scene.web.counterweight
    if weight is None or weight.bolted:
        return
    yield lambda scene, at: sector_of(scene).below_rim_mm(at[0], at[1])
    if weight.corner_mm is not None:
        yield lambda scene, at: sector_of(scene).inside_corner_mm(at[0], at[1])
    if weight.fillet_mm is None:
        yield lambda scene, at: sector_of(scene).inside_flank_mm(at[0], at[1])
    if weight.thickness_mm is not None and weight.thickness_mm < scene.web.thickness_mm:
        end = 1 if weight.face == "journal" else 0
        yield lambda scene, at: at[2] - sector_of(scene).z_mm[end]
    for number, cut in enumerate(weight.cuts(scene)):
        yield partial(_off_wall, number)
        if not isinstance(cut, AxialHole) or cut.floor_mm is not None:
            yield partial(_above_floor, number)


def _off_wall(number: int, scene: Scene, at: Array) -> Array:
    """Return the distance from the wall of a hole of the counterweight, or the plane of a bevel."""
    return _cut_of(scene, number).off_wall_mm(at)


def _above_floor(number: int, scene: Scene, at: Array) -> Array:
    """Return the distance from the floor of a hole of the counterweight, or the wall that ends a bevel."""
    return _cut_of(scene, number).off_floor_mm(at)


def _cut_of(scene: Scene, number: int) -> AxialHole | RadialHole | EdgeCut:
    assert scene.web.counterweight is not None
    return scene.web.counterweight.cuts(scene)[number]


def sector_of(scene: Scene) -> Sector:
    """Return the counterweight of a scene that has one, without its fillets."""
    assert scene.web.counterweight is not None
    return scene.web.counterweight.sector(scene)


def _above_web_face(number: int, scene: Scene, at: Array) -> Array:
    above: Array = at[2] - scene.web_z_mm[number]
    return above


def _off_cylinder(number: int, bore: bool, scene: Scene, at: Array) -> Array:
    journal, y = scene.throw.journals[number]
    radius_mm = journal.bore_radius_mm if bore else journal.radius_mm
    return np.asarray(np.hypot(at[0], at[1] - y) - radius_mm)


def _off_drilling(number: int, scene: Scene, at: Array) -> Array:
    bore = drill_bores(scene)[number]
    return bore.off_axis_mm(at[0], at[1], at[2]) - bore.radius_mm


def _side(number: int) -> float:
    """Return the way along z from the web's face to the centre of a journal's fillet."""
    return 1.0 if number else -1.0


def off_fillet(number: int, scene: Scene, at: Array) -> Array:
    """Return the distance from the part of the ring that is the fillet; far from the rest."""
    journal, y = scene.throw.journals[number]
    section, side = journal.fillet, _side(number)
    across = np.hypot(at[0], at[1] - y) - journal.radius_mm - section.radial_mm
    height = side * (at[2] - scene.web_z_mm[number]) - section.reach_mm
    beyond = (across > section.half_mouth_mm + _BESIDE_MM) | (height > _BESIDE_MM)
    return np.asarray(section.off_mm(across, height) + np.where(beyond, section.radial_mm, 0.0))
