"""Stresses by fitted polynomials: exact for a linear stress, nearer to Lame's thick cylinder than means."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import extract_mesh
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.fitted_stress import fitted_stress
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.stress import (
    boundary_faces,
    nodal_stress,
    outer_surface,
    surface_stress,
)
from tests.physics.numerics.test_surface_stress import POISSON, YOUNGS, cube

_ELASTIC = YOUNGS, POISSON
_SHEAR = YOUNGS / (2 * (1 + POISSON))
_INNER = 1.0
_UNIFORM = _FALLING = 100.0
"""Radial stress uniform - falling / r^2, hoop stress uniform + falling / r^2, MPa: a free bore (Lame)."""


def test_linear_stress_is_exact() -> None:
    """A quadratic displacement has a linear stress, which the polynomials hold, and whose means are exact."""
    model = assemble(cube(), *_ELASTIC)
    x, y, z = model.nodes_mm
    u = 1e-4 * np.stack([x * x + y * z - y, z * x - 2 * y * y, x * y + z * z + 3 * x]).T.reshape(1, -1)
    found = nodal_stress(model, u, *_ELASTIC)
    surface = outer_surface(model, found.elements, ())
    means = surface_stress(model, surface, found)
    chosen = surface.points_mm[2] > 1.5 - 1e-9
    inside = (surface.points_mm[:2] > 0.1).all(axis=0) & (surface.points_mm[0] < 1.9)
    inside &= surface.points_mm[1] < 2.9
    stress, depth = fitted_stress(model, surface, chosen, u, _ELASTIC)
    scale = np.abs(means.stress_MPa).max()
    assert stress == pytest.approx(means.stress_MPa[:, chosen], abs=1e-7 * scale)
    flat = inside[chosen]  # at edges the normal is between those of two faces, for both
    assert depth[:, flat] == pytest.approx(means.depth_MPa_per_mm[:, chosen & inside], abs=1e-6 * scale)


def ring() -> TetMesh:
    """A quarter of a thick cylinder, radii 1 and 2 mm, of the irregular elements of fatigue."""
    with cad_session("ring") as gmsh:
        bodies = [[(3, gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 1, r, -1, np.pi / 2))] for r in (2, _INNER)]
        gmsh.model.occ.cut(*bodies)
        gmsh.model.occ.synchronize()
        for option, number in (("MeshSizeMax", 0.17), ("Algorithm3D", 10)):
            gmsh.option.setNumber(f"Mesh.{option}", number)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        return extract_mesh(gmsh, mirrored=False)


def displacement(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the displacement of Lame's cylinder at points (3, n), plane strain, (1, unknowns)."""
    radius = np.hypot(points[0], points[1])
    out = ((1 - 2 * POISSON) * _UNIFORM * radius + _FALLING / radius) / (2 * _SHEAR)
    return np.stack([out * points[0] / radius, out * points[1] / radius, 0 * radius]).T.reshape(1, -1)


def solved(model: Elasticity) -> NDArray[np.float64]:
    """Return the displacement of elements whose surface moves as Lame's cylinder does, the bore free."""
    exact, faces = displacement(model.nodes_mm)[0], boundary_faces(model.mesh.dofs.element_dofs)
    numbers = model.mesh.dofs.element_dofs[faces]
    away = np.abs(np.hypot(*model.nodes_mm[:2, numbers]) - _INNER).max(axis=0) > 1e-9
    held = (3 * np.unique(numbers[:, away])[:, None] + np.arange(3)).ravel()
    known = np.zeros_like(exact)
    known[held] = exact[held]
    rest = model.equations.solver(held)(-(model.stiffness @ known)[:, None])[:, 0]
    return np.asarray(known + rest)[None]


def hoop(stress: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the hoop component of stresses (n, 6) at points (3, n)."""
    x, y = points[:2] / np.hypot(points[0], points[1])
    return np.asarray(stress[:, 0] * y * y + stress[:, 1] * x * x - 2 * stress[:, 3] * x * y)


def test_nearer_to_a_thick_cylinder_than_means() -> None:
    """Hoop stress at the free bore and its fall into the wall, on irregular elements."""
    model = assemble(ring(), *_ELASTIC)
    u = solved(model)
    found = nodal_stress(model, u, *_ELASTIC)
    surface = outer_surface(model, found.elements, ())
    means = surface_stress(model, surface, found)
    points = surface.points_mm
    bore = np.abs(np.hypot(points[0], points[1]) - _INNER) < 1e-9
    bore &= (np.abs(points[2] - 0.5) < 0.3) & (points[:2] > 0.3).all(axis=0)
    assert bore.sum() > 50
    fitted = fitted_stress(model, surface, bore, u, _ELASTIC)
    others = means.stress_MPa[:, bore], means.depth_MPa_per_mm[:, bore]
    for one, other, truth in zip(
        fitted, others, (_UNIFORM + _FALLING / _INNER**2, -2 * _FALLING / _INNER**3), strict=True
    ):
        error, usual = (np.sqrt(((hoop(v[0], points[:, bore]) - truth) ** 2).mean()) for v in (one, other))
        assert error < 0.6 * usual
        assert error < 0.05 * abs(truth)
