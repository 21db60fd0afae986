"""The limits of a goal in the cells, beside what the body-fitted evaluation says of the same design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from cranktopo.base.progress import Json, Work
from cranktopo.design.goal.constraint import ACTIVE, TOLERANCE, bound_in_model
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.outcome import LimitOutcome, goal_outcome
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.engine.plan.simulated import without
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State
from cranktopo.tasks.density.statement import Requirement
from cranktopo.tasks.extraction.checked_surface import checked_surface
from cranktopo.tasks.fea.evaluation import evaluate
from cranktopo.tasks.fea.goal_values import goal_values
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.importing.original import original_file, without_its_fillets

_ORIGINAL = "original"
Values = Mapping[str, float]


@dataclass(frozen=True)
class CheckedLimit:
    """One limit of the optimisation.

    Attributes:
        in_cells: the limit as the optimiser has it now.
        value: what the design reaches of it in the cells.
        outcome: the limit as it is wanted, by the evaluation.
    """

    in_cells: Requirement
    value: float
    outcome: LimitOutcome

    @property
    def met(self) -> bool:
        """Whether the limit holds by the evaluation, and with no reserve if it decides the design."""
        missed = self.outcome.violation
        if missed is None:
            return True
        decides = self.in_cells.broken(self.value) >= -ACTIVE
        return abs(missed) <= TOLERANCE if decides else missed <= TOLERANCE

    @property
    def moved(self) -> float:
        """Bound in the cells at which the evaluation reaches what is wanted."""
        required, reached = self.outcome.required, self.outcome.reached
        if required is None or reached is None:
            return self.in_cells.bound
        return bound_in_model(self.outcome.quantity, required, self.value, reached)


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
    work: Work

    def original(self) -> Values:
        """Quantities of the original web.

        Raises:
            CranktopoError: its file is no half throw, or a failed solve.
        """
        with TemporaryDirectory() as folder:
            path = Path(folder) / "original.stl"
            return self._values(_ORIGINAL, lambda: self._original(path))

    def reached(self, state: State) -> Values:
        """Quantities of the last design of a state.

        Raises:
            CranktopoError: its density has no surface, or a failed solve.
        """
        with TemporaryDirectory() as folder:
            path = Path(folder) / "web.stl"
            return self._values(iteration_name(state.last.iteration), lambda: self._surface(state, path))

    def limits(self, state: State) -> tuple[CheckedLimit, ...]:
        """The limits of the last design of a state; raises as `reached`."""
        limits = self.problem.with_bounds(state.bounds).statement.limits
        names = {limit.response.name for limit in limits}
        found = goal_outcome(self.goal, self.reached(state), self.original()).limits
        known = (outcome for outcome in found if outcome.quantity in names)
        return tuple(CheckedLimit(*row) for row in zip(limits, state.last.limits, known, strict=True))

    def _original(self, path: Path) -> Target:
        file, name = original_file(self.scene), "original web"
        if file is None:
            return Target(name, without(planned_scene(self.scene), "fillets"))
        body = planned_scene(self.scene, ("bores", "fillets"))
        write_stl(path, without_its_fillets(file, body))
        return Target(name, without(body, "fillets"), path)

    def _surface(self, state: State, path: Path) -> Target:
        design = loop.final_design(self.problem, state)
        found = checked_surface(self.prepared.scene, self.prepared.domain, design)
        write_stl(path, found.surface.half_throw)
        name = f"surface of iteration {state.last.iteration}"
        return Target(name, planned_scene(self.scene), path)

    def _values(self, name: str, target: Callable[[], Target]) -> Values:
        def make() -> Json:
            return evaluate(target(), progress=self.work.info).as_json()

        return goal_values(self.scene, self.work.once(name, make))


def iteration_name(iteration: int) -> str:
    """Name under which the evaluation of a design is kept."""
    return f"iteration-{iteration}"
