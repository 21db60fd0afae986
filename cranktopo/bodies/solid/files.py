"""STEP and STL files of web, half throw, full throw and crankshaft."""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import replacing
from cranktopo.base.formats import SOLIDS, SolidPart
from cranktopo.base.reproducible import time_of_writing
from cranktopo.bodies.solid.orientation import orient_outward
from cranktopo.bodies.solid.primitives import DimTags
from cranktopo.bodies.solid.step_text import StepLabel, label_step
from cranktopo.bodies.solid.throw import (
    VOLUME_TOLERANCE,
    add_crankshaft,
    add_drillings,
    add_full_throw,
    add_half_throw,
    add_web,
    check_body,
    cut,
)
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.checks.scene import check_solid
from cranktopo.design.halves import halves, mirror_image, usual_scale
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout, triangles
from cranktopo.runs.destination import check_file
from cranktopo.runs.manifest import versions

if TYPE_CHECKING:
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

_FACET_MM = 1.0
_FUSED: tuple[SolidPart, ...] = ("throw", "crankshaft")
_DELAUNAY = 5
"""gmsh's usual method, the frontal one, can refine without end a bore made of two halves with two seams."""


def export_solid(
    scene: Scene,
    part: SolidPart,
    path: Path,
    facet_mm: float | None = None,
    started: datetime | None = None,
) -> float:
    """Write a part of a scene as STEP or STL, by the file's suffix; the file appears only when complete.

    Args:
        path: target, suffix .step, .stp or .stl; mm, in the frame of `cranktopo.base.frames`.
        facet_mm: edge length of STL facets; by default 1 mm for a throw of usual size, others in proportion.
        started: when the work began that the file is a part of, the date of a STEP file; now by default.

    Returns:
        Volume of the exact body, mm3.

    Raises:
        CranktopoError: impossible dimensions, unknown suffix, a STEP file that does not read back, or a file
            that cannot be written.
    """
    suffix = path.suffix.lower()
    check_file(path, "file", SOLIDS)
    with replacing(path) as temporary:
        temporary.touch()  # before the work, and with a reason: gmsh gives none when it cannot write
        with cad_session(f"{part} of {scene.name}") as gmsh:
            body = _add(gmsh.model.occ, scene, part)
            volume = float(gmsh.model.occ.getMass(*body[0]))
            gmsh.model.occ.synchronize()
            if suffix == ".stl":
                _triangulate(gmsh, body, part, facet_mm or _usual_facet_mm(scene))
            with quiet_stdout():
                gmsh.write(str(temporary))
        if suffix != ".stl":
            label_step(temporary, _label(scene, part, time_of_writing(started)))
            _read_back(temporary, volume)
    return volume


def surface_of(scene: Scene, part: SolidPart, facet_mm: float | None = None) -> SurfaceMesh:
    """Closed triangle mesh of a part of a scene.

    Args:
        facet_mm: edge length of the triangles; by default as `export_solid`.

    Raises:
        CranktopoError: impossible dimensions.
    """
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh

    with cad_session(f"{part} of {scene.name}") as gmsh:
        body = _add(gmsh.model.occ, scene, part)
        gmsh.model.occ.synchronize()
        _triangulate(gmsh, body, part, facet_mm or _usual_facet_mm(scene))
        vertices, faces = triangles(gmsh)
    return SurfaceMesh(vertices, faces)


def _add(occ: Any, scene: Scene, part: SolidPart) -> DimTags:
    """The one body of a part, and nothing else in the session: not the points that its arcs were built on."""
    if part in ("web", "second_web"):
        first, second = halves(scene)
        body = _web(occ, first if part == "web" else mirror_image(second))
        if part == "second_web":
            occ.rotate(body, 0, 0, scene.pitch_mm / 2, 0, 1, 0, math.pi)
    else:
        add = {"half": add_half_throw, "throw": add_full_throw, "crankshaft": add_crankshaft}[part]
        body = add(occ, scene)
    _remove_loose(occ)
    return body


def _web(occ: Any, half: Scene) -> DimTags:
    check_solid(half)
    body = cut(occ, add_web(occ, half), add_drillings(occ, half))
    check_body(occ, body, web_volume_mm3(half), "web")
    return body


def _remove_loose(occ: Any) -> int:
    """Remove the points, curves and faces that bound no body, and count them."""
    before = len(occ.getEntities())
    for dim in (2, 1, 0):  # what bounds something is kept by gmsh
        occ.remove(occ.getEntities(dim))
    return before - len(occ.getEntities())


def _label(scene: Scene, part: SolidPart, written: datetime) -> StepLabel:
    names = {"half": "half throw", "second_web": "second web"}
    version = versions()["cranktopo"] or "unknown version"
    return StepLabel(
        f"{scene.name} {names.get(part, part)}",
        "mm; z along the crank axis, y along the throw, origin at the mid-main-journal plane",
        "cranktopo",
        version,
        written,
    )


def _usual_facet_mm(scene: Scene) -> float:
    return _FACET_MM / usual_scale(scene)


def coarse_facet_mm(scene: Scene) -> float:
    """Twice the usual facet: for what is looked at, and for the envelope of a loop's next step."""
    return 2 * _usual_facet_mm(scene)


def _triangulate(gmsh: Any, body: DimTags, part: SolidPart, facet_mm: float) -> None:
    """Facets with outward normals: a face's own normal may point into the body, as a bore's does."""
    if part in _FUSED:
        gmsh.option.setNumber("Mesh.Algorithm", _DELAUNAY)
    gmsh.option.setNumber("Mesh.MeshSizeMax", facet_mm)
    gmsh.option.setNumber("Mesh.MeshSizeMin", facet_mm)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(2)
    for pair in body:
        if pair[0] == 3:
            orient_outward(gmsh, [tag for _, tag in gmsh.model.getBoundary([pair], oriented=False)])


def _read_back(path: Path, volume: float) -> None:
    """Check that a STEP file gives the body that was written, and nothing beside it."""
    with cad_session(str(path)) as gmsh:
        occ = gmsh.model.occ
        occ.importShapes(str(path), highestDimOnly=False)
        loose = _remove_loose(occ)
        found = [float(occ.getMass(*pair)) for pair in occ.getEntities(3)]
    if len(found) != 1 or loose or abs(found[0] - volume) > VOLUME_TOLERANCE * volume:
        raise CranktopoError(
            f"STEP file: reads back as {len(found)} solids of {sum(found):.3f} mm3 and {loose} loose points, "
            f"curves and faces instead of one solid of {volume:.3f} mm3.",
            hint="Export STL, or change the dimensions slightly.",
            code=ExitCode.SOLVER,
        )
