"""STEP and STL files of web, half throw, full throw and crankshaft, and their surfaces."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.errors import solver_error
from cranktopo.base.files import as_path, replacing
from cranktopo.base.formats import SOLIDS, SolidPart
from cranktopo.base.notes import note, warn
from cranktopo.base.reproducible import time_of_writing
from cranktopo.bodies.raw_crankshaft import raw_crank_end
from cranktopo.bodies.solid.balancer import add_balancer
from cranktopo.bodies.solid.bolted import (
    add_bolted,
    add_thread_tools,
    bolted_names,
    threads_mm3,
    with_threads,
)
from cranktopo.bodies.solid.boundaries import apart_mm
from cranktopo.bodies.solid.checked import DOUBTFUL, VOLUME_TOLERANCE, ClosedForm, solid_properties
from cranktopo.bodies.solid.crankshaft import add_crankshaft, add_end, placed_throws
from cranktopo.bodies.solid.drilled import drilled
from cranktopo.bodies.solid.facets import OTHER_SIZES, closed_facets, open_error
from cranktopo.bodies.solid.plugs import add_plugs, plug_names
from cranktopo.bodies.solid.raw_crankshaft import add_raw_crankshaft, add_raw_end
from cranktopo.bodies.solid.raw_part import add_raw_throw
from cranktopo.bodies.solid.rod import add_rod
from cranktopo.bodies.solid.shapes import turned_half
from cranktopo.bodies.solid.step import StepLabel, closed_surface, kernel_surface, label_step
from cranktopo.bodies.solid.thin_faces import thin_face_words, thin_faces
from cranktopo.bodies.solid.throw import (
    add_full_throw,
    add_half_throw,
    add_web,
    built,
    half_form,
    throw_form,
)
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.checks.scene import check_solid
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import refuse_split_pins, throw_scenes
from cranktopo.design.halves import halves, mirror_image, usual_scale
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.cad_volume import triangulated_volume_mm3
from cranktopo.numerics.gmsh_session import DELAUNAY, DimTags, cad_session, quiet_stdout, triangles
from cranktopo.numerics.outward_faces import orient_outward
from cranktopo.runs.destination import check_file
from cranktopo.runs.manifest import versions
from cranktopo.throw.drilling.table import drill_bores

if TYPE_CHECKING:
    from manifold3d import Manifold

    from cranktopo.numerics.surfaces.mesh import SurfaceMesh


_FRAME = "z along the crank axis, y along the throw, origin at the mid-main-journal plane"
_FRAMES: dict[SolidPart, str] = {
    "rod": "z along the crank axis, y along the rod, origin at the axis of its big end",
    "balancer": "z along the shaft, origin at its first end, holes across along x",
}


_FACET_MM = 1.0
_FUSED: tuple[SolidPart, ...] = ("throw", "crankshaft", "raw_crankshaft")


def export_solid(
    scene: DesignLike,
    part: SolidPart,
    path: Path | str,
    facet_mm: float | None = None,
    started: datetime | None = None,
) -> float:
    """Write a part of a scene, mm, as STEP or STL by the file's suffix; return the part's exact volume, mm3.

    Its webs have the thread holes of placed bolts. STEP files of throw and crankshaft hold bolted
    counterweights as bodies of their own, which the volume does not count; an STL file holds the part alone.
    The file appears only when complete. STL facets have 1 mm for a throw of usual size, others in proportion;
    `started` dates a STEP file, now by default. Raises CranktopoError: impossible dimensions, unknown suffix,
    a STEP file that does not read back, facets that do not close at any size near the one asked for, or a
    file that cannot be written.
    """
    path = as_path(path)
    scene = as_scene(scene)
    suffix = path.suffix.lower()
    check_file(path, "file", SOLIDS)
    with replacing(path) as temporary:
        with cad_session(f"{part} of {scene.name}") as gmsh:
            body = _add(gmsh.model.occ, scene, part, threads=True)
            beside = [] if suffix == ".stl" else _bolted(gmsh.model.occ, scene, part)
            volumes = _volumes_mm3(gmsh.model.occ, scene, part, body)
            volumes += [float(gmsh.model.occ.getMass(*pair)) for pair in beside]
            gmsh.model.occ.synchronize()
            if suffix == ".stl":
                name = f"{part} of {scene.name}"
                _write_facets(gmsh, body, part, facet_mm or _usual_facet_mm(scene), temporary, name)
            else:
                if thin := thin_faces(gmsh.model.occ, body, usual_scale(scene)):
                    warn(f"{part} of {scene.name}: {thin_face_words(thin)}")
                with quiet_stdout():
                    gmsh.write(str(temporary))
                label_step(temporary, _label(scene, part, time_of_writing(started), apart_mm(gmsh)))
        if suffix != ".stl":
            read_back(temporary, volumes)
    return sum(volumes[: len(body)])


def _volumes_mm3(occ: Any, scene: Scene, part: SolidPart, body: DimTags) -> list[float]:
    """Return volumes of a part's bodies, by triangles where the kernel integrates a half or a throw wrong."""
    if part not in ("half", "throw"):
        return [float(occ.getMass(*pair)) for pair in body]
    half = part == "half"
    form = half_form(scene) if half else throw_form(scene)
    less = ClosedForm(form.volume_mm3 - threads_mm3(scene, half=half), form.roundings_mm3)
    return [solid_properties(occ, body, less).volume_mm3]


def _write_facets(gmsh: Any, body: DimTags, part: SolidPart, facet_mm: float, path: Path, name: str) -> None:
    """Write facets as STL once they are closed: as they are, joined, or of a size near the one asked for."""
    from cranktopo.numerics.surfaces.files import write_stl
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

    sizes = [facet_mm, *(factor * facet_mm for factor in OTHER_SIZES)]
    first = None
    for size in sizes:
        gmsh.model.mesh.clear()
        _triangulate(gmsh, body, part, size)
        made = SurfaceMesh(*triangles(gmsh))
        first, closed = first or made, closed_facets(made)
        if closed is None:
            continue
        if size != facet_mm:
            note(f"{name}: facets of {facet_mm:.3g} mm do not close; written with {size:.3g} mm")
        if closed is not made:
            note(f"{name}: facets along edges of the CAD kernel that do not meet are joined")
        write_stl(path, closed)
        return
    assert first is not None
    raise open_error(name, first, sizes)


def surface_of(scene: Scene, part: SolidPart, facet_mm: float | None = None) -> SurfaceMesh:
    """Return the closed triangle mesh of a part of a scene, facets as `export_solid`, thread holes full."""
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

    with cad_session(f"{part} of {scene.name}") as gmsh:
        body = _add(gmsh.model.occ, scene, part)
        gmsh.model.occ.synchronize()
        _triangulate(gmsh, body, part, facet_mm or _usual_facet_mm(scene))
        vertices, faces = triangles(gmsh)
    return closed_surface(SurfaceMesh(vertices, faces))


def kernel_surface_of(scene: Scene, part: SolidPart) -> SurfaceMesh:
    """Return the CAD kernel's own triangles of a part: fewer and nearer to it than facets of one size."""
    with cad_session(f"{part} of {scene.name}") as gmsh:
        _add(gmsh.model.occ, scene, part)
        gmsh.model.occ.synchronize()
        return kernel_surface(gmsh)


def end_surface_of(scene: Scene, side: Side) -> SurfaceMesh:
    """Return the CAD kernel's triangles of an end of the crank, from the middle of its main journal on."""
    with cad_session(f"{side} end of {scene.name}") as gmsh:
        add_end(gmsh.model.occ, scene, side)
        gmsh.model.occ.synchronize()
        return kernel_surface(gmsh)


def raw_end_surface_of(scene: Scene, side: Side) -> SurfaceMesh | None:
    """Return the kernel's triangles of a raw end of the crank in its place; None where it has no such end."""
    end = raw_crank_end(scene, side)
    if end is None:
        return None
    with cad_session(f"raw {side} end of {scene.name}") as gmsh:
        add_raw_end(gmsh.model.occ, scene, side, end)
        gmsh.model.occ.synchronize()
        return kernel_surface(gmsh)


def _add(occ: Any, scene: Scene, part: SolidPart, *, threads: bool = False) -> DimTags:
    """The bodies of a part, one but for plugs, and nothing else in the session: no points of its arcs."""
    body = _part(occ, scene, part)
    if threads:
        body = _bored(occ, scene, part, body)
    _remove_loose(occ)
    return body


def _part(occ: Any, scene: Scene, part: SolidPart) -> DimTags:
    if part in ("web", "second_web"):
        first, second = halves(scene)
        body = _web(occ, first if part == "web" else mirror_image(second))
        if part == "second_web":
            turned_half(occ, body, scene.pitch_mm)
    else:
        add = {
            "half": add_half_throw,
            "throw": add_full_throw,
            "crankshaft": add_crankshaft,
            "rod": add_rod,
            "balancer": add_balancer,
            "raw": add_raw_throw,
            "raw_crankshaft": add_raw_crankshaft,
            "plugs": add_plugs,
        }[part]
        if part not in ("throw", "crankshaft", "rod", "balancer"):
            refuse_split_pins(scene)
        body = add(occ, scene)
    return body


def _bored(occ: Any, scene: Scene, part: SolidPart, body: DimTags) -> DimTags:
    """Return a part with the thread holes of bolts in its webs."""
    if part == "crankshaft":
        throws = throw_scenes(scene)
        tools = [pair for one in placed_throws(occ, scene, add_thread_tools) for pair in one]
        return with_threads(occ, body, tools, sum(map(threads_mm3, throws)), part)
    if part == "second_web":
        own = mirror_image(halves(scene)[1])
        tools = turned_half(occ, add_thread_tools(occ, own, half=True), scene.pitch_mm)
        return with_threads(occ, body, tools, threads_mm3(own, half=True), "web")
    if part in ("web", "half", "throw"):
        half = part != "throw"
        tools = add_thread_tools(occ, scene, half=half)
        return with_threads(occ, body, tools, threads_mm3(scene, half=half), part)
    return body


def _bolted(occ: Any, scene: Scene, part: SolidPart) -> DimTags:
    """Return the counterweights bolted to a throw, or to those of a crank in their places."""
    found: DimTags = []
    if part == "throw":
        found = add_bolted(occ, scene)
    elif part == "crankshaft":
        found = [pair for one in placed_throws(occ, scene, add_bolted) for pair in one]
    _remove_loose(occ)
    return found


def bolted_bodies(scene: Scene, part: SolidPart) -> tuple[str, ...]:
    """Return the names of the counterweights bolted to a part, in the order of their bodies."""
    if part in ("throw", "half"):
        return bolted_names(scene)
    throws = throw_scenes(scene) if part == "crankshaft" else ()
    return tuple(
        f"throw {number}, {name}" for number, throw in enumerate(throws, 1) for name in bolted_names(throw)
    )


def _web(occ: Any, half: Scene) -> DimTags:
    check_solid(half)
    return built(occ, half, "web", _drilled_web, lambda part: ClosedForm(web_volume_mm3(part)))


def _drilled_web(occ: Any, scene: Scene, *, pieces: int = 1) -> DimTags:
    return drilled(occ, add_web(occ, scene, pieces=pieces), drill_bores(scene))


def _remove_loose(occ: Any) -> int:
    before = len(occ.getEntities())
    for dim in (2, 1, 0):  # what bounds something is kept by gmsh
        occ.remove(occ.getEntities(dim))
    return before - len(occ.getEntities())


def _label(scene: Scene, part: SolidPart, written: datetime, apart_mm: float) -> StepLabel:
    names = {"half": "half throw", "raw": "raw part", "balancer": "balancer shaft"}
    version = versions()["cranktopo"] or "unknown version"
    product = f"{scene.name} {names.get(part, part.replace('_', ' '))}"
    bolted = () if part == "half" else bolted_bodies(scene, part)
    return StepLabel(
        product,
        f"mm; {_FRAMES.get(part, _FRAME)}",
        "cranktopo",
        version,
        written,
        plug_names(scene) if part == "plugs" else (product, *bolted) if bolted else (),
        apart_mm,
    )


def _usual_facet_mm(scene: Scene) -> float:
    return _FACET_MM / usual_scale(scene)


def coarse_facet_mm(scene: Scene) -> float:
    """Return twice the usual facet: for what is looked at, and for the envelope of a loop's next step."""
    return 2 * _usual_facet_mm(scene)


def _triangulate(gmsh: Any, body: DimTags, part: SolidPart, facet_mm: float) -> None:
    """Facets with outward normals: a face's own normal may point into the body, as a bore's does."""
    if part in _FUSED:
        gmsh.option.setNumber("Mesh.Algorithm", DELAUNAY)
    gmsh.option.setNumber("Mesh.MeshSizeMax", facet_mm)
    gmsh.option.setNumber("Mesh.MeshSizeMin", facet_mm)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(2)
    for pair in body:
        if pair[0] == 3:
            orient_outward(gmsh, [tag for _, tag in gmsh.model.getBoundary([pair], oriented=False)])


def read_back(path: Path, volumes: list[float]) -> None:
    """Check that a STEP file holds solids of these volumes, mm3, and nothing else; else CranktopoError."""
    with cad_session(str(path)) as gmsh:
        occ = gmsh.model.occ
        occ.importShapes(str(path), highestDimOnly=False)
        loose = _remove_loose(occ)
        solids, total = occ.getEntities(3), sum(volumes)
        found = [float(occ.getMass(*pair)) for pair in solids]
        allowed = 2 * VOLUME_TOLERANCE * total  # either volume may be so far from the true one
        if allowed < abs(sum(found) - total) <= DOUBTFUL * allowed:
            found = [triangulated_volume_mm3(solid) for _, solid in solids]
    if len(found) != len(volumes) or loose or abs(sum(found) - total) > allowed:
        raise solver_error(
            f"STEP file: reads back as {len(found)} solids of {sum(found):.3f} mm3 and {loose} loose points, "
            f"curves and faces instead of {len(volumes)} of {total:.3f} mm3.",
            "Export STL, or change the dimensions slightly.",
        )


def cut_in_halves(scene: Scene, throw: Manifold) -> tuple[Manifold, Manifold]:
    """Return both halves of a throw or its raw part, each in the frame of its half.

    They are cut out of the whole: a drilling may reach across.
    """
    middle, whole = halves(scene)[0].pitch_mm / 2, scene.pitch_mm
    first = throw.trim_by_plane((0.0, 0.0, -1.0), -middle)
    second = throw.trim_by_plane((0.0, 0.0, 1.0), middle).mirror((0.0, 0.0, 1.0))
    return first, second.translate((0.0, 0.0, whole))
