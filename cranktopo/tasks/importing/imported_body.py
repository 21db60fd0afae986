"""Half throws that come as a file: a STEP solid, or a watertight STL remeshed as a body-fitted solid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array, Int64
from cranktopo.base.child import in_child, tell_read
from cranktopo.base.errors import CranktopoError
from cranktopo.base.frames import Z
from cranktopo.base.notes import note
from cranktopo.base.units import MM_PER_INCH
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_body, ring_size_mm
from cranktopo.bodies.prisms import is_mirror_image, web_region
from cranktopo.bodies.solid.checked import NotCutError, SolidProperties, solid_properties, volume_mm3
from cranktopo.bodies.solid.files import cut_in_halves, surface_of
from cranktopo.bodies.solid.step import STEP_SUFFIXES, in_cad_kernel, kernel_surface, step_solid
from cranktopo.design.halves import difference
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags, cad_session
from cranktopo.numerics.surfaces.files import as_stored, read_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, shell_volumes_mm3, solid_of
from cranktopo.numerics.tetrahedra.cad_mesh import by_smaller_elements, positive_x
from cranktopo.numerics.tetrahedra.mesh import TetMesh, tetrahedralise
from cranktopo.tasks.importing.cad_body import (
    ALIKE,
    REACH,
    between_planes,
    halves_apart,
    moved_rigidly,
    sides_alike,
    volumes_between,
)
from cranktopo.tasks.importing.exact_motion import Motion, exact_motions, snapped
from cranktopo.tasks.importing.found_fillets import with_found_fillets
from cranktopo.tasks.importing.placement import Placement, placed, without_bores_left_out

if TYPE_CHECKING:
    from manifold3d import Manifold

_SNAP_MM = 0.05
"""Largest distance of an end section from its plane; closer vertices are moved onto it."""
_UNIT_SHARE = 0.01
_ROUNDING = 1e-6
"""Distance by which single precision and the mesher may move an end section, over the pitch."""


def mesh_file(
    path: Path, scene: Scene, element_size_mm: float, align: bool = False, *, own: bool = False
) -> MeshedThrow:
    """Return the mesh of the half throw in an STL or STEP file.

    The file is in mm in the frame of `cranktopo.base.frames`, z from 0 to half the pitch; a STEP file may
    also hold the full throw. `align` moves a body that lies elsewhere to where the journals are.

    Args:
        own: the file is a run's, written by this program: an STL is meshed in this process, without the
            second that another takes to begin.

    Raises:
        CranktopoError: not watertight, several bodies, not where the journals are, or no valid mesh.
    """
    if path.suffix.lower() == ".stl":
        return _mesh_stl(path, scene, element_size_mm, align, own)
    return in_cad_kernel(f"'{path}'", _mesh_step, path, scene, element_size_mm, align)


def _mesh_step(path: Path, scene: Scene, element_size_mm: float, align: bool) -> MeshedThrow:
    def make(size: float, adapt: bool) -> MeshedThrow:
        with cad_session(f"solid of {path}") as gmsh:
            return _meshed(gmsh, _solid(gmsh, path, scene, align), scene, size, adapt)

    return by_smaller_elements(f"solid of {path}", element_size_mm, make)


def mesh_step_for_stress(
    path: Path,
    scene: Scene,
    element_size_mm: float,
    fillet_fraction: float,
    align: bool = False,
    *,
    regular: bool = False,
) -> tuple[MeshedThrow, Scene]:
    """Return the mesh of a STEP file's half throw, fine in the fillets found on it, and the scene with these.

    The fraction is the element size in a fillet over its radius; a journal without one raises CranktopoError.

    Args:
        regular: as in `mesh_throw`.
    """
    settings = scene, element_size_mm, fillet_fraction, align, regular
    return in_cad_kernel(f"'{path}'", _mesh_for_stress, path, *settings)


def _mesh_for_stress(
    path: Path, scene: Scene, element_size_mm: float, fillet_fraction: float, align: bool, regular: bool
) -> tuple[MeshedThrow, Scene]:
    def make(size: float, adapt: bool) -> tuple[MeshedThrow, Scene]:
        with cad_session(f"solid of {path}") as gmsh:
            found = _solid(gmsh, path, scene, align)
            gmsh.model.occ.synchronize()
            filleted = with_found_fillets(gmsh, scene, str(path))
            return _meshed(gmsh, found, filleted, size, adapt, fillet_fraction, regular), filleted

    return by_smaller_elements(f"solid of {path}", element_size_mm, make)


def _meshed(
    gmsh: Any,
    found: _Solid,
    scene: Scene,
    size: float,
    adapt: bool,
    fillet_fraction: float | None = None,
    regular: bool = False,
) -> MeshedThrow:
    mirrored = _halved(gmsh.model.occ, found.body, scene)
    mesh = mesh_body(
        gmsh,
        scene,
        size,
        mirrored=mirrored,
        full=found.whole,
        fillet_fraction=fillet_fraction,
        regular=regular,
        adapt=adapt,
    )
    return MeshedThrow(mesh, found.properties, found.web_mm3, found.note, found.whole, size)


def fillets_of_step(path: Path, scene: Scene, align: bool = False) -> Scene:
    """Return the scene with the fillets of the half throw in a STEP file; raises as meshing it for stress."""
    return in_cad_kernel(f"'{path}'", _fillets, path, scene, align)


def _fillets(path: Path, scene: Scene, align: bool) -> Scene:
    with cad_session(f"solid of {path}") as gmsh:
        _solid(gmsh, path, scene, align)
        gmsh.model.occ.synchronize()
        return with_found_fillets(gmsh, scene, str(path))


@dataclass(frozen=True)
class _Solid:
    """A half throw of a STEP file in its place, or the `whole` one; its first web, what was done."""

    body: DimTags
    properties: SolidProperties
    web_mm3: float
    note: str
    whole: bool


def _solid(gmsh: Any, path: Path, scene: Scene, align: bool) -> _Solid:
    """Return the half throw of a STEP file in its place, or the whole one where its halves differ."""
    occ = gmsh.model.occ
    body = [step_solid(gmsh, path, f"'{path}'")]
    low, high = _heights_mm(gmsh, body[0], scene)
    _check_unit(path, scene, low, high)
    apart = ""
    if _reaches(low, high, scene.pitch_mm):
        apart = halves_apart(occ, body, scene.pitch_mm)
        if not apart:
            body = between_planes(occ, body, -1.0, scene.pitch_mm / 2, REACH * scene.pitch_mm)
    occ.synchronize()
    surface = solid_of(kernel_surface(gmsh), str(path))
    if apart:
        for half in _both(surface, scene):
            _placed(half, scene, path, align=False)
        motion, remark = None, f"{apart}. The whole throw is taken"
    else:
        motion, remark = _placed(surface, scene, path, align, partial(exact_motions, gmsh, scene))
        if motion is not None and not motion.exact:
            remark += "; its journals are no exact cylinders, its triangles tell the place to about 1e-3 mm"
    if motion is not None:
        moved_rigidly(occ, body, motion.matrix, motion.shift_mm)
    body = snapped(gmsh, body)
    return _Solid(body, solid_properties(occ, body), _web_mm3(gmsh, body, scene, path), remark, bool(apart))


def _web_mm3(gmsh: Any, body: DimTags, scene: Scene, path: Path) -> float:
    """Return the volume of the first web, by triangles where the kernel cannot cut it out."""
    occ = gmsh.model.occ
    try:
        return float(volumes_between(occ, body, scene.web_z_mm, REACH * scene.pitch_mm)[1])
    except NotCutError:
        note(f"{path}: the CAD kernel cannot cut out its web exactly: its mass is that of triangles")
        occ.synchronize()
        surface = solid_of(kernel_surface(gmsh), str(path))
        return float(web_region(surface, scene).volume() / surface.volume()) * volume_mm3(occ, body)


def _heights_mm(gmsh: Any, body: tuple[int, int], scene: Scene) -> tuple[float, float]:
    """Return where a body begins and ends along the crank axis.

    The kernel's box is that of its faces before they are trimmed: the mouth of a drilling in an end section
    reaches beyond it. Where that fits no throw, the triangles tell.
    """
    low, high = (gmsh.model.occ.getBoundingBox(*body)[i] for i in (2, 5))
    if any(_reaches(low, high, end) for end in (scene.pitch_mm / 2, scene.pitch_mm)):
        return low, high
    gmsh.model.occ.synchronize()
    z = kernel_surface(gmsh).vertices_mm[:, 2]
    return float(z.min()), float(z.max())


def _reaches(low: float, high: float, end: float) -> bool:
    return abs(low) < _SNAP_MM and abs(high - end) < _SNAP_MM


def _both(throw: Manifold, scene: Scene) -> tuple[Manifold, Manifold]:
    """Return both halves of a whole throw, each in the frame of a half throw."""
    middle = scene.pitch_mm / 2
    far = throw.trim_by_plane((0.0, 0.0, 1.0), middle).mirror((0.0, 0.0, 1.0))
    return throw.trim_by_plane((0.0, 0.0, -1.0), -middle), far.translate((0.0, 0.0, scene.pitch_mm))


def _halved(occ: Any, body: DimTags, scene: Scene) -> bool:
    """Leave the half x >= 0 of a body that is its own mirror image, and tell whether that was done."""
    if scene.effects.lateral_symmetry == "off" or not sides_alike(occ, body, scene.pitch_mm):
        return False
    positive_x(occ, body, scene.pitch_mm)
    return True


def _mesh_stl(path: Path, scene: Scene, size: float, align: bool, own: bool) -> MeshedThrow:
    surface, note = _half_throw(read_stl(path, str(path)), path, scene, align)
    body, half = solid_of(surface, str(path)), surface_properties(surface)
    mirrored = scene.effects.lateral_symmetry != "off" and is_mirror_image(body, ALIKE)
    if mirrored:
        cut = mesh_of(body.trim_by_plane((1.0, 0.0, 0.0), 0.0))
        surface = SurfaceMesh(_on_planes(cut.vertices_mm, scene, _ROUNDING), cut.faces)
    task = surface, size, scene, str(path)
    points, cells = _filled(*task) if own else in_child(f"'{path}'", _filled, *task, by="mesher")
    points = np.ascontiguousarray(_on_planes(points.T, scene, _ROUNDING).T)
    web_volume = float(web_region(body, scene).volume())
    return MeshedThrow(TetMesh(points, cells, mirrored), half, web_volume, note)


def _filled(surface: SurfaceMesh, size: float, scene: Scene, name: str) -> tuple[Array, Int64]:
    """Return nodes and cells as `tetrahedralise`; native code may not survive triangles from elsewhere."""
    tell_read()
    return tetrahedralise(surface, size, partial(ring_size_mm, scene, size), name)


def read_half_throw(path: Path, scene: Scene, align: bool = False) -> SurfaceMesh:
    """Return the surface of the half throw in an STL file, its ends on their planes."""
    return _half_throw(read_stl(path, str(path)), path, scene, align)[0]


def half_throw_of(surface: SurfaceMesh, path: Path, scene: Scene) -> SurfaceMesh:
    """Return what `read_half_throw` reads of a surface that was written to a file."""
    return _half_throw(as_stored(surface), path, scene, align=False)[0]


def _half_throw(surface: SurfaceMesh, path: Path, scene: Scene, align: bool) -> tuple[SurfaceMesh, str]:
    """Return the surface of a file where the scene's journals are, and what was done or is to be known."""
    if not surface.as_trimesh().is_watertight:
        raise CranktopoError(f"{path}: the surface is not watertight.", hint="Repair it, then try again.")
    faces = surface.faces if surface.volume_mm3 > 0 else surface.faces[:, ::-1]
    bodies = int((shell_volumes_mm3(SurfaceMesh(surface.vertices_mm, faces)) > 0).sum())
    if bodies != 1:
        raise CranktopoError(f"{path}: holds {bodies} separate bodies.", hint="Remove the loose parts.")
    vertices = surface.vertices_mm
    _check_unit(path, scene, float(vertices[:, Z].min()), float(vertices[:, Z].max()))
    body = solid_of(SurfaceMesh(vertices, faces), str(path))
    motion, note = _placed(body, scene, path, align)
    if motion is not None:
        vertices = motion.moved(vertices)
    snapped = _on_planes(vertices, scene, _SNAP_MM / 10 / scene.pitch_mm)
    return SurfaceMesh(snapped, faces), note


def _placed(
    body: Manifold,
    scene: Scene,
    path: Path,
    align: bool,
    exact: Callable[[], Sequence[Motion]] = tuple,
) -> tuple[Placement | None, str]:
    """Return the motion to where the journals are, if one is needed, and what was done or is to be known."""
    scene, lacking = without_bores_left_out(body, scene)
    motion = placed(body, scene, str(path), align, exact)
    return motion, f"moved to where the journals are: it {motion.words}" if motion else lacking


def half_surfaces(scene: Scene, file: Path | None, facet_mm: float, align: bool = False) -> list[SurfaceMesh]:
    """Return the surface of a half throw, of the scene or the file, or of both where they differ."""
    if difference(scene):
        throw = solid_of(surface_of(scene, "throw", facet_mm), "throw")
        return [mesh_of(half) for half in cut_in_halves(scene, throw)]
    if file is None:
        return [surface_of(scene, "half", facet_mm)]
    return _surfaces(file, scene, align)


def half_throw_surface(path: Path, scene: Scene, align: bool = False) -> SurfaceMesh:
    """Return the surface of the half throw in an STL or STEP file.

    Raises:
        CranktopoError: as `mesh_file`, or a whole throw whose halves differ.
    """
    found = _surfaces(path, scene, align)
    if len(found) > 1:
        raise CranktopoError(
            f"'{path}': the halves of the throw differ, and this command or stage models half of it.",
            hint="Give the half that is to be changed: `cranktopo import` cuts both. "
            "`evaluate` and `fatigue` take the whole.",
        )
    return found[0]


def _surfaces(path: Path, scene: Scene, align: bool) -> list[SurfaceMesh]:
    """Return the surface of the half throw in a file, or of both halves where they differ."""
    if path.suffix.lower() not in STEP_SUFFIXES:
        return [read_half_throw(path, scene, align)]
    return in_cad_kernel(f"'{path}'", _step_surfaces, path, scene, align)


def _step_surfaces(path: Path, scene: Scene, align: bool) -> list[SurfaceMesh]:
    with cad_session(f"solid of {path}") as gmsh:
        whole = _solid(gmsh, path, scene, align).whole
        gmsh.model.occ.synchronize()
        surface = kernel_surface(gmsh)
    found = [mesh_of(half) for half in _both(solid_of(surface), scene)] if whole else [surface]
    return [SurfaceMesh(_on_planes(one.vertices_mm, scene, _ROUNDING), one.faces) for one in found]


def _on_planes(points_mm: Array, scene: Scene, share: float) -> Array:
    """Return points (n, 3), those nearer to an end plane than `share` of the pitch exactly on it.

    Single precision, in which surfaces are kept, holds few of the planes' heights: what is not put back on
    its plane would lie beside it by the rounding, and carry no support.
    """
    moved = points_mm.copy()
    z = moved[:, Z]
    for plane in (0.0, scene.pitch_mm / 2):
        z[np.abs(z - plane) < share * scene.pitch_mm] = plane
    return moved


def _check_unit(path: Path, scene: Scene, low: float, high: float) -> None:
    end = scene.pitch_mm / 2
    for name, factor in (("metres", 1000.0), ("inches", MM_PER_INCH)):
        if abs(factor * (high - low) / end - 1) < _UNIT_SHARE:
            raise CranktopoError(
                f"{path}: is {high - low:.4g} long along the crank axis, the half throw {end:g} mm.",
                hint=f"It is in {name}: export it in mm.",
            )


def surface_properties(surface: SurfaceMesh) -> SolidProperties:
    """Return the mass properties of a closed surface."""
    body = surface.as_trimesh()
    x, y, z = (float(c) for c in body.center_mass)
    volume = float(body.volume)
    return SolidProperties(volume, (x, y, z), float(body.moment_inertia[2, 2] + volume * (x**2 + y**2)))
