"""Quadratic tetrahedra on whatever solid the open gmsh session holds: curved, never inverted."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import product
from typing import Any, TypeVar

import numpy as np

from cranktopo.base.errors import CranktopoError, solver_error
from cranktopo.base.notes import note
from cranktopo.numerics.gmsh_session import DimTags, tetrahedra
from cranktopo.numerics.tetrahedra.mesh import TetMesh, reasons_of, straighten_folded

_R = TypeVar("_R")
TET10 = 11
_GMSH_TO_STANDARD = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
_DELAUNAY_2D, _FRONTAL_2D, _MESH_ADAPT_2D = 5, 6, 1
"""Frontal Delaunay, gmsh's default, makes more regular triangles and cuts across a bore that has a seam.
MeshAdapt is slower and takes long narrow faces on which the others fold triangles."""
_DELAUNAY_3D, _HXT_3D = 1, 10
"""HXT takes a fifth of the time of the other and a quarter fewer nodes; its elements are less regular."""
_LIGHT = ("", "Relocate3D")
"""gmsh's own optimiser takes flat elements away, the other moves nodes."""


class NoMeshError(CranktopoError):
    """Elements on the surface cut across each other; the message is the reason, with its place."""


_SIZES = (1.0, 0.8, 0.64)
"""Element sizes that are tried one after another, over the one that was asked for."""
_SURFACE = re.compile(r"[Ss]urface (\d+)")


def by_smaller_elements(what: str, element_size_mm: float, make: Callable[[float, bool], _R]) -> _R:
    """Return what the first size of elements and algorithm for the surface give that make a mesh.

    Args:
        make: given an element size, mm, and whether the surface is meshed by MeshAdapt; it opens a session of
            its own, as gmsh stays locked after an error.

    Raises:
        CranktopoError: no size gives one, with the reasons of all tries.
    """
    failures, sizes = list[str](), [share * element_size_mm for share in _SIZES]
    for size, adapt in product(sizes, (False, True)):
        try:
            found = make(size, adapt)
        except NoMeshError as error:
            failures.append(error.message)
            continue
        if size != element_size_mm:
            note(f"{what}: no mesh with elements of {element_size_mm:.3g} mm; taken are {size:.3g} mm")
        return found
    *most, last = (f"{size:.3g}" for size in sizes)
    raise solver_error(
        f"{what}: no mesh with elements of {', '.join(most)} or {last} mm, too large for its thinnest parts: "
        f"{reasons_of(failures)}.",
        "Choose a smaller element size; an error estimate takes one 1.5 times as large, too.",
    )


def generate(gmsh: Any, mirrored: bool, *, stresses: bool, regular: bool, adapt: bool = False) -> TetMesh:
    """Return the mesh of the open session, smooth where stresses are wanted.

    Regular triangles on the surface and Netgen's optimiser each take a quarter to a third off the noise of
    the stresses; where polynomials do that, optimisers that take a tenth of its time suffice. Bores of a
    quarter model have no seam. `adapt` meshes the surface by MeshAdapt.

    Raises:
        NoMeshError: elements on the surface cut across each other.
    """
    usual = _FRONTAL_2D if stresses and mirrored else _DELAUNAY_2D
    gmsh.option.setNumber("Mesh.Algorithm", _MESH_ADAPT_2D if adapt else usual)
    gmsh.option.setNumber("Mesh.Algorithm3D", _DELAUNAY_3D if regular or adapt else _HXT_3D)
    try:
        gmsh.model.mesh.generate(3)
    except Exception as error:  # gmsh raises the bare class, for elements that cut across a thin part
        if type(error) is not Exception:
            raise
        raise NoMeshError(str(error).strip().rstrip(".") + _place(gmsh, str(error))) from None
    if stresses:
        for optimiser in ("Netgen",) if regular else _LIGHT:
            gmsh.model.mesh.optimize(optimiser)
    gmsh.model.mesh.setOrder(2)
    return extract_mesh(gmsh, mirrored=mirrored)


def _place(gmsh: Any, reason: str) -> str:
    """Return where the first face that a reason names lies, in words; empty where it names none."""
    found = _SURFACE.search(reason)
    if found is None or (2, int(found[1])) not in gmsh.model.getEntities(2):
        return ""
    return f" near ({', '.join(f'{x:.1f}' for x in gmsh.model.occ.getCenterOfMass(2, int(found[1])))}) mm"


def positive_x(occ: Any, body: DimTags, reach: float, *, quarter: bool = False) -> DimTags:
    """Return the half x >= 0 of a body, or its quarter with z >= 0; `reach` is a length of its size, mm."""
    size = 20 * reach
    low = 0 if quarter else -size
    box = occ.addBox(0, -size, low, size, 2 * size, size - low)
    kept, _ = occ.intersect(body, [(3, box)])
    return list(kept)


def extract_mesh(gmsh: Any, *, mirrored: bool) -> TetMesh:
    """Return the quadratic mesh of the open session, folded elements straightened."""
    coordinates, nodes = tetrahedra(gmsh, TET10, 10)
    cells = nodes[:, _GMSH_TO_STANDARD]
    present = np.zeros(len(coordinates), dtype=bool)
    present[cells] = True
    used, compact = np.flatnonzero(present), np.ascontiguousarray((np.cumsum(present) - 1)[cells].T)
    curved = np.ascontiguousarray(coordinates[used].T)
    points, _ = straighten_folded(curved, compact)
    return TetMesh(points, compact, mirrored, curved - points)
