"""Bodies cut from densities that begin with a bound's own cells of variable stiffness: how near they come.

The density optimisation starts from the densities that prove a bound, with a low power of the modulus, so
that it loses little of what they reach. Its filtered field is then cut at a level, as `optimise` cuts its
surface, and the cells of the body are filled by their share: a body is a web, a grey density is none.
`python -m tests.studies.density_bodies [THROW...]` prints the table; throws are those of `bound_proof`.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from cranktopo.base.notes import silent
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, prove
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.problem import USUAL_SOLVING
from cranktopo.tasks.density.stage import iterate, prepare
from tests.physics.bound.bound_cases import quantities_of
from tests.studies.bound_proof import GOALS, THROWS, Judged, cells_of, goal_value, keeps, throw_of

Array = NDArray[np.float64]
POWER, FILTER_CELLS = 1.25, 1.2
_ITERATIONS, _POINTS = 80, 4
"""Most iterations, and points along each edge of a cell by which its share is counted."""
_LEVELS, _STEPS = np.linspace(0.2, 0.8, 7), (0.05, 0.025, 0.0125, 0.00625)
"""Levels that are tried, and steps by which the best of them is moved."""


@dataclass(frozen=True)
class Nearest:
    """A bound and the body that comes nearest to it.

    Attributes:
        value: of the goal's quantity; None where no level keeps the limits.
        body: share of each cell that it fills (nx, ny, nw).
        bound_s, body_s: processor time of the bound, and of densities and cuts.
    """

    bound: Bound
    value: float | None
    body: Array | None
    bound_s: float
    body_s: float

    @property
    def gap_percent(self) -> float:
        """Difference of both, percent; infinite without a body."""
        return 100 * abs((self.value or np.inf) / (self.bound.value or 1.0) - 1)


def nearest_body(scene: Scene, model: BoundModel, name: str) -> Nearest:
    """The bound of a goal of `bound_proof` and the best body for it; call inside `double_precision()`."""
    asked, began = with_goal(scene, **GOALS[name]), time.process_time()
    goal = goal_of(asked)
    assert goal is not None
    bound, sign = prove(model, goal), 1.0 if goal.sense == "minimise" else -1.0
    proven = time.process_time()
    field, design = filtered_density(asked, model, np.array(bound.density)), model.webs.design

    def judged(level: float) -> tuple[float, float]:
        web = Judged("body", quantities_of(model, body(field, design, level)))
        return (sign * goal_value(model, bound, web) if keeps(model, bound, web) else np.inf), level

    best, level = _best_level(judged)
    found = np.isfinite(best)
    return Nearest(
        bound,
        sign * best if found else None,
        body(field, design, level) if found else None,
        proven - began,
        time.process_time() - proven,
    )


def _best_level(judged: Callable[[float], tuple[float, float]]) -> tuple[float, float]:
    best = min(judged(float(level)) for level in _LEVELS)
    for step in _STEPS:
        best = min(best, *(judged(best[1] + move) for move in (-step, step)))
    return best


def filtered_density(asked: Scene, model: BoundModel, start: Array) -> Array:
    """Filtered density (nx, ny, nw) that the optimisation makes of a start for the goal of a scene."""
    settings = {"penalty": POWER, "max_iterations": _ITERATIONS}
    lengths_mm = {
        "resolution_mm": model.scene.optimise.resolution_mm,
        "filter_radius_mm": FILTER_CELLS * model.domain.grid.largest_edge_mm,
    }
    prepared = prepare(asked.with_optimise(**settings, **lengths_mm))
    problem = build_problem(prepared.scene, prepared.domain, prepared.cases, USUAL_SOLVING)
    state = iterate(problem, replace(loop.init(problem), x=start, evaluated=start))
    return loop.final_design(problem, state).filtered


def body(field: Array, design: Array, level: float) -> Array:
    """Share of each cell in which a field, linear between the centres of the cells, is above a level."""
    nearest = ndimage.distance_transform_edt(design <= 0, return_distances=False, return_indices=True)
    padded = np.pad(field[tuple(nearest)], 1, mode="edge")
    offsets = (np.arange(_POINTS) + 0.5) / _POINTS - 0.5
    above = np.zeros(padded.shape)
    for offset in itertools.product(offsets, repeat=3):
        above += ndimage.shift(padded, [-x for x in offset], order=1, mode="nearest") > level
    return above[1:-1, 1:-1, 1:-1] / _POINTS**3 * (design > 0)


def print_rows(name: str) -> None:
    """A row of the table for each goal."""
    with double_precision(), silent():
        scene = throw_of(name)
        model = cells_of(scene)
        for goal in GOALS:
            found = nearest_body(scene, model, goal)
            bound = found.bound
            most, best, grey = (
                f"{100 * (value / bound.original - 1):+.1f} %" if value else "-"
                for value in (bound.value, found.value, bound.reached)
            )
            print(
                f"| {scene.name} | {goal} | {most} | {grey} | {best} | {found.gap_percent:.1f} % "
                f"| {found.bound_s:.0f} | {found.body_s:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    print("| throw | goal | bound | grey cells | body | gap | CPU s, bound | CPU s, body |")
    print("|---" * 8 + "|")
    for throw in sys.argv[1:] or THROWS:
        print_rows(throw)
