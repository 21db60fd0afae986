"""Half throws of a crank in the frame of a throw, and which of them are alike."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.checked import SolidProperties
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf
from cranktopo.tasks.crank_import.solids import FoundSolid
from cranktopo.tasks.importing.faces import DIGITS, Faces

if TYPE_CHECKING:
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh


@dataclass(frozen=True)
class Closeness:
    """Differences of what counts as one.

    Attributes:
        length: share of a dimension of two halves.
        bulk: share of their volumes and moments.
        outline_mm: distance of outlines, where triangles end beside the body.
        digits: decimals of a dimension.
        scatter_mm: scatter of corners about round faces, at least as a file rounds them.
    """

    length: float
    bulk: float
    outline_mm: float
    digits: int
    scatter_mm: float = 0.0

    @property
    def plain_mm(self) -> float:
        """Distance within which a dimension counts as one of `_PLAIN` decimals."""
        return min(_FITTED * self.scatter_mm, 0.5 * 10.0**-_PLAIN)

    @property
    def rounding_mm(self) -> float:
        """Most that rounding changes a dimension by."""
        return max(self.plain_mm, 0.5 * 10.0**-self.digits)

    def rounded(self, data: Any) -> Any:
        """Return tables with all numbers rounded."""
        if isinstance(data, Mapping):
            return {key: self.rounded(value) for key, value in data.items()}
        if isinstance(data, list | tuple):
            return [self.rounded(value) for value in data]
        return self._number(data) if isinstance(data, float) else data

    def _number(self, value: float) -> float:
        plain = round(value, _PLAIN)
        return plain if abs(value - plain) <= self.plain_mm else round(value, self.digits)


EXACT = Closeness(1e-6, 2e-5, 0.0, DIGITS)
"""Of exact faces; the kernel approximates roundings of drillings."""
_PLAIN, _MOST_DIGITS, _FITTED = 3, 6, 3.0
"""Decimals of a drawing; decimals at most, and deviation at most over the scatter, of what triangles tell."""


def faceted(scatter_mm: float) -> Closeness:
    """Return that of triangles whose corners scatter about the body."""
    digits = min(max(math.ceil(-math.log10(max(scatter_mm, 1e-12))), _PLAIN), _MOST_DIGITS)
    return Closeness(5e-4, 2e-3, 0.03, digits, scatter_mm)


@dataclass(frozen=True)
class HalfBody:
    """A half throw in its frame.

    Attributes:
        file: name of the file that holds it.
        mesh: triangles of it.
        others: halves of the crank that are alike, this one first.
        mirrored: those of them that are its mirror image.
    """

    half: FoundHalf
    file: str
    faces: Faces
    mesh: SurfaceMesh
    solid: SolidProperties
    others: tuple[FoundHalf, ...]
    mirrored: tuple[FoundHalf, ...]
    near: Closeness


@dataclass(frozen=True)
class FoundBody:
    """The crank of a file: all solids, the one that it is, and its distinct half throws.

    Attributes:
        assumed: what was assumed of the file, in words.
        faces, triangles: numbers of them; no triangles of a body with exact faces.
        volume_within: share of the volume that the scatter of corners may hide.
    """

    solids: tuple[FoundSolid, ...]
    taken: FoundSolid
    crank: FoundCrank
    halves: tuple[HalfBody, ...]
    faces: int
    triangles: int = 0
    volume_within: float = 0.0
    assumed: tuple[str, ...] = ()


def frame_of(crank: FoundCrank, half: FoundHalf) -> tuple[Array, Array]:
    """Return rotation and shift, p -> matrix p + shift, that bring a half throw to its frame."""
    z = half.toward * crank.axis
    y = crank.direction(half.pin)
    matrix = np.stack([np.cross(y, z), y, z])
    origin = crank.origin_mm + half.main_plane_mm * crank.axis
    return matrix, -matrix @ origin


def check_one_body(count: int, half: FoundHalf) -> None:
    """Refuse a half throw that is cut into several bodies, or none."""
    if count != 1:
        raise CranktopoError(
            f"throw {half.throw}: {count} bodies between the middles of its journals, not one.",
            hint="Join loose parts in CAD, or leave them out.",
        )


@dataclass(frozen=True)
class HalfGroup:
    """Halves of a crank that are alike, and those of them that are mirror images of the first.

    Attributes:
        own_image: whether each is its own mirror image.
    """

    halves: tuple[FoundHalf, ...]
    mirrored: tuple[FoundHalf, ...]
    own_image: bool


def alike_halves(halves: Sequence[FoundHalf], bulks: Sequence[Array], near: Closeness) -> list[HalfGroup]:
    """Return halves in groups that are alike or mirror images, the largest first; `bulks` by `bulk_of`."""
    groups: list[list[int]] = []
    turned: set[int] = set()
    for index, (half, bulk) in enumerate(zip(halves, bulks, strict=True)):
        likely = [g for g in groups if _alike(halves[g[0]], half, near.length)]
        for image in (1.0, _MIRRORED):
            own = next((g for g in likely if _same(bulks[g[0]], bulk * image, near.bulk)), None)
            if own is not None:
                own.append(index)
                if image is _MIRRORED:
                    turned.add(index)
                break
        else:
            groups.append([index])
    groups.sort(key=lambda group: -len(group))
    return [
        HalfGroup(
            tuple(halves[i] for i in group),
            tuple(halves[i] for i in group if i in turned),
            _same(bulks[group[0]], bulks[group[0]] * _MIRRORED, near.bulk),
        )
        for group in groups
    ]


def bulk_of(volume: float, centre: Array, inertia: Array) -> Array:
    """Return size, centre of mass, moments and products of inertia (3, 3), lengths over the size."""
    size = volume ** (1 / 3)
    return np.array([size, *(centre / size), *(inertia.ravel() / (volume * size**2))])


_MIRRORED = np.array([1, -1, 1, 1, 1, -1, -1, -1, 1, 1, -1, 1, 1])
"""Signs of a half's measures in its mirror image at x = 0, which the far half of a throw is."""


def _same(one: Array, other: Array, bulk: float) -> bool:
    scale = np.array([one[0], *np.ones(12)])
    return bool(np.abs((one - other) / scale).max() < bulk)


def _alike(one: FoundHalf, other: FoundHalf, length: float) -> bool:
    pairs = [
        (one.main.radius_mm, other.main.radius_mm),
        (one.pin.radius_mm, other.pin.radius_mm),
        (one.main_length_mm, other.main_length_mm),
        (one.pin_length_mm, other.pin_length_mm),
        (one.thickness_mm, other.thickness_mm),
    ]
    return all(abs(a - b) < length * max(a, b) for a, b in pairs)
