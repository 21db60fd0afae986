"""Values and whole derivatives of every response, on a lopsided design of the half throw."""

from __future__ import annotations

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.tasks.density.material import (
    MaterialInterpolation,
    build_interpolation,
    physical_density,
    relative_moduli,
    solid_fraction,
)
from cranktopo.tasks.density.model import ThrowModel, build_model, case_forces
from cranktopo.tasks.density.problem import Objective, ResponseConstraint
from cranktopo.tasks.density.proposals import vjp
from cranktopo.tasks.density.response import compliances, solve
from cranktopo.tasks.density.responses import (
    Design,
    Response,
    gradients,
    loads_of,
    quantities,
    relative_compliance,
    values_of,
    volume,
    weighted_compliance,
)
from tests.physics.density.throw_cases import BENDING, CENTRIFUGAL, TORSION

TIGHT = 1e-11
CELL_MM, FILTER_MM, BETA = 10.0, 20.0, 2.0
DENSITY = 7850.0
# Both components of the pin force in one case, which only the half throw can carry.
LEANING = LoadCase(name="leaning", kind="bending", radial_N=800.0, tangential_N=-600.0)
pytestmark = pytest.mark.usefixtures("float64")


@pytest.fixture(scope="module")
def setting(mikron: Scene) -> tuple[ThrowModel, MaterialInterpolation]:
    from cranktopo.numerics.precision import double_precision

    with double_precision():
        domain = build_domain(mikron, CELL_MM, extent="half")
        model = build_model(mikron, domain, (BENDING, TORSION, CENTRIFUGAL, LEANING))
        return model, build_interpolation(domain, FILTER_MM)


def lopsided(density_chain: MaterialInterpolation) -> jax.Array:
    return jnp.asarray(np.random.default_rng(1).uniform(0.2, 0.8, density_chain.design_fraction.shape))


def solved(model: ThrowModel, density_chain: MaterialInterpolation, x: jax.Array) -> Design:
    density = physical_density(density_chain, x, BETA)
    moduli, solid = relative_moduli(density_chain, density), solid_fraction(density_chain, density)
    forces = case_forces(model, solid)
    u = solve(model, moduli, forces=forces, tolerance=TIGHT).displacements
    return Design(moduli, solid, compliances(model, u, forces), jnp.asarray([2.0, 3.0, 0.1, 4.0]), u)


def responses(model: ThrowModel, density_chain: MaterialInterpolation) -> dict[str, Response]:
    more = (
        weighted_compliance((1.0, 2.0, 0.5, 0.0)),
        relative_compliance(3, "leaning", 2.0),
        volume(density_chain),
        Response("square", "mm2", lambda design: design.displacements[0, 1, 2, 9, 5] ** 2, True),
        Response("far corner", "mm", lambda design: design.displacements[1, 0, 2, 9, 5], True),
    )
    return quantities(model, DENSITY, rods_kg_mm=(20.0, 30.0)) | {
        response.name: response for response in more
    }


NAMES = (
    "mass",
    "inertia",
    "unbalance",
    "balance_factor",
    "torsion",
    "torsion_per_mass",
    "twist",
    "bending",
    "bending_per_mass",
    "pin_displacement",
    "leaning",
    "leaning_per_mass",
    "leaning_displacement",
    "weighted compliance",
    "leaning compliance",
    "volume fraction",
    "square",
    "far corner",
)


def test_every_quantity_of_the_model_is_checked(setting: tuple[ThrowModel, MaterialInterpolation]) -> None:
    assert sorted(responses(*setting)) == sorted(NAMES)


def test_derivatives_against_central_differences(setting: tuple[ThrowModel, MaterialInterpolation]) -> None:
    """Of every response, and of goals and limits that scale them, through filter, projection and penalty."""
    model, density_chain = setting
    known, x = responses(model, density_chain), lopsided(density_chain)
    functions = {name: response.value for name, response in known.items()} | {
        "maximise": Objective(known["torsion"], "maximise", 1e4).scaled,
        "at least": ResponseConstraint(known["bending"], Constraint("bending", ">=", 1e5)).scaled,
        "at most": ResponseConstraint(known["pin_displacement"], Constraint("motion", "<=", 0.01)).scaled,
        "about zero": ResponseConstraint(known["unbalance"], Constraint("unbalance", "<=", 0.0, 40.0)).scaled,
    }
    direction = jnp.asarray(np.random.default_rng(2).standard_normal(x.shape)) * (
        density_chain.design_fraction > 0
    )
    expected = differences(model, density_chain, tuple(functions.values()), x, direction)
    design = solved(model, density_chain, x)
    adjoints = {
        index: solve(
            model, design.moduli, forces=loads_of(functions[name], design), tolerance=TIGHT
        ).displacements
        for index, name in enumerate(functions)
        if name in known and known[name].reads_displacements
    }
    assert len(adjoints) == 2
    _, *fields = gradients(model, tuple(functions.values()), design, adjoints)
    by_x = vjp(density_chain, x, jnp.asarray(BETA), *fields)
    found = np.asarray(jnp.sum(by_x * direction, axis=(1, 2, 3)))
    for name, value, wanted in zip(functions, found, expected, strict=True):
        assert value == pytest.approx(wanted, rel=1e-5), name


def differences(
    model: ThrowModel,
    density_chain: MaterialInterpolation,
    functions: tuple[Callable[[Design], jax.Array], ...],
    x: jax.Array,
    direction: jax.Array,
    step: float = 1e-3,
) -> np.ndarray:
    """Fourth-order central differences of functions along a direction."""
    f = [
        np.asarray(values_of(functions, solved(model, density_chain, x + k * step * direction)))
        for k in (-2, -1, 1, 2)
    ]
    return np.asarray((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step))


@pytest.mark.slow
def test_jit_and_grad_work_around_a_response(setting: tuple[ThrowModel, MaterialInterpolation]) -> None:
    model, density_chain = setting
    design, known = solved(model, density_chain, lopsided(density_chain)), responses(model, density_chain)
    together = jax.jit(lambda design: {n: jax.value_and_grad(r.value)(design) for n, r in known.items()})
    for name, (value, by) in together(design).items():
        assert float(value) == pytest.approx(float(known[name].value(design)), rel=1e-12), name
        assert jax.tree.structure(by) == jax.tree.structure(design)


def test_inertia_of_the_original_web(mikron: Scene) -> None:
    """Closed form: obround of two half discs and a rectangle, less the bores, and two rings."""
    domain = build_domain(mikron, 2.0, "web")
    known = quantities(build_model(mikron, domain, (BENDING,)), DENSITY)
    solid = jnp.asarray(domain.passive_fraction)
    none = jnp.zeros(0)
    found = float(known["inertia"].value(Design(solid, solid, none, none, none)))
    r, w, throw = 25.0, 50.0, 48.0
    rectangle = w * throw * (w**2 / 12 + throw**2 / 3)
    # Half discs about their own centres, of which the inner one lies on the axis.
    near = np.pi * r**4 / 4
    far = np.pi * r**4 / 4 + np.pi * r**2 / 2 * throw**2 + 2 * throw * 2 / 3 * r**3
    hole = np.pi * 12.0**2
    bores = hole * 12.0**2 / 2 + hole * (12.0**2 / 2 + throw**2)
    ring = np.pi * (21.0**2 - 12.0**2)
    polar = ring * (21.0**2 + 12.0**2) / 2
    expected = (
        DENSITY * 1e-9 * (38 * (rectangle + near + far - bores) + 40 * polar + 36 * (polar + ring * throw**2))
    )
    assert found == pytest.approx(expected, rel=1e-3)
