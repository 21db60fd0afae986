"""Body force of rotation: resultant, mirrors, and its derivative by the density."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.domain.build import Extent, build_domain
from cranktopo.fem.model import build_model, case_forces
from cranktopo.fem.response import (
    compliance_gradients,
    compliance_gradients_by_solid,
    compliances,
    solve,
)
from cranktopo.optimise.material import (
    build_interpolation,
    physical_density,
    relative_moduli,
    solid_fraction,
)
from cranktopo.optimise.optimality_criteria import design_gradients
from cranktopo.scene import Scene
from tests.physics.throw_cases import CENTRIFUGAL


def test_resultant_is_unbalance_times_speed_squared(float64: None, mikron: Scene) -> None:
    """Closed form of the half throw without pin force: rho w^2 (web area moment + pin area x r)."""
    case = type(CENTRIFUGAL)("centrifugal", "centrifugal", speed_rpm=3000.0)
    domain = build_domain(mikron, 2.0, "web", "half")
    model = build_model(mikron, domain, (case,))
    force = np.asarray(case_forces(model, jnp.asarray(domain.fixed)))[0] * model.modulus_MPa
    ring = np.pi * (21.0**2 - 12.0**2)
    web = 19 * (50 * 48 + np.pi * 25**2 - 2 * np.pi * 12**2) * 24  # symmetric about y = 24
    moment = 7850e-12 * (web + 18 * ring * 48)
    speed = 3000 * 2 * np.pi / 60
    assert force[1].sum() == pytest.approx(moment * speed**2, rel=1e-3)
    assert abs(force[0].sum()) < 1e-6 * force[1].sum()


@pytest.mark.slow
def test_extents_agree(float64: None, mikron: Scene) -> None:
    def work(extent: Extent) -> float:
        domain = build_domain(mikron, 4.0, "web", extent)
        model = build_model(mikron, domain, (CENTRIFUGAL,))
        forces = case_forces(model, jnp.asarray(domain.fixed))
        u = solve(model, jnp.asarray(domain.fixed), forces=forces, tolerance=1e-10).displacements
        return float(compliances(model, u, forces)[0])

    assert work("quarter") == pytest.approx(work("half"), rel=1e-6)
    assert work("full") == pytest.approx(work("half"), rel=1e-6)


def test_derivative_by_density(float64: None, mikron: Scene) -> None:
    domain = build_domain(mikron, 4.5)
    model = build_model(mikron, domain, (CENTRIFUGAL,))
    chain = build_interpolation(domain, 9.0)
    x = jnp.asarray(np.random.default_rng(1).uniform(0.2, 0.8, chain.design.shape))
    direction = jnp.asarray(np.random.default_rng(2).standard_normal(x.shape)) * chain.design

    def parts(x: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
        density = physical_density(chain, x, 2.0)
        moduli, solid = relative_moduli(chain, density), solid_fraction(chain, density)
        forces = case_forces(model, solid)
        u = solve(model, moduli, forces=forces, tolerance=1e-11).displacements
        return u, forces, solid, compliances(model, u, forces)[0]

    u, _, solid, _ = parts(x)
    by_x, _ = design_gradients(
        chain,
        x,
        jnp.asarray(2.0),
        compliance_gradients(model, u)[0],
        compliance_gradients_by_solid(model, u, solid)[0],
    )
    step = 1e-3
    f = [float(parts(x + k * step * direction)[3]) for k in (-2, -1, 1, 2)]
    expected = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step)
    assert float(jnp.sum(by_x * direction)) == pytest.approx(expected, rel=1e-5)
