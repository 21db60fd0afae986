"""Targets beside a baseline: values, percentages, and which of them is best beyond the error estimates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.goal.balance_moved import MovedBalance
from cranktopo.design.goal.outcome import GoalOutcome
from cranktopo.design.published import Published
from cranktopo.report.result_table import Cell
from cranktopo.tasks.throw_fatigue.result import FatigueResult, JudgedAs
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fatigue.verdicts import WORLDS
from cranktopo.tasks.throw_fea.error_bound import difference_bound_percent
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.quantities import COMPARED, SAFETY, UNBALANCE, Quantity, evaluation_values
from cranktopo.tasks.throw_fea.result import EvaluationResult

Fillets = Literal["as designed", "left out", "none", "as in the file"]
"""Of a compared body: those of its design, left out beside a run, none on the surface of a run."""


class ChangeErrors(Result):
    """Errors of the changes in percent of the baseline: bounds of both stiffnesses, and of the safety."""

    target: str
    torsion: float
    bending: float
    safety: float | None = UNLESS_NONE
    """Of the fatigue safety by the first method; null where it was not judged."""


class RuleAnswer(Result):
    """Answer of the crankshaft rule to a throw."""

    verdict: str
    """The worst of its webs': "not covered", "not accepted", "not judged" or "accepted"."""
    reason: str
    """Place and reason of what is not judged; else the place of the least factor with its set of factors."""


class ComparisonResult(Result):
    """Output of `compare --format json`."""

    schema_version: int = 1
    baseline: str
    fillets: dict[str, Fillets]
    """Mass and stiffness with or without fillets, by target; beside the surface of a run all are without."""
    pitch_mm: dict[str, float] | None = UNLESS_NONE
    """Distance of the throws by target, where one has another than the baseline."""
    mirrored_web: str | None = UNLESS_NONE
    """That throws whose halves differ count with one web twice, as that beside them has; null where none."""
    evaluations: list[EvaluationResult]
    percent_of_baseline: list[dict[str, Cell]]
    """Rows of the table, by its columns."""
    change_error_percent: list[ChangeErrors]
    best: dict[str, str | None]
    """Name of the best target by column; None where another is within the error estimate, or none was judged
    beside it."""
    published: list[dict[str, Cell]] | None
    """Percent of the baseline as computed (`ours`) and as printed elsewhere, and their difference."""
    fatigue: FatigueResult | None
    """As `fatigue --json`, where it was assessed; by the first method."""
    further_fatigue: list[FatigueResult] | None = UNLESS_NONE
    """By every further method."""
    safety_by_method: dict[str, dict[str, float | None]] | None = UNLESS_NONE
    """Least safety by method and target; null where it was not judged."""
    verdicts: dict[str, RuleAnswer] | None = UNLESS_NONE
    """Answers of the crankshaft rule by target, where requested: the worst of a throw's webs."""
    not_judged: dict[str, dict[str, str]] | None = UNLESS_NONE
    """Why a method did not judge a target, by method and target."""
    goals: dict[str, GoalOutcome] | None = UNLESS_NONE
    balance: dict[str, MovedBalance] | None = UNLESS_NONE
    """Balance factors that left the baseline's, by target; none that a limit holds."""


@dataclass(frozen=True)
class Entry:
    """A compared target and what was published for it.

    Attributes:
        safety: smallest fatigue safety by the first method, if it was judged.
        further_safety: by every further method that judged it.
        stress_MPa: largest von Mises stress, if a method of local stresses judged it.
        fillets: whether its mass and stiffness are with them; its safety always is.
        safety_as: by the first method, of a throw alone and in its shaft, where both were found.
    """

    evaluation: Evaluation
    published: Published | None = None
    safety: float | None = None
    further_safety: Mapping[str, float] = field(default_factory=dict)
    fillets: Fillets = "as designed"
    stress_MPa: float | None = None
    safety_as: Mapping[JudgedAs, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the target."""
        return self.evaluation.target

    @cached_property
    def values(self) -> Mapping[str, float]:
        """The compared quantities by key, in the units of their table: kg, kN m/rad, kN/mm, kg mm.

        `Quantity.unit` tells them; the `evaluation` itself is in N m/rad and N/mm.
        """
        safeties = {safety_by(method).key: safety for method, safety in self.further_safety.items()}
        first = {} if self.safety is None else {SAFETY.key: self.safety}
        worlds = {_safety_as(world).key: safety for world, safety in self.safety_as.items()}
        return evaluation_values(self.evaluation) | first | safeties | worlds

    def error_percent(self, quantity: Quantity) -> float:
        """Return the error estimate of a stiffness; 0 of what is exact."""
        return {
            "torsion": self.evaluation.torsion_error_percent,
            "bending": self.evaluation.bending_error_percent,
        }.get(quantity.error or "", 0.0)


@dataclass(frozen=True)
class Comparison:
    """Targets beside a baseline.

    Attributes:
        baseline: position of the entry that counts as 100 %.
        fatigue: by the first method, which goals and limits take.
        further_fatigue: by every further method.
        goals: what became of the goal of each entry whose design has one, as `goal` of the metrics, by name.
        balanced_kg_mm: unbalance that is wanted of a throw; the nearest to it is best, not the least.
        pitch_mm: distance of the throws of every entry, in their order; empty where all are alike.
        pitches: lines on those whose throws are farther apart, or closer, than the baseline's.
        balance: where the balance factor went, by the name of each entry in which it left the baseline's.
        mirrored: that a web counts twice in every target, as one was found; empty where none does.
        bare: surfaces of runs, for which all designs are compared without fillets.
    """

    entries: tuple[Entry, ...]
    baseline: int
    fatigue: FatigueComparison | None = None
    goals: Mapping[str, GoalOutcome] = field(default_factory=dict)
    further_fatigue: tuple[FatigueComparison, ...] = ()
    balanced_kg_mm: float = 0.0
    bare: tuple[str, ...] = ()
    mirrored: str = ""
    pitch_mm: tuple[float, ...] = ()
    pitches: tuple[str, ...] = ()
    balance: Mapping[str, MovedBalance] = field(default_factory=dict)

    @property
    def fatigues(self) -> tuple[FatigueComparison, ...]:
        """Fatigue by every method."""
        return () if self.fatigue is None else (self.fatigue, *self.further_fatigue)

    @property
    def safeties(self) -> dict[str, Quantity]:
        """Safety by method, the first one's under the plain name."""
        methods = [one.result.method for one in self.fatigues]
        return {m: safety_by(m) if number else SAFETY for number, m in enumerate(methods)}

    @property
    def safety_quantities(self) -> tuple[Quantity, ...]:
        """Safety by every method, and that of a throw alone and in its shaft where both are known."""
        worlds = tuple(map(_safety_as, WORLDS)) if any(one.safety_as for one in self.entries) else ()
        return (*self.safeties.values(), *worlds)

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Quantities that are compared."""
        return (*COMPARED, *self.safety_quantities)

    @property
    def base(self) -> Entry:
        """The entry that counts as 100 %."""
        return self.entries[self.baseline]

    def percent(self, row: int, quantity: Quantity) -> float:
        """Return a value in percent of the baseline's; both have it."""
        return 100 * self.entries[row].values[quantity.key] / self.base.values[quantity.key]

    def having(self, quantity: Quantity) -> list[int]:
        """Return the rows that have a value of a quantity: all of them but of the safety."""
        return [row for row, entry in enumerate(self.entries) if quantity.key in entry.values]

    def has_percent(self, row: int, quantity: Quantity) -> bool:
        """Tell whether both an entry and the baseline have a value of a quantity."""
        return all(quantity.key in entry.values for entry in (self.entries[row], self.base))

    def change_error_percent(self, row: int, other: int, quantity: Quantity) -> float:
        """Return the bound of the error of the relative difference between two entries; 0 if it is exact."""
        if row == other:
            return 0.0
        if quantity.error == "safety":
            return self._judged(quantity).change_error_percent(row, other)
        one, two = self.entries[row], self.entries[other]
        errors = one.error_percent(quantity), two.error_percent(quantity)
        triangles = one.evaluation.triangles or two.evaluation.triangles
        return difference_bound_percent(*errors, triangles=triangles)

    def _judged(self, quantity: Quantity) -> FatigueComparison:
        """Return the fatigue by the method of a safety; bodies are judged apart by the first one alone."""
        found = (one for one in self.fatigues if self.safeties[one.result.method] == quantity)
        return next(found, self.fatigues[0])

    def differ(self, row: int, other: int, quantity: Quantity) -> bool:
        """Tell whether two entries differ in a quantity by at least the bound of the difference's error."""
        if quantity.error is None:
            return True
        one, two = self.entries[row], self.entries[other]
        change = 100 * abs(one.values[quantity.key] / two.values[quantity.key] - 1)
        return bool(change >= self.change_error_percent(row, other, quantity))

    def leading(self, quantity: Quantity) -> int:
        """Return the row with the best value of a quantity, by however little.

        Where the rule judges no throw it is the one with the largest factor, which `best` does not name.
        """
        return max(self.rated(quantity) or self.having(quantity), key=lambda row: self._worth(row, quantity))

    def rated(self, quantity: Quantity) -> list[int]:
        """Return the rows that may be best: those with a value, by the rule only of throws that it judges."""
        unrated = next(
            (f.unrated for f in self.fatigues if self.safeties[f.result.method] == quantity), frozenset()
        )
        return [row for row in self.having(quantity) if self.entries[row].name not in unrated]

    def _worth(self, row: int, quantity: Quantity) -> float:
        value = self.entries[row].values[quantity.key]
        return -abs(value - self.balanced_kg_mm) if quantity == UNBALANCE else quantity.better * value

    def level(self, quantity: Quantity) -> list[int]:
        """Return rows that the best value of a quantity does not beat by as much as the error estimates."""
        best = self.leading(quantity)
        others = (row for row in self.rated(quantity) if row != best)
        return [row for row in others if not self.differ(best, row, quantity)]

    def best(self, quantity: Quantity) -> int | None:
        """Return the row of the best entry; None if another is within the error estimate.

        One that is rated alone is the best of none.
        """
        alone = len(self.rated(quantity)) < 2
        return None if alone or self.level(quantity) else self.leading(quantity)


def safety_by(method: str) -> Quantity:
    """Return the fatigue safety by a further method as a quantity of its own."""
    return replace(SAFETY, key=f"{SAFETY.key}_{method}", label=f"{SAFETY.label} by {method}")


def _safety_as(world: JudgedAs) -> Quantity:
    """Return the fatigue safety of a throw alone, or in its shaft, as a quantity of its own."""
    return replace(SAFETY, key=f"{SAFETY.key}_{world}", label=f"{SAFETY.label} {WORLDS[world]}")


def compare(
    entries: Sequence[Entry],
    baseline: str,
    fatigue: FatigueComparison | None = None,
    further_fatigue: Sequence[FatigueComparison] = (),
) -> Comparison:
    """Return a comparison against the entry of this name; raises CranktopoError where there is none."""
    names = [entry.name for entry in entries]
    if baseline not in names:
        raise CranktopoError(
            f"baseline '{baseline}' is not among the targets {', '.join(names)}.", code=ExitCode.USAGE
        )
    check_same_supports((e.evaluation.torsion_support, e.evaluation.bending_support) for e in entries)
    others = tuple(further_fatigue)
    return Comparison(tuple(entries), names.index(baseline), fatigue, further_fatigue=others)


def check_same_supports(supports: Iterable[tuple[str, str]]) -> None:
    """Check that targets with these supports in torsion and in bending can be compared."""
    found = dict.fromkeys(supports)
    if len(found) > 1:
        named = "; ".join(f"torsion '{torsion}', bending '{bending}'" for torsion, bending in found)
        raise CranktopoError(
            f"the targets have different [supports], so their stiffnesses do not compare: {named}.",
            hint="Give all of them the same.",
        )
