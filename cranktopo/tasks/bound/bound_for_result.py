"""The bound beside a web that was found: how much of what is possible at all it has."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.quantities import QuantityName
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.cost import bound_cell_mm
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.certificate import best_certificate
from cranktopo.tasks.bound.convex_problem import STIFFNESSES
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, bound_model, prove
from cranktopo.tasks.bound.result import BoundCells, BoundStatement, BoundStatements, NoBound
from cranktopo.tasks.density.assessment import model_error_percent
from cranktopo.tasks.refit.family import free_dimensions

Info = Callable[[str], None]
Cells = Callable[[], BoundModel]
_MASSES, _BEYOND = 9, 0.08
"""Points of a curve over the mass, and how far it goes beyond original and result."""


def bound_for_goal(scene: Scene, goal: Goal, cell_mm: float, info: Info) -> BoundStatement | NoBound:
    """Prove what no web of the envelope can beat, however it is made; call inside `double_precision()`.

    Returns:
        The entry `bound` of shape.json but for what was reached.
    """
    if free_dimensions(scene):
        why = "dimensions of the throw are free, and the bound is about webs between its journals"
        return NoBound(none=why)
    try:
        model = _model(scene, goal, cell_mm, info)
        return _statement(model, prove(model, goal))
    except CranktopoError as error:
        return NoBound(none=error.message)


def model_for_result(scene: Scene, goal: Goal | None, info: Info) -> BoundModel:
    """Build the cells that `bounds_for_result` computes on; the web itself need not be known.

    Raises:
        CranktopoError: as `bound_model`.
    """
    with double_precision():
        return _model(scene, goal, bound_cell_mm(scene), info)


def bounds_for_result(
    scene: Scene, reached: Mapping[str, float], goal: Goal | None, info: Info, cells: Cells | None = None
) -> BoundStatements | NoBound:
    """Prove the same beside a web whose goal may be no more than stiffness: statements, curves over the mass.

    Args:
        reached: mass, stiffnesses and the goal's quantity as far as they are known, % of the original's.
        goal: what was wanted; without one it is the largest of each stiffness at the web's own mass.
        cells: gives those of `model_for_result`, where they have been made before.

    Returns:
        The entry `bound` of metrics.json.
    """
    try:
        model = cells() if cells else model_for_result(scene, goal, info)
        with double_precision():
            return _bounds(model, reached, goal)
    except CranktopoError as error:
        return NoBound(none=error.message)


def stiffest(quantity: QuantityName, mass_percent: float) -> Goal:
    """Return the largest stiffness of a web no heavier than a share of the original, %, as a goal."""
    return Goal("maximise", quantity, (Limit("mass", "<=", mass_percent, percent=True),))


def stiffness_percent(model: BoundModel, bound: Bound, masses_percent: Sequence[float]) -> list[float | None]:
    """Return what no web of each mass can beat in a bound's stiffness, % of the original's.

    Args:
        bound: of that stiffness, tightest at its own mass; its displacements prove all of the curve.

    Returns:
        None where no web is that light.
    """
    underestimator = model.underestimator(bound.displacements)
    goal = np.array([float(name == bound.problem.quantity) for name in underestimator.names])
    found = []
    for percent in masses_percent:
        no_heavier = Constraint("mass", "<=", percent / 100)
        value = best_certificate(underestimator, goal, [no_heavier], np.ones(1)).value
        found.append(100 / value if 0 < value < np.inf else None)
    return found


def _bounds(model: BoundModel, reached: Mapping[str, float], goal: Goal | None) -> BoundStatements:
    statements, start = list[BoundStatement](), None
    if goal is not None and goal.quantity in reached:
        bound = prove(model, goal)
        told = {"reached_percent": reached[goal.quantity]}
        statements.append(_statement(model, bound).model_copy(update=told))
        start = bound.density
    mass = reached["mass"]
    masses = np.linspace((1 - _BEYOND) * min(mass, 100.0), (1 + _BEYOND) * max(mass, 100.0), _MASSES).tolist()
    curves: dict[str, list[float | None]] = {"mass_percent": masses}
    for name in (name for name in STIFFNESSES if name in reached):
        bound = prove(model, stiffest(name, mass), start=start)
        start, curves[f"{name}_percent"] = bound.density, stiffness_percent(model, bound, masses)
        if goal is None:
            told = {"at_mass_percent": mass, "reached_percent": reached[name]}
            statements.append(_statement(model, bound).model_copy(update=told))
    return BoundStatements(
        statements=tuple(statements), stiffest={key: tuple(curve) for key, curve in curves.items()}
    )


def _model(scene: Scene, goal: Goal | None, cell_mm: float, info: Info) -> BoundModel:
    info(f"bound: what no web of the envelope can beat, on cells of {cell_mm:.3g} mm")
    return bound_model(scene.with_optimise(process="free", draft_deg=0.0), cell_mm, goal)


def _statement(model: BoundModel, bound: Bound) -> BoundStatement:
    """Return a bound as it stands beside a result."""
    scene, problem = model.scene, bound.problem
    error = model_error_percent(scene, model.domain.grid.largest_edge_mm)
    return BoundStatement(
        quantity=problem.goal.quantity,
        value=bound.value,
        percent_of_original=bound.percent,
        dropped=tuple(str(limit) for limit, _ in problem.dropped),
        model=BoundCells(cell_mm=scene.optimise.resolution_mm, error_percent=error),
    )
