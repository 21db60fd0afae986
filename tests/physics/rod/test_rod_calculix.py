"""A quarter of the rod by CalculiX: the same elements, its own matrices, pressure and gravity."""

import shutil

import numpy as np
import pytest

from cranktopo.bodies.mesh.rod_mesh import mesh_rod
from cranktopo.design.loading import load_scene
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.stress import boundary_faces
from cranktopo.tasks.rod.unit_fields import solve_rod
from cranktopo.tasks.rod.unit_loads import ALONG
from tests.physics.fea import calculix

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
FACES = {(0, 1, 2): 1, (0, 1, 3): 2, (1, 2, 3): 3, (0, 2, 3): 4}
"""Corners of the faces of C3D10 by the number that CalculiX gives them."""


def pressed(mesh, y_mm, radius_mm, pressure):
    """Lines of pressure on the faces of a bore, by the place of their middles over the radius."""
    local, owners = boundary_faces(mesh.cells)
    at = mesh.points_mm[:, mesh.cells[local[:3], owners]] - np.array([0, y_mm, 0])[:, None, None]
    on = (np.abs(np.hypot(at[0], at[1]) / radius_mm - 1) < 1e-5).all(axis=0)
    values = pressure(*(at[:2, :, on].mean(axis=1) / radius_mm))
    numbers = [FACES[tuple(sorted(face))] for face in local[:3, on].T]
    return [f"{e + 1}, P{n}, {v:.10e}" for e, n, v in zip(owners[on], numbers, values, strict=True)]


@needs_ccx
@pytest.mark.slow
def test_press_fit_and_push_against_calculix(tmp_path):
    """A press fit as pressure on faces, closed in itself; a push by the cosine of the middles of faces.

    Pressure is even on each face there, so that the push differs by the square of the faces' size.
    """
    scene = load_scene("mikron-iiic-rod")
    scene = scene.model_copy(update={"material": scene.rod.material})
    mesh = mesh_rod(scene, 5.0)
    fields = solve_rod(scene, assemble(mesh, scene.material.E_GPa * 1e3, scene.material.poisson), {})
    on = np.abs(mesh.points_mm) < 1e-6
    held = [(int(n), axis) for axis in (0, 2) for n in np.flatnonzero(on[axis])]
    held.append((int(np.flatnonzero(on[0])[0]), 1))
    rod, order = scene.rod, nodes_of(mesh, fields.model)
    even = pressed(mesh, 166.0, rod.small_end_bore_mm / 2, lambda x, y: np.ones_like(x))
    moved = calculix.of_free_body(tmp_path, mesh, scene, held, ["*DLOAD", *even])
    ours = fields.displacement_mm[ALONG.index("press fit")].reshape(-1, 3)[order]
    assert not_shifted(ours) == pytest.approx(not_shifted(moved), abs=3e-4 * np.abs(ours).max())
    lower = pressed(mesh, 166.0, rod.small_end_bore_mm / 2, lambda _, y: np.maximum(-y, 0.0))
    upper = pressed(mesh, 0.0, rod.big_end_bore_mm / 2, lambda _, y: np.maximum(y, 0.0))
    small = scaled(lower, 1000.0 / (np.pi / 4 * rod.small_end_bore_mm * rod.small_end_width_mm))
    big = scaled(upper, 1000.0 / (np.pi / 4 * rod.big_end_bore_mm * rod.big_end_width_mm))
    moved = calculix.of_free_body(tmp_path, mesh, scene, held, ["*DLOAD", *small, *big])
    ours = 1000 * fields.displacement_mm[[0, 2]].sum(axis=0).reshape(-1, 3)[order]
    free = np.arange(len(ours)) != held[-1][0]  # what the faces' pressures lack pulls at the support
    assert not_shifted(ours)[free] == pytest.approx(not_shifted(moved)[free], abs=0.02 * np.abs(ours).max())


def scaled(lines, factor):
    """Lines of pressure times a factor."""
    parts = (line.rsplit(",", 1) for line in lines)
    return [f"{head}, {float(value) * factor:.10e}" for head, value in parts]


def nodes_of(mesh, model):
    """Numbers in the model of the nodes of a mesh."""
    order = np.empty(mesh.points_mm.shape[1], dtype=int)
    order[mesh.cells] = model.mesh.dofs.element_dofs
    return order


def not_shifted(moved):
    """Displacements without their mean along the rod, which a support decides."""
    return moved - np.array([0.0, moved[:, 1].mean(), 0.0])
