"""Limits that no design can meet, found by one solve before the first iteration.

Stiffness grows with every bit of material: the envelope all solid is the stiffest design there is. Mass,
inertia and unbalance are sums over the cells: their extreme is solid where that helps, void elsewhere. Each
limit is looked at alone; limits that exclude each other show in the iterations.
"""

from __future__ import annotations

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.errors import CranktopoError, ExitCode, invalid
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.assess import assess_envelope
from cranktopo.tasks.density.material import MaterialInterpolation, solid_fraction
from cranktopo.tasks.density.optimisation_problem import ResponseConstraint
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.responses import Design

_ROUNDING = 1e-6


def check_limits(problem: DensityProblem, scene: Scene, domain: Domain) -> None:
    """Refuse limits that not even the best design for each of them alone meets.

    Call it inside `double_precision()`.

    Raises:
        CranktopoError: such limits, with what can be reached (exit code 6), or two that contradict each other
            now that the original's value is known.
    """
    _check_together(problem.optimisation.limits)
    found = [
        _of_cells(problem, limit) for limit in problem.optimisation.limits if not limit.response.needs_solve
    ]
    if any(_monotone(limit) for limit in problem.optimisation.limits):
        full = assess_envelope(problem, scene, domain).quantities
        found += [
            (limit, full[limit.response.name], "the whole envelope reaches")
            for limit in problem.optimisation.limits
            if _monotone(limit) and limit.response.name in full
        ]
    broken = [item for item in found if item[0].broken(item[1]) > _ROUNDING]
    if broken:
        raise CranktopoError(
            "; ".join(f"{limit}: {what} {limit.shown(value)}" for limit, value, what in broken) + ".",
            hint="No design meets it: ask for less, or give the web another envelope.",
            code=ExitCode.CRITERION_NOT_MET,
        )


def _check_together(limits: Sequence[ResponseConstraint]) -> None:
    """Refuse a range whose ends, in different units, have changed places."""
    upper = {limit.response.name: limit for limit in limits if limit.sense == "<="}
    for low in (limit for limit in limits if limit.sense == ">="):
        high = upper.get(low.response.name)
        if high is not None and low.bound > high.bound:
            percent = low if low.percent else high
            raise invalid(
                f"goal.limits.{low.response.name}",
                f"{low.sense} {low.shown(low.bound)}, {high.sense} {high.shown(high.bound)}",
                f"contradictory: the original web has {percent.in_unit(percent.original)}, so nothing is "
                f">= {low.in_unit(low.bound)} and <= {high.in_unit(high.bound)}",
                "Give both in the same unit, the lower one first.",
            )


def _monotone(limit: ResponseConstraint) -> bool:
    """Tell whether the limit is met best by the stiffest design."""
    return limit.response.stiffest == {"<=": "least", ">=": "most"}[limit.sense]


def _of_cells(problem: DensityProblem, limit: ResponseConstraint) -> tuple[ResponseConstraint, float, str]:
    """Return the best value of a sum over the cells, and what has it."""
    density_chain = problem.density_chain

    def reached(density: jax.Array, density_chain: MaterialInterpolation) -> jax.Array:
        solid = solid_fraction(density_chain, density)
        nothing = jnp.zeros(0)
        return limit.response.value(Design(solid, solid, nothing, nothing, nothing))

    value_and_gradient = jax.jit(jax.value_and_grad(reached))
    _, gradient = value_and_gradient(np.zeros(density_chain.design_fraction.shape), density_chain)
    density = np.where((np.asarray(gradient) > 0) == (limit.sense == ">="), 1.0, 0.0)
    share = float(density[np.asarray(density_chain.design_fraction) > 0].mean())
    what = {0.0: "the journals alone have", 1.0: "the whole envelope has"}.get(
        share, "the best share of the envelope has"
    )
    return limit, float(value_and_gradient(density, density_chain)[0]), what
