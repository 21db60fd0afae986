"""The whole crank as pieces in their places: throws turned by their angles, journals, ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_drillings import Crossing, crank_crossings
from cranktopo.bodies.crank_ends import SIDES, EndPiece, crank_end, main_journal_places_mm
from cranktopo.bodies.prisms import bolted_counterweight, thread_holes
from cranktopo.bodies.solid.files import end_surface_of, kernel_surface_of
from cranktopo.design.crank_throws import half_turns_deg, is_split, throw_scenes
from cranktopo.design.halves import difference, halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.numerics.surfaces.plane_section import section_x
from cranktopo.throw.journal import Journal

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_SEAM_MM, _BESIDE_MM = 1e-4, 1e-3


@dataclass(frozen=True)
class PlacedThrow:
    """A throw of the crank: its scene, its angle in the sense of rotation, its first mid-main plane."""

    scene: Scene
    angle_deg: float
    z_mm: float

    @property
    def half_angles_deg(self) -> tuple[float, float]:
        """Angles of its halves, which those of a split pin have each their own."""
        near, far = half_turns_deg(self.scene)
        return self.angle_deg + near, self.angle_deg + far


@dataclass(frozen=True)
class MainJournal:
    """A main journal between its two web faces, or to the end of the shaft."""

    journal: Journal
    z_mm: tuple[float, float]


@dataclass(frozen=True)
class Piece:
    """A closed body of the crank, in its place; it goes on beyond the planes of its seams."""

    solid: Manifold
    seams_mm: tuple[float, ...] = ()


@dataclass(frozen=True)
class CrankShape:
    """The whole crank: throws and main journals from the free end, and the bodies that they make."""

    name: str
    throws: tuple[PlacedThrow, ...]
    journals: tuple[MainJournal, ...]
    pieces: tuple[Piece, ...]
    ends: tuple[Piece, ...] = ()
    end_parts: tuple[EndPiece, ...] = ()
    bolted: tuple[Piece, ...] = ()
    """Counterweights that are bolted to the webs."""

    @cached_property
    def z_mm(self) -> tuple[float, float]:
        """Both ends of the shaft."""
        boxes = [piece.solid.bounding_box() for piece in self.pieces]
        return min(box[2] for box in boxes), max(box[5] for box in boxes)

    @cached_property
    def reach_mm(self) -> tuple[float, float, float, float]:
        """Least and greatest x, least and greatest y."""
        low, high = (
            np.array([piece.solid.bounding_box() for piece in (*self.pieces, *self.bolted)])
            .reshape(-1, 2, 3)
            .swapaxes(0, 1)
        )
        (x0, y0, _), (x1, y1, _) = low.min(axis=0), high.max(axis=0)
        return float(x0), float(x1), float(y0), float(y1)

    def seen(self, view: Array, removed: Manifold | None = None) -> SurfaceMesh:
        """Return the surface in the axes of a view, rows right, up, toward the viewer, less a body."""
        meshes = [_open(piece, removed) for piece in (*self.pieces, *self.bolted)]
        offsets = np.cumsum([0, *(len(mesh.vertices_mm) for mesh in meshes)])
        vertices = np.concatenate([mesh.vertices_mm for mesh in meshes])
        faces = [mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=False)]
        return SurfaceMesh(vertices @ view.T, np.concatenate(faces))


def joined_section_x(pieces: Sequence[Piece]) -> CrossSection:
    """Return the section x = 0 of pieces, (z, y); a thousandth of overlap joins neighbours at their seam."""
    from manifold3d import CrossSection

    grown = (section_x(piece.solid).offset(_SEAM_MM * 10) for piece in pieces)
    return sum(grown, CrossSection()).offset(-_SEAM_MM * 10)


def _open(piece: Piece, removed: Manifold | None) -> SurfaceMesh:
    mesh = mesh_of(piece.solid if removed is None else piece.solid - removed)
    z = mesh.corners_mm[..., 2]
    seam = np.zeros(len(mesh.faces), dtype=bool)
    for plane in piece.seams_mm:
        seam |= (np.abs(z - plane) < _SEAM_MM).all(axis=1)
    return SurfaceMesh(mesh.vertices_mm, mesh.faces[~seam])


@lru_cache(maxsize=8)
def throw_solid(scene: Scene) -> Manifold:
    """Return the exact throw, triangulated by the CAD kernel, from its first mid-main plane on.

    Of halves that are alike and make a straight pin it is the first one. Thread holes of bolts are cut.
    """
    first, second = halves(scene)
    if is_whole(scene):
        whole, turns = solid_of(kernel_surface_of(scene, "throw"), "throw"), half_turns_deg(scene)
        holes = thread_holes(first), _beyond(scene, thread_holes(second))
        near, far = (_turned(solid, turn) for solid, turn in zip(holes, turns, strict=True))
        return whole - near - far
    return solid_of(kernel_surface_of(scene, "half"), "half throw") - thread_holes(first)


def is_whole(scene: Scene) -> bool:
    """Tell whether a throw is no half and its mirror image: its halves differ, or its pin is split."""
    return bool(difference(scene)) or is_split(scene)


def _turned(solid: Manifold, angle_deg: float) -> Manifold:
    """Return a body turned by an angle of the crank."""
    return solid.rotate((0.0, 0.0, about_z_deg(angle_deg)))


def _beyond(scene: Scene, solid: Manifold) -> Manifold:
    """Return a body of the second half, in its own frame, in that of the throw."""
    return solid.mirror((0.0, 0.0, 1.0)).translate((0.0, 0.0, scene.pitch_mm))


def _bolted(throw: PlacedThrow) -> list[Piece]:
    """Return the counterweights that are bolted to a throw, in their places."""
    first, second = halves(throw.scene)
    far = _beyond(throw.scene, bolted_counterweight(second))
    solids = zip((bolted_counterweight(first), far), throw.half_angles_deg, strict=True)
    return [
        Piece(_turned(solid, angle).translate((0.0, 0.0, throw.z_mm)))
        for solid, angle in solids
        if not solid.is_empty()
    ]


def crank_shape(scene: Scene) -> CrankShape:
    """Return the crank of a design: each throw at its angle of the shaft, and its ends."""
    angles = (0.0,) if scene.engine is None else scene.shaft_angles_deg
    placed = zip(throw_scenes(scene), angles, main_journal_places_mm(scene), strict=False)
    shape = assembled(scene.name, [PlacedThrow(*one) for one in placed], _ends(scene))
    pieces = tuple(_drilled_on(piece, crank_crossings(scene)) for piece in shape.pieces)
    end_parts = tuple(part for side in SIDES for part in crank_end(scene, side))
    return replace(shape, pieces=pieces, end_parts=end_parts)


def _drilled_on(piece: Piece, crossings: Sequence[Crossing]) -> Piece:
    """Return a piece less the drillings of its neighbours that go on in it."""
    box = piece.solid.bounding_box()
    starts = {1: box[2], -1: box[5]}
    reaching = [one for one in crossings if abs(starts[one.outward] - one.plane_mm) < _BESIDE_MM]
    solid = piece.solid
    for one in reaching:
        solid = solid - one.tool
    return replace(piece, solid=solid)


def _ends(scene: Scene) -> list[Piece]:
    """Return the bodies of the ends of a crank, closed at their outer faces alone."""
    found = []
    for side in SIDES:
        pieces = crank_end(scene, side)
        if pieces:
            solid = solid_of(end_surface_of(scene, side), f"end of the crank, {side}")
            found.append(Piece(solid, (pieces[0].z_mm[0],)))
    return found


def assembled(name: str, throws: Sequence[PlacedThrow], ends: Sequence[Piece] = ()) -> CrankShape:
    """Return the crank that throws in their places and bodies of its ends make."""
    first, last = throws[0].z_mm, throws[-1].z_mm + throws[-1].scene.pitch_mm
    joined = {plane for piece in ends for plane in piece.seams_mm}
    pieces = tuple(piece for throw in throws for piece in _placed(throw, {first, last} - joined))
    bolted = tuple(piece for throw in throws for piece in _bolted(throw))
    pieces = (*pieces, *ends)
    return CrankShape(name, tuple(throws), _journals(throws, joined), pieces, tuple(ends), bolted=bolted)


def _placed(throw: PlacedThrow, ends_mm: set[float]) -> list[Piece]:
    """Return a throw in its place: one body, or two halves that are mirror images."""
    scene, (start, middle) = throw.scene, (throw.z_mm, throw.scene.pitch_mm / 2)
    seams, parts = {start, start + scene.pitch_mm}, [throw_solid(scene)]
    if not is_whole(scene):
        parts.append(_beyond(scene, parts[0]))
    if not is_split(scene):
        seams.add(start + middle)
    placed = (_turned(part, throw.angle_deg).translate((0.0, 0.0, start)) for part in parts)
    return [Piece(part, tuple(seams - ends_mm)) for part in placed]


def _journals(throws: Sequence[PlacedThrow], joined: set[float]) -> tuple[MainJournal, ...]:
    """Return the main journals; an outer one is whole where an end of the crank goes on beyond its middle."""
    found, outer = [], halves(throws[0].scene)[0].throw.main_journal
    begin = throws[0].z_mm - (outer.length_mm / 2 if throws[0].z_mm in joined else 0.0)
    for throw in throws:
        near, far = halves(throw.scene)
        found.append(MainJournal(near.throw.main_journal, (begin, throw.z_mm + near.web_z_mm[0])))
        middle = throw.z_mm + throw.scene.pitch_mm
        begin = middle - far.web_z_mm[0]
    end = middle + (far.web_z_mm[0] if middle in joined else 0.0)
    return (*found, MainJournal(far.throw.main_journal, (begin, end)))
