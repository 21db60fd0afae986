"""Edges that a viewer sees, against boxes whose hidden parts are known."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.numerics.surfaces.visible_edges import visible_edges


def length(chains: list[np.ndarray]) -> float:
    return sum(float(np.linalg.norm(np.diff(chain, axis=0), axis=1).sum()) for chain in chains)


def test_a_box_in_front_hides_what_lies_behind_it() -> None:
    behind = Manifold.cube((10.0, 10.0, 1.0))
    front = Manifold.cube((4.0, 20.0, 1.0)).translate((3.0, -5.0, 5.0))
    assert length(visible_edges(mesh_of(behind), 0.02)) == pytest.approx(40.0, abs=0.1)
    both = visible_edges(mesh_of(behind + front), 0.02)
    assert length(both) == pytest.approx(40.0 - 2 * 4.0 + 48.0, abs=0.3)


def test_three_faces_of_a_turned_box_show_nine_edges() -> None:
    turned = Manifold.cube((10.0, 10.0, 10.0)).rotate((45.0, 0.0, 0.0)).rotate((0.0, 30.0, 0.0))
    chains = visible_edges(mesh_of(turned), 0.02)
    mesh = mesh_of(turned)
    sides = np.sort(
        np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]), axis=1
    )
    ends = mesh.vertices_mm[np.unique(sides, axis=0)]
    true = ends[np.isclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), 10.0)]
    assert len(true) == 12
    lowest = mesh.vertices_mm[mesh.vertices_mm[:, 2].argmin()]
    seen = [pair for pair in true if not np.isclose(pair, lowest).all(axis=1).any()]
    expected = sum(float(np.linalg.norm(b[:2] - a[:2])) for a, b in seen)
    assert length(chains) == pytest.approx(expected, rel=5e-3)


def test_facets_of_a_cylinder_are_no_edges_but_its_outline_is() -> None:
    lying = Manifold.cylinder(30.0, 5.0, 5.0, 90).rotate((0.0, 90.0, 0.0))
    chains = visible_edges(mesh_of(lying), 0.02)
    assert length(chains) == pytest.approx(2 * 30.0 + 2 * 10.0, rel=5e-3)
    assert len(chains) <= 6
