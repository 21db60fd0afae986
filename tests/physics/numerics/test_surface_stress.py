"""Stresses at the nodes of a surface: exact for a linear stress field, gradients and normals with it."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshTet, MeshTet2

from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.stress import (
    SurfaceStress,
    hooke,
    nodal_stress,
    outer_surface,
    principal_stresses,
    surface_stress,
    von_mises,
)
from cranktopo.tasks.fatigue.superposition import signed_von_mises_range

YOUNGS, POISSON = 2.1e5, 0.3


def cube() -> TetMesh:
    """A box of ten-node tetrahedra."""
    return upright(MeshTet2.from_mesh(MeshTet.init_tensor(*(np.linspace(0, s, 4) for s in (2.0, 3.0, 1.5)))))


def upright(mesh: MeshTet2) -> TetMesh:
    """A mesh of ten-node tetrahedra, none inverted."""
    cells = mesh.dofs.element_dofs.copy()
    edges = (mesh.doflocs[:, cells[1:4]] - mesh.doflocs[:, cells[:1]]).transpose(2, 0, 1)
    inverted = np.linalg.det(edges) < 0
    cells[:, inverted] = cells[:, inverted][[0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    return TetMesh(mesh.doflocs, cells, False)


def test_linear_stress_is_exact_on_the_surface() -> None:
    """A quadratic displacement is in the space of the elements; its stress and slope are exact."""
    rng = np.random.default_rng(1)
    model = assemble(cube(), YOUNGS, POISSON)
    shape = rng.standard_normal((3, 10)) * 1e-4
    x, y, z = model.nodes_mm
    terms = np.stack([np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, y * z, z * x])
    u = (shape @ terms).T.ravel()
    zero, one = np.zeros_like(x), np.ones_like(x)
    slopes = np.stack(
        [
            np.stack([zero, one, zero, zero, 2 * x, zero, zero, y, zero, z]),
            np.stack([zero, zero, one, zero, zero, 2 * y, zero, x, z, zero]),
            np.stack([zero, zero, zero, one, zero, zero, 2 * z, zero, y, x]),
        ]
    )
    gradient = np.einsum("it,jtn->nij", shape, slopes)
    strain = (gradient + gradient.transpose(0, 2, 1)) / 2
    exact = hooke(strain[:, (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)], YOUNGS, POISSON)
    found = nodal_stress(model, u[None], YOUNGS, POISSON)
    surface = outer_surface(model, found.elements, ((2, 0.0), (0, 2.0)))
    stress = surface_stress(model, surface, found)
    scale = np.abs(exact).max()
    assert stress.stress_MPa[0] == pytest.approx(exact[surface.nodes], abs=1e-9 * scale)
    assert stress.jump_MPa.max() < 1e-9 * scale
    assert (np.abs(surface.points_mm[2]) > 1e-9).sum() > 0
    inner = (surface.points_mm[1] > 0.1) & (surface.points_mm[1] < 2.9) & (surface.points_mm[0] < 1.9)
    top = (surface.points_mm[2] > 1.5 - 1e-9) & inner & (surface.points_mm[0] > 0.1)
    assert surface.normals[top] == pytest.approx(np.tile([0.0, 0, 1], (top.sum(), 1)), abs=1e-12)
    # slope of the stress along -z from exact stresses a step below
    below = exact_at(shape, model.nodes_mm[:, surface.nodes[top]] - np.array([[0.0], [0.0], [0.1]]))
    slope = (below - exact[surface.nodes[top]]) / 0.1
    assert stress.depth_MPa_per_mm[0][top] == pytest.approx(slope, abs=1e-8 * scale)


def test_jump_is_that_of_the_worst_element() -> None:
    """Random element stresses: array operations against a plain loop over the elements of one node."""
    rng = np.random.default_rng(3)
    model = assemble(cube(), YOUNGS, POISSON)
    found = nodal_stress(model, rng.standard_normal((2, model.nodes_mm.size)) * 1e-4, YOUNGS, POISSON)
    surface = outer_surface(model, found.elements, ((2, 0.0),))
    jump = surface_stress(model, surface, found).jump_MPa
    for position in (0, 17, len(surface.nodes) - 1):
        node = surface.nodes[position]
        for field in range(2):
            mean = von_mises(found.nodal_MPa[field, node])
            local, owners = np.nonzero(found.elements == node)
            apart = [
                abs(von_mises(found.element_MPa[field, e, k]) - mean)
                for k, e in zip(local, owners, strict=True)
            ]
            assert jump[field, position] == pytest.approx(max(apart))
            assert max(apart) > 0.01 * mean


def exact_at(shape: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Stress of the quadratic displacement at points (3, n), by central differences, exact for it."""
    step = 1e-3

    def displacement(p: np.ndarray) -> np.ndarray:
        x, y, z = p
        return shape @ np.stack([np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, y * z, z * x])

    gradient = np.stack(
        [
            (displacement(points + step * e[:, None]) - displacement(points - step * e[:, None])) / (2 * step)
            for e in np.eye(3)
        ],
        axis=1,
    ).transpose(2, 0, 1)
    strain = (gradient + gradient.transpose(0, 2, 1)) / 2
    return hooke(strain[:, (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)], YOUNGS, POISSON)


def signed_von_mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress with the sign of the principal stress that is largest in magnitude."""
    values = principal_stresses(stress)
    sign = np.where(values[..., 0] + values[..., 2] >= 0, 1.0, -1.0)
    return sign * von_mises(stress)


def test_signed_von_mises_by_hand() -> None:
    tension, pressure = [100.0, 0, 0, 0, 0, 0], [-100.0, 0, 0, 0, 0, 0]
    mixed, shear = [50.0, -120, 0, 0, 0, 0], [0.0, 0, 0, 40, 0, 0]
    stress = np.array([tension, pressure, mixed, shear])
    expected = [100.0, -100, -np.sqrt(50**2 + 120**2 + 50 * 120), np.sqrt(3) * 40]
    assert np.abs(signed_von_mises(stress)) == pytest.approx(np.abs(expected))
    assert (np.sign(signed_von_mises(stress[:3])) == [1, -1, -1]).all()
    assert principal_stresses(np.array(shear)) == pytest.approx([40, 0, -40])


def test_extremes_are_those_of_every_state_one_by_one() -> None:
    """Random plane stresses of a free surface, random states: matrix products against a plain loop."""
    rng = np.random.default_rng(7)
    unit = np.zeros((3, 50, 6))
    unit[..., [0, 1, 3]] = rng.standard_normal((3, 50, 3))
    depth = -1.5 * unit
    loads = rng.standard_normal((40, 3)) * [1, 3, 0.5]
    found = signed_von_mises_range(SurfaceStress(unit, depth, np.zeros((3, 50))), loads)
    signed = np.stack([signed_von_mises(np.einsum("f,fnc->nc", load, unit)) for load in loads])
    assert found.local.amplitude_MPa == pytest.approx(np.ptp(signed, axis=0) / 2)
    assert found.local.mean_MPa == pytest.approx((signed.max(axis=0) + signed.min(axis=0)) / 2)
    assert (found.highest == signed.argmax(axis=0)).all()
    assert found.local.gradient_per_mm == pytest.approx(np.full(50, 1.5))
    assert von_mises(np.zeros(6)) == 0.0
