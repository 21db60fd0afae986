"""A goal whose limits hold by the body-fitted evaluation of the extracted surface, not only in the cells.

The converged design is extracted and evaluated, each limit in the cells is moved by the error that shows, and
the optimisation goes on from there, until every limit that decides the design is met.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.base.progress import Json, StageMemory
from cranktopo.design.goal.constraint import TOLERANCE, Constraint, bound_in_model
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.outcome import GoalOutcome, LimitOutcome, LimitRound, goal_outcome
from cranktopo.design.goal.scene_goal import goal_of, judged_by_evaluation
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.report.goal_table import percent_line, unknown_limits, violated_limits
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.loop import with_bounds
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State
from cranktopo.tasks.extraction.checked_surface import checked_surface
from cranktopo.tasks.importing.original import original_file, without_its_fillets
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.quantities import goal_values
from cranktopo.tasks.throw_fea.result import EvaluationResult
from cranktopo.tasks.throw_fea.targets import Target

_ROUNDS = 3
"""Most times that the limits are moved."""
_MOVED = "limits in the cells as the evaluation moved them"
_ORIGINAL = "original"
Values = Mapping[str, float]
Step = Callable[[State], State]


@dataclass(frozen=True)
class EvaluatedGoal:
    """A goal, and what the evaluation says of the designs of one optimisation.

    The surface of a density has no fillets, so the original is evaluated without its own, also where it is
    a body from CAD.

    Attributes:
        scene: as the run has it.
        work: keeps the evaluations.
    """

    goal: Goal
    scene: Scene
    prepared: Prepared
    problem: DensityProblem
    work: StageMemory

    def original(self) -> Values:
        """Return the quantities of the original web."""
        return self._values(_ORIGINAL, "original.stl", self._original)

    def reached(self, state: State) -> Values:
        """Return the quantities of the last design of a state; its density may have no surface."""
        name = _iteration_name(state.last.iteration)
        return self._values(name, "web.stl", lambda path: self._surface(state, path))

    def outcome(self, state: State) -> GoalOutcome:
        """Return the outcome of the goal for the last design of a state."""
        return goal_outcome(self.goal, self.reached(state), self.original())

    def in_cells(self, state: State) -> tuple[tuple[Constraint, float], ...]:
        """Return the limits that the cells have now, each with the value of the last design of a state."""
        limits = self.problem.with_bounds(state.bounds).optimisation.limits
        return tuple(zip((limit.constraint for limit in limits), state.last.limits, strict=True))

    def _original(self, path: Path) -> Target:
        file, name = original_file(self.scene), "original web"
        if file is None:
            return Target(name, strip_features(planned_scene(self.scene), "fillets"))
        body = planned_scene(self.scene, ("bores", "fillets"))
        write_stl(path, without_its_fillets(file, body))
        return Target(name, strip_features(body, "fillets"), path)

    def _surface(self, state: State, path: Path) -> Target:
        design = loop.final_design(self.problem, state)
        found = checked_surface(self.prepared.scene, self.prepared.domain, design)
        write_stl(path, found.surface.half_throw)
        name = f"surface of iteration {state.last.iteration}"
        return Target(name, planned_scene(self.scene), path)

    def _values(self, name: str, file: str, target: Callable[[Path], Target]) -> Values:
        def make() -> Json:
            with TemporaryDirectory() as folder:
                return evaluate(target(Path(folder) / file)).result.as_json()

        return goal_values(self.scene, _evaluation(self.work.once(name, make)))


def _evaluation(kept: Json) -> EvaluationResult:
    return EvaluationResult.of_json(kept, "kept evaluation")


def _iteration_name(iteration: int) -> str:
    return f"iteration-{iteration}"


def evaluated_goal(
    scene: Scene, prepared: Prepared, problem: DensityProblem, work: StageMemory
) -> EvaluatedGoal | None:
    """Return the goal of a scene whose limits are to hold by the evaluation; None where none are."""
    goal = goal_of(scene)
    if goal is None or not judged_by_evaluation(scene):
        return None
    return EvaluatedGoal(goal, scene, prepared, problem, work)


def moved_bounds(
    in_cells: Sequence[tuple[Constraint, float]], outcomes: Sequence[LimitOutcome]
) -> tuple[float, ...]:
    """Return bounds in the cells at which the evaluation reaches what is required; none where all are met.

    Args:
        in_cells: limits that the cells have, each with its value.
        outcomes: of all limits by the evaluation of the same design.
    """
    names = {constraint.quantity for constraint, _ in in_cells}
    known = (outcome for outcome in outcomes if outcome.quantity in names)
    rows = [(*limit, outcome) for limit, outcome in zip(in_cells, known, strict=True)]
    if all(_met(*row) for row in rows):
        return ()
    return tuple(_moved_bound(*row) for row in rows)


def _met(constraint: Constraint, value: float, outcome: LimitOutcome) -> bool:
    """Tell whether a limit holds by the evaluation, and with no reserve if it decides the design."""
    violation = outcome.violation
    if violation is None:
        return True
    return (abs(violation) if constraint.active(value) else violation) <= TOLERANCE


def _moved_bound(constraint: Constraint, value: float, outcome: LimitOutcome) -> float:
    if outcome.required is None or outcome.reached is None:
        return constraint.bound
    return bound_in_model(outcome.quantity, outcome.required, value, outcome.reached)


def enforce_limits_by_fea(
    case: EvaluatedGoal | None, state: State, save: Callable[[State], None], go_on: Step
) -> tuple[State, str]:
    """Have the limits met by the evaluation, if rounds and iterations suffice.

    `save` keeps a state, so that the run can be resumed; `go_on` takes one to the end in the cells.

    Returns:
        The state at the end, and why its design could not be evaluated: that ends the rounds. Empty where it
        was, or was not to be since the optimisation has not converged.
    """
    while case is not None and state.status == "converged":
        try:
            outcome = case.outcome(state)
        except CranktopoError as error:
            if error.code == ExitCode.INTERRUPTED:
                raise
            note(f"iteration {state.last.iteration} could not be evaluated: {error.message}")
            return replace(state, reason=f"{state.reason}; its limits are not judged"), error.message
        last = len(state.rounds) == _ROUNDS
        bounds = () if last else moved_bounds(case.in_cells(state), outcome.limits)
        more = "; the limits in the cells are moved by their error" if bounds else ""
        note(f"iteration {state.last.iteration} by the evaluation: {percent_line(outcome)}{more}")
        if not bounds:
            return replace(state, reason=f"{state.reason}; {_verdict(outcome, len(state.rounds))}"), ""
        state = with_bounds(state, bounds)
        save(state)
        state = go_on(state)
    return (replace(state, reason=f"{state.reason} ({_MOVED})") if state.rounds else state), ""


def _verdict(outcome: GoalOutcome, rounds: int) -> str:
    after = f"after the limits in the cells were moved {'once' if rounds == 1 else f'{rounds} times'}"
    after = f" {after}" if rounds else ""
    violated = violated_limits(outcome)
    if violated:
        return f"not met by the evaluation{after}: {'; '.join(violated)}"
    unknown = unknown_limits(outcome)
    if unknown:
        return f"every limit but {', '.join(unknown)}, not assessed here, holds by the evaluation{after}"
    return f"every limit holds by the evaluation{after}"


def goal_by_evaluation(goal: GoalOutcome, case: EvaluatedGoal, state: State, failure: str) -> GoalOutcome:
    """Return entry `goal` of the metrics with what the evaluation says, or the failure that it met."""
    if failure:
        return goal.without_evaluation(failure)
    name, kept = _iteration_name(state.last.iteration), case.work.kept
    if name not in kept:
        return goal
    evaluated = _evaluation(kept[name])
    return goal.with_evaluation(
        case.outcome(state),
        fillets=False,
        element_size_mm=evaluated.mesh.element_size_mm,
        error_estimate_percent=evaluated.error_estimate_percent,
        rounds=tuple(LimitRound(iteration=r.iteration, bounds=tuple(r.bounds)) for r in state.rounds),
    )


def evaluation_seconds(case: EvaluatedGoal) -> float:
    """Return the wall time of the evaluations."""
    return float(sum(_evaluation(entry).seconds.total for entry in case.work.kept.values()))
