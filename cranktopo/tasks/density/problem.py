"""The density optimisation as equations: model, density-to-modulus chain, goals and limits, schedule.

Every function that an optimiser sees is of the order of 1: a goal over its reference, a limit as the share by
which it is broken. A stiffness enters through its reciprocal, which is nearly linear in what is added.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import jax
import jax.numpy as jnp

from cranktopo.base.units import plain_number
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import Precision
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.responses import Design, Response
from cranktopo.tasks.density.state import Proposal, State

Sense = Literal["minimise", "maximise"]


@dataclass(frozen=True)
class Objective:
    """A response to make small or large, over a positive reference such as the original web's value."""

    response: Response
    sense: Sense = "minimise"
    reference: float = 1.0

    def scaled(self, design: Design) -> jax.Array:
        """Return what is minimised: the response over its reference, or its reciprocal."""
        value = self.response.value(design) / self.reference
        return value if self.sense == "minimise" else 1 / value


@dataclass(frozen=True)
class ResponseConstraint:
    """A constraint, and the response that gives cells its value and gradient.

    `percent` where messages give values in percent of the original's.
    """

    response: Response
    constraint: Constraint
    percent: bool = False

    def __str__(self) -> str:
        return f"{self.response.name} {self.constraint.sense} {self.value_text(self.constraint.bound)}"

    def value_text(self, value: float) -> str:
        """Return a value of the response with its unit, as in messages."""
        if self.percent:
            return f"{100 * value / self.constraint.original:.4g} %"
        return self.in_unit(value)

    def in_unit(self, value: float) -> str:
        """Return a value of the response in its own unit."""
        return f"{plain_number(value, 6)} {self.response.unit}".rstrip()

    def at(self, bound: float) -> ResponseConstraint:
        """Return the same with another bound."""
        return replace(self, constraint=self.constraint.at(bound))

    def scaled(self, design: Design) -> jax.Array:
        """Share by which the limit is broken: at most 0 where it holds.

        A lower bound of something positive is taken as bound / value - 1, unless that may be 0.
        """
        value, own = self.response.value(design), self.constraint
        linear = own.sign * (value - own.bound) / own.scale
        if own.sense == "<=" or own.bound <= 0 or own.minimum_scale:
            return linear
        return jnp.where(value > 0, own.bound / jnp.where(value > 0, value, 1.0) - 1.0, linear)


@dataclass(frozen=True)
class OptimisationProblem:
    """Goals (at least one) and limits of an optimisation; the worst of several goals counts."""

    goals: tuple[Objective, ...]
    limits: tuple[ResponseConstraint, ...] = ()

    @property
    def responses(self) -> tuple[Response, ...]:
        """Those of the goals, then those of the limits."""
        return (*(g.response for g in self.goals), *(r.response for r in self.limits))

    @property
    def functions(self) -> tuple[Callable[[Design], jax.Array], ...]:
        """The scaled functions in the same order."""
        return (*(g.scaled for g in self.goals), *(r.scaled for r in self.limits))

    @property
    def worst_of_several(self) -> bool:
        """True where the largest of several goals is minimised."""
        return len(self.goals) > 1


_FACTOR_PERCENT = {"torsion": 60.0, "bending": 90.0}
_ORDER = {"torsion": 1.5, "bending": 1.1}
_HELD = 2.0
"""A journal that may not tilt bends the web: its torsional stiffness has about twice the error."""
_FEATURED = 1.15
"""With a counterweight or an oil drilling four to six cells through the web miss the torsional stiffness by
up to a tenth more."""


@dataclass(frozen=True)
class CaseResult:
    """Stiffness of the full throw: N m/rad for torsion, N/mm for a pin force, None for a body force."""

    name: str
    kind: str
    compliance_N_mm: float
    stiffness: float | None
    cg_iterations: int
    relative_residual: float


@dataclass(frozen=True)
class Assessment:
    """Masses and stiffnesses of a body in the optimiser's model.

    `throw_kg` is between the two mid-main-journal planes; `quantities` are in the units of a scene's goal.
    """

    cases: tuple[CaseResult, ...]
    throw_kg: float
    web_kg: float
    quantities: Mapping[str, float]

    def stiffness_per_mass(self) -> dict[str, float]:
        """Return the stiffness per mass of the throw, by load case name, in N m/(rad kg) or N/(mm kg)."""
        return {c.name: c.stiffness / self.throw_kg for c in self.cases if c.stiffness is not None}


def model_error_percent(scene: Scene, cell_mm: float) -> dict[str, float]:
    """Return the bound of the error of the stiffnesses of a throw without fillets, %, by kind of load case.

    A power of the cell over the thickness of the web, fitted from above to the errors of `python -m
    tests.benchmarks.voxel_accuracy --throws` on webs of 14 to 37 mm, and `--features` with counterweights and
    drillings. That of bending is the order at a sharp re-entrant ring, 1.09 (Williams, 1952); torsion is less
    sensitive to the rings.
    """
    share = cell_mm / scene.web.thickness_mm
    found = {kind: factor * share ** _ORDER[kind] for kind, factor in _FACTOR_PERCENT.items()}
    if scene.supports.torsion == "held":
        found["torsion"] *= _HELD
    if scene.web.counterweight is not None or scene.throw.drilling:
        found["torsion"] *= _FEATURED
    return found


# The error of a compliance is the square of the residual's: a loose solve, started from the last design's
# displacements, leads to the same design in half the cycles. The final design is assessed at 1e-8.
TOLERANCE, TOLERANCE_EARLY = 1e-3, 1e-2
_MOVE_LEAST = 0.05


@dataclass(frozen=True)
class SolverSettings:
    """Accuracy of the solves of the design iterations.

    `tolerance_early` is the relative residual before the last projection stage; modes are of hexahedra.
    """

    tolerance_early: float = TOLERANCE_EARLY
    tolerance: float = TOLERANCE
    precision: Precision = "float32"
    incompatible_modes: bool = True


USUAL_SOLVING = SolverSettings()


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

    def largest_move(self, beta: float) -> float:
        """Return the largest change of a design variable by one step at a steepness of the projection.

        The steeper it is, the smaller: a full step would flip boundary cells to and fro.
        """
        return max(min(_MOVE_LEAST, self.move), self.move / math.sqrt(beta))


@dataclass(frozen=True)
class DensityProblem:
    """Everything constant during an optimisation.

    Attributes:
        weights: of the load cases' compliances, where their sum is the goal.
        target: volume fraction of the design space; without one it is free.
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
    solving: SolverSettings = USUAL_SOLVING
    schedule: Schedule = Schedule()
    original: Assessment | None = None

    def tolerance_at(self, beta: float) -> float:
        """Return the relative residual that a solve at this projection steepness must reach."""
        last = beta >= self.schedule.projection_last
        return self.solving.tolerance if last else self.solving.tolerance_early

    def with_bounds(self, bounds: Sequence[float]) -> DensityProblem:
        """Return the same with the limits at other bounds, in their order; none keep their own."""
        if not bounds:
            return self
        pairs = zip(self.optimisation.limits, bounds, strict=True)
        limits = tuple(limit.at(bound) for limit, bound in pairs)
        return replace(self, optimisation=replace(self.optimisation, limits=limits))


Method = Callable[[DensityProblem, State, Design, Design], Proposal]
"""A way to the next design variables, such as those of `proposals`.

It takes the design as it is made, whose values count, and the one with the stiffness of the eroded and the
mass of the dilated design, whose derivatives count: the same one unless members or gaps have a least size.
"""
Progress = Callable[[DensityProblem, State], None]
"""Called after every iteration with the state that it left."""
