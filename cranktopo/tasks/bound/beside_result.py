"""The bound beside a web that was found: how much of what is possible at all it has."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.progress import Json
from cranktopo.design.goal.limit import Goal
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.cost import bound_cell_mm
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.curve import stiffest, stiffness_percent
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, bound_model, prove
from cranktopo.tasks.bound.requirements import STIFFNESSES
from cranktopo.tasks.density.assessment import model_error_percent
from cranktopo.tasks.refit.dimensions import free_dimensions

Info = Callable[[str], None]
Cells = Callable[[], BoundModel]
_MASSES, _BEYOND = 9, 0.08
"""Points of a curve over the mass, and how far it goes beyond original and result."""


def bound_beside(scene: Scene, goal: Goal, cell_mm: float, info: Info) -> Json:
    """What no web of the envelope can beat, however it is made; call inside `double_precision()`.

    Returns:
        The entry `bound` of shape.json but for what was reached; `none` says why there is no bound.
    """
    if free_dimensions(scene):
        return {"none": "dimensions of the throw are free, and the bound is about webs between its journals"}
    try:
        model = _model(scene, goal, cell_mm, info)
        return _entry(model, goal, prove(model, goal))
    except CranktopoError as error:
        return {"none": error.message}


def model_beside(scene: Scene, goal: Goal | None, info: Info) -> BoundModel:
    """The cells that `bounds_beside` computes on; the web itself need not be known.

    Raises:
        CranktopoError: as `bound_model`.
    """
    with double_precision():
        return _model(scene, goal, bound_cell_mm(scene), info)


def bounds_beside(
    scene: Scene, reached: Mapping[str, float], goal: Goal | None, info: Info, cells: Cells | None = None
) -> Json:
    """The same beside a web whose goal may be no more than stiffness: statements, and curves over the mass.

    Args:
        reached: mass, stiffnesses and the goal's quantity as far as they are known, % of the original's.
        goal: what was wanted; without one it is the largest of each stiffness at the web's own mass.
        cells: gives those of `model_beside`, where they have been made before.

    Returns:
        The entry `bound` of metrics.json; `none` says why there is no bound.
    """
    try:
        model = cells() if cells else model_beside(scene, goal, info)
        with double_precision():
            return _bounds(model, reached, goal)
    except CranktopoError as error:
        return {"none": error.message}


def _bounds(model: BoundModel, reached: Mapping[str, float], goal: Goal | None) -> Json:
    statements, start = [], None
    if goal is not None and goal.quantity in reached:
        bound = prove(model, goal)
        statements.append({**_entry(model, goal, bound), "reached_percent": reached[goal.quantity]})
        start = bound.density
    mass = reached["mass"]
    masses = np.linspace((1 - _BEYOND) * min(mass, 100.0), (1 + _BEYOND) * max(mass, 100.0), _MASSES).tolist()
    curves: Json = {"mass_percent": masses}
    for name in (name for name in STIFFNESSES if name in reached):
        wanted = stiffest(name, mass)
        bound = prove(model, wanted, start=start)
        start, curves[f"{name}_percent"] = bound.density, stiffness_percent(model, bound, masses)
        if goal is None:
            entry = {"at_mass_percent": mass, "reached_percent": reached[name]}
            statements.append({**_entry(model, wanted, bound), **entry})
    return {"statements": statements, "stiffest": curves}


def _model(scene: Scene, goal: Goal | None, cell_mm: float, info: Info) -> BoundModel:
    info(f"bound: what no web of the envelope can beat, on cells of {cell_mm:.3g} mm")
    return bound_model(scene.with_optimise(process="free", draft_deg=0.0), cell_mm, goal)


def _entry(model: BoundModel, goal: Goal, bound: Bound) -> Json:
    grid, scene = model.domain.grid, model.scene
    return {
        "quantity": goal.quantity,
        "value": bound.value,
        "percent_of_original": bound.percent,
        "dropped": [str(limit) for limit, _ in bound.wanted.dropped],
        "model": {
            "cell_mm": scene.optimise.resolution_mm,
            "error_percent": model_error_percent(scene, grid.largest_edge_mm),
        },
    }
