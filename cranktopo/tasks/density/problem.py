"""The density optimisation as equations: model, density-to-modulus chain, goals and limits, schedule."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from cranktopo.numerics.precision import Precision
from cranktopo.tasks.density.assessment import Assessment
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.optimisation_problem import OptimisationProblem
from cranktopo.tasks.density.responses import Design
from cranktopo.tasks.density.state import Proposal, State

# The error of a compliance is the square of the residual's: a loose solve, started from the last design's
# displacements, leads to the same design in half the cycles. The final design is assessed at 1e-8.
TOLERANCE, TOLERANCE_EARLY = 1e-3, 1e-2


@dataclass(frozen=True)
class SolverSettings:
    """Accuracy of the solves of the design iterations.

    Attributes:
        tolerance_early: relative residual before the last projection stage.
        incompatible_modes: of the hexahedra.
    """

    tolerance_early: float = TOLERANCE_EARLY
    tolerance: float = TOLERANCE
    precision: Precision = "float32"
    incompatible_modes: bool = True


@dataclass(frozen=True)
class Schedule:
    """Schedule of projection and steps.

    Attributes:
        projection_first, projection_last: steepness of the projection, which doubles from stage to stage.
        stage_iterations: most iterations of a stage but the last.
        move: largest change of a design variable in the first stage; steeper ones take smaller steps.
    """

    projection_first: float = 1.0
    projection_last: float = 16.0
    stage_iterations: int = 6
    move: float = 0.2


@dataclass(frozen=True)
class DensityProblem:
    """Everything constant during an optimisation.

    Attributes:
        weights: of the load cases' compliances, where their sum is the goal.
        target: volume fraction of the design space; without one it is free.
        optimisation: goals and limits, for a method that takes any.
        method: how the next design is found.
        start: density of the uniform first design.
        original: the scene's own web in the model, where a goal is measured by it.
    """

    model: ThrowModel
    density_chain: MaterialInterpolation
    weights: tuple[float, ...]
    target: float | None
    max_iterations: int
    optimisation: OptimisationProblem
    method: Method
    start: float
    solving: SolverSettings = SolverSettings()
    schedule: Schedule = Schedule()
    original: Assessment | None = None

    def with_bounds(self, bounds: Sequence[float]) -> DensityProblem:
        """Return the same with the limits at other bounds, in their order; none keep their own."""
        if not bounds:
            return self
        pairs = zip(self.optimisation.limits, bounds, strict=True)
        limits = tuple(replace(limit, bound=bound) for limit, bound in pairs)
        return replace(self, optimisation=replace(self.optimisation, limits=limits))


Method = Callable[[DensityProblem, State, Design, Design], Proposal]
"""A way to the next design variables, such as those of `proposals`.

It takes the design as it is made, whose values count, and the one with the stiffness of the eroded and the
mass of the dilated design, whose derivatives count: the same one unless members or gaps have a least size.
"""
Progress = Callable[[DensityProblem, State], None]
"""Called after every iteration with the state that it left."""
