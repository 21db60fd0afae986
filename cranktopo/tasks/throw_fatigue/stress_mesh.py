"""Meshes of throws for stresses: their fillets, how fine, and how long their edges are there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.notes import note
from cranktopo.bodies.memory import check_fillet_fraction, check_stress_memory
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.design.halves import default_element_size_mm, halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.stress import boundary_faces
from cranktopo.tasks.throw_fatigue.fillets import on_fillets
from cranktopo.tasks.throw_fatigue.mesh_quality import EDGE_LIMIT
from cranktopo.tasks.throw_fea.targets import Target

RULE_FRACTION = 0.17
"""Element size in a fillet over its radius that keeps edges below a quarter (IACS UR M53, Appendix III)."""
_BELOW = 0.97
"""Share of the rule's largest edge that a mesh which misses it aims at when it is made anew."""
_ACROSS_WEB = 6
"""Elements through the web: the same rule."""


def check_fillets(target: Target) -> None:
    """Check that both fillets of a target have a radius.

    Raises:
        CranktopoError: a surface file, a STEP body without round fillets at its journals, fillets switched
            off, or a fillet of radius 0.
    """
    if target.file is not None:
        from cranktopo.tasks.importing.imported_body import fillets_of_step

        fillets_of_step(_step_of(target), target.scene, target.align)
        return
    if target.scene.effects.fillets == "off":
        raise invalid(
            f"{target.name}: effects.fillets",
            "off",
            "the stress at the sharp edges that this leaves is singular",
            "Set it to 'auto' or 'on'.",
        )
    for key in ("main_journal", "crankpin"):
        if getattr(target.scene.throw, key).fillet_mm == 0:
            raise CranktopoError(
                f"{target.name}: throw.{key}.fillet_mm = 0: the stress at a sharp edge is singular, so "
                "that any value of it follows from the mesh alone.",
                hint="Give the fillet a radius.",
            )


def _step_of(target: Target) -> Path:
    """Return the STEP file of a target.

    Raises:
        CranktopoError: it is a surface of triangles.
    """
    if target.file is None or target.triangles:
        raise CranktopoError(
            f"target '{target.name}': a surface file has no true fillets, and the stress at its edges is "
            "singular.",
            hint="Assess a STEP body, or a design whose fillets have a radius; 'cranktopo remodel' makes one "
            "of a run.",
        )
    return target.file


def mesh_for_stress(
    target: Target, fillet_fraction: float, *, by_rule: bool = False, to_follow: bool = False
) -> tuple[MeshedThrow, Scene]:
    """Return the mesh of a target for stresses, and its scene with the fillets that the mesh has.

    Elements of the size that keeps edges below the rule's quarter may miss it by one edge: they are made
    smaller then, once, before anything is solved.

    Args:
        by_rule: as in `solve_stresses`.
        to_follow: as in `mesh_throw`; not for a body from a file.

    Raises:
        CranktopoError: a surface file, a fillet of radius 0, or a failed mesh.
    """
    found = _meshed(target, fillet_fraction, by_rule=by_rule, to_follow=to_follow)
    if not by_rule or fillet_fraction > RULE_FRACTION:
        return found
    longest = longest_edge(*found)
    if longest <= EDGE_LIMIT:
        return found
    finer = fillet_fraction * _BELOW * EDGE_LIMIT / longest
    note(
        f"{target.name}: longest edge in a fillet over its radius {longest:.4f}, at most {EDGE_LIMIT:g}: "
        f"meshed anew with a fillet fraction of {finer:.3f}"
    )
    return _meshed(target, finer, by_rule=by_rule, to_follow=to_follow)


def longest_edge(meshed: MeshedThrow, scene: Scene) -> float:
    """Return the longest element edge in a fillet over the fillet's least radius."""
    points, cells = meshed.mesh.points_mm, meshed.mesh.cells
    local, owners = boundary_faces(cells)
    fillets = on_fillets(scene, meshed.whole, points)
    return longest_edge_of(scene, points, cells[local[:3], owners], fillets)


def _meshed(
    target: Target, fillet_fraction: float, *, by_rule: bool, to_follow: bool
) -> tuple[MeshedThrow, Scene]:
    scene = target.scene
    thinner = min(half.web.thickness_mm for half in halves(scene))
    size = min(default_element_size_mm(scene), thinner / _ACROSS_WEB)
    if target.file is None:
        check_fillets(target)
        check_fillet_fraction(scene, size, fillet_fraction)
        made = mesh_throw(scene, size, fillet_fraction=fillet_fraction, regular=by_rule, to_follow=to_follow)
        check_stress_memory(made.mesh.points_mm.shape[1], fillet_fraction)
        return made, scene
    from cranktopo.tasks.importing.imported_body import mesh_step_for_stress

    path = _step_of(target)
    made, scene = mesh_step_for_stress(path, scene, size, fillet_fraction, target.align, regular=by_rule)
    check_stress_memory(made.mesh.points_mm.shape[1], fillet_fraction)
    return made, scene


def longest_edge_of(
    scene: Scene, points_mm: Array, triangles: Index, fillets: tuple[NDArray[np.bool_], NDArray[np.bool_]]
) -> float:
    """Return the longest edge of triangles (3, n) on the fillets over the fillet's (least) radius."""
    longest = []
    for on, (journal, _) in zip(fillets, scene.throw.journals, strict=True):
        corners = points_mm[:, triangles[:, on[triangles].all(axis=0)]]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=0)
        longest.append(float(edges.max(initial=0.0)) / journal.fillet.least_radius_mm)
    return max(longest)
