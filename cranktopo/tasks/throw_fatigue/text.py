"""Tables and remarks of the fatigue command.

`baseline` is the position of the target that counts as 100 %, if any.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from cranktopo.engine.histories import LoadsName
from cranktopo.engine.judged_histories import states_words
from cranktopo.report.result_table import Column, ResultTable, tabulate
from cranktopo.tasks.fatigue.criteria import safety_method, shortfall_words
from cranktopo.tasks.throw_fatigue.remarks import (
    cut_outlet_words,
    deciding_speed_words,
    further_speed_words,
    quality_remarks,
    vibration_sets_words,
)
from cranktopo.tasks.throw_fatigue.result import FatigueResult, FieldFatigue, HardenedFillet, PartLife
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fatigue.rule_text import decided_depth, rule_remarks
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.throw_verdict import ThrowVerdict
from cranktopo.tasks.throw_fatigue.verdicts import (
    SAME,
    FatigueOutcome,
    Summary,
    safety_change_error_percent,
    summary,
    verdicts,
    with_percent,
)
from cranktopo.tasks.throw_fea.quantities import MASS, SAFETY

_FIELD_COLUMNS: tuple[Column[FatigueField], ...] = (
    Column("target", 0, lambda f: f.model.name),
    Column("throw_kg", MASS.digits, lambda f: f.model.throw_kg),
    Column(SAFETY.column, SAFETY.digits, lambda f: f.critical.safety),
    Column("amplitude_MPa", 1, lambda f: f.critical.amplitude_MPa),
    Column("mean_MPa", 1, lambda f: f.critical.mean_MPa),
    Column("gradient_per_mm", 3, lambda f: f.critical.gradient_per_mm),
    Column("strength_MPa", 1, lambda f: f.critical.strength_MPa),
    Column("pin_safety", SAFETY.digits, lambda f: f.fillet_safety["pin"]),
    Column("journal_safety", SAFETY.digits, lambda f: f.fillet_safety["journal"]),
    Column("decided_by", 0, lambda f: f.critical.decided_by),
    Column("critical_place", 0, lambda f: f.critical.place),
)
_OUTLET_COLUMNS: tuple[Column[FatigueField], ...] = (
    Column("outlet_safety", SAFETY.digits, lambda f: f.at_outlet.safety if f.at_outlet else None),
    Column("outlet_place", 0, lambda f: f.at_outlet.place if f.at_outlet else None),
)
"""Columns of a throw with outlets of oil bores: the first behind the fillets, the second at the end."""
_FILLETS_END = 9


@dataclass(frozen=True)
class FatigueComparison:
    """Fatigue of several targets beside a baseline.

    Attributes:
        safeties: of every target; None where it was not judged.
        verdicts: answers of the rule, what it does not judge, then one line for each target but the baseline.
        result: what `fatigue --json` prints.
        not_judged: why targets were not judged, by name.
        answers: of the rule to throws, by name.
        summaries: of every target, in the order of the safeties; None where it was not judged.
    """

    safeties: tuple[float | None, ...]
    verdicts: tuple[str, ...]
    result: FatigueResult
    not_judged: Mapping[str, str] = field(default_factory=dict)
    answers: Mapping[str, ThrowVerdict] = field(default_factory=dict)
    summaries: tuple[Summary | None, ...] = ()

    def change_error_percent(self, row: int, other: int) -> float:
        """Return the error of the relative difference between the safeties of two targets, %."""
        found = [self.summaries[at] for at in (row, other)] if self.summaries else []
        pair = [one for one in found if one is not None]
        return safety_change_error_percent(*pair) if len(pair) == 2 else 100 * SAME

    @property
    def unrated(self) -> frozenset[str]:
        """Throws that the rule has no answer to, so that their least factor says nothing of their safety."""
        open_ones = ("not judged", "not covered")
        return frozenset(name for name, one in self.answers.items() if one.verdict in open_ones)

    @property
    def failing(self) -> dict[str, str]:
        """Targets that fail, with the reason: a safety below what is asked, or no acceptance by the rule."""
        refused = {name: one.words for name, one in self.answers.items() if one.verdict != "accepted"}
        method = self.result.method
        return refused | {
            one.target: f"by {method}: safety {one.safety:.3f} {words}"
            for one in self.result.fatigue
            if isinstance(one, FieldFatigue) and (words := shortfall_words(method, one.safety))
        }


def web_safety_words(web_safety: Mapping[str, float]) -> str:
    """Return the least safety of either web of a throw whose webs differ."""
    return ", ".join(f"{web} web {safety:.{SAFETY.digits}f}" for web, safety in web_safety.items())


def loads_by_target(found: FatigueResult) -> dict[str, LoadsName]:
    """Return the load states that the safety of each target is over."""
    return {
        one.target: "shaft"
        if isinstance(one, FieldFatigue) and one.judged_as == "continuous_shaft"
        else found.loads
        for one in found.fatigue
    }


def load_words(found: FatigueResult) -> str:
    """Return the load states of the safeties in words, by target where these have several."""
    by: dict[LoadsName, list[str]] = {}
    for target, loads in loads_by_target(found).items():
        by.setdefault(loads, []).append(target)
    if len(by) < 2:
        return states_words(next(iter(by), found.loads))
    return "; ".join(f"{' and '.join(targets)} {states_words(one)}" for one, targets in by.items())


def compare_fatigue(
    results: Sequence[FatigueOutcome],
    baseline: int | None,
    fatigue_result: FatigueResult,
    answers: Sequence[ThrowVerdict] = (),
    checks: Sequence[RuleCheck] = (),
) -> FatigueComparison:
    """Return what a comparison shows of the fatigue of its targets; no verdicts without a baseline.

    Args:
        results: one of each target, of two different webs the worse one.
        answers: of the rule to each target.
        checks: of every web by the rule.
    """
    summaries = tuple(map(summary, results))
    safeties = tuple(one.safety for one in summaries)
    remarks = [*(f"{one.target}: {one.words}." for one in answers), *rule_remarks(checks)]
    fields = [result for result in results if isinstance(result, FatigueField)]
    remarks += field_remarks(fields)
    remarks += [f"{field.model.name}: {line}" for field in fields for line in quality_remarks(field)]
    remarks += dict.fromkeys(
        f"{entry.target}: material: {remark}."
        for entry in fatigue_result.fatigue
        for remark in entry.strength_remarks or ()
    )
    sentences = [] if baseline is None else verdicts(results, baseline, answers)
    by_name = {one.target: one for one in answers}
    return FatigueComparison(
        safeties, (*remarks, *sentences), fatigue_result, answers=by_name, summaries=summaries
    )


def field_table(fields: Sequence[FatigueField], baseline: int | None) -> ResultTable:
    """Return one row per target: mass, safety, cyclic stress, gradient and place of the critical point."""
    columns = _FIELD_COLUMNS
    if any(field.at_outlet for field in fields):
        columns = (*columns[:_FILLETS_END], _OUTLET_COLUMNS[0], *columns[_FILLETS_END:], _OUTLET_COLUMNS[1])
    return with_percent(tabulate(columns, fields), fields, baseline)


def field_remarks(fields: Sequence[FatigueField]) -> list[str]:
    """Return what the tables do not say: failures, speeds, hardened fillets, lives, chances of failure."""
    remarks = _failures, _speed_remarks, _hardening_remarks, _life_remarks, _scatter_remarks
    unlike = vibration_sets_words(fields)
    return [*([unlike] if unlike else []), *(line for of_kind in remarks for line in of_kind(fields))]


def _failures(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each target that fails, or has less than the method asks for."""
    return [
        f"{field.model.name}: safety {field.critical.safety:.3f} {words}."
        for field in fields
        if (words := shortfall_words(field.method, field.critical.safety))
    ]


def inclusions(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each method: what its safety counts, and the least safety that it asks for."""
    methods = dict.fromkeys(field.method for field in fields)
    return [f"A safety by {method} counts: {safety_method(method).includes}." for method in methods]


def not_judged(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each target with outlets that are not judged."""
    found = ((field.model.name, cut_outlet_words(field.model)) for field in fields)
    return [f"{name}: {words}" for name, words in found if words]


def _speed_remarks(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each target that is judged at several speeds: the one that decides."""
    found = [
        (field.model.name, further_speed_words(field) or deciding_speed_words(field))
        for field in fields
        if field.model.scene.engine
    ]
    return [f"{name}: {words}" for name, words in found if words]


def _hardening_remarks(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each hardened fillet: the depth that decides, and what the treatment gains."""
    return [
        f"{field.model.name}, {fillet} fillet, {one.process}: decided {decided_depth(one.depth_mm)}, safety "
        f"{one.safety:.3f} ({one.safety_surface:.3f} at the surface, {one.safety_below:.3f} below it), "
        f"{one.gain:.2f} times that of the untreated point{_up_to(one)}."
        for field in fields
        for fillet, one in field.hardening.items()
    ]


def _up_to(one: HardenedFillet) -> str:
    """Return the safety at the other end of the scatter of the residual stress, if it scatters."""
    if one.safety_high is None:
        return ""
    return f"; {one.safety_high:.3f} at the other end of residual_scatter_MPa"


def _life_remarks(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each part whose life by the spectrum is known."""
    return [
        f"{field.model.name}, {_PARTS[part]}: {_life(one)}."
        for field in fields
        for part, one in field.lives.items()
    ]


def _life(one: PartLife) -> str:
    if one.life_hours is None:
        return "no limit of life, as no cycle exceeds the fatigue limit"
    hours = f"{one.life_hours:,.0f} h" if one.life_hours >= 10 else f"{one.life_hours:.2g} h"
    known = {rpm: share for rpm, share in one.damage_shares.items() if share >= 0.005}
    shares = ", ".join(f"{rpm} rpm {100 * share:.0f} %" for rpm, share in known.items())
    return f"life {hours}, {one.throw}; damage by {shares}"


def _scatter_remarks(fields: Sequence[FatigueField]) -> list[str]:
    """Return one line for each part whose probability of failure is known."""
    return [
        f"{field.model.name}, {_PARTS[part]}: probability of failure {_probability(one.failure_probability)} "
        f"(reliability index {one.reliability_index:.2f}), by {_parts_of(one.shares)}."
        for field in fields
        for part, one in field.scatter.items()
    ]


_PARTS = {"pin": "pin fillet", "journal": "journal fillet", "elsewhere": "off the fillets"}


def _probability(value: float) -> str:
    return "below 1e-9" if value < 1e-9 else f"{value:.1e}" if value < 0.001 else f"{100 * value:.2g} %"


def _parts_of(shares: dict[str, float]) -> str:
    return ", ".join(
        f"{name.replace('_', ' ')} {100 * share:.0f} %" for name, share in shares.items() if share
    )
