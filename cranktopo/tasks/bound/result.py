"""Output of `bound --json`, and the entry `bound` beside other results."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.bodies.cells.outside import OutsideEnvelope
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.outcome import StatedGoal
from cranktopo.design.goal.quantities import QuantityName


class DroppedLimit(Result):
    """A limit that is left out of the proof, which only makes the bound looser."""

    limit: str
    reason: str


class BoundGoal(StatedGoal):
    """The goal of a bound."""

    dropped: tuple[DroppedLimit, ...]


class ProvenBound(Result):
    """The bound itself."""

    quantity: QuantityName
    value: float | None
    """None where no web keeps all limits."""
    unit: str
    percent_of_original: float | None
    possible: bool


class VariableStiffness(Result):
    """Value that cells of any stiffness reach, which is no web: the proof cannot do better."""

    value: float
    percent_of_original: float
    steps: int


class BoundResult(Result):
    """Output of `bound --json`."""

    schema_version: int = 1
    design: str
    goal: BoundGoal
    bound: ProvenBound
    variable_stiffness: VariableStiffness
    original: dict[str, float]
    original_outside_envelope_percent: float
    """Volume of the original web outside of the envelope, percent of the web."""
    original_outside_envelope_mm3: float
    """The same of one web."""
    weights: dict[str, float]
    """Percent that the bound loses per percent of each limit."""
    process: str
    die: bool
    cells: tuple[int, ...]
    design_cells: int
    resolution_mm: float
    model_error_percent: dict[str, float]
    seconds: float
    assumed: tuple[Assumption, ...]


class BoundCells(Result):
    """The cells of a bound."""

    cell_mm: float
    error_percent: dict[str, float]


class NoBound(Result):
    """Why there is no bound beside a result."""

    none: str
    reached_percent: float | None = UNLESS_NONE

    @property
    def stiffest(self) -> dict[str, tuple[float | None, ...]]:
        """No curves."""
        return {}


class BoundStatement(Result):
    """Bound of one quantity, and what a result reaches of it."""

    quantity: QuantityName
    value: float | None
    percent_of_original: float | None
    dropped: tuple[str, ...]
    model: BoundCells
    at_mass_percent: float | None = UNLESS_NONE
    reached_percent: float | None = UNLESS_NONE


class BoundStatements(Result):
    """Bounds beside a web whose goal may be no more than stiffness."""

    statements: tuple[BoundStatement, ...]
    stiffest: dict[str, tuple[float | None, ...]]
    """Curves over the mass by their quantity and unit."""
    outside_envelope: OutsideEnvelope | None = UNLESS_NONE
    """Part of the original web that lies outside of the envelope that the bound is about."""

    def with_reached(self, percent: float | None) -> BoundStatements:
        """Return the same with what the first statement's quantity reached, where that is known."""
        if percent is None or not self.statements:
            return self
        first = self.statements[0].model_copy(update={"reached_percent": percent})
        return self.model_copy(update={"statements": (first, *self.statements[1:])})


AnyBound = NoBound | BoundStatements
