"""STEP files: the surface of the body in one as triangles, and what one says about itself.

The surface is the CAD kernel's own triangulation. Labels replace what OCC writes (ISO 10303-21, clear text
encoding); the schema stays as OCC writes it, AP214 (automotive_design).
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.child import in_child, tell_read
from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.base.files import GEOMETRY_LIMIT_MIB, check_input
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout, triangles

if TYPE_CHECKING:
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh


_R = TypeVar("_R")
_NARROW, _RIBBON = 0.1, 0.01
"""Area of a hole over the square of its longest edge, or of half its rim, that a sliver stays below."""
_TEXT = r"'(?:[^']|'')*'"
_HEADER = re.compile(r"(?s)\AISO-10303-21;\s*HEADER;.*?(FILE_SCHEMA\s*\(.*?\);)\s*ENDSEC;")
_SYSTEM = re.compile(rf"FILE_NAME\s*\((?:[^;']|{_TEXT})*?({_TEXT})\s*,\s*{_TEXT}\s*,\s*{_TEXT}\s*\);")
_PRODUCT = re.compile(rf"(=\s*PRODUCT\s*\(\s*){_TEXT}(\s*,\s*){_TEXT}(\s*,\s*){_TEXT}")
_UNCERTAINTY = re.compile(r"(UNCERTAINTY_MEASURE_WITH_UNIT\s*\(\s*LENGTH_MEASURE\s*\()([^)]*)(\))")
_SOLID = re.compile(rf"(=\s*MANIFOLD_SOLID_BREP\s*\(\s*){_TEXT}")


@dataclass(frozen=True)
class StepLabel:
    """Labels that a reader shows of a STEP file: its product and its solids, in a line; written in UTC.

    Without names of solids there is one, which is called as the product.

    Attributes:
        apart_mm: largest distance of a curve's end from its point, which the file tells as its uncertainty.
    """

    product: str
    description: str
    program: str
    version: str
    written: datetime
    solids: tuple[str, ...] = ()
    apart_mm: float = 0.0


def label_step(path: Path, label: StepLabel) -> None:
    """Write the label into a STEP file that OCC wrote."""
    path.write_text(labelled(path.read_text(encoding="ascii"), label), encoding="ascii")


def labelled(text: str, label: StepLabel) -> str:
    """Return the text of a STEP file with the label; it must hold the solids that this names.

    Of several each is a product, and all of them are one.
    """
    product, description = step_string(label.product), step_string(label.description)
    solids = [step_string(name) for name in label.solids or (label.product,)]
    names = [product, *solids] if len(solids) > 1 else [product]
    system = _SYSTEM.search(text)
    header = (
        "ISO-10303-21;\nHEADER;\n"
        f"FILE_DESCRIPTION(({description}),'2;1');\n"
        f"FILE_NAME({product},'{label.written.isoformat(timespec='seconds')}',\n"
        f"  ({step_string(f'{label.program} {label.version}')}),({step_string(label.program)}),\n"
        f"  {system[1] if system else repr('')},{step_string(f'{label.program} {label.version}')},'');\n"
    )
    text, headers = _HEADER.subn(lambda found: f"{header}{found[1]}\nENDSEC;", text)
    found = len(_PRODUCT.findall(text)), len(_SOLID.findall(text))
    if (headers, *found) != (1, len(names), len(solids)):
        raise solver_error(
            f"STEP file: holds {found[0]} products with {found[1]} solids instead of {len(names)} with "
            f"{len(solids)}.",
            "Export STL, or change the dimensions slightly.",
        )
    next_name, next_solid = iter(names), iter(solids)

    def with_name(match: re.Match[str]) -> str:
        name = next(next_name)
        return f"{match[1]}{name}{match[2]}{name}{match[3]}{description}"

    text = _UNCERTAINTY.sub(lambda match: match[1] + _no_less(match[2], label.apart_mm) + match[3], text)
    text = _PRODUCT.sub(with_name, text)
    return _SOLID.sub(lambda match: f"{match[1]}{next(next_solid)}", text)


def _no_less(written_mm: str, least_mm: float) -> str:
    """Return an uncertainty that OCC wrote, an average, or one that is larger, rounded up to one digit.

    A reader takes edges that end farther from each other for no closed loop: of a torus it put in a seam.
    """
    if float(written_mm) >= least_mm:
        return written_mm
    power = math.floor(math.log10(least_mm))
    return f"{math.ceil(least_mm / 10.0**power):.1f}E{power:+03d}"


def step_string(text: str) -> str:
    """Return a string of ISO 10303-21, 6.4.3, quotes included: other alphabets as UTF-16."""

    def coded(match: re.Match[str]) -> str:
        return f"\\X2\\{match[0].encode('utf-16-be').hex().upper()}\\X0\\"

    plain = text.replace("\\", "\\\\").replace("'", "''")
    return "'" + re.sub(r"[^\x20-\x7e]+", coded, plain) + "'"


STEP_SUFFIXES = (".step", ".stp")
_BREP_SUFFIXES = (".brep", ".brp")
KERNEL_SUFFIXES = (*STEP_SUFFIXES, *_BREP_SUFFIXES)
"""Files that the CAD kernel reads; a BREP file tells no unit."""
_HEADS = {"STEP": b"ISO-10303-21", "BREP": b"CASCADE Topology"}
CHORD_MM = 0.01
"""Largest distance of a triangle from the body; 1e-4 of the volume of a web."""
_TRIANGULATION = {
    "StlLinearDeflection": CHORD_MM,
    "StlLinearDeflectionRelative": 0,
    "StlAngularDeflection": 0.1,
}
WELD_MM = 2e-5
"""Vertices nearer than this are one: twice the tolerance that CAD systems give an edge."""
_VOLUME_TOLERANCE = 2e-3


def step_surface(path: Path, name: str) -> SurfaceMesh:
    """Return outward triangles of the one solid in a STEP file of any unit, mm, joined along its edges.

    Raises CranktopoError: it cannot be read, does not hold exactly one solid, or its faces do not close.
    """
    return in_cad_kernel(name, _step_surface, path, name)


def _step_surface(path: Path, name: str) -> SurfaceMesh:
    with cad_session(f"surface of {path}") as gmsh:
        body = step_solid(gmsh, path, name)
        volume = float(gmsh.model.occ.getMass(*body))
        mesh = kernel_surface(gmsh)
    if not (mesh.as_trimesh().is_watertight and abs(mesh.volume_mm3 / volume - 1) < _VOLUME_TOLERANCE):
        raise CranktopoError(
            f"{name}: the faces of its solid do not close ({mesh.volume_mm3:.1f} of {volume:.1f} mm3).",
            hint="Repair the solid in CAD, or export it as STL.",
        )
    return mesh


def kernel_surface(gmsh: Any) -> SurfaceMesh:
    """Return the kernel's own triangles of the open session's body, joined; it stays unmeshed.

    The kernel triangulates face by face, and ends two faces of one edge up to that edge's tolerance apart.
    """
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh, welded

    for option, value in _TRIANGULATION.items():
        gmsh.option.setNumber(f"Mesh.{option}", value)
    gmsh.model.mesh.importStl()
    points, faces = triangles(gmsh)
    gmsh.model.mesh.clear()
    return closed_surface(welded(SurfaceMesh(points, faces), WELD_MM))


def closed_surface(mesh: SurfaceMesh) -> SurfaceMesh:
    """Return the mesh with small and narrow holes closed, and all faces turned as their neighbours.

    Where a face runs out in a sliver, at the rounded outlet of a drilling say, the kernel leaves its last
    triangles out, and may turn a face the wrong way.
    """
    from trimesh.repair import fill_holes

    from cranktopo.numerics.surfaces.mesh import SurfaceMesh, outward

    body = mesh.as_trimesh()
    if body.is_watertight and body.is_winding_consistent:
        return mesh
    fill_holes(body)  # of three or four edges
    faces = np.asarray(body.faces, np.int64)
    return outward(
        SurfaceMesh(mesh.vertices_mm, np.vstack([faces, *_across_slivers(mesh.vertices_mm, faces)]))
    )


def _across_slivers(points_mm: Array, faces: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """Yield faces across each hole that is narrow: a whole face that is missing stays so."""
    edges = np.sort(np.concatenate([faces[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]), axis=1)
    found, count = np.unique(edges, axis=0, return_counts=True)
    for rim in _rims(found[count == 1]):
        at = points_mm[rim]
        area, across = _least_area(at)
        lengths = np.linalg.norm(at - np.roll(at, 1, axis=0), axis=1)
        if area < max(_NARROW * lengths.max() ** 2, _RIBBON * (lengths.sum() / 2) ** 2):
            yield rim[across]


def _least_area(points_mm: Array) -> tuple[float, NDArray[np.int64]]:
    """Return the triangles with the least area across a closed rim, (n - 2, 3), and that area, mm2.

    Dynamic programming over the part of the rim between two points (Klincsek, 1980).
    """
    count = len(points_mm)
    least, split = np.zeros((count, count)), np.zeros((count, count), np.int64)
    for gap in range(2, count):
        for first in range(count - gap):
            last, between = first + gap, np.arange(first + 1, first + gap)
            sides = np.cross(points_mm[between] - points_mm[first], points_mm[last] - points_mm[first])
            areas = least[first, between] + least[between, last] + np.linalg.norm(sides, axis=1) / 2
            split[first, last] = between[areas.argmin()]
            least[first, last] = areas.min()
    found, open_parts = [], [(0, count - 1)]
    while open_parts:
        first, last = open_parts.pop()
        if last - first > 1:
            middle = int(split[first, last])
            found.append((first, middle, last))
            open_parts += [(first, middle), (middle, last)]
    return float(least[0, -1]), np.array(found)


def _rims(edges: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """Yield the vertices of each hole in their order, from edges (n, 2) that have one face alone.

    Holes may touch in vertices: a way along edges that comes back to one of its vertices has gone around one.
    """
    beside = defaultdict[int, list[int]](list)
    for one, other in edges.tolist():
        beside[one].append(other)
        beside[other].append(one)
    for start in list(beside):
        way = [start]
        while beside[way[-1]]:
            at = beside[way[-1]].pop()
            beside[at].remove(way[-1])
            if at in way:
                first = way.index(at)
                yield np.array(way[first:])
                del way[first + 1 :]
            else:
                way.append(at)


def in_cad_kernel(name: str, function: Callable[..., _R], path: Path, *arguments: object) -> _R:
    """Return what a function makes of a STEP file in a process of its own: a damaged file may end it.

    Raises:
        CranktopoError: as the function, no STEP file, or one that the kernel does not survive.
    """
    _check_step(path, name)
    return in_child(name, function, path, *arguments)


def _check_step(path: Path, name: str) -> None:
    """Check that a file can be what its name says before the reader is asked; raises CranktopoError."""
    check_input(path, name, GEOMETRY_LIMIT_MIB, "Give the path of a STEP file of one solid.")
    kind = "BREP" if path.suffix.lower() in _BREP_SUFFIXES else "STEP"
    with path.open("rb") as file:
        head = file.read(1000)
    if _HEADS[kind] not in head:
        raise CranktopoError(f"{name}: is no {kind} file.", hint="Export one solid again as STEP, mm.")


def step_solid(gmsh: Any, path: Path, name: str) -> tuple[int, int]:
    """Return the one solid of a STEP file in the open session; raises CranktopoError without one.

    Called in a child process: the reader may not survive a damaged file.
    """
    solids = step_solids(gmsh, path, name)
    if len(solids) != 1:
        raise CranktopoError(
            f"{name}: holds {len(solids)} solids, not one.",
            hint="Join its solids in CAD, or close its surfaces to a solid, and export it again.",
        )
    tell_read()
    return solids[0]


def import_solid(occ: Any, file: str) -> tuple[int, int]:
    """Add the one solid of a STEP file that was read before in a child process; return its pair."""
    with quiet_stdout():
        found = occ.importShapes(file)
    return next((dim, tag) for dim, tag in found if dim == 3)


def step_solids(gmsh: Any, path: Path, name: str) -> list[tuple[int, int]]:
    """Return the solids of a STEP file in the open session; in a child process, as `step_solid`."""
    occ = gmsh.model.occ
    try:
        with quiet_stdout():
            found = occ.importShapes(str(path))
    except Exception as error:
        if type(error) is not Exception:  # gmsh raises the bare class
            raise
        raise CranktopoError(
            f"{name}: cannot be read as STEP.", hint="Export one solid again as STEP (AP203, AP214 or AP242)."
        ) from None
    occ.synchronize()
    return [pair for pair in found if pair[0] == 3]
