"""Bars and beams against closed forms."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.tasks.density.response import compliances, solve
from tests.physics.density.throw_cases import clamped_beam

MODULUS = 210e3


GRID = (8, 16, 64)
"""Every beam lies in the first cells of one grid, the others empty: one compilation serves them all."""


def end_deflection(
    beam: Cells, edges_mm: tuple[float, float], dz_mm: tuple[float, ...], poisson: float, component: int
) -> float:
    dz = dz_mm + dz_mm[-1:] * (GRID[2] - len(dz_mm))
    lattice = Lattice(GRID, *edges_mm, dz, poisson)
    solid = np.zeros(GRID)
    solid[: beam[0], : beam[1], : beam[2]] = 1.0
    model = clamped_beam(lattice, 3, component, MODULUS, beam)
    solution = solve(model, jnp.asarray(solid), tolerance=1e-10)
    assert not solution.notice
    return float(compliances(model, solution.displacements)[0])


@pytest.mark.parametrize("poisson", [pytest.param(0.0, marks=pytest.mark.slow), 0.3])
def test_axial_bar(float64: None, poisson: float) -> None:
    """P L / (E A); with nu = 0.3 the clamp holds the section and stiffens the last half width of the bar."""
    exact = 64.0 / (MODULUS * 1.0)
    found = end_deflection((2, 2, 64), (0.5, 0.5), (0.5,) * 32 + (1.5,) * 32, poisson, 2)
    assert found == pytest.approx(exact, rel=1e-9 if poisson == 0 else 1e-3)


def test_cantilever_against_timoshenko(float64: None) -> None:
    """8 cells through the depth; other direction of the load than of the wide side (asymmetric section)."""
    depth, width, length, poisson = 8.0, 4.0, 64.0, 0.3
    inertia, area = width * depth**3 / 12, width * depth
    shear = 10 * (1 + poisson) / (12 + 11 * poisson)  # Cowper 1966, rectangle
    modulus_g = MODULUS / (2 * (1 + poisson))
    exact = length**3 / (3 * MODULUS * inertia) + length / (shear * modulus_g * area)
    found = end_deflection((4, 8, 64), (1.0, 1.0), (1.0,) * 64, poisson, 1)
    assert found == pytest.approx(exact, rel=0.02)


def test_cantilever_converges_at_second_order(float64: None) -> None:
    """Error against the Richardson limit on 3 meshes; without Poisson's ratio the clamp is no singularity."""
    values = []
    for n in (1, 2, 4):
        beam = (2 * n, 4 * n, 16 * n)
        values.append(end_deflection(beam, (1 / n, 1 / n), (1 / n,) * (16 * n), 0.0, 1))
    limit = values[2] + (values[2] - values[1]) / 3
    errors = np.abs(np.array(values) / limit - 1)
    assert errors[2] < 1e-3
    assert errors[0] / errors[1] > 3.0
