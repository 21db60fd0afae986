"""A goal whose limits hold by the body-fitted evaluation of the extracted surface, not only in the cells.

The converged design is extracted and evaluated, each limit in the cells is moved by the error that shows, and
the optimisation goes on from there, until every limit that decides the design is met.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.progress import Work
from cranktopo.design.goal.outcome import GoalOutcome, MovedBounds, goal_outcome
from cranktopo.design.goal.wanted import judged_by_evaluation, wanted
from cranktopo.design.schema import Scene
from cranktopo.report.goal_table import broken_limits, percent_line
from cranktopo.tasks.density.continuation import with_bounds
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State
from cranktopo.tasks.optimise.evaluated_limits import EvaluatedGoal, iteration_name

ROUNDS = 3
"""Most times that the limits are moved."""
_MOVED = "limits in the cells as the evaluation moved them"
Step = Callable[[State], State]


def evaluated_goal(
    scene: Scene, prepared: Prepared, problem: DensityProblem, work: Work
) -> EvaluatedGoal | None:
    """The goal of a scene whose limits are to hold by the evaluation; None where none are."""
    goal = wanted(scene)
    if goal is None or not judged_by_evaluation(scene):
        return None
    return EvaluatedGoal(goal, scene, prepared, problem, work)


def met_by_evaluation(
    case: EvaluatedGoal, state: State, save: Callable[[State], None], go_on: Step
) -> tuple[State, str]:
    """Have the limits met by the evaluation, if rounds and iterations suffice.

    Args:
        state: where the optimisation in the cells has ended.
        save: keeps a state, so that the run can be resumed.
        go_on: takes a running state to the end of the optimisation in the cells.

    Returns:
        The state at the end, and why its design could not be evaluated: that ends the rounds. Empty where it
        was, or was not to be since the optimisation has not converged.
    """
    while state.status == "converged":
        try:
            limits = case.limits(state)
        except CranktopoError as error:
            if error.code == ExitCode.INTERRUPTED:
                raise
            case.work.info(f"iteration {state.last.iteration} could not be evaluated: {error.message}")
            return replace(state, reason=f"{state.reason}; its limits are not judged"), error.message
        told = goal_outcome(case.goal, case.reached(state), case.original())
        done = len(state.rounds) == ROUNDS or all(limit.met for limit in limits)
        more = "" if done else "; the limits in the cells are moved by their error"
        case.work.info(f"iteration {state.last.iteration} by the evaluation: {percent_line(told)}{more}")
        if done:
            return replace(state, reason=f"{state.reason}; {_verdict(told, len(state.rounds))}"), ""
        state = with_bounds(state, [limit.moved for limit in limits])
        save(state)
        state = go_on(state)
    return (replace(state, reason=f"{state.reason} ({_MOVED})") if state.rounds else state), ""


def _verdict(told: GoalOutcome, rounds: int) -> str:
    after = f"after the limits in the cells were moved {'once' if rounds == 1 else f'{rounds} times'}"
    after = f" {after}" if rounds else ""
    broken = broken_limits(told)
    if broken:
        return f"not met by the evaluation{after}: {'; '.join(broken)}"
    return f"every limit holds by the evaluation{after}"


def told_by_evaluation(goal: GoalOutcome, case: EvaluatedGoal, state: State, failure: str) -> GoalOutcome:
    """The entry `goal` of the metrics with what the evaluation says of the last design; as it is without.

    Args:
        failure: why the last design could not be evaluated; empty where it was, or was not to be.
    """
    if failure:
        return goal.without_evaluation(failure)
    name, kept = iteration_name(state.last.iteration), case.work.kept
    if name not in kept:
        return goal
    told = goal_outcome(case.goal, case.reached(state), case.original())
    return goal.with_evaluation(
        told,
        fillets=False,
        element_size_mm=kept[name]["mesh"]["element_size_mm"],
        error_estimate_percent=kept[name]["error_estimate_percent"],
        rounds=tuple(MovedBounds(iteration=r.iteration, bounds=tuple(r.bounds)) for r in state.rounds),
    )


def evaluation_seconds(case: EvaluatedGoal) -> float:
    """Wall time of the evaluations."""
    return float(sum(entry["seconds"]["total"] for entry in case.work.kept.values()))
