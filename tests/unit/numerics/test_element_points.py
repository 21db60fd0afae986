"""What integrals over elements take is what scikit-fem's bases have."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import Basis, ElementTetP2, MeshTet

from cranktopo.numerics.tetrahedra.elasticity import LOAD_ORDER, STIFFNESS_ORDER, Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh, quadratic
from cranktopo.numerics.tetrahedra.node_gradients import chunks, nodal_values, shape_slopes


@pytest.fixture(scope="module")
def model() -> Elasticity:
    """A box of curved elements."""
    box = MeshTet.init_tensor(*(np.linspace(0, s, 4) for s in (2.0, 3.0, 1.5)))
    points, cells = quadratic(box.p.T, box.t.T.astype(np.int64))
    edges = (points[:, cells[1:4]] - points[:, cells[:1]]).transpose(2, 0, 1)
    inverted = np.linalg.det(edges) < 0
    cells[:, inverted] = cells[:, inverted][[0, 2, 1, 3, 6, 5, 4, 7, 9, 8]]
    points += 0.03 * np.random.default_rng(2).standard_normal(points.shape)
    return assemble(TetMesh(points, cells, False), 2.1e5, 0.3)


@pytest.mark.parametrize("order", [STIFFNESS_ORDER, LOAD_ORDER])
def test_points_of_elements_are_those_of_the_bases(model: Elasticity, order: int) -> None:
    elements = np.arange(0, model.mesh.nelements, 3)
    (found,) = chunks(model, order, elements)
    basis = Basis(model.mesh, ElementTetP2(), intorder=order, elements=elements)
    assert np.array_equal(found.element_dofs, basis.element_dofs)
    assert found.dx == pytest.approx(basis.dx, rel=1e-10)
    assert found.places_mm == pytest.approx(np.asarray(basis.global_coordinates()), abs=1e-12)
    assert found.slopes == pytest.approx(shape_slopes(basis), abs=1e-9)
    values = np.broadcast_to(found.values.T[:, None], nodal_values(basis).shape)
    assert values == pytest.approx(nodal_values(basis), abs=1e-14)
