"""Stiffness and mass of a design, and of the original web, in the optimiser's own model."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.assessment import Assessment, CaseResult
from cranktopo.tasks.density.material import relative_moduli
from cranktopo.tasks.density.model import ThrowModel, case_forces
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.response import compliances, solve, stiffness
from cranktopo.tasks.density.responses import Design, quantities, values_of

TOLERANCE = 1e-8


def assess(problem: DensityProblem, scene: Scene, domain: Domain, density: Array) -> Assessment:
    """Return stiffness and mass of a design at a tight solver tolerance; call inside `double_precision()`.

    Raises:
        CranktopoError: the solve failed.
    """
    first, last = domain.web_layers
    solid = domain.passive_fraction.copy()
    solid[:, :, first:last] += domain.design_fraction[:, :, first:last] * density
    moduli = np.asarray(_moduli(problem.density_chain, density))
    return _assess(problem.model, scene, domain, moduli, solid)


def assess_original(model: ThrowModel, scene: Scene, domain: Domain) -> Assessment:
    """Return the scene's own web on the same grid, in the same model."""
    original = build_domain(scene, scene.optimise.resolution_mm, "web", domain.extent, domain.grid)
    return _assess(model, scene, domain, original.passive_fraction, original.passive_fraction)


def assess_envelope(problem: DensityProblem, scene: Scene, domain: Domain) -> Assessment:
    """Return the design space all solid: no design is stiffer."""
    return assess(problem, scene, domain, np.asarray(problem.density_chain.design_fraction > 0, float))


def _assess(model: ThrowModel, scene: Scene, domain: Domain, moduli: Array, solid: Array) -> Assessment:
    forces = case_forces(model, jnp.asarray(solid))
    solution = solve(model, jnp.asarray(moduli), forces=forces, tolerance=TOLERANCE)
    found = compliances(model, solution.displacements, forces)
    work = [float(c) for c in found]
    cases = tuple(
        CaseResult(
            name=case.name,
            kind=case.kind,
            compliance_N_mm=value,
            stiffness=None if case.kind == "centrifugal" else stiffness(model, value, case.name),
            cg_iterations=int(solution.iterations),
            relative_residual=float(residual),
        )
        for case, value, residual in zip(model.cases, work, solution.relative_residual, strict=True)
    )
    kg = solid * domain.volume_mm3 / domain.symmetry_fraction
    kg *= density_kg_per_mm3(scene.material.density_kg_m3)
    first, last = domain.web_layers
    design = Design(jnp.asarray(moduli), jnp.asarray(solid), found, found, solution.displacements)
    known = quantities(model, scene.material.density_kg_m3, bolted_mass(scene))
    values = values_of(tuple(response.value for response in known.values()), design)
    bolted = bolted_mass(scene).volume
    web_kg = float(kg[:, :, first:last].sum()) / 2
    told = dict(zip(known, values.tolist(), strict=True))
    return Assessment(cases, float(kg.sum()) + 2 * bolted, web_kg + bolted, told)


_moduli = jax.jit(relative_moduli)
