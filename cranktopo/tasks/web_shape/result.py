"""shape.json: the goal and its limits, the original, the result, what changed, every dimension."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.result import UNLESS_NONE, FileName, Result
from cranktopo.design.assumed import Assumption
from cranktopo.design.goal.constraint import TOLERANCE, LimitSense
from cranktopo.design.goal.outcome import GoalOutcome, GoalWords, LimitOutcome
from cranktopo.design.goal.quantities import STIFFNESS_OF, QuantityName
from cranktopo.engine.histories import LoadsName
from cranktopo.report.report_file import REPORT
from cranktopo.tasks.bound.result import BoundStatement, NoBound
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.throw_fea.result import EvaluationResult


class DimensionSensitivity(Result):
    """A dimension of a web, and what a millimetre or degree of it is worth."""

    name: str
    unit: str
    value: float
    """mm, or degrees for a draft."""
    low: float
    high: float
    """The bounds of its range."""
    at_bound: str | None
    """"low" or "high" where it lies on that bound."""
    held_by: tuple[str, ...]
    """Names of the rules, bounds and limits that keep it where it is."""
    per_unit: dict[str, float]
    """Change of each quantity per mm or degree, % of the original's."""

    @property
    def per_unit_percent(self) -> dict[str, float]:
        """The same by quantity."""
        return {name.removesuffix("_percent"): value for name, value in self.per_unit.items()}


class ShapeParameter(DimensionSensitivity):
    """A dimension of the optimum."""

    start: float | None
    """Value at the start of the search; None for a feature that it added."""


class SensitivityTable(Result):
    """Every dimension of a web, and the worst case within the tolerance."""

    parameters: tuple[DimensionSensitivity, ...]
    worst_case_percent: dict[str, float]
    """By quantity, to first order; `tolerance` in mm or degrees."""


class FeatureTrial(Result):
    """One row of the table of what was tried."""

    step: str
    """Stations or feature."""
    parameters: int
    """Number of parameters that the web then has."""
    objective: float | None
    """The goal, smaller is better; None where no web kept limits and rules."""
    gain_percent: float | None
    """Gain in the goal against what was there before, % of the original's; None likewise."""
    kept: bool
    evaluations: int
    """Webs solved."""
    missed_percent: float = 0.0
    """Violation of the worst limit, 0 where all are kept. Then the gain is how much nearer the web comes."""


MINIMUM_PERCENT = 5e-3
"""A price below it counts as zero."""
LOOSE_PERCENT = 30.0
"""Part of the goal's gradient that the prices leave unexplained, above which no price is known.

A price may be wrong by that part of the goal's gradient over the limit's own. In percent both gradients are
alike for stiffness and mass, and usual prices are 0.1 to 1 % per percent: beyond 0.3 they tell nothing.
"""


def too_loose(remainder_percent: float) -> bool:
    """Tell whether the prices leave too much of the goal's gradient unexplained to be known."""
    return remainder_percent > LOOSE_PERCENT


class LimitPrice(Result):
    """Cost of a limit at the optimum."""

    quantity: QuantityName
    sense: LimitSense
    goal_percent_per_percent: float | None
    """None where it is not known: the limit is missed, or binds where the prices explain too little. 0 of a
    limit that does not bind."""

    def outcomes(self, limits: Sequence[LimitOutcome]) -> tuple[LimitOutcome, ...]:
        """Return the goal's limits that it is of; one of a displacement is that of its stiffness."""
        return tuple(limit for limit in limits if _in_model(limit) == (self.quantity, self.sense))

    def known(self, limits: Sequence[LimitOutcome], remainder_percent: float) -> float | None:
        """Return the price, None where it is not known."""
        cost, own = self.goal_percent_per_percent, self.outcomes(limits)
        missed = any(limit.holds is False for limit in own)
        if own and not missed and not any(limit.active for limit in own):
            return 0.0
        return None if missed or too_loose(remainder_percent) else cost

    @property
    def side(self) -> str:
        """Word for the limit beside one from the other side."""
        return "greatest" if self.sense == "<=" else "least"


def _in_model(limit: LimitOutcome) -> tuple[str, LimitSense]:
    """Return quantity and sense of a limit as the search states it."""
    stiffness = STIFFNESS_OF.get(limit.quantity)
    if stiffness is None:
        return limit.quantity, limit.sense
    return stiffness, ">=" if limit.sense == "<=" else "<="


class RulePrice(Result):
    """Gain in the goal by a unit of a rule or bound, % of the original's."""

    name: str
    unit: str
    goal_percent_per_unit: float


class ShapeValues(Result):
    """Quantities by name, in the units of the goal's limits."""

    original: dict[str, float]
    result: dict[str, float]


class RoundValues(Result):
    """A web that was evaluated on the way."""

    values: dict[str, float]
    excess_percent: tuple[float, ...]
    """Violation of each limit by the evaluation, %; 0 or less is kept."""


class LeastInShaft(Result):
    """Least fatigue safety of all webs of the shaft on all its bearings, over its range of speeds."""

    original: float
    """With the design's own web."""
    result: float
    """With the best web."""
    required: float | None
    """Least one that the limits ask for."""
    web: int
    """Web of the result that has it, from the free end, 1 first."""
    part: str
    """Its place: pin_fillet, journal_fillet, outlets or elsewhere."""


class SafetyInShaft(LeastInShaft):
    """The same under the loads that the search had, which its limits are about."""

    @property
    def held(self) -> bool:
        """True where the shaft is as safe as is required, within what counts as kept."""
        return self.required is None or self.result >= self.required * (1 - TOLERANCE)


class ShaftCheck(LeastInShaft):
    """The same where the search judged a throw alone, both webs on meshes as coarse.

    The limits are those of the throw alone: none of them is missed by this.
    """

    speeds_rpm: tuple[float, float]
    """Lowest and highest speed of its range."""
    fillet_fraction: float
    """Element size in a fillet over its radius."""


class ShapeFiles(Result):
    """Files beside `shape.json`."""

    design: FileName = "web.toml"
    step: FileName = "web.step"
    stl: FileName = "web.stl"
    drawing: FileName = "drawing.pdf"
    report: FileName = REPORT


class ShapeResult(Result):
    """The content of shape.json, and what `shape --json` prints."""

    schema_version: int = 1
    design: str
    goal: GoalOutcome
    status: str
    stop_reason: str
    original: EvaluationResult
    """The evaluation of the original web, with the fatigue safety where requested."""
    result: EvaluationResult
    values: ShapeValues
    change_percent: dict[str, float]
    parameters: tuple[ShapeParameter, ...]
    worst_case_percent: dict[str, float]
    prices: tuple[LimitPrice, ...]
    goal_on_cells: GoalWords
    prices_remainder_percent: float
    """Part of the goal's gradient that the prices leave unexplained."""
    rule_prices: tuple[RulePrice, ...]
    trials: tuple[FeatureTrial, ...]
    rounds: tuple[RoundValues, ...]
    best_round: int
    iterations: int
    evaluations: int
    seconds: dict[str, float]
    bound: BoundStatement | NoBound | None = None
    assumed: tuple[Assumption, ...] = ()
    loads: LoadsName | None = UNLESS_NONE
    """Load states of safety and stress, as `fatigue --loads`, or "shaft": those of webs in their shaft, by
    `--each-web` and where the effect `continuous_shaft` is on; None without these and in earlier versions."""
    in_shaft: SafetyInShaft | None = UNLESS_NONE
    """Safety of the shaft, where the effect `continuous_shaft` is on."""
    shaft_check: ShaftCheck | None = UNLESS_NONE
    """Safety of the shaft where the search judged a throw alone; None where nothing of it was solved."""
    shaft_unjudged: str | None = UNLESS_NONE
    """Why the web was not judged in its shaft, in words."""
    undercuts: ShapedUndercuts | None = UNLESS_NONE
    """None in results of an earlier version."""
    unfinished: bool | None = UNLESS_NONE
    """True where a limit is missed and the last of the finishes that were allowed came nearer to it; None in
    results of an earlier version."""
    balance: str | None = UNLESS_NONE
    """Sentence on the balance factor that moved, if no limit holds it there."""
    left_off: str | None = UNLESS_NONE
    """Loads that safety and stress do not count although they are above the threshold, in words."""
    files: ShapeFiles = ShapeFiles()

    @property
    def held(self) -> bool:
        """True where every limit holds by the evaluation, that of the safety in the shaft as well."""
        in_shaft = self.in_shaft is None or self.in_shaft.held
        return in_shaft and all(limit.holds for limit in self.goal.limits)

    @property
    def makeable(self) -> bool:
        """True where the process can make the web, as far as that was looked at."""
        return self.undercuts is None or self.undercuts.makeable
