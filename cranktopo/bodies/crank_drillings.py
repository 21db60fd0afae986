"""Oil drillings that cross the middle of a main journal: what they take out of the neighbour behind it.

A throw ends at the middle of its main journals, and so does what its own drillings take out of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_ends import crank_end, main_journal_places_mm
from cranktopo.design.crank_throws import half_turns_deg, throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.moments import beyond_middle
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.journal import Journal
from cranktopo.throw.moments import Moments

if TYPE_CHECKING:
    from manifold3d import Manifold


@dataclass(frozen=True)
class Crossing:
    """A drilling of a throw that goes on in its neighbour.

    Attributes:
        bore: in the frame of the throw.
        angle_deg, z_mm: of its half of the throw, and the middle of its first main journal along the crank.
        plane_mm: the middle that it crosses.
        outward: 1 where it goes on toward the output, else -1.
        journal: that it crosses.
        taken: moments of what it takes out of the neighbour, in the frame of the throw.
        taken_beyond: the same weighted by the distance beyond the middle.
    """

    bore: DrillBore
    angle_deg: float
    z_mm: float
    plane_mm: float
    outward: int
    journal: Journal
    taken: Moments
    taken_beyond: Moments

    @property
    def tool(self) -> Manifold:
        """The drilling in its place along the crank, in triangles."""
        from cranktopo.bodies.drill_tool import drill_tool

        turned = drill_tool(self.bore).rotate((0.0, 0.0, about_z_deg(self.angle_deg)))
        return turned.translate((0.0, 0.0, self.z_mm))


@dataclass(frozen=True)
class Taken:
    """Volume and integrals of what drillings take out of the neighbours of their throws, mm.

    Attributes:
        first: integral of the place across the crank, real along throw 1, imaginary toward +x.
        product: the same times the place along the crank.
    """

    volume: float
    polar: float
    first: complex
    product: complex


def crank_crossings(scene: Scene) -> tuple[Crossing, ...]:
    """Return the drillings of all throws of a crank that go on in a neighbour, or in an end of the crank."""
    halved = halved_crossings(scene)
    return tuple(one for one in _all_crossings(scene) if one not in halved)


@lru_cache(maxsize=8)
def halved_crossings(scene: Scene) -> tuple[Crossing, ...]:
    """Return those that share a mouth with their mirror image in the neighbour: each ends at the middle."""
    pairs = combinations(_all_crossings(scene), 2)
    return tuple(crossing for pair in pairs if _are_images(*pair) for crossing in pair)


@lru_cache(maxsize=8)
def _all_crossings(scene: Scene) -> tuple[Crossing, ...]:
    return tuple(_crossings(scene)) if any(one.throw.drilling for one in throw_scenes(scene)) else ()


def crossing_words(scene: Scene) -> str:
    """Return that drillings of a throw go on in its neighbours, in a sentence; empty where none does."""
    keys = [bore.key for half in halves(scene) for bore in drill_bores(half) if bore.crosses_middle]
    if not keys:
        return ""
    return (
        f"{', '.join(dict.fromkeys(keys))}: crosses the middle of the main journal, where the throw ends: "
        "the rest of the hole lies in the neighbouring throw, as the whole crank (--part crankshaft) has it"
    )


def _crossings(scene: Scene) -> Iterator[Crossing]:
    throws, places = throw_scenes(scene), main_journal_places_mm(scene)
    angles = (0.0,) if scene.engine is None else scene.shaft_angles_deg
    for index, (throw, angle) in enumerate(zip(throws, angles, strict=False)):
        for far, half in enumerate(halves(throw)):
            bores = drill_bores(half) if _goes_on(scene, index + far, len(throws)) else ()
            for bore in bores:
                if bore.crosses_middle:
                    own = bore.in_second_half(throw.pitch_mm) if far else bore
                    place = places[index], places[index + far], 2 * far - 1
                    taken = beyond_middle(half, bore), beyond_middle(half, bore, weighted=True)
                    turn = angle + half_turns_deg(throw)[far]
                    yield Crossing(own, turn, *place, half.throw.main_journal, *taken)


def _goes_on(scene: Scene, journal: int, throws: int) -> bool:
    """Tell whether the crank goes on beyond the middle of a main journal, 0 at the free end."""
    if journal == 0:
        return bool(crank_end(scene, "free"))
    return journal < throws or bool(crank_end(scene, "output"))


def taken_beyond(scene: Scene) -> Taken:
    """Return all that the drillings of a crank take out, its product from the middle of main journal 0."""
    places = main_journal_places_mm(scene)
    return _sum(_moved(one, place) for one, place in zip(taken_at_journals(scene), places, strict=True))


@lru_cache(maxsize=8)
def taken_at_journals(scene: Scene) -> tuple[Taken, ...]:
    """Return what drillings take out of the neighbours of their throws, by the main journal they cross.

    Products are from the middle of that journal. Where the drillings of two throws meet there, what is common
    to them counts once.
    """
    crossings = crank_crossings(scene)
    parts = [(one.plane_mm, _of_one(one)) for one in crossings]
    parts += [(pair[0].plane_mm, _common(*pair)) for pair in combinations(crossings, 2) if _meet(*pair)]
    return tuple(
        _sum(part for plane, part in parts if plane == place) for place in main_journal_places_mm(scene)
    )


def _sum(parts: Iterable[Taken]) -> Taken:
    found = tuple(parts)
    return Taken(
        sum(one.volume for one in found),
        sum(one.polar for one in found),
        sum((one.first for one in found), 0j),
        sum((one.product for one in found), 0j),
    )


def _moved(one: Taken, by_mm: float) -> Taken:
    """Return the same for places along the crank that are larger."""
    return replace(one, product=one.product + by_mm * one.first)


def _of_one(one: Crossing) -> Taken:
    turn = complex(np.exp(1j * np.radians(one.angle_deg)))
    own, beyond = (turn * complex(m.first_y, m.first_x) for m in (one.taken, one.taken_beyond))
    return Taken(one.taken.volume, one.taken.polar, own, one.outward * beyond)


def _meet(one: Crossing, other: Crossing) -> bool:
    return one.plane_mm == other.plane_mm and one.outward != other.outward


def _are_images(one: Crossing, other: Crossing) -> bool:
    """Tell whether two drillings are mirror images of each other in the middle of the journal they cross."""
    alike = (
        one.bore.radius_mm == other.bore.radius_mm
        and math.cos(math.radians(one.angle_deg - other.angle_deg)) > 1 - _SAME
    )
    return _meet(one, other) and alike and bool(np.allclose(_mouth(one), _mouth(other), rtol=0, atol=_SAME))


def _mouth(one: Crossing) -> Array:
    """Place, direction and rounding of a drilling's end at the middle it crosses; heights outward from it."""
    ends = (end for end in one.bore.outlets if end.journal == "main_journal")
    found = []
    for end in ends:
        (x, y, z), (dx, dy, dz) = end.point_mm, end.outward
        height = one.outward * (z + one.z_mm - one.plane_mm)
        found.append([x, y, height, dx, dy, one.outward * dz, end.rounding_mm])
    return np.array(min(found, key=lambda end: abs(end[2])))


def _common(one: Crossing, other: Crossing) -> Taken:
    """Return what two drillings that meet have in common, less than nothing: it is counted twice."""
    from manifold3d import Manifold

    from cranktopo.numerics.surfaces.mesh import mesh_of

    journal = one.journal
    ring = Manifold.cylinder(journal.length_mm, journal.radius_mm, journal.radius_mm, _CHORDS)
    if journal.bore_radius_mm:
        inner = journal.bore_radius_mm
        ring -= Manifold.cylinder(journal.length_mm, inner, inner, _CHORDS)
    material = ring.translate((0.0, 0.0, one.plane_mm - journal.length_mm / 2))
    common = one.tool ^ other.tool ^ material
    found = _counted_twice(mesh_of(common).corners_mm) if common.num_tri() else Taken(0.0, 0.0, 0j, 0j)
    return _moved(found, -one.plane_mm)


_CHORDS = 1440
_SAME = 1e-9
"""Difference of directions, and of places in mm, that counts as none."""


def _counted_twice(corners_mm: Array) -> Taken:
    """Return the integrals of a closed body of triangles (n, 3, 3), negative, by tetrahedra."""
    size = np.linalg.det(corners_mm) / 6
    total = corners_mm.sum(axis=1)
    squares = (np.einsum("nci,ncj->nij", corners_mm, corners_mm) + np.einsum("ni,nj->nij", total, total)) / 20
    second, first = -np.einsum("n,nij->ij", size, squares), -(size @ total) / 4
    return Taken(
        -float(size.sum()),
        float(second[0, 0] + second[1, 1]),
        complex(first[1], first[0]),
        complex(second[1, 2], second[0, 2]),
    )
