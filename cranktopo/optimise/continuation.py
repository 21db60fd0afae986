"""When the projection gets steeper, how far a step may move, and when the optimisation ends."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.optimise.problem import DensityProblem, SolverSettings
from cranktopo.optimise.state import State

Array = NDArray[np.float64]

# Projection continuation: beta doubles when a stage's objective has settled or its iterations are spent.
BETA_FIRST, BETA_LAST = 1.0, 16.0
STAGE_ITERATIONS = 6
# A stage has settled, and the last one converged, when the objective changes by less over the window.
STAGE_PLATEAU, FINAL_PLATEAU = 5e-3, 1e-3
WINDOW = 3
FEASIBILITY = 1e-3
GREYNESS_LIMIT = 0.15
# The steeper the projection, the smaller the move: a full step would flip boundary cells to and fro.
MOVE_FIRST, MOVE_LEAST = 0.2, 0.05


def advance(problem: DensityProblem, state: State, new_x: Array) -> State:
    """The next design, its projection, and whether the evaluated one ends the run."""
    in_stage = len(state.history) - state.stage_start
    plateau = _plateau(state, in_stage) if in_stage > WINDOW else np.inf
    beta, stage_start = state.beta, state.stage_start
    if beta < BETA_LAST and (plateau < STAGE_PLATEAU or in_stage >= STAGE_ITERATIONS):
        beta, stage_start = 2 * beta, len(state.history)
    following = replace(state, x=new_x, beta=beta, stage_start=stage_start)
    last = state.last
    feasible = abs(last.volume_fraction - problem.target) <= FEASIBILITY
    if last.beta >= BETA_LAST and plateau < FINAL_PLATEAU and feasible and last.greyness <= GREYNESS_LIMIT:
        reason = (
            f"objective changed by less than {100 * FINAL_PLATEAU:g} % over {WINDOW} iterations, "
            f"volume fraction within {FEASIBILITY:g} of its target, "
            f"greyness {last.greyness:.3f} at most {GREYNESS_LIMIT:g}"
        )
        return replace(following, status="converged", reason=reason)
    if len(state.history) >= problem.max_iterations:
        reason = f"iteration limit {problem.max_iterations} reached before the objective settled"
        return replace(following, status="stopped", reason=reason)
    return following


def largest_move(beta: float) -> float:
    """Largest change of a design variable by one step."""
    return max(MOVE_LEAST, MOVE_FIRST / math.sqrt(beta))


def tolerance_at(solver: SolverSettings, beta: float) -> float:
    """Relative residual that a solve at this projection steepness must reach."""
    return solver.tolerance if beta >= BETA_LAST else solver.tolerance_early


def with_limit(problem: DensityProblem, state: State) -> State:
    """A stopped state set running again when the problem's iteration limit allows more."""
    if state.status == "stopped" and len(state.history) < problem.max_iterations:
        return replace(state, status="running", reason="")
    return state


def iterations_left(problem: DensityProblem, state: State) -> int:
    """Upper estimate of the iterations still needed, for the progress display."""
    stages = 1 + round(math.log2(BETA_LAST / state.beta))
    in_stage = len(state.history) - state.stage_start
    return min(problem.max_iterations - len(state.history), max(1, stages * STAGE_ITERATIONS - in_stage))


def _plateau(state: State, in_stage: int) -> float:
    """Relative spread of the objective over the last window of the current stage."""
    recent = [row.objective for row in state.history[-min(WINDOW + 1, in_stage) :]]
    return (max(recent) - min(recent)) / abs(recent[-1])
