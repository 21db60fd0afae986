"""The bound beside a web that was found: how much of what is possible at all it has."""

from __future__ import annotations

from cranktopo.bound.stage import bound_model, prove
from cranktopo.errors import CranktopoError
from cranktopo.optimise.error_bound import model_error_percent
from cranktopo.remodel.dimensions import free_dimensions
from cranktopo.scene import Scene
from cranktopo.scene.goal import Goal
from cranktopo.store import Json, Work


def bound_beside(scene: Scene, goal: Goal, cell_mm: float, work: Work) -> Json:
    """What no web of the envelope can beat, however it is made; call inside `double_precision()`.

    Returns:
        The entry `bound` of shape.json but for what was reached; `none` says why there is no bound.
    """
    if free_dimensions(scene):
        return {"none": "dimensions of the throw are free, and the bound is about webs between its journals"}
    work.info(f"bound: what no web of the envelope can beat, on cells of {cell_mm:.3g} mm")
    try:
        model = bound_model(scene.with_optimise(process="free", draft_deg=0.0), cell_mm, goal)
        bound = prove(model, goal)
    except CranktopoError as error:
        return {"none": error.message}
    return {
        "quantity": goal.quantity,
        "value": bound.value,
        "percent_of_original": bound.percent,
        "dropped": [str(limit) for limit, _ in bound.wanted.dropped],
        "model": {
            "cell_mm": cell_mm,
            "error_percent": model_error_percent(scene, model.domain.grid.largest_edge_mm),
        },
    }
