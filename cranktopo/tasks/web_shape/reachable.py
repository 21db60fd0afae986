"""Limits that no web of the envelope meets, refused before the first web is tried."""

from __future__ import annotations

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import main_load_cases
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.assess import assess_original, check_reach
from cranktopo.tasks.density.build import build_chain, response_constraint
from cranktopo.tasks.density.model import build_model
from cranktopo.tasks.density.problem import model_error_percent
from cranktopo.tasks.density.responses import quantities_of
from cranktopo.tasks.refit.family import free_dimensions


def check_reachable(scene: Scene, goal: Goal, cell_mm: float) -> None:
    """Refuse limits that even the best filling of the envelope misses, by more than cells may err.

    Nothing is known so of a throw whose dimensions are free, nor in percent of another body's quantities.

    Raises:
        CranktopoError: a limit that no web meets, as the density optimisation tells it.
    """
    open_limits = [limit for limit in goal.limits if not _met_by_original(limit)]
    if not open_limits or free_dimensions(scene) or scene.original is not None:
        return
    with double_precision():
        domain = build_domain(scene, cell_mm)
        model = build_model(scene, domain, main_load_cases(scene, plan(scene).enabled))
        known = quantities_of(scene, model)
        own = assess_original(model, scene, domain).quantities
        limits = [
            response_constraint(one, known[one.quantity], own) for one in open_limits if one.quantity in known
        ]
        error = max(model_error_percent(scene, cell_mm).values()) / 100
        check_reach(limits, model, build_chain(scene, domain), scene, domain, error)


def _met_by_original(limit: Limit) -> bool:
    return limit.percent and (limit.value <= 100 if limit.sense == ">=" else limit.value >= 100)
