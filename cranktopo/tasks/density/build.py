"""The optimisation problem of a scene: its goal and limits in the optimiser's own model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import jax
import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.goal.constraint import Constraint, minimum_scale, scale_of
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.design.goal.scene_goal import goal_of
from cranktopo.design.schema import Optimise, Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.filters.density_filter import ConeFilter, boundary_correction
from cranktopo.tasks.density.assess import assess_original
from cranktopo.tasks.density.first_web import check_start
from cranktopo.tasks.density.manufacturing import designable, filter_radius_mm, process_block, projection_for
from cranktopo.tasks.density.material import Block, MaterialInterpolation, build_interpolation
from cranktopo.tasks.density.model import ThrowModel, build_model
from cranktopo.tasks.density.problem import (
    USUAL_SOLVING,
    DensityProblem,
    Objective,
    OptimisationProblem,
    ResponseConstraint,
    Schedule,
    SolverSettings,
)
from cranktopo.tasks.density.proposals import by_moving_asymptotes, by_optimality_criteria
from cranktopo.tasks.density.responses import (
    Response,
    quantities_of,
    relative_compliance,
    volume,
    weighted_compliance,
)

# Half the design space is where the projection turns neither way.
_START = 0.5


def build_problem(
    scene: Scene, domain: Domain, cases: Sequence[LoadCase], solving: SolverSettings = USUAL_SOLVING
) -> DensityProblem:
    """Return the optimisation problem of a scene on a domain; call inside `double_precision()`."""
    settings = scene.optimise
    model = build_model(scene, domain, cases, incompatible_modes=solving.incompatible_modes)
    density_chain = build_chain(scene, domain)
    weights = tuple(float(getattr(settings.weights, case.kind)) for case in cases)
    goal = goal_of(scene)
    original = None if goal is None else assess_original(model, scene, domain)
    optimisation = (
        _of_volume(density_chain, model, weights, settings)
        if goal is None or original is None
        else _of_goal(
            goal,
            quantities_of(scene, model),
            original.quantities,
        )
    )
    start = settings.volume_fraction if goal is None else _START
    schedule = _schedule(settings)
    check_start(density_chain, start, schedule)
    simple = goal is None and settings.combine == "sum" and settings.method != "moving_asymptotes"
    return DensityProblem(
        model=model,
        density_chain=density_chain,
        weights=weights,
        target=settings.volume_fraction if goal is None else None,
        max_iterations=settings.max_iterations,
        optimisation=optimisation,
        method=by_optimality_criteria if simple else by_moving_asymptotes,
        start=start,
        solving=solving,
        schedule=schedule,
        original=original,
    )


def _schedule(settings: Optimise) -> Schedule:
    return Schedule(
        settings.projection_first, settings.projection_last, settings.stage_iterations, settings.move
    )


def with_limits(problem: DensityProblem, *limits: ResponseConstraint) -> DensityProblem:
    """Return the problem with further limits, by the method that takes any."""
    optimisation = replace(problem.optimisation, limits=(*problem.optimisation.limits, *limits))
    return replace(problem, optimisation=optimisation, method=by_moving_asymptotes)


def _of_volume(
    density_chain: MaterialInterpolation, model: ThrowModel, weights: tuple[float, ...], settings: Optimise
) -> OptimisationProblem:
    limit = ResponseConstraint(volume(density_chain), Constraint("volume", "<=", settings.volume_fraction))
    if settings.combine == "sum":
        return OptimisationProblem((Objective(weighted_compliance(weights)),), (limit,))
    names = model.case_names
    cases = [
        relative_compliance(index, names[index], weight) for index, weight in enumerate(weights) if weight
    ]
    return OptimisationProblem(tuple(Objective(case) for case in cases), (limit,))


def _of_goal(goal: Goal, known: Mapping[str, Response], original: Mapping[str, float]) -> OptimisationProblem:
    first, least = _known(known, goal.quantity, "goal"), minimum_scale(goal.quantity, original)
    return OptimisationProblem(
        (Objective(first, goal.sense, scale_of(original[goal.quantity], 0.0, least)),),
        tuple(
            response_constraint(limit, _known(known, limit.quantity, "goal.limits"), original)
            for limit in goal.limits
            if "density" in quantity_named(limit.quantity).optimisers
        ),
    )


def _known(known: Mapping[str, Response], quantity: str, key: str) -> Response:
    if quantity in known:
        return known[quantity]
    if "density" not in quantity_named(quantity).optimisers:
        raise invalid(
            key,
            quantity,
            "the density optimisation leaves it to the evaluation of the extracted surface",
            "Name another goal, or use `cranktopo shape`.",
        )
    case = quantity_named(quantity).load_case
    raise invalid(key, quantity, f"its load case '{case}' is off", f"Set effects.{case} = 'auto'.")


def response_constraint(
    limit: Limit, response: Response, original: Mapping[str, float]
) -> ResponseConstraint:
    """Return a limit of a goal on a response, with the original web's quantities for percentages."""
    constraint = limit.constraint(original)
    assert constraint is not None
    return ResponseConstraint(response, constraint, limit.percent)


def build_chain(scene: Scene, domain: Domain) -> MaterialInterpolation:
    """Return the density-to-modulus chain of a scene on a domain; call inside `double_precision()`."""
    radius = filter_radius_mm(scene, domain)
    density_chain = build_interpolation(domain, radius, designable(scene, domain))
    return replace(
        density_chain,
        process=process_block(scene, domain),
        projection=projection_for(scene, radius),
        penalty=scene.optimise.penalty,
        boundary_correction=_boundary_correction(density_chain.density_filter, scene, domain),
    )


def _boundary_correction(density_filter: Block, scene: Scene, domain: Domain) -> jax.Array | None:
    """Return what keeps a member as thick as asked along a wall of the design space."""
    if scene.optimise.min_member_mm is None or not isinstance(density_filter, ConeFilter):
        return None
    (first, last), reach = domain.web_layers, density_filter.kernel.shape[2] // 2
    main, pin = (
        np.repeat(domain.passive_fraction[:, :, layer, None], reach, axis=2) for layer in (first - 1, last)
    )
    return boundary_correction(
        density_filter, np.concatenate([main, domain.passive_fraction[:, :, first:last], pin], axis=2)
    )
