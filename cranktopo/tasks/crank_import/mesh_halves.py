"""The crank of a body of triangles: found on fitted faces, cut into its half throws."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.child import tell_read
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import note
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.tasks.crank_import.choices import EndJournals, Unit
from cranktopo.tasks.crank_import.crank_finder import find_crank
from cranktopo.tasks.crank_import.distortion import (
    check_scatter,
    check_undistorted,
    noise_named,
    remarks,
    scatter_words,
)
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf
from cranktopo.tasks.crank_import.half_body import (
    Closeness,
    FoundBody,
    HalfBody,
    HalfGroup,
    alike_halves,
    bulk_of,
    check_one_body,
    faceted,
    frame_of,
)
from cranktopo.tasks.crank_import.hand import hand_words
from cranktopo.tasks.crank_import.mesh_faces import mesh_faces, turned_faces
from cranktopo.tasks.crank_import.mesh_skin import Skin
from cranktopo.tasks.crank_import.meshes import mesh_solids
from cranktopo.tasks.crank_import.solids import FoundSolid, chosen, parallel_axes
from cranktopo.tasks.importing.faces import CylinderFace, Faces, PlaneFace, span_along
from cranktopo.tasks.importing.imported_body import surface_properties

if TYPE_CHECKING:
    from manifold3d import Manifold

_NEAR, _NEAR_MM = 2e-5, (1e-3, 0.05)
"""Distance of corners from a face that they belong to: over the size of the body, and its limits."""
_COARSER = (1.0, 5.0, 25.0, 250.0)
"""Multiples of that distance, tried until a crank is found; the last finds only why it is none."""
_STRAIGHT = 3e-4
"""Part of a direction that rounding of corners explains."""
_TOUCH_MM = 0.02
"""Distance of faces that touch."""
_CRUMB = 1e-6
_DISORDER, _DISORDER_RAD, _FEW = 0.3, 0.8, 1000
"""Part of the surface in triangles with sharp folds all around: cranks have none. Then that fold, and the
number of triangles up to which a body may have it."""
_LARGE = 0.02
"""Volume of a solid that may be a crank, over the largest one's."""
_ORIGIN, _ALONG = np.zeros(3), np.array([0.0, 0.0, 1.0])
_Found = tuple[Faces, FoundCrank, Closeness]
"""Faces and crank of a body, and how closely they tell its dimensions."""


def crank_of_mesh(
    path: Path, solid: str | None, ends: EndJournals, unit: Unit | None, folder: Path
) -> FoundBody:
    """Return the crank of a file of triangles, its distinct half throws written as `half-N.stl`.

    Called in a child process: native code may not survive a damaged file.

    Raises:
        CranktopoError: no closed body, none that is a crank, or a unit that must be told.
    """
    meshes, assumed = mesh_solids(path, unit)
    tell_read()
    solids = _solids(meshes)
    taken = chosen(solids, path, solid)
    mesh = meshes[taken.name]
    body = solid_of(mesh, f"'{path}'")
    skin = Skin(mesh, _near_mm(mesh))
    _check_order(skin, path)
    scatter_mm = skin.scatter_mm
    check_scatter(scatter_mm, f"'{path}'")
    faces, crank, near = _found(mesh, path, ends, scatter_words(scatter_mm))
    note(f"{path}: {crank.words}")
    try:
        cuts = [_cut(body, crank, half) for half in crank.halves]
    except CranktopoError as error:
        raise noise_named(error, crank.unread) from None
    bulks = [bulk_of(*_mass(cut)) for cut in cuts]
    groups = alike_halves(crank.halves, bulks, near)
    halves = tuple(
        _written(
            cuts[crank.halves.index(group.halves[0])],
            (faces, crank, near),
            group,
            folder / f"half-{number}.stl",
        )
        for number, group in enumerate(groups, 1)
    )
    count = sum(map(len, (faces.cylinders, faces.planes, faces.tori, faces.others, faces.cones)))
    within = near.scatter_mm * float(mesh.areas_mm2.sum()) / mesh.volume_mm3
    words = (*assumed, *hand_words(crank, groups))
    return FoundBody(solids, taken, crank, halves, count, len(mesh.faces), within, words)


def _check_order(skin: Skin, path: Path) -> None:
    """Refuse a surface without faces, in which circles and lines would be looked for without end."""
    lonely = skin.lonely_share(_DISORDER_RAD) if len(skin.areas) > _FEW else 0.0
    if lonely > _DISORDER:
        raise CranktopoError(
            f"'{path}': no body of faces: {100 * lonely:.0f} % of its surface is triangles that fold by more "
            f"than {math.degrees(_DISORDER_RAD):.0f} deg at every edge.",
            hint="Its corners are in disorder: write the file again from CAD.",
        )


def _solids(meshes: Mapping[str, SurfaceMesh]) -> tuple[FoundSolid, ...]:
    largest = max(mesh.volume_mm3 for mesh in meshes.values())
    found = []
    for name, mesh in meshes.items():
        x, y, z = (float(size) for size in np.ptp(mesh.vertices_mm, axis=0))
        large = len(meshes) > 1 and mesh.volume_mm3 > _LARGE * largest
        likely = len(meshes) == 1 or (large and parallel_axes(mesh_faces(mesh, _near_mm(mesh))[0]) >= 2)
        found.append(FoundSolid(0, name, (x, y, z), mesh.volume_mm3, likely))
    return tuple(found)


def _near_mm(mesh: SurfaceMesh) -> float:
    return float(np.clip(_NEAR * mesh.extent_mm, *_NEAR_MM))


def _found(mesh: SurfaceMesh, path: Path, ends: EndJournals, scatter: Sequence[str]) -> _Found:
    """Return what is found; a body whose corners scatter is looked at more coarsely, which is told."""
    name = f"'{path}'"
    first: CranktopoError | None = None
    for coarser in _COARSER:
        faces, journals = mesh_faces(mesh, coarser * _near_mm(mesh))
        try:
            crank = find_crank(faces, name, ends)
        except CranktopoError as error:
            first = first or error
            continue
        check_undistorted(faces, journals, crank.axis, name)
        if coarser < _COARSER[-1]:
            told = remarks(faces, journals, crank.axis)
            near = faceted(max((journal.off_mm for journal in journals), default=0.0))
            return faces, replace(crank, unread=(*crank.unread, *told)), near
    assert first is not None
    raise noise_named(first, scatter)


def _cut(body: Manifold, crank: FoundCrank, half: FoundHalf) -> Manifold:
    matrix, shift = frame_of(crank, half)
    turned = body.transform(np.column_stack([matrix, shift]))
    end = abs(half.pin_plane_mm - half.main_plane_mm)
    cut = turned.trim_by_plane((0.0, 0.0, 1.0), 0.0).trim_by_plane((0.0, 0.0, -1.0), -end)
    parts = [part for part in cut.decompose() if part.volume() > _CRUMB * cut.volume()]
    check_one_body(len(parts), half)
    return parts[0]


def _mass(cut: Manifold) -> tuple[float, Array, Array]:
    body = mesh_of(cut).as_trimesh()
    return float(body.volume), np.asarray(body.center_mass), np.asarray(body.moment_inertia)


def _written(cut: Manifold, found: _Found, group: HalfGroup, file: Path) -> HalfBody:
    (faces, crank, near), half, surface = found, group.halves[0], mesh_of(cut)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_stl(file, surface)
    own = straight(turned_faces(faces, *frame_of(crank, half)), abs(half.pin_plane_mm - half.main_plane_mm))
    return HalfBody(
        half, file.name, own, surface, surface_properties(surface), group.halves, group.mirrored, near
    )


def straight(faces: Faces, end_mm: float) -> Faces:
    """Return the faces of one half throw, in its frame, from those of a crank: straight and tangent.

    Fits leave a hair between what is one line or one plane in the body.
    """
    planes = tuple(
        _straight_plane(plane)
        for plane in faces.planes
        if -_TOUCH_MM < plane.point_mm[2] < end_mm + _TOUCH_MM
    )
    sides = Faces((), planes, (), ()).sides
    cylinders = (_straight_cylinder(face, sides, end_mm) for face in faces.cylinders)
    tori = tuple(replace(t, axis=_ALONG) for t in faces.tori if 0 < t.centre_mm[2] < end_mm)
    cones = tuple(c for c in faces.cones if 0 < (c.ends_mm[0][2] + c.ends_mm[1][2]) / 2 < end_mm)
    others = (*faces.others, *["Cone"] * len(cones))
    return Faces(tuple(face for face in cylinders if face is not None), planes, tori, others, cones)


def _straight_plane(plane: PlaneFace) -> PlaneFace:
    normal = np.where(np.abs(plane.normal) < _STRAIGHT, 0.0, plane.normal)
    normal = normal / np.linalg.norm(normal)
    off = float(normal @ plane.point_mm)
    return replace(
        plane, normal=normal, point_mm=plane.point_mm - (off if abs(off) < _TOUCH_MM else 0.0) * normal
    )


def _straight_cylinder(face: CylinderFace, sides: Sequence[PlaneFace], end_mm: float) -> CylinderFace | None:
    main = int(np.abs(face.axis).argmax())
    if abs(face.axis[main]) > 1 - _STRAIGHT**2:
        face = replace(face, axis=np.sign(face.axis[main]) * np.eye(3)[main])
    if not face.upright:
        return face if 0 < face.middle_mm[2] < end_mm else None
    low, high = np.clip(span_along(face, _ORIGIN, _ALONG), 0.0, end_mm)
    if high - low < _TOUCH_MM:
        return None
    point = np.array([*face.point_mm[:2], 0.0])
    middle = np.array([*face.middle_mm[:2], (low + high) / 2])
    radius = face.radius_mm
    if not face.full:
        apart = [float(side.normal @ (side.point_mm - point)) for side in sides]
        radius = next((d for d in apart if abs(d - radius) < _TOUCH_MM), radius)
    span = (float(low), float(high))
    return replace(face, point_mm=point, axis=_ALONG, span_mm=span, middle_mm=middle, radius_mm=radius)
