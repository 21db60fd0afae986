"""Gauss's rule, found once for all."""

import pytest

from cranktopo.base.quadrature import gauss_legendre


def test_five_points_are_exact_to_the_ninth_degree_and_found_once() -> None:
    nodes, weights = gauss_legendre(5)
    for degree in range(10):
        exact = 2 / (degree + 1) if degree % 2 == 0 else 0.0
        assert weights @ nodes**degree == pytest.approx(exact, abs=1e-14)
    assert gauss_legendre(5)[0] is nodes
    with pytest.raises(ValueError, match="read-only"):
        nodes[0] = 0.0
