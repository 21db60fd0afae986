"""The crank of a file that the CAD kernel reads: found among exact faces, cut into its half throws, once."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import note
from cranktopo.bodies.solid.checked import check_parts, solid_properties, volume_mm3
from cranktopo.bodies.solid.step import STEP_SUFFIXES, kernel_surface
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
from cranktopo.tasks.crank_import.hand import hand_words, mirrored_by_file
from cranktopo.tasks.crank_import.solids import read_crank
from cranktopo.tasks.importing.cad_body import edges_in_planes, moved_rigidly, slab
from cranktopo.tasks.importing.faces import exact_faces

_INTEGRATED = 1e-4
"""Share of a half in which its volume may differ between two ways to cut it; the smallest pocket has as much.

The kernel integrates a plane that an outlet cuts to a tenth of a percent, which was 2.6e-5 of a half.
"""


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
        kept = Path(scratch) / "crank.brep"
        gmsh.write(str(kept))
        bulks = _bulks(gmsh.model.occ, [taken.entity], crank)
        groups = alike_halves(crank.halves, bulks, EXACT)
        halves = tuple(
            _written(
                gmsh,
                kept,
                crank,
                group,
                bulks[crank.halves.index(group.halves[0])],
                folder / f"half-{number}.step",
            )
            for number, group in enumerate(groups, 1)
        )
    by_file = mirrored_by_file(path) if path.suffix.lower() in STEP_SUFFIXES else []
    assumed = (*by_file, *hand_words(crank, groups))
    return FoundBody(solids, taken, crank, halves, count, assumed=assumed)


def _bulks(occ: Any, body: DimTags, crank: FoundCrank) -> list[Array]:
    """Return the bulk of each half throw; all are cut at once, by discs, which takes the body apart.

    Raises:
        CranktopoError: the parts do not add up to the body, or a half is not one body.
    """
    whole, box = volume_mm3(occ, body), np.array(occ.getBoundingBox(*body[0])).reshape(2, 3)
    reach = float(np.linalg.norm(box[1] - box[0]))
    heights = {place for half in crank.halves for place in (half.main_plane_mm, half.pin_plane_mm)}
    discs = [
        (2, occ.addDisk(*(crank.origin_mm + height * crank.axis), reach, reach, zAxis=crank.axis.tolist()))
        for height in sorted(heights)
    ]
    with edges_in_planes():
        parts = [pair for pair in occ.fragment(body, discs)[1][0] if pair[0] == 3]
    check_parts(volume_mm3(occ, parts), whole)
    centres = np.array([occ.getCenterOfMass(*part) for part in parts])
    along = (centres - crank.origin_mm) @ crank.axis
    found = []
    for half in crank.halves:
        low, high = sorted((half.main_plane_mm, half.pin_plane_mm))
        own = np.flatnonzero((low < along) & (along < high))
        check_one_body(len(own), half)
        matrix, shift = frame_of(crank, half)
        inertia = np.array(occ.getMatrixOfInertia(*parts[own[0]])).reshape(3, 3)
        volume = float(occ.getMass(*parts[own[0]]))
        found.append(bulk_of(volume, matrix @ centres[own[0]] + shift, matrix @ inertia @ matrix.T))
    return found


def _cut(occ: Any, body: DimTags, crank: FoundCrank, half: FoundHalf, volume: float) -> DimTags:
    """Cut a half throw out of a body that was moved first: its planes are those of the frame exactly."""
    moved_rigidly(occ, body, *frame_of(crank, half))
    x0, y0, _, x1, y1, _ = occ.getBoundingBox(*body[0])
    reach = 2 * max(abs(v) for v in (x0, y0, x1, y1))
    cut = slab(occ, body, 0.0, abs(half.pin_plane_mm - half.main_plane_mm), reach)
    check_one_body(len(cut), half)
    check_parts(volume_mm3(occ, cut), volume, _INTEGRATED)
    return cut


def _written(gmsh: Any, kept: Path, crank: FoundCrank, group: HalfGroup, bulk: Array, file: Path) -> HalfBody:
    """Write one half alone, in a model of its own, and return it."""
    gmsh.model.add(file.name)
    occ = gmsh.model.occ
    cut = _cut(occ, occ.importShapes(str(kept)), crank, group.halves[0], float(bulk[0] ** 3))
    occ.remove([pair for pair in occ.getEntities(3) if pair != cut[0]], recursive=True)
    occ.synchronize()
    properties = solid_properties(occ, cut)
    faces, mesh = exact_faces(gmsh), kernel_surface(gmsh)
    file.parent.mkdir(parents=True, exist_ok=True)
    with quiet_stdout():
        gmsh.write(str(file))
    return HalfBody(group.halves[0], file.name, faces, mesh, properties, group.halves, group.mirrored, EXACT)
