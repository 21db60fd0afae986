"""Settings of an optimisation of dimensions, the webs that it evaluates, and the best of them."""

from __future__ import annotations

from dataclasses import dataclass, field

from cranktopo.base.arrays import Array
from cranktopo.design.goal.constraint import TOLERANCE
from cranktopo.design.goal.limit import Goal
from cranktopo.engine.histories import Loads
from cranktopo.numerics.optimisers.gradient_search import Multipliers
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.web_shape.evaluated_web import EvaluatedWeb, Judging
from cranktopo.tasks.web_shape.mesh_model import MeshResponses
from cranktopo.tasks.web_shape.result import FeatureTrial
from cranktopo.tasks.web_shape.search import HELD
from cranktopo.tasks.web_shape.search_goal import SearchGoal
from cranktopo.throw.manufacturing_limits import ManufacturingLimits


@dataclass(frozen=True)
class ShapeSettings:
    """Settings of a shape optimisation.

    Attributes:
        cell_mm: cells on which features are chosen.
        mesh_mm: elements on which trials are judged and gradients taken.
        rounds: most finishes; three times as many with free dimensions.
        element_size_mm: of the evaluation; by default that of `evaluate`.
        loads: load states over which fatigue safety and stress are judged, as `cranktopo fatigue --loads`, or
            of webs in their shaft the safety.
        fillet_fraction: element size in a fillet over its radius where these are evaluated.
        features: whether outline and features are sought on cells before the finishes; else these begin with
            the web of the start, whose features stay.
    """

    cell_mm: float = 4.0
    mesh_mm: float = 8.0
    rounds: int = 4
    element_size_mm: float | None = None
    limits: ManufacturingLimits = field(default_factory=ManufacturingLimits)
    loads: Loads = "extremes"
    fillet_fraction: float = RULE_FRACTION
    features: bool = True

    @property
    def judging(self) -> Judging:
        """Return what evaluates stresses."""
        return Judging(self.loads, self.fillet_fraction)


@dataclass(frozen=True)
class ShapeRound:
    """A web that was found, and its evaluation.

    Attributes:
        excess_percent: how far each limit of the goal is missed by the evaluation, %; 0 or less is kept.
        evaluations: webs solved to find it.
    """

    web: EvaluatedWeb
    values: Array
    excess_percent: tuple[float, ...]
    evaluations: int

    @property
    def violation(self) -> float:
        """Violation of the worst limit by the evaluation, as a part; 0 or less is kept."""
        return max(self.excess_percent, default=0.0) / 100

    @property
    def held(self) -> bool:
        """True where every limit is kept by the evaluation."""
        return self.violation <= HELD

    @property
    def met(self) -> bool:
        """True where every limit counts as satisfied."""
        return self.violation <= TOLERANCE


@dataclass(frozen=True)
class ShapeOptimum:
    """The best web found.

    Attributes:
        stated: the goal in the units of the evaluation.
        rounds: webs that were evaluated, in their order; the first is that of the cells.
        responses: quantities of the best web as the evaluation tells them, with their exact gradients.
        unfinished: whether it misses a limit and was the last of the finishes that were allowed.
    """

    goal: Goal
    stated: SearchGoal
    original: EvaluatedWeb
    web: ParametricWeb
    rounds: tuple[ShapeRound, ...]
    best: int
    trials: tuple[FeatureTrial, ...]
    responses: MeshResponses
    multipliers: Multipliers
    unfinished: bool

    @property
    def result(self) -> ShapeRound:
        """The best round."""
        return self.rounds[self.best]
