"""The crank of a file that the CAD kernel reads: found among exact faces, cut into its half throws, once."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import note
from cranktopo.bodies.solid.checked import solid_properties
from cranktopo.bodies.solid.step import kernel_surface
from cranktopo.numerics.gmsh_session import DimTags, cad_session, quiet_stdout
from cranktopo.tasks.crank_import.choices import EndJournals, Unit
from cranktopo.tasks.crank_import.crank_finder import find_crank
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf
from cranktopo.tasks.crank_import.half_body import (
    EXACT,
    FoundBody,
    HalfBody,
    HalfGroup,
    alike_halves,
    bulk_of,
    check_one_body,
    frame_of,
)
from cranktopo.tasks.crank_import.solids import read_crank
from cranktopo.tasks.importing.cad_body import between_planes, moved_rigidly
from cranktopo.tasks.importing.faces import exact_faces


def crank_by_kernel(
    path: Path, solid: str | None, ends: EndJournals, unit: Unit | None, folder: Path
) -> FoundBody:
    """Return the crank of a file, its distinct half throws written as `half-N.step`.

    Called in a child process. The file is read once: half throws are cut from the kernel's own copy of it.
    """
    with cad_session(f"crank in {path}") as gmsh, tempfile.TemporaryDirectory() as scratch:
        taken, solids = read_crank(gmsh, path, solid, unit)
        crank = find_crank(exact_faces(gmsh), f"'{path}'", ends)
        count = len(gmsh.model.getEntities(2))
        note(f"{path}: {crank.words}")
        body = [taken.entity]
        bulks = [_bulk(gmsh, body, crank, half) for half in crank.halves]
        kept = Path(scratch) / "crank.brep"
        gmsh.write(str(kept))
        halves = tuple(
            _written(gmsh, kept, crank, group, folder / f"half-{number}.step")
            for number, group in enumerate(alike_halves(crank.halves, bulks, EXACT), 1)
        )
    return FoundBody(solids, taken, crank, halves, count)


def _cut(gmsh: Any, body: DimTags, crank: FoundCrank, half: FoundHalf) -> DimTags:
    occ = gmsh.model.occ
    own = occ.copy(body)
    moved_rigidly(occ, own, *frame_of(crank, half))
    x0, y0, _, x1, y1, _ = occ.getBoundingBox(*own[0])
    reach = 2 * max(abs(v) for v in (x0, y0, x1, y1))
    cut = between_planes(occ, own, 0.0, abs(half.pin_plane_mm - half.main_plane_mm), reach)
    check_one_body(len(cut), half)
    return cut


def _bulk(gmsh: Any, body: DimTags, crank: FoundCrank, half: FoundHalf) -> Array:
    occ = gmsh.model.occ
    cut = _cut(gmsh, body, crank, half)
    centre, inertia = np.array(occ.getCenterOfMass(*cut[0])), np.array(occ.getMatrixOfInertia(*cut[0]))
    bulk = bulk_of(float(occ.getMass(*cut[0])), centre, inertia)
    occ.remove(cut, recursive=True)
    return bulk


def _written(gmsh: Any, kept: Path, crank: FoundCrank, group: HalfGroup, file: Path) -> HalfBody:
    """Write one half alone, in a model of its own, and return it."""
    gmsh.model.add(file.name)
    occ = gmsh.model.occ
    cut = _cut(gmsh, occ.importShapes(str(kept)), crank, group.halves[0])
    occ.remove([pair for pair in occ.getEntities(3) if pair != cut[0]], recursive=True)
    occ.synchronize()
    properties = solid_properties(occ, cut)
    faces, mesh = exact_faces(gmsh), kernel_surface(gmsh)
    file.parent.mkdir(parents=True, exist_ok=True)
    with quiet_stdout():
        gmsh.write(str(file))
    return HalfBody(group.halves[0], file.name, faces, mesh, properties, group.halves, group.mirrored, EXACT)
