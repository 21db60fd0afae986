"""A quarter of the rod, and half of an oblique one, by CalculiX: its own matrices, pressure and gravity."""

import shutil

import numpy as np
import pytest

from cranktopo.bodies.mesh.rod_mesh import mesh_rod
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
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


def solved(angle_deg):
    """A rod with its split at an angle, its mesh and unit loads, and what is held, (node, axis)."""
    scene = with_values(load_scene("mikron-iiic-rod"), {"rod.split_angle_deg": angle_deg})
    scene = scene.model_copy(update={"material": scene.rod.material})
    mesh = mesh_rod(scene, 5.0)
    fields = solve_rod(scene, assemble(mesh, scene.material.E_GPa * 1e3, scene.material.poisson), {})
    on = np.abs(mesh.points_mm) < 1e-6
    held = [(int(n), axis) for axis in ((2,) if angle_deg else (0, 2)) for n in np.flatnonzero(on[axis])]
    ends = [int(mesh.points_mm[1].argmin()), int(mesh.points_mm[1].argmax())] if angle_deg else []
    return scene, mesh, fields, [*held, *((n, 0) for n in ends), (int(np.flatnonzero(on[0])[0]), 1)]


@needs_ccx
@pytest.mark.slow
@pytest.mark.parametrize("angle_deg", [0.0, 45.0])
def test_press_fit_against_calculix(tmp_path, angle_deg):
    """As pressure on faces, closed in itself."""
    scene, mesh, fields, held = solved(angle_deg)
    order, at = nodes_of(mesh, fields.model), mesh.points_mm.T
    even = pressed(mesh, 166.0, scene.rod.small_end_bore_mm / 2, lambda x, y: np.ones_like(x))
    moved = calculix.of_free_body(tmp_path, mesh, scene, held, ["*DLOAD", *even])
    ours = fields.displacement_mm[ALONG.index("press fit")].reshape(-1, 3)[order]
    assert deformed(ours, at) == pytest.approx(deformed(moved, at), abs=3e-4 * np.abs(ours).max())


@needs_ccx
@pytest.mark.slow
def test_a_push_against_calculix(tmp_path):
    """By the cosine of the middles of faces.

    Pressure is even on each face there, so that the push differs by the square of the faces' size.
    """
    scene, mesh, fields, held = solved(0.0)
    rod, order, at = scene.rod, nodes_of(mesh, fields.model), mesh.points_mm.T
    lower = pressed(mesh, 166.0, rod.small_end_bore_mm / 2, lambda _, y: np.maximum(-y, 0.0))
    upper = pressed(mesh, 0.0, rod.big_end_bore_mm / 2, lambda _, y: np.maximum(y, 0.0))
    small = scaled(lower, 1000.0 / (np.pi / 4 * rod.small_end_bore_mm * rod.small_end_width_mm))
    big = scaled(upper, 1000.0 / (np.pi / 4 * rod.big_end_bore_mm * rod.big_end_width_mm))
    moved = calculix.of_free_body(tmp_path, mesh, scene, held, ["*DLOAD", *small, *big])
    ours = 1000 * fields.displacement_mm[[0, 2]].sum(axis=0).reshape(-1, 3)[order]
    free = np.arange(len(ours)) != held[-1][0]  # what the faces' pressures lack pulls at the support
    found, wanted = deformed(ours, at)[free], deformed(moved, at)[free]
    assert found == pytest.approx(wanted, abs=0.02 * np.abs(ours).max())


def scaled(lines, factor):
    """Lines of pressure times a factor."""
    parts = (line.rsplit(",", 1) for line in lines)
    return [f"{head}, {float(value) * factor:.10e}" for head, value in parts]


def nodes_of(mesh, model):
    """Numbers in the model of the nodes of a mesh."""
    order = np.empty(mesh.points_mm.shape[1], dtype=int)
    order[mesh.cells] = model.mesh.dofs.element_dofs
    return order


def deformed(moved, at_mm):
    """Displacements without what moves the rod in its plane as a whole, which supports decide."""
    x, y, _ = at_mm.T
    none, one = np.zeros_like(x), np.ones_like(x)
    rigid = np.stack([np.stack(way, axis=1) for way in ((one, none, none), (none, one, none), (-y, x, none))])
    parts = rigid.reshape(3, -1).T
    return moved - (parts @ np.linalg.lstsq(parts, moved.ravel(), rcond=None)[0]).reshape(moved.shape)
