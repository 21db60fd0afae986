"""The bound of a design, what no web of its envelope can beat; alone, and beside a web that was found."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import note
from cranktopo.bodies.memory import available_memory_MiB, check_resolution
from cranktopo.design.assumed import ENVELOPE, GOAL, SUPPORTS, THROW, Assumption, assumed_text, assumptions
from cranktopo.design.free_dimensions import is_of_counterweight, move_journals
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.goal.outcome import stated_goal
from cranktopo.design.goal.quantities import QUANTITIES, QuantityName
from cranktopo.design.goal.scene_goal import require_goal
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.cost import bound_cell_mm
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.certificate import best_certificate
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, bound_model, densities_on_cells, prove
from cranktopo.tasks.bound.result import (
    BoundCells,
    BoundGoal,
    BoundResult,
    BoundStatement,
    BoundStatements,
    DroppedLimit,
    NoBound,
    ProvenBound,
    VariableStiffness,
)
from cranktopo.tasks.bound.webs import STIFFNESSES, limit_on_cells
from cranktopo.tasks.density.manufacturing import is_manufactured
from cranktopo.tasks.density.problem import model_error_percent
from cranktopo.tasks.refit.family import free_dimensions

Cells = Callable[[], BoundModel]
_CASES = 2
_FINE = 8
"""Cells through the web from which on densities of cells twice as large are the start."""
_TABLES = (THROW, SUPPORTS, ENVELOPE, GOAL)
_MASSES, _BEYOND = 9, 0.08
"""Points of a curve over the mass, and how far it goes beyond original and result."""


def bound_of(scene: DesignLike, resolution_mm: float | None = None) -> BoundResult:
    """Prove what no web of a scene's envelope can beat; cells are by default the scene's own.

    Raises:
        CranktopoError: no goal, one about which nothing can be proven, no envelope, or a failed solve.
    """
    scene = as_scene(scene, whole=False)
    goal, assumed = require_goal(scene, "bound", "torsion"), assumptions(scene, _TABLES)
    note(assumed_text(assumed))
    cell_mm = resolution_mm or scene.optimise.resolution_mm
    check_resolution(scene, cell_mm, _CASES, available_memory_MiB())
    with double_precision():
        model = bound_model(scene, cell_mm, goal)
        start = None
        if cell_mm <= scene.web.thickness_mm / _FINE:
            coarse = bound_model(scene, 2 * cell_mm, goal)
            start = densities_on_cells(coarse, prove(coarse, goal).density, model)
        nx, ny, nz = model.domain.grid.cells
        note(f"{scene.name}: {nx} x {ny} x {nz} cells, {int((model.webs.design > 0).sum())} to fill")
        return _result(model, prove(model, goal, start), assumed)


def _result(model: BoundModel, bound: Bound, assumed: tuple[Assumption, ...]) -> BoundResult:
    problem, scene, grid = bound.problem, model.scene, model.domain.grid
    dropped = tuple(DroppedLimit(limit=str(limit), reason=why) for limit, why in problem.dropped)
    return BoundResult(
        design=scene.name,
        goal=BoundGoal(**dict(stated_goal(problem.goal)), dropped=dropped),
        bound=ProvenBound(
            quantity=problem.goal.quantity,
            value=bound.value,
            unit=QUANTITIES[problem.goal.quantity].unit,
            percent_of_original=bound.percent,
            possible=bound.value is not None,
        ),
        variable_stiffness=VariableStiffness(
            value=bound.reached, percent_of_original=100 * bound.reached / bound.original, steps=bound.steps
        ),
        original=dict(model.original.quantities),
        original_outside_envelope_percent=model.outside.percent if model.outside else 0.0,
        original_outside_envelope_mm3=model.outside.volume_mm3 if model.outside else 0.0,
        weights={
            limit.quantity: price for limit, price in zip(problem.limits, bound.multipliers, strict=True)
        },
        process=scene.optimise.process if is_manufactured(scene) else "free",
        die=model.webs.die is not None,
        cells=grid.cells,
        design_cells=int((model.webs.design > 0).sum()),
        resolution_mm=scene.optimise.resolution_mm,
        model_error_percent=model_error_percent(scene, grid.largest_edge_mm),
        seconds=bound.seconds,
        assumed=assumed,
    )


def bound_for_goal(
    scene: Scene, goal: Goal, cell_mm: float, judged: Mapping[str, float]
) -> BoundStatement | NoBound:
    """Prove the entry `bound` of shape.json but for what was reached; call inside `double_precision()`.

    Args:
        judged: quantities of the original web in the model by which webs keep their limits.
    """
    free = free_dimensions(scene)
    if move_journals(free):  # a counterweight may have any form within the envelope as it is
        others = ", ".join(name for name in free if not is_of_counterweight(name))
        why = (
            "free, and the bound is about webs of one thickness between the same journals, bores and fillets"
        )
        return NoBound(none=f"{others}: {why}")
    try:
        model = _model(scene, goal, cell_mm)
        limits = tuple(limit_on_cells(limit, model.original.quantities, judged) for limit in goal.limits)
        original_limits = dict(zip(limits, goal.limits, strict=True))
        return _statement(model, prove(model, replace(goal, limits=limits)), original_limits)
    except CranktopoError as error:
        return NoBound(none=error.message)


def model_for_result(scene: Scene, goal: Goal | None) -> BoundModel:
    """Build the cells that `bounds_for_result` computes on; the web itself need not be known."""
    with double_precision():
        return _model(scene, goal, bound_cell_mm(scene))


def bounds_for_result(
    scene: Scene, reached: Mapping[str, float], goal: Goal | None, cells: Cells | None = None
) -> BoundStatements | NoBound:
    """Prove the same beside a web whose goal may be no more than stiffness: statements, curves over the mass.

    Args:
        reached: mass, stiffnesses and the goal's quantity as far as they are known, % of the original's.
        goal: what was wanted; without one it is the largest of each stiffness at the web's own mass.
        cells: gives those of `model_for_result`, where they have been made before.
    """
    try:
        model = cells() if cells else model_for_result(scene, goal)
        with double_precision():
            return _bounds(model, reached, goal)
    except CranktopoError as error:
        return NoBound(none=error.message)


def stiffest(quantity: QuantityName, mass_percent: float) -> Goal:
    """Return the largest stiffness of a web no heavier than a share of the original, %, as a goal."""
    return Goal("maximise", quantity, (Limit("mass", "<=", mass_percent, percent=True),))


def stiffness_percent(model: BoundModel, bound: Bound, masses_percent: Sequence[float]) -> list[float | None]:
    """Return what no web of each mass can beat in a bound's stiffness, % of the original's; None for no web.

    The bound is tightest at its own mass; its displacements prove all of the curve.
    """
    underestimator = model.underestimator(bound.displacements)
    goal = underestimator.weights_of(bound.problem.quantity)
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
        reached_values = {"reached_percent": reached[goal.quantity]}
        statements.append(_statement(model, bound).model_copy(update=reached_values))
        start = bound.density
    mass = reached["mass"]
    masses = np.linspace((1 - _BEYOND) * min(mass, 100.0), (1 + _BEYOND) * max(mass, 100.0), _MASSES).tolist()
    curves: dict[str, list[float | None]] = {"mass_percent": masses}
    for name in (name for name in STIFFNESSES if name in reached):
        bound = prove(model, stiffest(name, mass), start=start)
        start, curves[f"{name}_percent"] = bound.density, stiffness_percent(model, bound, masses)
        if goal is None:
            reached_values = {"at_mass_percent": mass, "reached_percent": reached[name]}
            statements.append(_statement(model, bound).model_copy(update=reached_values))
    return BoundStatements(
        statements=tuple(statements),
        stiffest={key: tuple(curve) for key, curve in curves.items()},
        outside_envelope=model.outside,
    )


def _model(scene: Scene, goal: Goal | None, cell_mm: float) -> BoundModel:
    note(f"bound: what no web of the envelope can beat, on cells of {cell_mm:.3g} mm")
    return bound_model(scene.with_optimise(process="free", draft_deg=0.0), cell_mm, goal)


def _statement(
    model: BoundModel, bound: Bound, original_limits: Mapping[Limit, Limit] | None = None
) -> BoundStatement:
    """Return a bound as it is told; limits left out by the words of `original_limits`, where it has them."""
    scene, problem = model.scene, bound.problem
    error = model_error_percent(scene, model.domain.grid.largest_edge_mm)
    return BoundStatement(
        quantity=problem.goal.quantity,
        value=bound.value,
        percent_of_original=bound.percent,
        dropped=tuple(str((original_limits or {}).get(limit, limit)) for limit, _ in problem.dropped),
        model=BoundCells(cell_mm=scene.optimise.resolution_mm, error_percent=error),
    )
