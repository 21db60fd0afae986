"""Load states summed from unit fields against one direct solve of the whole throw with all loads at once."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cranktopo.base.units import MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, centrifugal_force, mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.rigid_motions import section_motions
from cranktopo.numerics.tetrahedra.stress import von_mises
from cranktopo.tasks.throw_fea.unit_fields import unit_fields
from tests.physics.fatigue.point_stress import point_stress
from tests.physics.fea.evaluation_cases import elastic, mikron_with

Array = NDArray[np.float64]
SPRING = 8.0e5
RADIAL_N, TANGENTIAL_N, TORQUE_NMM, SPEED2 = 30e3, 9e3, -4e5, 290.0**2
REFLECTED = [0, 2, 1, 3, 6, 5, 4, 7, 9, 8]
IMAGES = ((False, False), (True, False), (False, True), (True, True))


def sprung() -> Scene:
    data = mikron_with().model_dump(mode="json", exclude_none=True)
    data["supports"] = {"torsion": "spring", "bending": "spring", "bearing_spring_N_per_mm": SPRING}
    return scene_from_dict(data)


def moved(points: Array, flip: tuple[bool, bool], pitch: float) -> Array:
    x, y, z = points
    return np.stack([-x if flip[0] else x, y, pitch - z if flip[1] else z])


def whole(quarter: TetMesh, pitch: float) -> TetMesh:
    """The whole throw from four images of the quarter model, their elements in order."""
    blocks = np.concatenate([moved(quarter.points_mm, flip, pitch) for flip in IMAGES], axis=1)
    _, first, number = np.unique(np.round(blocks, 6), axis=1, return_index=True, return_inverse=True)
    count = quarter.points_mm.shape[1]
    images = [number.ravel()[i * count : (i + 1) * count] for i in range(4)]
    cells = [
        image[quarter.cells[REFLECTED] if flip[0] != flip[1] else quarter.cells]
        for image, flip in zip(images, IMAGES, strict=True)
    ]
    return TetMesh(blocks[:, first], np.concatenate(cells, axis=1), False)


def direct(model: Elasticity, scene: Scene, pin: Array) -> Array:
    """Displacement of the whole throw on springs under all loads, by one LU factorisation.

    Both sections are rigid. The tangential force is answered by equal torques: their mean rotation is zero.
    """
    nodes, pitch = model.nodes_mm, scene.pitch_mm
    ends = [np.nonzero(np.abs(nodes[2] - z) < 1e-6)[0] for z in (0.0, pitch)]
    near, far = (section_motions(nodes, end) for end in ends)
    motions = np.column_stack([near[:, :2], far[:, :2], near[:, 2] - far[:, 2], near[:, 3:5], far[:, 3:5]])
    motions = np.column_stack([motions, near[:, 5] - far[:, 5]])
    free = np.setdiff1d(np.arange(nodes.size), np.concatenate([3 * e[:, None] + np.arange(3) for e in ends]))
    select = sp.csr_matrix((np.ones(free.size), (free, np.arange(free.size))), (nodes.size, free.size))
    basis = sp.hstack([select, sp.csr_matrix(motions)]).tocsr()
    springs = np.zeros(basis.shape[1])
    springs[free.size : free.size + 4] = SPRING
    matrix = (basis.T @ model.stiffness.tocsr() @ basis + sp.diags(springs)).tocsc()
    density = density_tonne_per_mm3(scene.material.density_kg_m3)
    loads = basis.T @ (pin + SPEED2 * centrifugal_force(model, density))
    loads[-1] += 2 * TORQUE_NMM  # on the near section, its opposite on the far one
    return np.asarray(basis @ sla.splu(matrix).solve(loads))


def pin_force(body: Elasticity, model: Elasticity, scene: Scene) -> Array:
    """Radial and tangential force spread evenly over the pin, gathered from the four images."""
    start, total = scene.web_z_mm[1], np.zeros(model.nodes_mm.size)
    tree = cKDTree(model.nodes_mm.T)
    images = [tree.query(moved(body.nodes_mm, flip, scene.pitch_mm).T)[1] for flip in IMAGES]
    for axis, force in ((1, -RADIAL_N), (0, TANGENTIAL_N)):
        quarter = force / 4 * mean_displacement(body, axis, start)[axis::3]
        for image in images:
            np.add.at(total, 3 * image + axis, quarter)
    return total


def test_superposed_states_equal_a_direct_solve() -> None:
    scene = sprung()
    youngs, poisson = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    quarter = mesh_throw(scene, 15.0, graded=False).mesh
    assert quarter.mirrored
    body = elastic(quarter, scene)
    fields = unit_fields(body, scene, True, ("bending", "tangential", "torsion", "centrifugal"))
    unit = point_stress(body, np.stack([f.displacement_mm for f in fields]), youngs, poisson).stress_MPa
    model = elastic(whole(quarter, scene.pitch_mm), scene)
    found = point_stress(model, direct(model, scene, pin_force(body, model, scene))[None], youngs, poisson)
    factors = np.array([RADIAL_N, TANGENTIAL_N, TORQUE_NMM, SPEED2])
    count = quarter.cells.shape[1]
    for index, flip in enumerate(IMAGES):
        signs = [(f.sign_x if flip[0] else 1) * (f.sign_z if flip[1] else 1) for f in fields]
        summed = np.einsum("f,feqc->eqc", factors * signs, unit)
        straight = found.stress_MPa[0, index * count : (index + 1) * count]
        scale = von_mises(straight).max()
        # a reflected element counts its quadrature points in another order
        assert np.abs(np.sort(von_mises(summed)) - np.sort(von_mises(straight))).max() < 1e-8 * scale
        trace = [np.sort(s[..., :3].sum(axis=-1)) for s in (summed, straight)]
        assert np.abs(trace[0] - trace[1]).max() < 1e-8 * scale
