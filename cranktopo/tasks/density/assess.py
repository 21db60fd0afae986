"""Stiffness and mass of a design, and of the original web, in the optimiser's own model."""

from __future__ import annotations

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import Domain, own_web
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.schema import Scene
from cranktopo.numerics.device_arrays import on_device
from cranktopo.tasks.density.material import MaterialInterpolation, relative_moduli, solid_fraction
from cranktopo.tasks.density.model import ThrowModel, case_forces
from cranktopo.tasks.density.problem import Assessment, CaseResult, DensityProblem, ResponseConstraint
from cranktopo.tasks.density.response import compliances, solve, stiffness
from cranktopo.tasks.density.responses import Design, quantities_of, values_of

TOLERANCE = 1e-8


def assess(problem: DensityProblem, scene: Scene, domain: Domain, density: Array) -> Assessment:
    """Return stiffness and mass of a design, solved to 1e-8; call inside `double_precision()`."""
    return _assess_density(problem.model, problem.density_chain, scene, domain, density)


def _assess_density(
    model: ThrowModel, chain: MaterialInterpolation, scene: Scene, domain: Domain, density: Array
) -> Assessment:
    first, last = domain.web_layers
    solid = domain.passive_fraction.copy()
    solid[:, :, first:last] += domain.design_fraction[:, :, first:last] * density
    return _assess(model, scene, domain, np.asarray(_moduli(chain, density)), solid)


def assess_original(
    model: ThrowModel, scene: Scene, domain: Domain, solid: Array | None = None
) -> Assessment:
    """Return the scene's own web on the same grid, in the same model.

    Args:
        solid: what `own_web` returns, where it is known.
    """
    solid = own_web(scene, domain) if solid is None else solid
    return _assess(model, scene, domain, solid, solid)


def _assess(model: ThrowModel, scene: Scene, domain: Domain, moduli: Array, solid: Array) -> Assessment:
    relative, filled = on_device(moduli), on_device(solid)
    forces = case_forces(model, filled)
    solution = solve(model, relative, forces=forces, tolerance=TOLERANCE)
    found = compliances(model, solution.displacements, forces)
    work, residuals = np.asarray(found).tolist(), np.asarray(solution.relative_residual).tolist()
    cases = tuple(
        CaseResult(
            name=case.name,
            kind=case.kind,
            compliance_N_mm=value,
            stiffness=None if case.has_body_force else stiffness(model, value, case.name),
            cg_iterations=int(solution.iterations),
            relative_residual=residual,
        )
        for case, value, residual in zip(model.cases, work, residuals, strict=True)
    )
    kg = solid * domain.volume_mm3 / domain.symmetry_fraction
    kg *= density_kg_per_mm3(scene.material.density_kg_m3)
    first, last = domain.web_layers
    design = Design(relative, filled, found, found, solution.displacements)
    known = quantities_of(scene, model)
    values = values_of(tuple(response.value for response in known.values()), design)
    bolted = bolted_mass(scene).volume
    web_kg = float(kg[:, :, first:last].sum()) / 2
    quantities_of_body = dict(zip(known, values.tolist(), strict=True))
    return Assessment(cases, float(kg.sum()) + 2 * bolted, web_kg + bolted, quantities_of_body)


_moduli = jax.jit(relative_moduli)


_ROUNDING = 1e-6


def check_limits(problem: DensityProblem, scene: Scene, domain: Domain) -> None:
    """Refuse limits that contradict each other or that not even the best design for each alone meets.

    Call it inside `double_precision()`.
    """
    limits = problem.optimisation.limits
    _check_ranges(limits)
    check_reach(limits, problem.model, problem.density_chain, scene, domain)


def check_reach(
    limits: Sequence[ResponseConstraint],
    model: ThrowModel,
    chain: MaterialInterpolation,
    scene: Scene,
    domain: Domain,
    allowed: float = _ROUNDING,
) -> None:
    """Refuse limits that not even the best design for each alone meets; call inside `double_precision()`.

    Stiffness grows with every bit of material: the envelope all solid is the stiffest design. Mass, inertia
    and unbalance are sums over the cells, whose extreme is solid where that helps. Limits that exclude each
    other show in the iterations.

    Args:
        allowed: share by which the best design may miss a limit.
    """
    found = [_of_cells(chain, limit) for limit in limits if not limit.response.needs_solve]
    if any(_monotone(limit) for limit in limits):
        everywhere = np.asarray(chain.design_fraction > 0, float)
        full = _assess_density(model, chain, scene, domain, everywhere).quantities
        found += [
            (limit, full[limit.response.name], "the whole envelope reaches")
            for limit in limits
            if _monotone(limit) and limit.response.name in full
        ]
    violated = [item for item in found if item[0].constraint.violation(item[1]) > allowed]
    if violated:
        raise CranktopoError(
            "; ".join(f"{limit}: {what} {limit.value_text(value)}" for limit, value, what in violated) + ".",
            hint="No design meets it: ask for less, or give the web another envelope.",
            code=ExitCode.CRITERION_NOT_MET,
        )


def _check_ranges(limits: Sequence[ResponseConstraint]) -> None:
    """Refuse a range whose ends, in different units, have changed places."""
    upper = {limit.response.name: limit for limit in limits if limit.constraint.sense == "<="}
    for low in (limit for limit in limits if limit.constraint.sense == ">="):
        high = upper.get(low.response.name)
        if high is None or low.constraint.bound <= high.constraint.bound:
            continue
        percent, bounds = low if low.percent else high, (low.constraint.bound, high.constraint.bound)
        raise invalid(
            f"goal.limits.{low.response.name}",
            f">= {low.value_text(bounds[0])}, <= {high.value_text(bounds[1])}",
            f"contradictory: the original web has {percent.in_unit(percent.constraint.original)}, so nothing "
            f"is >= {low.in_unit(bounds[0])} and <= {high.in_unit(bounds[1])}",
            "Give both in the same unit, the lower one first.",
        )


def _monotone(limit: ResponseConstraint) -> bool:
    """Tell whether the limit is met best by the stiffest design."""
    return limit.response.stiffest == {"<=": "least", ">=": "most"}[limit.constraint.sense]


def _of_cells(
    density_chain: MaterialInterpolation, limit: ResponseConstraint
) -> tuple[ResponseConstraint, float, str]:
    """Return the best value of a sum over the cells, and what has it."""

    def reached(density: jax.Array, density_chain: MaterialInterpolation) -> jax.Array:
        solid = solid_fraction(density_chain, density)
        nothing = jnp.zeros(0)
        return limit.response.value(Design(solid, solid, nothing, nothing, nothing))

    value_and_gradient = jax.jit(jax.value_and_grad(reached))
    _, gradient = value_and_gradient(np.zeros(density_chain.design_fraction.shape), density_chain)
    density = np.where((np.asarray(gradient) > 0) == (limit.constraint.sense == ">="), 1.0, 0.0)
    share = float(density[np.asarray(density_chain.design_fraction) > 0].mean())
    what = {0.0: "the journals alone have", 1.0: "the whole envelope has"}.get(
        share, "the best share of the envelope has"
    )
    return limit, float(value_and_gradient(density, density_chain)[0]), what
