"""The first modes of a whole crank as one meshed body, free, beside those of its reduced throws.

`python -m tests.studies.crank_modes` prints the table of docs/pages/modes.md: the share by which frequencies
of the reduced shaft lie above those of the body, by steps of the reduction and deformations of the sections.
"""

from __future__ import annotations

import sys

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from numpy.typing import NDArray

from cranktopo.base.units import MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.bodies.solid.crankshaft import add_crankshaft
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import extract_mesh, positive_x
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.solver import cholesky
from cranktopo.numerics.turning_body import modes_at_rest
from cranktopo.tasks.modes.reduced_throw import reduced_throw, section_shapes
from cranktopo.tasks.modes.shaft_model import shaft_model
from cranktopo.tasks.shaft.loaded_throw import throw_body

Array = NDArray[np.float64]
SHIFT = -((2 * np.pi * 300.0) ** 2)
MODES = 10


def crank_mesh(scene: Scene, size_mm: float) -> TetMesh:
    """The half x >= 0 of a crank whose throws lie in one plane, of the exact solid."""
    with cad_session("crank in one piece") as gmsh:
        body = add_crankshaft(gmsh.model.occ, scene)
        positive_x(gmsh.model.occ, body, 4 * scene.pitch_mm)
        gmsh.model.occ.synchronize()
        for option, value in (("Max", size_mm), ("Min", size_mm / 3), ("FromCurvature", 16)):
            gmsh.option.setNumber(f"Mesh.MeshSize{option}", value)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        return extract_mesh(gmsh, mirrored=True)


def body_frequencies_Hz(mesh: TetMesh, scene: Scene, count: int = MODES) -> Array:
    """First frequencies of a free body above its rigid motions, by all its unknowns; mass by scikit-fem."""
    from skfem import Basis, BilinearForm, ElementTetP2

    material = scene.material
    model = assemble(mesh, material.E_GPa * MPA_PER_GPA, material.poisson)
    basis = Basis(model.mesh, ElementTetP2(), intorder=6)
    density = density_tonne_per_mm3(material.density_kg_m3)
    scalar = BilinearForm(lambda u, v, _: density * u * v).assemble(basis)
    stiffness, mass = model.stiffness.tocsr(), sp.kron(scalar, sp.eye(3)).tocsr()
    middle = np.flatnonzero(np.abs(model.nodes_mm[0]) < 1e-6)
    halves = ([0], [1, 2]) if mesh.mirrored else ([],)
    found: list[float] = []
    for axes in halves:
        held = np.concatenate([np.array([], int), *(3 * middle + axis for axis in axes)])
        free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
        own, heavy = stiffness[free][:, free], mass[free][:, free]
        solve = cholesky(own - SHIFT * heavy)
        inverse = sla.LinearOperator(
            own.shape, lambda load, solve=solve: solve(load.reshape(-1, 1)).ravel(), dtype=float
        )
        squares = sla.eigsh(own, count + 6, heavy, sigma=SHIFT, OPinv=inverse, return_eigenvectors=False)
        found += np.sqrt(np.maximum(squares, 0.0)).tolist()
    return np.sort(found)[6 : 6 + count] / (2 * np.pi)


def reduced_frequencies_Hz(scene: Scene, size_mm: float, steps: int, degree: int) -> Array:
    """The same of throws reduced one by one, without rods and pistons."""
    throws, shapes = throw_scenes(scene), section_shapes(scene, degree)
    reduced = {
        throw.name: reduced_throw(throw_body(mesh_throw(throw, size_mm), throw), throw, shapes, steps, 0.0)
        for throw in {throw.name: throw for throw in throws}.values()
    }
    shaft = shaft_model([reduced[throw.name] for throw in throws], scene, "free", 0.0)
    modes = modes_at_rest(shaft.body)
    assert modes.rigid == 6
    return modes.frequency_Hz[6 : 6 + MODES]


def main(design: str, size_mm: float) -> None:
    scene = load_scene(design, whole=True)
    body = body_frequencies_Hz(crank_mesh(scene, size_mm), scene)
    cases = [(0, 3), (1, 3), (2, 3), (1, 0), (1, 1), (1, 2)]
    columns = [reduced_frequencies_Hz(scene, size_mm, *case) for case in cases]
    heads = (f"{steps} steps, degree {degree}" for steps, degree in cases)
    print(f"| mode | one body Hz | {' | '.join(heads)} |")
    print("|---:" * (len(cases) + 2) + "|")
    for number, frequency in enumerate(body):
        errors = (f"{100 * (column[number] / frequency - 1):+.2f} %" for column in columns)
        print(f"| {number + 1} | {frequency:.1f} | {' | '.join(errors)} |")


if __name__ == "__main__":
    main(*(sys.argv[1:2] or ["mikron-iiic"]), float((sys.argv[2:] or ["8"])[0]))
