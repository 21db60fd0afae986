"""Solids of a STEP file with their names, and the one of them that is the crank."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cranktopo.base.child import tell_read
from cranktopo.base.errors import CranktopoError, suggest
from cranktopo.bodies.solid.step import step_solids
from cranktopo.tasks.crank_import.choices import UNIT_MM, Unit
from cranktopo.tasks.importing.faces import Faces, exact_faces, lines_of, parallel

_LISTED = 20


@dataclass(frozen=True)
class FoundSolid:
    """A solid of a file: its name, its box, its volume, and whether it looks like a crank."""

    tag: int
    name: str
    size_mm: tuple[float, float, float]
    volume_mm3: float
    looks_like_a_crank: bool

    @property
    def entity(self) -> tuple[int, int]:
        """Dimension and tag in the session that read it."""
        return 3, self.tag


def _solids(gmsh: Any, path: Path) -> tuple[FoundSolid, ...]:
    """Read a STEP file into the open session; return its solids."""
    gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
    solids = step_solids(gmsh, path, f"'{path}'")
    found: list[FoundSolid] = []
    for dim, tag in solids:
        box = gmsh.model.occ.getBoundingBox(dim, tag)
        x, y, z = (float(high - low) for low, high in zip(box[:3], box[3:], strict=True))
        name = gmsh.model.getEntityName(dim, tag).rsplit("/", 1)[-1] or f"solid {len(found) + 1}"
        found.append(
            FoundSolid(
                tag, name, (x, y, z), float(gmsh.model.occ.getMass(dim, tag)), _looks_like_a_crank(gmsh, tag)
            )
        )
    return tuple(found)


def _looks_like_a_crank(gmsh: Any, tag: int) -> bool:
    faces = [face for _, face in gmsh.model.getBoundary([(3, tag)], oriented=False)]
    return parallel_axes(exact_faces(gmsh, faces)) >= 2


def parallel_axes(faces: Faces) -> int:
    """Return on how many lines whole shafts of one direction lie: two or more on a crank."""
    lines = lines_of([face for face in faces.cylinders if face.full and face.outward])
    return max((sum(parallel(one[0].axis, other[0].axis) for other in lines) for one in lines), default=0)


def read_crank(
    gmsh: Any, path: Path, name: str | None, unit: Unit | None = None
) -> tuple[FoundSolid, tuple[FoundSolid, ...]]:
    """Read a file; return its crank, which alone is left in the session, and all its solids.

    The crank is the named solid, the only one, or the only one that looks so.

    Raises:
        CranktopoError: no solid, none or several of that name, or several that look like a crank.
    """
    if unit:
        gmsh.option.setNumber("Geometry.OCCScaling", UNIT_MM[unit])
    found = _solids(gmsh, path)
    tell_read()
    own = chosen(found, path, name)
    rest = [solid.entity for solid in found if solid is not own]
    if rest:
        gmsh.model.occ.remove(rest, recursive=True)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Geometry.OCCScaling", 1.0)
    return own, found


def chosen(solids: tuple[FoundSolid, ...], path: Path, name: str | None) -> FoundSolid:
    """Return the named solid, the only one, or the only one that looks so; raises CranktopoError."""
    if name is not None:
        own = [solid for solid in solids if solid.name == name]
        if len(own) != 1:
            said = f"holds {len(own)} solids named '{name}'" if own else f"holds no solid '{name}'"
            raise CranktopoError(f"'{path}': {said}.", hint=suggest(name, [solid.name for solid in solids]))
        return own[0]
    likely = [solid for solid in solids if solid.looks_like_a_crank]
    if len(solids) == 1 or len(likely) == 1:
        return (likely or list(solids))[0]
    if not solids:
        raise CranktopoError(f"'{path}': holds no solid.", hint="Close its surfaces to a solid in CAD.")
    rows = "; ".join(
        f"'{solid.name}' {solid.size_mm[0]:.4g} x {solid.size_mm[1]:.4g} x {solid.size_mm[2]:.4g} mm"
        for solid in (likely or solids)[:_LISTED]
    )
    what = f"{len(likely)} of them look like a crank" if likely else "none of them looks like a crank"
    raise CranktopoError(
        f"'{path}': holds {len(solids)} solids, {what}: {rows}.", hint="Choose one with --solid NAME."
    )
