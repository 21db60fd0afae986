"""The bound of a design: what no web of its envelope can beat."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cranktopo.bodies.cells.domain import laterally_symmetric
from cranktopo.bodies.memory import available_memory_MiB, check_resolution
from cranktopo.design.assumed import ENVELOPE, GOAL, SUPPORTS, THROW, assumed_json, assumed_text, assumptions
from cranktopo.design.goal.outcome import stated_goal
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.design.goal.wanted import require_goal
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, bound_model, densities_on_cells, prove
from cranktopo.tasks.bound.result import BoundGoal, BoundResult, DroppedLimit, ProvenBound, VariableStiffness
from cranktopo.tasks.density.assessment import model_error_percent
from cranktopo.tasks.density.manufacturing import is_manufactured

Info = Callable[[str], None]
_CASES = 2
_FINE = 8
"""Cells through the web from which on densities of cells twice as large are the start."""
_TABLES = (THROW, SUPPORTS, ENVELOPE, GOAL)


def bound_of(
    scene: Scene,
    resolution_mm: float | None = None,
    info: Info = lambda _: None,
    detail: Info = lambda _: None,
) -> BoundResult:
    """Prove what no web of a scene's envelope can beat, for its goal and limits.

    Args:
        resolution_mm: largest cell edge; the scene's own by default.
        info, detail: called with lines of progress.

    Raises:
        CranktopoError: no goal, one about which nothing can be proven, no envelope, or a failed solve.
    """
    goal = require_goal(scene, "bound", "torsion")
    assumed = assumptions(scene, _TABLES)
    info(assumed_text(assumed))
    cell_mm = resolution_mm or scene.optimise.resolution_mm
    check_resolution(scene, cell_mm, laterally_symmetric(scene, "envelope"), _CASES, available_memory_MiB())
    with double_precision():
        model = bound_model(scene, cell_mm, goal)
        start = None
        if cell_mm <= scene.web.thickness_mm / _FINE:
            coarse = bound_model(scene, 2 * cell_mm, goal)
            start = densities_on_cells(coarse, prove(coarse, goal).density, model)
        nx, ny, nz = model.domain.grid.cells
        info(f"{scene.name}: {nx} x {ny} x {nz} cells, {int((model.webs.design > 0).sum())} to fill")
        return _result(model, prove(model, goal, detail, start), assumed_json(assumed))


def _result(model: BoundModel, bound: Bound, assumed: list[dict[str, Any]]) -> BoundResult:
    """Return what `bound --json` prints of one bound."""
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
            value=bound.reached,
            percent_of_original=100 * bound.reached / bound.original,
            steps=bound.steps,
        ),
        original=dict(model.original.quantities),
        original_outside_envelope_percent=100 * model.outside,
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
        assumed=tuple(assumed),
    )
