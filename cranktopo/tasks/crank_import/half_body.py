"""Half throws cut from a crank and moved to the frame of a throw, and which of them are alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.step import kernel_surface
from cranktopo.bodies.solid.throw import DimTags, SolidProperties, solid_properties
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout
from cranktopo.tasks.crank_import.faces import Faces, exact_faces
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf
from cranktopo.tasks.crank_import.solids import read_crank
from cranktopo.tasks.importing.cad_body import between_planes, moved_rigidly

if TYPE_CHECKING:
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

_SAME, _ALIKE = 1e-6, 2e-5
"""Shares in which dimensions, and volumes and moments, may differ of halves that count as one: the kernel
approximates roundings of drillings."""


@dataclass(frozen=True)
class HalfBody:
    """A half throw in its frame.

    Attributes:
        shown: the kernel's triangles of it.
        others: halves of the crank that are alike, this one first.
    """

    half: FoundHalf
    faces: Faces
    shown: SurfaceMesh
    solid: SolidProperties
    others: tuple[FoundHalf, ...]


def distinct_halves(path: Path, crank: FoundCrank, solid: str | None, folder: Path) -> tuple[HalfBody, ...]:
    """Return each distinct half throw once, those of most webs first, and write it as `half-N.step`."""
    with cad_session(f"halves of {path}") as gmsh:
        body = [read_crank(gmsh, path, solid)[0].entity]
        found = [_measure(gmsh, body, crank, half) for half in crank.halves]
    groups: list[list[int]] = []
    for index, (half, measured) in enumerate(zip(crank.halves, found, strict=True)):
        own = next(
            (g for g in groups if _alike(crank.halves[g[0]], half) and _same(found[g[0]], measured)), None
        )
        if own is None:
            groups.append([index])
        else:
            own.append(index)
    groups.sort(key=lambda group: -len(group))
    return tuple(
        _written(path, crank, solid, tuple(crank.halves[i] for i in group), folder / f"half-{number}.step")
        for number, group in enumerate(groups, 1)
    )


def frame_of(crank: FoundCrank, half: FoundHalf) -> tuple[Array, Array]:
    """Return rotation and shift, p -> matrix p + shift, that bring a half throw to its frame."""
    z = half.toward * crank.axis
    y = crank.direction(half.pin)
    matrix = np.stack([np.cross(y, z), y, z])
    origin = crank.origin_mm + half.main_plane_mm * crank.axis
    return matrix, -matrix @ origin


def _cut(gmsh: Any, body: DimTags, crank: FoundCrank, half: FoundHalf) -> DimTags:
    occ = gmsh.model.occ
    own = occ.copy(body)
    moved_rigidly(occ, own, *frame_of(crank, half))
    x0, y0, _, x1, y1, _ = occ.getBoundingBox(*own[0])
    reach = 2 * max(abs(v) for v in (x0, y0, x1, y1))
    cut = between_planes(occ, own, 0.0, abs(half.pin_plane_mm - half.main_plane_mm), reach)
    if len(cut) != 1:
        raise CranktopoError(
            f"throw {half.throw}: {len(cut)} bodies between the middles of its journals, not one.",
            hint="Join loose parts in CAD, or leave them out.",
        )
    return cut


def _measure(gmsh: Any, body: DimTags, crank: FoundCrank, half: FoundHalf) -> Array:
    """Return volume, centre of mass, moments and products of inertia of a half, lengths over its size."""
    occ = gmsh.model.occ
    cut = _cut(gmsh, body, crank, half)
    volume, centre = occ.getMass(*cut[0]), np.array(occ.getCenterOfMass(*cut[0]))
    inertia = np.array(occ.getMatrixOfInertia(*cut[0]))
    occ.remove(cut, recursive=True)
    size = volume ** (1 / 3)
    return np.array([size, *(centre / size), *(inertia / (volume * size**2))])


_MIRRORED = np.array([1, -1, 1, 1, 1, -1, -1, -1, 1, 1, -1, 1, 1])
"""Signs of a half's measures in its mirror image at x = 0, which the far half of a throw is."""


def _same(one: Array, other: Array) -> bool:
    scaled = [values / np.array([one[0], *np.ones(12)]) for values in (one, other, other * _MIRRORED)]
    return any(bool(np.abs(scaled[0] - values).max() < _ALIKE) for values in scaled[1:])


def _alike(one: FoundHalf, other: FoundHalf) -> bool:
    pairs = [
        (one.main.radius_mm, other.main.radius_mm),
        (one.pin.radius_mm, other.pin.radius_mm),
        (one.main_length_mm, other.main_length_mm),
        (one.pin_length_mm, other.pin_length_mm),
        (one.thickness_mm, other.thickness_mm),
    ]
    return all(abs(a - b) < _SAME * max(a, b) for a, b in pairs)


def _written(
    path: Path, crank: FoundCrank, solid: str | None, halves: Sequence[FoundHalf], file: Path
) -> HalfBody:
    """Write one half alone, and return it as its file has it."""
    with cad_session(f"half of {path}") as gmsh:
        occ = gmsh.model.occ
        body = [read_crank(gmsh, path, solid)[0].entity]
        cut = _cut(gmsh, body, crank, halves[0])
        occ.remove([pair for pair in occ.getEntities(3) if pair != cut[0]], recursive=True)
        occ.synchronize()
        properties = solid_properties(occ, cut)
        faces, shown = exact_faces(gmsh), kernel_surface(gmsh)
        file.parent.mkdir(parents=True, exist_ok=True)
        with quiet_stdout():
            gmsh.write(str(file))
    return HalfBody(halves[0], faces, shown, properties, tuple(halves))
