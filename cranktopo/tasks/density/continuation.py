"""When the projection gets steeper, how far a step may move, and when the optimisation ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.tasks.density.problem import DensityProblem, Schedule
from cranktopo.tasks.density.state import MovedBounds, Record, State

# A stage has settled, and the last one converged, when the objective changes by less over the window.
STAGE_PLATEAU, FINAL_PLATEAU = 5e-3, 1e-3
_WINDOW = 3
# The volume may differ by the first, as a share of the design space; a limit may be broken by the second.
FEASIBILITY, LIMIT_FEASIBILITY = 1e-3, 2e-3
_GREYNESS_LIMIT = 0.15
# No design is found for all limits when over so many iterations the worst comes no nearer than by this
# share; another start may find one, so it is no proof that they exclude each other. Below the last, a matter
# of the steps alone.
STUCK_WINDOW, STUCK, STUCK_LEAST = 6, 0.8, 1e-2
# The steeper the projection, the smaller the move: a full step would flip boundary cells to and fro.
_MOVE_LEAST = 0.05


def advance(problem: DensityProblem, state: State, new_x: Array) -> State:
    """Return the next design, its projection, and whether the evaluated one ends the run."""
    schedule, last = problem.schedule, state.last
    in_stage = len(state.history) - state.stage_start
    plateau = _plateau(state, in_stage) if in_stage > _WINDOW else np.inf
    beta, stage_start = state.beta, state.stage_start
    if beta < schedule.projection_last and (plateau < STAGE_PLATEAU or in_stage >= schedule.stage_iterations):
        beta, stage_start = min(2 * beta, schedule.projection_last), len(state.history)
    following = replace(state, x=new_x, beta=beta, stage_start=stage_start)
    settled = last.beta >= schedule.projection_last and plateau < FINAL_PLATEAU
    if settled and _feasible(problem, last) and last.greyness <= _GREYNESS_LIMIT:
        reason = (
            f"objective changed by less than {100 * FINAL_PLATEAU:g} % over {_WINDOW} iterations, "
            f"{_kept(problem)}, greyness {last.greyness:.3f} at most {_GREYNESS_LIMIT:g}"
        )
        return replace(following, status="converged", reason=reason)
    if _stuck(problem, state, in_stage):
        reason = f"no design was found that meets every limit, the last one breaks {_broken(problem, last)}"
        return replace(following, status="infeasible", reason=reason)
    if len(state.history) >= problem.max_iterations:
        reason = f"iteration limit {problem.max_iterations} reached before the objective settled"
        broken = _broken(problem, last)
        reason += f"; limits not met: {broken}" if broken else ""
        return replace(following, status="stopped", reason=reason)
    return following


def _feasible(problem: DensityProblem, last: Record) -> bool:
    full = problem.target is None or abs(last.volume_fraction - problem.target) <= FEASIBILITY
    return full and last.broken <= LIMIT_FEASIBILITY


def _kept(problem: DensityProblem) -> str:
    if problem.target is not None:
        return f"volume fraction within {FEASIBILITY:g} of its target"
    return f"every limit within {100 * LIMIT_FEASIBILITY:g} %"


def _broken(problem: DensityProblem, last: Record) -> str:
    """Return which limits are broken, and what was reached."""
    pairs = zip(problem.optimisation.limits, last.limits, strict=False)
    texts = [
        f"{limit}: reached {limit.shown(value)}"
        for limit, value in pairs
        if limit.broken(value) > LIMIT_FEASIBILITY
    ]
    return ", ".join(texts)


def _stuck(problem: DensityProblem, state: State, in_stage: int) -> bool:
    """Tell whether broken limits have come no nearer during two windows at the final projection."""
    last = state.last
    if last.beta < problem.schedule.projection_last or last.broken <= STUCK_LEAST:
        return False
    recent = [row.broken for row in state.history[-in_stage:]]
    if len(recent) < 2 * STUCK_WINDOW:
        return False
    return min(recent[-STUCK_WINDOW:]) > STUCK * min(recent[:-STUCK_WINDOW])


def largest_move(schedule: Schedule, beta: float) -> float:
    """Return the largest change of a design variable by one step."""
    return max(min(_MOVE_LEAST, schedule.move), schedule.move / math.sqrt(beta))


def tolerance_at(problem: DensityProblem, beta: float) -> float:
    """Return the relative residual that a solve at this projection steepness must reach."""
    solving = problem.solving
    return solving.tolerance if beta >= problem.schedule.projection_last else solving.tolerance_early


def with_limit(problem: DensityProblem, state: State) -> State:
    """Set a stopped state running again when the problem's iteration limit allows more."""
    if state.status == "stopped" and len(state.history) < problem.max_iterations:
        return replace(state, status="running", reason="")
    return state


def with_bounds(state: State, bounds: Sequence[float]) -> State:
    """Set a converged state running again at the same projection, its limits at new bounds."""
    now = MovedBounds(state.last.iteration, tuple(bounds))
    return replace(
        state, status="running", reason="", stage_start=len(state.history), rounds=(*state.rounds, now)
    )


def iterations_left(problem: DensityProblem, state: State) -> int:
    """Return the upper estimate of the iterations still needed, for the progress display."""
    schedule = problem.schedule
    stages = 1 + math.ceil(math.log2(schedule.projection_last / state.beta))
    in_stage = len(state.history) - state.stage_start
    left = max(1, stages * schedule.stage_iterations - in_stage)
    return min(problem.max_iterations - len(state.history), left)


def _plateau(state: State, in_stage: int) -> float:
    """Return the relative spread of the objective over the last window of the current stage."""
    recent = [row.objective for row in state.history[-min(_WINDOW + 1, in_stage) :]]
    return (max(recent) - min(recent)) / abs(recent[-1])
