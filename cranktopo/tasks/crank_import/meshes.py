"""Bodies of triangles in STL, 3MF and OBJ files: their solids in mm, and the unit that they have."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import GEOMETRY_LIMIT_MIB, check_input
from cranktopo.base.units import MM_PER_INCH
from cranktopo.numerics.surfaces.files import read_stl, without_flat
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, shells
from cranktopo.tasks.crank_import.choices import UNIT_MM, Unit

MESH_SUFFIXES = (".stl", ".3mf", ".obj")
_UNITS_3MF = {
    "micron": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "meter": 1e3,
    "inch": MM_PER_INCH,
    "foot": 304.8,
}
_PLAUSIBLE_MM = (60.0, 30e3)
"""Length of a crank that is believed where no unit is told."""
_METRES = 2.0
"""Length without a unit below which metres are likelier than inches."""
_MOST_TRIANGLES = 2_000_000
_CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
_AGAIN = "Export it again, or export STEP: its exact faces tell more."


def mesh_solids(path: Path, unit: Unit | None) -> tuple[dict[str, SurfaceMesh], list[str]]:
    """Return the closed solids of a file by name, in mm, and what was assumed of the unit.

    Raises:
        CranktopoError: it cannot be read, holds no closed solid, or its size asks for a unit.
    """
    check_input(path, f"'{path}'", GEOMETRY_LIMIT_MIB, "Give a closed body in mm.")
    parts, file_unit_mm = _parts(path)
    triangles = sum(len(mesh.faces) for mesh in parts.values())
    if not triangles:
        raise CranktopoError(f"'{path}': holds no triangles.", hint=_AGAIN)
    if triangles > _MOST_TRIANGLES:
        raise CranktopoError(
            f"'{path}': holds {triangles} triangles, more than {_MOST_TRIANGLES}.",
            hint="Export it with facets of 0.02 mm, or as STEP.",
        )
    size = max(mesh.extent_mm for mesh in parts.values())
    factor = UNIT_MM[unit] if unit else file_unit_mm or 1.0
    assumed = [] if unit or file_unit_mm else _assumed_unit(path, size)
    found: dict[str, SurfaceMesh] = {}
    for name, mesh in parts.items():
        bodies = _bodies(path, SurfaceMesh(factor * mesh.vertices_mm, mesh.faces))
        for number, body in enumerate(bodies, 1):
            found[name if len(bodies) == 1 else f"{name} {number}"] = body
    return found, assumed


def _assumed_unit(path: Path, size: float) -> list[str]:
    """Return the unit assumed of a length that is a crank's in mm; any other raises CranktopoError."""
    low, high = _PLAUSIBLE_MM
    if low <= size <= high:
        return [
            f"unit = mm: the file tells none, and {size:.4g} mm is a crank's length (--unit says otherwise)"
        ]
    unit: Unit = "m" if size < _METRES else "in"
    likely = f"; {'metres' if unit == 'm' else 'inches'} would give {size * UNIT_MM[unit]:.4g} mm"
    more = likely if size < low else ""
    raise CranktopoError(
        f"'{path}': tells no unit, and is {size:.4g} long: no crank's length in mm{more}.",
        hint=f"Give --unit {unit}, or what it is: mm, cm, m, in." if size < low else "Give --unit.",
    )


def _bodies(path: Path, mesh: SurfaceMesh) -> list[SurfaceMesh]:
    """Return the separate bodies of a closed mesh, the largest first; raises CranktopoError."""
    surface = mesh.as_trimesh()
    if not surface.is_watertight:
        raise CranktopoError(f"'{path}': its surface is open.", hint=f"Close its holes. {_AGAIN}")
    if not surface.is_winding_consistent:
        raise CranktopoError(f"'{path}': its triangles are not turned alike.", hint=_AGAIN)
    if mesh.volume_mm3 <= 0:
        raise CranktopoError(
            f"'{path}': is inside out (volume {mesh.volume_mm3:.4g} mm3), as mirroring by "
            "a negative scale leaves a body.",
            hint="Turn its triangles round, and check that it is not its own mirror image.",
        )
    parts = shells(mesh)
    outer = [part for part in parts if part.volume_mm3 > 0]
    if len(outer) == 1:
        return [mesh]
    hollows = [part for part in parts if part.volume_mm3 <= 0]
    return [*(_with(part, [one for one in hollows if _within(one, part)]) for part in outer)]


def _within(inner: SurfaceMesh, outer: SurfaceMesh) -> bool:
    low, high = outer.vertices_mm.min(axis=0), outer.vertices_mm.max(axis=0)
    return bool((inner.vertices_mm.min(axis=0) > low).all() and (inner.vertices_mm.max(axis=0) < high).all())


def _with(body: SurfaceMesh, hollows: list[SurfaceMesh]) -> SurfaceMesh:
    points, faces = body.vertices_mm, body.faces
    for hollow in hollows:
        faces = np.vstack([faces, hollow.faces + len(points)])
        points = np.vstack([points, hollow.vertices_mm])
    return SurfaceMesh(points, faces)


def _parts(path: Path) -> tuple[dict[str, SurfaceMesh], float]:
    """Return the meshes of a file by name, in its own unit, and that unit in mm; 0 where it tells none."""
    if path.suffix.lower() == ".stl":
        return {path.stem: read_stl(path)}, 0.0
    try:
        if path.suffix.lower() == ".3mf":
            return _of_3mf(path)
        import trimesh

        scene = trimesh.load_scene(path, file_type="obj", skip_materials=True)
        named = {str(name): _plain(mesh, f"'{path}'") for name, mesh in scene.geometry.items()}
        return (dict(zip([path.stem], named.values(), strict=True)) if len(named) == 1 else named), 0.0
    except Exception as error:  # readers raise what their parsers raise, all meaning this
        raise CranktopoError(
            f"'{path}': cannot be read as {path.suffix[1:].upper()}: {quoted(str(error))}.", hint=_AGAIN
        ) from None


def _plain(mesh: Any, name: str) -> SurfaceMesh:
    """Return a mesh of a file with the corners of its triangles joined."""
    points, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    vertices, number = np.unique(points, axis=0, return_inverse=True)
    return without_flat(SurfaceMesh(vertices, number.reshape(-1)[faces]), name)


def _of_3mf(path: Path) -> tuple[dict[str, SurfaceMesh], float]:
    """Return the objects that the build of a package of one model places (3MF core specification 1.3)."""
    with zipfile.ZipFile(path) as package:
        models = [entry for entry in package.infolist() if entry.filename.lower().endswith(".model")]
        if len(models) != 1 or models[0].file_size > GEOMETRY_LIMIT_MIB * 2**20:
            raise ValueError(f"holds {len(models)} models")
        root = ElementTree.fromstring(package.read(models[0]))
    objects = {one.get("id"): one for one in root.iter(f"{_CORE}object")}
    found: dict[str, SurfaceMesh] = {}
    for number, item in enumerate(root.iter(f"{_CORE}item"), 1):
        entry = objects[item.get("objectid")]
        for mesh in _placed_3mf(entry, objects, _matrix_3mf(item), 0):
            found[entry.get("name") or f"object {number}"] = mesh
    return found, _UNITS_3MF[root.get("unit", "millimeter")]


def _placed_3mf(entry: Any, objects: Mapping[Any, Any], matrix: Any, depth: int) -> Iterator[SurfaceMesh]:
    if depth > 20:
        raise ValueError("components of components without end")
    mesh = entry.find(f"{_CORE}mesh")
    if mesh is not None:
        points = [[float(v.attrib[k]) for k in "xyz"] for v in mesh.iter(f"{_CORE}vertex")]
        faces = [[int(t.attrib[k]) for k in ("v1", "v2", "v3")] for t in mesh.iter(f"{_CORE}triangle")]
        corners = np.array(points, float).reshape(-1, 3)
        yield SurfaceMesh(corners @ matrix[:3] + matrix[3], np.array(faces, np.int64).reshape(-1, 3))
    for part in entry.iter(f"{_CORE}component"):
        own, outer = (np.column_stack([m, [0, 0, 0, 1]]) for m in (_matrix_3mf(part), matrix))
        yield from _placed_3mf(objects[part.get("objectid")], objects, (own @ outer)[:, :3], depth + 1)


def _matrix_3mf(item: Any) -> Any:
    """Return the transform (4, 3) of an item: rows of the rotation, then the shift."""
    text = item.get("transform") or "1 0 0 0 1 0 0 0 1 0 0 0"
    return np.array([float(number) for number in text.split()]).reshape(4, 3)
