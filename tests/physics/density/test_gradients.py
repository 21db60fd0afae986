"""Implicit derivatives of every response against central differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import Projection
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.material import (
    MaterialInterpolation,
    build_interpolation,
    dilated_density,
    eroded_density,
    physical_density,
    relative_moduli,
    solid_fraction,
    volume_fraction,
)
from cranktopo.tasks.density.model import ThrowModel, build_model, case_forces
from cranktopo.tasks.density.proposals import design_gradients, vjp
from cranktopo.tasks.density.response import (
    case_load,
    compliance_gradients,
    compliance_gradients_by_solid,
    compliances,
    displacements,
    solve,
    throw_mass_kg,
    throw_unbalance_kg_mm,
)
from tests.physics.density.throw_cases import BENDING, CENTRIFUGAL, TANGENTIAL, TORSION, forged

TIGHT = 1e-11
# One coarse grid and three load cases throughout: everything here runs the same compiled programs.
CELL_MM, FILTER_MM = 10.0, 20.0
Response = Callable[[ThrowModel, jax.Array], jax.Array]


def motion(model: ThrowModel, u: jax.Array, case: str) -> jax.Array:
    """Twist of the mid-journal sections, rad, or displacement of the crankpin along its force, mm."""
    index = model.case_names.index(case)
    return compliances(model, u)[index] / case_load(model.cases[index])


RESPONSES: dict[str, Response] = {
    "bending compliance": lambda model, u: compliances(model, u)[0],
    "torsion compliance": lambda model, u: compliances(model, u)[1],
    "twist": lambda model, u: motion(model, u, "torsion"),
    "pin displacement": lambda model, u: motion(model, u, "bending"),
    "tangential displacement": lambda model, u: motion(model, u, "tangential"),
    # Not self-adjoint: one displacement component far from the loads.
    "corner displacement": lambda model, u: u[0, 1, 3, 8, 5] * 1e3 + u[1, 0, 2, 9, 5] * 1e3,
}


@pytest.fixture
def setting(float64: None, mikron: Scene) -> tuple[ThrowModel, MaterialInterpolation, jax.Array]:
    domain = build_domain(mikron, CELL_MM)
    model = build_model(mikron, domain, (BENDING, TORSION, TANGENTIAL))
    density_chain = build_interpolation(domain, FILTER_MM)
    return model, density_chain, some_design(density_chain)


def some_design(density_chain: MaterialInterpolation) -> jax.Array:
    return jnp.asarray(np.random.default_rng(1).uniform(0.2, 0.8, density_chain.design_fraction.shape))


def some_direction(density_chain: MaterialInterpolation) -> jax.Array:
    return (
        jnp.asarray(np.random.default_rng(2).standard_normal(density_chain.design_fraction.shape))
        * density_chain.design_fraction
    )


def slope(value: Callable[[jax.Array], Any], x: jax.Array, direction: jax.Array, step: float = 1e-3) -> Any:
    """Fourth-order central difference, so that the check is limited by the solver and not by the step."""
    f = [np.asarray(value(x + k * step * direction)) for k in (-2, -1, 1, 2)]
    return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step)


@pytest.mark.slow
def test_responses_by_density(setting: tuple[ThrowModel, MaterialInterpolation, jax.Array]) -> None:
    """All of the same displacements, each with an adjoint solve of its own."""
    model, density_chain, x = setting

    def values(x: jax.Array) -> jax.Array:
        moduli = relative_moduli(density_chain, physical_density(density_chain, x, 2.0))
        u = displacements(model, moduli, TIGHT)
        return jnp.stack([response(model, u) for response in RESPONSES.values()])

    direction = some_direction(density_chain)
    _, pulled = jax.vjp(values, x)
    expected = slope(values, x, direction)
    for name, row, wanted in zip(RESPONSES, jnp.eye(len(RESPONSES)), expected, strict=True):
        (gradient,) = pulled(row)
        assert float(jnp.sum(gradient * direction)) == pytest.approx(wanted, rel=1e-5), name


@pytest.mark.slow
def test_largest_single_cell_derivative(setting: tuple[ThrowModel, MaterialInterpolation, jax.Array]) -> None:
    model, density_chain, x = setting

    def moduli(x: jax.Array) -> jax.Array:
        return relative_moduli(density_chain, physical_density(density_chain, x, 2.0))

    def work(x: jax.Array) -> float:
        return float(compliances(model, solve(model, moduli(x), tolerance=TIGHT).displacements)[1])

    u = solve(model, moduli(x), tolerance=TIGHT).displacements
    by_moduli = compliance_gradients(model, u)[1]
    by_x, _ = design_gradients(density_chain, x, jnp.asarray(2.0), by_moduli)
    cell = np.unravel_index(int(jnp.argmax(jnp.abs(by_x))), x.shape)
    expected = slope(work, x, jnp.zeros_like(x).at[cell].set(1.0), step=1e-2)
    assert float(by_x[cell]) == pytest.approx(expected, rel=1e-5)


@pytest.mark.slow
def test_compliance_of_a_forged_web(float64: None, mikron: Scene) -> None:
    """Through filter, die, projection and penalty: `pytest -m slow` of this file, 12 s."""
    scene = forged(mikron, filter_radius_mm=FILTER_MM)
    domain = build_domain(scene, CELL_MM)
    model, density_chain = (
        build_model(scene, domain, (BENDING, TORSION, TANGENTIAL)),
        build_chain(scene, domain),
    )
    assert density_chain.process is not None
    x, direction = 0.3 + 0.5 * some_design(density_chain), some_direction(density_chain)

    def moduli(x: jax.Array) -> jax.Array:
        return relative_moduli(density_chain, physical_density(density_chain, x, 2.0))

    def work(x: jax.Array) -> float:
        return float(compliances(model, solve(model, moduli(x), tolerance=TIGHT).displacements)[1])

    u = solve(model, moduli(x), tolerance=TIGHT).displacements
    by_x, _ = design_gradients(density_chain, x, jnp.asarray(2.0), compliance_gradients(model, u)[1])
    assert float(jnp.sum(by_x * direction)) == pytest.approx(slope(work, x, direction), rel=1e-5)


@pytest.mark.slow
def test_compliance_under_the_body_force(float64: None, mikron: Scene) -> None:
    """The density changes stiffness and centrifugal load alike."""
    domain = build_domain(mikron, CELL_MM)
    model = build_model(mikron, domain, (CENTRIFUGAL, TORSION, BENDING))
    density_chain = build_interpolation(domain, FILTER_MM)
    x, direction = some_design(density_chain), some_direction(density_chain)

    def parts(x: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        density = physical_density(density_chain, x, 2.0)
        moduli, solid = relative_moduli(density_chain, density), solid_fraction(density_chain, density)
        forces = case_forces(model, solid)
        u = solve(model, moduli, forces=forces, tolerance=TIGHT).displacements
        return u, solid, compliances(model, u, forces)[0]

    u, solid, _ = parts(x)
    by_moduli, by_solid = compliance_gradients(model, u)[0], compliance_gradients_by_solid(model, u, solid)[0]
    by_x, _ = design_gradients(density_chain, x, jnp.asarray(2.0), by_moduli, by_solid)
    expected = slope(lambda x: parts(x)[2], x, direction)
    assert float(jnp.sum(by_x * direction)) == pytest.approx(expected, rel=1e-5)
    without_mass, _ = design_gradients(density_chain, x, jnp.asarray(2.0), by_moduli)
    assert float(jnp.sum(without_mass * direction)) != pytest.approx(expected, rel=1e-2)


@pytest.mark.slow
def test_volume_derivative(setting: tuple[ThrowModel, MaterialInterpolation, jax.Array]) -> None:
    _, density_chain, x = setting
    _, by_x = design_gradients(
        density_chain, x, jnp.asarray(4.0), jnp.zeros(density_chain.passive_fraction.shape)
    )
    cell, step = (3, 9, 1), 1e-5

    def volume(x: jax.Array) -> float:
        return float(volume_fraction(density_chain, physical_density(density_chain, x, 4.0)))

    expected = (volume(x.at[cell].add(step)) - volume(x.at[cell].add(-step))) / (2 * step)
    assert float(by_x[cell]) == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_mass_and_unbalance(setting: tuple[ThrowModel, MaterialInterpolation, jax.Array]) -> None:
    model, density_chain, x = setting
    direction = jnp.asarray(np.random.default_rng(4).standard_normal(x.shape))
    for response in (throw_mass_kg, throw_unbalance_kg_mm):

        def value(x: jax.Array, response: Any = response) -> jax.Array:
            return response(
                model, solid_fraction(density_chain, physical_density(density_chain, x, 2.0)), 7850.0
            )

        step = 1e-5
        expected = float(value(x + step * direction) - value(x - step * direction)) / (2 * step)
        found = float(jnp.sum(jax.grad(value)(x) * direction))
        assert found == pytest.approx(expected, rel=1e-6)


def test_mass_and_unbalance_of_the_original_web(float64: None, mikron: Scene) -> None:
    """Closed form: web symmetric about half the throw, main journal on the axis, pin at the throw radius."""
    domain = build_domain(mikron, 2.0, "web")
    model = build_model(mikron, domain, (BENDING,))
    ring, radius = np.pi * (21.0**2 - 12.0**2), 48.0
    web = 2 * 19 * (50 * radius + np.pi * (25.0**2 - 2 * 12.0**2))
    solid = jnp.asarray(domain.passive_fraction)
    mass = 7850e-9 * (web + 76 * ring)
    unbalance = 7850e-9 * (web * radius / 2 + 36 * ring * radius)
    assert float(throw_mass_kg(model, solid, 7850.0)) == pytest.approx(mass, rel=1e-3)
    assert float(throw_unbalance_kg_mm(model, solid, 7850.0)) == pytest.approx(unbalance, rel=1e-3)


@pytest.mark.slow
def test_three_fields(float64: None, mikron: Scene) -> None:
    """Stiffness of the eroded design under the body force of the dilated one, and its volume."""
    domain = build_domain(mikron, CELL_MM)
    model = build_model(mikron, domain, (CENTRIFUGAL, TORSION, BENDING))
    density_chain = replace(build_interpolation(domain, FILTER_MM), projection=Projection(0.5, 0.7, 0.35))
    x, direction, beta = some_design(density_chain), some_direction(density_chain), jnp.asarray(2.0)

    def parts(x: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
        moduli = relative_moduli(density_chain, eroded_density(density_chain, x, 2.0))
        solid = solid_fraction(density_chain, dilated_density(density_chain, x, 2.0))
        forces = case_forces(model, solid)
        u = solve(model, moduli, forces=forces, tolerance=TIGHT).displacements
        return u, solid, compliances(model, u, forces)[0]

    u, solid, _ = parts(x)
    by_moduli, by_solid = compliance_gradients(model, u)[0], compliance_gradients_by_solid(model, u, solid)[0]
    by_x, volume_by_x = design_gradients(density_chain, x, beta, by_moduli, by_solid)
    by_asymptotes = vjp(density_chain, x, beta, by_moduli[None], by_solid[None])[0]
    expected = slope(lambda x: parts(x)[2], x, direction)
    for found in (by_x, by_asymptotes):
        assert float(jnp.sum(found * direction)) == pytest.approx(expected, rel=1e-5)
    expected = slope(
        lambda x: volume_fraction(density_chain, dilated_density(density_chain, x, 2.0)), x, direction
    )
    assert float(jnp.sum(volume_by_x * direction)) == pytest.approx(expected, rel=1e-6)
