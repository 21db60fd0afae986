"""Forging constraint: monotone densities, exact derivatives, undercuts counted by rays."""

from __future__ import annotations

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.undercuts import undercuts
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import apply_physics_plan
from cranktopo.numerics.filters.processes import SHARPNESS, ForgingConstraint, without_undercuts
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.manufacturing import open_cells, parting_of
from cranktopo.tasks.density.material import MaterialInterpolation, physical_density, smooth_density
from cranktopo.throw.envelope import OutlineEnvelope
from tests.physics.density.throw_cases import forged
from tests.unit.extraction.surface_cases import scene_with


def chain_of(scene: Scene, **grid: Any) -> tuple[Domain, MaterialInterpolation]:
    domain = build_domain(scene, 4.5, **grid)
    return domain, build_chain(scene, domain)


@pytest.fixture(params=[pytest.param("quarter", marks=pytest.mark.slow), "half"])
def density_chain(request: pytest.FixtureRequest, float64: None, mikron: Scene) -> MaterialInterpolation:
    return chain_of(forged(mikron), extent=request.param)[1]


def plane_of(density_chain: MaterialInterpolation) -> int:
    assert isinstance(density_chain.process, ForgingConstraint)
    assert len(set(density_chain.process.parting)) == 1
    return density_chain.process.parting[0]


def noise(density_chain: MaterialInterpolation, seed: int = 0) -> jax.Array:
    return jnp.asarray(np.random.default_rng(seed).random(density_chain.design_fraction.shape))


@pytest.mark.parametrize("beta", [1.0, 16.0])
def test_density_never_grows_away_from_the_parting_plane(
    density_chain: MaterialInterpolation, beta: float
) -> None:
    density = np.asarray(physical_density(density_chain, noise(density_chain), beta))
    free = np.asarray(density_chain.design_fraction) > 0
    parting = plane_of(density_chain)
    right, left = slice(parting, None), slice(parting - 1, None, -1) if parting else None
    for side in (right, left):
        if side is None:
            continue
        # Where not designable (a bore) the density of the next inner cell counts.
        value, inner = density[side], np.inf
        for row, usable in zip(value, free[side], strict=True):
            assert np.all(np.where(usable, row, 0.0) <= inner + 1e-12)
            inner = np.where(usable, row, inner)
    assert density[free].max() > 0.02


def test_smooth_minimum_is_between_its_bounds(float64: None) -> None:
    rng = np.random.default_rng(4)
    density, free = rng.random((12, 5, 3)), rng.random((12, 5, 3)) > 0.2
    result = np.asarray(without_undercuts(jnp.asarray(density), jnp.asarray(free), (5, 5)))
    hard = np.where(free, density, 1.0)
    hard = np.concatenate([np.minimum.accumulate(hard[:5][::-1])[::-1], np.minimum.accumulate(hard[5:])])
    assert np.all(result <= hard + 1e-12)
    assert np.all(result >= np.maximum(hard - np.log(12) / SHARPNESS, 0) - 1e-12)
    for constant in (0.0, 1.0):
        uniform = without_undercuts(jnp.full((12, 5, 3), constant), jnp.ones((12, 5, 3), bool), (5, 5))
        np.testing.assert_allclose(uniform, constant, atol=1e-12)


def test_quarter_is_the_half(float64: None, mikron: Scene) -> None:
    quarter, half = (chain_of(forged(mikron), extent=extent)[1] for extent in ("quarter", "half"))
    assert (plane_of(quarter), plane_of(half)) == (
        0,
        11,
    )  # 48 mm in cells of 4.36 mm, one cell of padding
    x = noise(quarter, 2)
    mirrored = jnp.zeros(half.design_fraction.shape).at[:22].set(jnp.concatenate([x[:11][::-1], x[:11]]))
    both = smooth_density(half, mirrored)
    inside = np.asarray(quarter.design_fraction)[:11] > 0
    expected = np.asarray(smooth_density(quarter, x))[:11]
    np.testing.assert_allclose(np.asarray(both)[11:22][inside], expected[inside], rtol=1e-10)


def test_derivatives_on_both_sides(density_chain: MaterialInterpolation) -> None:
    """Any weighting of the density, in the quarter and in the half with its two sides."""
    x, direction = 0.2 + 0.6 * noise(density_chain, 1), noise(density_chain, 3) - 0.5
    weights = noise(density_chain, 5)

    def value(x: jax.Array) -> jax.Array:
        return jnp.sum(weights * physical_density(density_chain, x, 4.0))

    step = 1e-4
    f = [float(value(x + k * step * direction)) for k in (-2, -1, 1, 2)]
    expected = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step)
    assert float(jnp.sum(jax.grad(value)(x) * direction)) == pytest.approx(expected, rel=1e-8)


def test_bores_are_no_obstacle_but_a_waist_is(float64: None, mikron: Scene) -> None:
    domain = build_domain(mikron, 4.5, extent="half")
    through = open_cells(mikron, domain)
    middle, _ = parting_of(domain)
    row = int(np.searchsorted(domain.grid.y_mm, 0.0))
    assert not domain.design_fraction[middle, row].any()  # the bore of the main journal
    assert through[middle, row].all()
    whole, plain = chain_of(forged(mikron))[1], chain_of(mikron)[1]
    np.testing.assert_array_equal(whole.design_fraction, plain.design_fraction)
    # An outline like a U: its legs hang beside a gap that no die half can reach around.
    points = [(-40, -30), (40, -30), (40, 110), (30, 110), (30, 78), (-30, 78), (-30, 110), (-40, 110)]
    envelope = OutlineEnvelope(shape="outline", points_mm=tuple((float(a), float(b)) for a, b in points))
    horned = mikron.model_copy(update={"envelope": envelope})
    domain, density_chain = chain_of(forged(horned))
    legs = domain.grid.y_mm[:-1] > 80
    web = domain.design_fraction[:, :, slice(*domain.web_layers)]
    assert web[:, legs].sum() > 0
    assert float(density_chain.design_fraction[:, legs].sum()) == 0.0
    np.testing.assert_array_equal(
        np.asarray(density_chain.design_fraction)[:, domain.grid.y_mm[1:] < 78],
        web[:, domain.grid.y_mm[1:] < 78],
    )


@pytest.mark.parametrize(
    ("process", "choice", "state"),
    [
        ("free", "auto", "off"),
        ("forged", "auto", "on"),
        ("cast", "auto", "on"),
        ("forged", "off", "off"),
        ("free", "on", "on"),
    ],
)
def test_plan(mikron: Scene, process: str, choice: str, state: str) -> None:
    scene = mikron.model_copy(
        update={
            "optimise": mikron.optimise.model_copy(update={"process": process}),
            "effects": mikron.effects.model_copy(update={"manufacturing_constraint": choice}),
        }
    )
    effect = plan(scene)["manufacturing_constraint"]
    assert effect.state == state
    assert (process if choice == "auto" else choice) in effect.reason
    simulated = apply_physics_plan(scene, plan(scene)).effects.manufacturing_constraint
    assert (simulated == "on") == (state == "on")


def block(*voids: Manifold) -> SurfaceMesh:
    body = Manifold.cube((60, 90, 19)).translate((-30, -25, 20))
    for void in voids:
        body -= void
    return mesh_of(body)


def test_undercuts_have_their_volume() -> None:
    """A groove on one side only, beside the bores that may stay."""
    scene = scene_with()
    slot = Manifold.cube((6, 20, 30)).translate((14, 15, 25))  # x 14 .. 20, y 15 .. 35, z 25 .. 39
    found = undercuts(block(slot), scene, 0.5)
    assert found.volume_mm3 == pytest.approx(6 * 20 * 14, rel=0.01)
    assert found.deepest_mm == pytest.approx(6.0, abs=1e-6)
    assert found.caught == pytest.approx(20 * 14 / 0.25, rel=0.02)
    assert not found.negligible


@pytest.mark.parametrize(
    "void",
    [
        Manifold.cube((40, 20, 30)).translate((14, 15, 25)),  # open to the side: the die reaches in
        Manifold.cylinder(40, 12, 12, 64).translate((0, 0, 10)),  # a bore
        Manifold.cube((80, 20, 30)).translate((-40, 15, 25)),  # nothing left on either side
    ],
    ids=["pocket", "bore", "step"],
)
def test_no_undercut(void: Manifold) -> None:
    found = undercuts(block(void), scene_with(), 0.5)
    assert (found.caught, found.deepest_mm) == (0, 0.0)
    assert found.negligible
