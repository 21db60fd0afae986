"""The hexahedron: rigid motions, constant strain, and the parity blocks against the full matrix."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics.grid.lattice import (
    CORNERS,
    Lattice,
    elasticity,
    hexahedron_stiffness,
    layer_blocks,
    layer_stiffness,
    parity_blocks,
    parity_sum_of,
)
from cranktopo.numerics.grid.operator import apply_stiffness, stiffness_diagonal, strain_energy_density

SIZES = [(1.0, 1.0, 1.0), (1.5, 1.2, 0.4), (1.0, 4.0, 1.0)]
GRADIENT = np.array([[1e-3, 2e-3, -5e-4], [4e-4, -3e-3, 1e-3], [7e-4, 2e-4, 1.5e-3]])


def constant_stress(poisson: float) -> np.ndarray:
    strain = (GRADIENT + GRADIENT.T) / 2
    voigt = np.array([*np.diag(strain), 2 * strain[1, 2], 2 * strain[0, 2], 2 * strain[0, 1]])
    xx, yy, zz, yz, zx, xy = elasticity(poisson) @ voigt
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.49])
def test_single_element_patch(size: tuple[float, float, float], poisson: float) -> None:
    """A linear displacement gives the nodal forces of the constant stress on the six faces, exactly."""
    stiffness = hexahedron_stiffness(size, poisson)
    points = CORNERS * np.array(size)
    forces = (stiffness @ (points @ GRADIENT.T).ravel()).reshape(8, 3)
    stress = constant_stress(poisson)
    faces = np.array([size[1] * size[2], size[0] * size[2], size[0] * size[1]])
    expected = ((2 * CORNERS - 1) * faces / 4) @ stress
    np.testing.assert_allclose(forces, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("size", SIZES)
def test_six_rigid_motions_and_no_other_mechanism(size: tuple[float, float, float]) -> None:
    values = np.linalg.eigvalsh(hexahedron_stiffness(size, 0.3))
    assert np.abs(values[:6]).max() < 1e-12 * values[-1]
    assert values[6] > 1e-3 * values[-1]


def test_pure_bending_has_no_parasitic_shear() -> None:
    """Incompatible modes: bending energy of a square cell is E kappa^2 I / 2 per length (nu = 0)."""
    curvature, size = 1e-3, (2.0, 1.0, 3.0)
    x, z = (CORNERS[:, 0] - 0.5) * size[0], (CORNERS[:, 2] - 0.5) * size[2]
    u = np.zeros((8, 3))
    u[:, 2] = curvature * x * z
    energy = u.ravel() @ hexahedron_stiffness(size, 0.0) @ u.ravel() / 2
    second_moment = size[1] * size[0] ** 3 / 12
    # Corner values of x z integrate to (size / 2)^2 instead of the mean square: 3 times the beam's moment,
    # of which the bubble modes leave exactly the beam's.
    assert energy == pytest.approx(curvature**2 * second_moment * size[2] / 2 * 1.0, rel=1e-12)


@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_the_plain_hexahedron_has_parasitic_shear(poisson: float) -> None:
    """Trilinear bending u_z = k x z: strain k x along z and shear k z, integrated by hand."""
    curvature, size = 1e-3, (2.0, 1.0, 3.0)
    x, z = (CORNERS[:, 0] - 0.5) * size[0], (CORNERS[:, 2] - 0.5) * size[2]
    u = np.zeros((8, 3))
    u[:, 2] = curvature * x * z
    energy = u.ravel() @ hexahedron_stiffness(size, poisson, incompatible_modes=False) @ u.ravel() / 2
    confined = (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
    shear = 0.5 / (1 + poisson)
    volume = size[0] * size[1] * size[2]
    expected = curvature**2 * volume / 24 * (confined * size[0] ** 2 + shear * size[2] ** 2)
    assert energy == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("incompatible_modes", [True, False])
def test_the_lattice_passes_the_kind_of_hexahedron_on(incompatible_modes: bool) -> None:
    lattice = Lattice((1, 1, 2), 1.0, 1.2, (0.7, 0.9), 0.3, incompatible_modes)
    expected = hexahedron_stiffness((1.0, 1.2, 0.9), 0.3, incompatible_modes=incompatible_modes)
    np.testing.assert_array_equal(layer_stiffness(lattice, 1), expected)


def test_reflection_blocks_rebuild_the_matrix() -> None:
    stiffness = hexahedron_stiffness((1.0, 1.2, 0.8), 0.3)
    blocks = parity_blocks(stiffness)
    signs = np.prod(np.where(CORNERS[None] == 1, 2 * CORNERS[:, None] - 1, 1), axis=2)
    waves = np.zeros((8, 3, 8, 3))
    for parity in range(8):
        for c in range(3):
            for d in range(3):
                waves[parity_sum_of(parity, c), c, parity_sum_of(parity, d), d] = blocks[parity, c, d]
    rebuilt = np.einsum("aw,wcvd,bv->acbd", signs, waves, signs).reshape(24, 24)
    np.testing.assert_allclose(rebuilt, stiffness, atol=1e-14)


def test_operator_equals_assembly_on_uneven_layers(float64: None) -> None:
    lattice = Lattice((4, 3, 5), 1.0, 1.2, (1.0, 1.0, 0.7, 0.7, 1.1), 0.3)
    rng = np.random.default_rng(0)
    moduli, u = rng.random(lattice.cells), rng.standard_normal((2, *lattice.field_shape))
    expected = np.zeros_like(u)
    for i, j, k in np.ndindex(lattice.cells):
        where = [(slice(None), i + a, j + b, k + c) for a, b, c in CORNERS]
        local = np.stack([u[(slice(None), *w)] for w in where], axis=1).reshape(2, 24)
        forces = (local @ layer_stiffness(lattice, k) * moduli[i, j, k]).reshape(2, 8, 3)
        for corner, w in enumerate(where):
            expected[(slice(None), *w)] += forces[:, corner]
    blocks = jnp.asarray(layer_blocks(lattice))
    product = jax.jit(apply_stiffness)
    result = product(blocks, jnp.asarray(moduli), jnp.asarray(u))
    np.testing.assert_allclose(result, expected, atol=1e-13)
    density = jax.jit(strain_energy_density)(blocks, jnp.asarray(u), jnp.asarray(u))
    assert float(jnp.sum(density * moduli)) == pytest.approx(float(np.sum(u * expected)), rel=1e-12)
    unit = np.zeros_like(u)
    unit[0, 1, 2, 1, 3] = 1.0
    column = product(blocks, jnp.asarray(moduli), jnp.asarray(unit))
    diagonal = jax.jit(stiffness_diagonal)(blocks, jnp.asarray(moduli))
    assert float(column[0, 1, 2, 1, 3]) == pytest.approx(float(diagonal[1, 2, 1, 3]), rel=1e-13)
