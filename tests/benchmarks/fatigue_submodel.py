"""Local refinement against a cut-boundary submodel: largest fillet stresses, unknowns, seconds.

Run with `python -m tests.benchmarks.fatigue_submodel` (`--design NAME` for another throw, `--fraction F` for
the element size over the fillet's radius). A submodel is the material in a box around one fillet, some fillet
radii wide; its cut faces follow the displacement of a global model on the mesh that stiffness is judged with.
Von Mises stress in percent of a finer local refinement, at the worst node of each fillet under unit bending
and unit torsion. Local refinement resolves both fillets in one model, so both submodels count.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cranktopo.cad.session import cad_session
from cranktopo.cad.throw_solid import add_half_throw
from cranktopo.evaluate.elasticity import Elasticity, assemble
from cranktopo.evaluate.equivalent import von_mises
from cranktopo.evaluate.evaluation import default_element_size_mm
from cranktopo.evaluate.fillets import Fillet, fillet_nodes
from cranktopo.evaluate.linear import solve
from cranktopo.evaluate.stress import nodal_stress
from cranktopo.evaluate.stress_model import RULE_FRACTION, solve_stresses
from cranktopo.evaluate.targets import Target
from cranktopo.evaluate.unit_fields import FieldKind, unit_fields
from cranktopo.meshing.curving import EDGES
from cranktopo.meshing.solid_mesh import TetMesh, _generate, _set_sizes, mesh_throw
from cranktopo.scene import Scene, load_scene
from cranktopo.units import MPA_PER_GPA

Array = NDArray[np.float64]
KINDS: tuple[FieldKind, ...] = ("bending", "torsion")
HELD_AXES = {"bending": (0,), "torsion": (1, 2)}
"""Displacements that the mirror plane x = 0 holds."""
FILLETS: tuple[Fillet, ...] = ("pin", "journal")
CUTS = (2.0, 4.0, 6.0)
FINER = 0.7
"""Element size of the reference over that of the others."""
_NEIGHBOURS, _PLANE_MM = 40, 1e-6


@dataclass(frozen=True)
class Result:
    """One line of the table.

    Attributes:
        name: of the method.
        unknowns: of each solved model.
        stress: by fillet and load, MPa per unit load, shape (2, 2).
        seconds: mesh to stress.
    """

    name: str
    unknowns: tuple[int, ...]
    stress: Array
    seconds: float

    def line(self, reference: Array) -> str:
        """The line in Markdown."""
        percent = " | ".join(f"{100 * v:.1f}" for v in (self.stress / reference).ravel())
        counts = " + ".join(f"{n:,}" for n in self.unknowns)
        return f"| {self.name} | {counts} | {percent} | {self.seconds:.1f} |"


def refined(scene: Scene, fraction: float) -> Result:
    """Both fillets refined in the model of the half throw."""
    start = time.perf_counter()
    model = solve_stresses(Target(scene.name, scene), KINDS, fraction)
    stress = von_mises(model.stress.stress_MPa)
    worst = np.stack([stress[:, on].max(axis=1) for on in (model.on_pin, model.on_journal)])
    name = f"local refinement, {fraction:g} r"
    return Result(name, (3 * model.quality.nodes,), worst, time.perf_counter() - start)


def submodelled(scene: Scene, cut: float, fraction: float) -> Result:
    """A coarse global model, and one submodel per fillet cut some radii away from it."""
    start = time.perf_counter()
    part = mesh_throw(scene, default_element_size_mm(scene))
    coarse = elastic(scene, part.mesh)
    fields = unit_fields(coarse, scene, True, KINDS)
    moved = np.stack([field.displacement_mm for field in fields])
    unknowns, worst = [moved.shape[1]], []
    for fillet in FILLETS:
        fine = elastic(scene, cut_mesh(scene, fillet, cut, fraction))
        found = nodal_stress(
            fine,
            driven(fine, coarse, moved, box(scene, fillet, cut)),
            scene.material.E_GPa * MPA_PER_GPA,
            scene.material.poisson,
        )
        on = fillet_nodes(scene, fillet, fine.nodes_mm)
        worst.append(von_mises(found.nodal_MPa[:, on]).max(axis=1))
        unknowns.append(fine.nodes_mm.size)
    name = f"submodels, {fraction:g} r, cut {cut:g} r away"
    return Result(name, tuple(unknowns), np.stack(worst), time.perf_counter() - start)


def elastic(scene: Scene, mesh: TetMesh) -> Elasticity:
    """The assembled model of a mesh."""
    return assemble(mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)


def box(scene: Scene, fillet: Fillet, cut: float) -> tuple[Array, Array]:
    """Corners of the box of a submodel within the half throw."""
    start, end = scene.web_z_mm
    pin = fillet == "pin"
    journal = scene.throw.crankpin if pin else scene.throw.main_journal
    axis, margin = scene.throw.radius_mm if pin else 0.0, cut * journal.fillet_mm
    reach = journal.radius_mm + journal.fillet_mm + margin
    low, high = (end, end + journal.fillet_mm) if pin else (start - journal.fillet_mm, start)
    return (
        np.array([0.0, axis - reach, max(low - margin, 0.0)]),
        np.array([reach, axis + reach, min(high + margin, scene.pitch_mm / 2)]),
    )


def cut_mesh(scene: Scene, fillet: Fillet, cut: float, fraction: float) -> TetMesh:
    """The half x >= 0 of a submodel, as fine as local refinement makes it."""
    low, high = box(scene, fillet, cut)
    with cad_session("submodel") as gmsh:
        occ = gmsh.model.occ
        occ.intersect(add_half_throw(occ, scene), [(3, occ.addBox(*low, *(high - low)))])
        size = min(default_element_size_mm(scene), scene.web.thickness_mm / 6)
        _set_sizes(gmsh, scene, size, graded=True, full=False, fillet_fraction=fraction)
        return _generate(gmsh, True, smooth=True)


def driven(fine: Elasticity, coarse: Elasticity, moved: Array, corners: tuple[Array, Array]) -> Array:
    """Displacement of a submodel whose cut faces follow the global model, shape (fields, unknowns)."""
    nodes = fine.nodes_mm
    off = np.minimum(np.abs(nodes - corners[0][:, None]), np.abs(nodes - corners[1][:, None]))
    off[0] = np.abs(nodes[0] - corners[1][0])  # x = 0 is the mirror
    cut = np.nonzero((off < _PLANE_MM).any(axis=0))[0]
    rows = (3 * cut[:, None] + np.arange(3)).ravel()
    mirror = np.nonzero(np.abs(nodes[0]) < _PLANE_MM)[0]
    found = np.zeros((len(KINDS), nodes.size))
    for field, kind, motion in zip(found, KINDS, interpolated(coarse, moved, nodes[:, cut]), strict=True):
        plane = np.concatenate([3 * mirror + axis for axis in HELD_AXES[kind]])
        field[rows] = motion.ravel()
        field[plane] = 0.0
        free = np.setdiff1d(np.arange(nodes.size), np.concatenate([rows, plane]))
        linear = free[free < fine.prolongation.shape[1]]
        force = -(fine.stiffness @ field)[free, None]
        field[free] = solve(fine.stiffness[free][:, free], force, fine.prolongation[free][:, linear])[:, 0]
    return found


def interpolated(model: Elasticity, moved: Array, points: Array) -> Array:
    """Displacements of a model at points (3, n) by its shape functions, shape (fields, n, 3)."""
    from skfem import Basis, ElementTetP2

    elements = Basis(model.mesh, ElementTetP2()).element_dofs
    corners = model.nodes_mm[:, elements[:4]]  # (3, 4, elements)
    _, near = cKDTree(corners.mean(axis=1).T).query(points.T, k=_NEIGHBOURS)
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(2, 0, 1))
    rest = np.einsum("nkij,nkj->nki", inverse[near], points.T[:, None] - corners[:, 0].T[near])
    weights = np.concatenate([1 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)
    every, best = np.arange(len(near)), weights.min(axis=-1).argmax(axis=1)  # inside, or least outside
    w = weights[every, best]
    shape = np.concatenate(
        [w * (2 * w - 1), np.stack([4 * w[:, a] * w[:, b] for a, b in EDGES], axis=1)], axis=1
    )
    around = elements[:, near[every, best]].T
    return np.einsum("nk,fnkc->fnc", shape, moved.reshape(len(moved), -1, 3)[:, around])


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--design", default="mikron-iiic")
    parser.add_argument("--fraction", type=float, default=RULE_FRACTION)
    chosen = parser.parse_args()
    scene, fraction = load_scene(chosen.design), chosen.fraction
    places = " | ".join(f"{fillet}, {kind} %" for fillet in FILLETS for kind in KINDS)
    print(f"| method | unknowns | {places} | s |\n{'|---' * 7}|")
    reference = refined(scene, FINER * fraction)
    print(reference.line(reference.stress), flush=True)
    print(refined(scene, fraction).line(reference.stress), flush=True)
    for cut in CUTS:
        print(submodelled(scene, cut, fraction).line(reference.stress), flush=True)


if __name__ == "__main__":
    main()
