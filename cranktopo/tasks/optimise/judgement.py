"""What a final density is worth in the optimiser's own model: beside the original, and beside the bound."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.runs.directories import RunStore
from cranktopo.tasks.bound.bound_for_result import Cells, bounds_for_result
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.density.assess import assess, assess_original
from cranktopo.tasks.density.assessment import Assessment
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State


class Judgement(NamedTuple):
    """The final design and the scene's own web, solved at a tight tolerance.

    Attributes:
        bound: what no web of the envelope can beat; None where the plan leaves it out.
        bound_s: wall time of the bound, without its cells.
    """

    result: Assessment
    original: Assessment
    bound: BoundStatements | NoBound | None
    bound_s: float


def judge(
    run: RunStore,
    prepared: Prepared,
    problem: DensityProblem,
    state: State,
    density: NDArray[np.float64],
    cells: Cells | None,
) -> Judgement:
    """Judge the physical density (nx, ny, nw) that a state ended with, in any thread.

    Args:
        cells: of the bound; None leaves it out.

    Raises:
        CranktopoError: a solve failed.
    """
    scene, domain = prepared.scene, prepared.domain
    with double_precision():
        result = assess(problem, scene, domain, density)
        original = problem.original or assess_original(problem.model, scene, domain)
    began, bound = time.perf_counter(), None
    if cells is not None:
        bound = _bound(run, scene, state, result, original, cells)
    return Judgement(result, original, bound, time.perf_counter() - began)


def _bound(
    run: RunStore, scene: Scene, state: State, result: Assessment, original: Assessment, cells: Cells
) -> BoundStatements | NoBound:
    """What no web of the envelope can beat, beside the result in percent of the original."""
    if state.status != "converged":
        return NoBound(none="the run has not converged")
    own = original.quantities
    reached = {name: 100 * value / own[name] for name, value in result.quantities.items() if own[name]}
    return bounds_for_result(scene, reached, wanted(scene), run.log, cells)


def beside_goal(
    bound: BoundStatements | NoBound, goal: Mapping[str, Any] | None
) -> BoundStatements | NoBound:
    """The bound beside what the goal's quantity reached, by the evaluation where the run has one.

    Args:
        goal: entry `goal` of the metrics, if there is one.
    """
    if goal is None or isinstance(bound, NoBound):
        return bound
    return bound.with_reached(goal["reached_percent"])
