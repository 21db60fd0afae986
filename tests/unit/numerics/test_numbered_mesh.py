"""Edges and faces by one number each are those of scikit-fem, in its order."""

from __future__ import annotations

import numpy as np
import pytest
from skfem import MeshTet, MeshTet2

from cranktopo.numerics.tetrahedra.numbered_mesh import numbered_mesh, row_keys


@pytest.fixture(scope="module")
def usual() -> MeshTet2:
    """A box whose nodes are numbered anyhow."""
    box = MeshTet.init_tensor(*(np.linspace(0, 1, 4) for _ in range(3)))
    order = np.random.default_rng(3).permutation(box.nvertices)
    return MeshTet2.from_mesh(MeshTet(box.p[:, np.argsort(order)], order[box.t]))


def test_meshes_have_the_entities_of_scikit_fem_in_its_order(usual: MeshTet2) -> None:
    found = numbered_mesh(usual.doflocs, usual.dofs.element_dofs)
    assert isinstance(found, MeshTet2)
    for name in ("edges", "t2e", "facets", "t2f", "f2e", "doflocs", "t"):
        own, other = getattr(found, name), getattr(usual, name)
        assert own.dtype == other.dtype
        assert np.array_equal(own, other), name
    assert np.array_equal(found.dofs.element_dofs, usual.dofs.element_dofs)


def test_entities_may_keep_the_order_of_their_nodes(usual: MeshTet2) -> None:
    found = numbered_mesh(usual.doflocs, usual.dofs.element_dofs)
    for sort in (True, False):
        own = found.build_entities(usual.t, usual.refdom.facets, sort)
        for one, other in zip(own, MeshTet.build_entities(usual.t, usual.refdom.facets, sort), strict=True):
            assert np.array_equal(one, other)
    assert found.build_entities(usual.t, None) == (None, None)


def test_columns_sort_by_their_keys_as_by_themselves() -> None:
    columns = np.random.default_rng(7).integers(0, 9, (3, 200))
    wanted, first = np.unique(columns, axis=1, return_index=True)
    _, own = np.unique(row_keys(columns), return_index=True)
    assert np.array_equal(own, first)
    assert np.array_equal(columns[:, own], wanted)
