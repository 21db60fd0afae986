"""The optimisation problem of a scene: its goal and limits in the optimiser's own model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cranktopo.base.errors import invalid
from cranktopo.bodies.cells.domain import Domain
from cranktopo.bodies.web_moments import bolted_mass
from cranktopo.design.goal.constraint import minimum_scale, scale_of
from cranktopo.design.goal.limit import Goal as WantedGoal
from cranktopo.design.goal.limit import Limit
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Optimise, Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.tasks.density.assess import assess_original
from cranktopo.tasks.density.chain import build_chain
from cranktopo.tasks.density.material import Interpolation
from cranktopo.tasks.density.model import ThrowModel, build_model
from cranktopo.tasks.density.problem import DensityProblem, Schedule, SolverSettings
from cranktopo.tasks.density.proposals import by_moving_asymptotes, by_optimality_criteria
from cranktopo.tasks.density.responses import (
    Response,
    quantities,
    relative_compliance,
    volume,
    weighted_compliance,
)
from cranktopo.tasks.density.statement import Goal, Requirement, Statement

LEFT_TO_EVALUATION = "fatigue_safety"
# Half the design space is where the projection turns neither way.
_START = 0.5


def build_problem(
    scene: Scene, domain: Domain, cases: Sequence[LoadCase], solving: SolverSettings | None = None
) -> DensityProblem:
    """The optimisation problem of a scene on a domain; call inside `double_precision()`.

    Raises:
        CranktopoError: a goal or limit without its load case.
    """
    solving = solving or SolverSettings()
    settings = scene.optimise
    model = build_model(scene, domain, cases, plain=solving.plain)
    chain = build_chain(scene, domain)
    weights = tuple(float(getattr(settings.weights, case.kind)) for case in cases)
    goal = wanted(scene)
    original = None if goal is None else assess_original(model, scene, domain)
    statement = (
        _of_volume(chain, model, weights, settings)
        if goal is None or original is None
        else _of_goal(
            goal, quantities(model, scene.material.density_kg_m3, bolted_mass(scene)), original.quantities
        )
    )
    simple = goal is None and settings.combine == "sum" and settings.method != "moving_asymptotes"
    return DensityProblem(
        model=model,
        chain=chain,
        weights=weights,
        target=settings.volume_fraction if goal is None else None,
        max_iterations=settings.max_iterations,
        statement=statement,
        method=by_optimality_criteria if simple else by_moving_asymptotes,
        start=settings.volume_fraction if goal is None else _START,
        solving=solving,
        schedule=Schedule(
            settings.projection_first, settings.projection_last, settings.stage_iterations, settings.move
        ),
        original=original,
    )


def with_limits(problem: DensityProblem, *limits: Requirement) -> DensityProblem:
    """The problem with further limits, by the method that takes any."""
    statement = replace(problem.statement, limits=(*problem.statement.limits, *limits))
    return replace(problem, statement=statement, method=by_moving_asymptotes)


def _of_volume(
    chain: Interpolation, model: ThrowModel, weights: tuple[float, ...], settings: Optimise
) -> Statement:
    limit = Requirement(volume(chain), "<=", settings.volume_fraction)
    if settings.combine == "sum":
        return Statement((Goal(weighted_compliance(weights)),), (limit,))
    names = model.case_names
    cases = [
        relative_compliance(index, names[index], weight) for index, weight in enumerate(weights) if weight
    ]
    return Statement(tuple(Goal(case) for case in cases), (limit,))


def _of_goal(goal: WantedGoal, known: Mapping[str, Response], original: Mapping[str, float]) -> Statement:
    first, least = _known(known, goal.quantity, "goal"), minimum_scale(goal.quantity, original)
    return Statement(
        (Goal(first, goal.sense, scale_of(original[goal.quantity], 0.0, least)),),
        tuple(
            _requirement(limit, _known(known, limit.quantity, "goal.limits"), original)
            for limit in goal.limits
            if limit.quantity != LEFT_TO_EVALUATION
        ),
    )


def _known(known: Mapping[str, Response], quantity: str, key: str) -> Response:
    if quantity in known:
        return known[quantity]
    if quantity == LEFT_TO_EVALUATION:
        raise invalid(
            key,
            quantity,
            "the density optimisation leaves it to the evaluation of the extracted surface",
            "Name another goal, or use `cranktopo shape`.",
        )
    case = quantity_named(quantity).load_case
    raise invalid(
        key,
        quantity,
        f"its load case '{case}' is off",
        f"Set effects.{case} = 'auto'.",
    )


def _requirement(limit: Limit, response: Response, original: Mapping[str, float]) -> Requirement:
    own = original[limit.quantity]
    bound = limit.value / 100 * own if limit.percent else limit.value
    least = minimum_scale(limit.quantity, original)
    return Requirement(response, limit.sense, bound, own, limit.percent, least)
