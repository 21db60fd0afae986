"""Tables of a comparison, and its JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cranktopo.base.units import plain_number, stem_and_unit
from cranktopo.design.published import PublishedValues
from cranktopo.report.result_table import Cell, ResultTable, Row, records
from cranktopo.tasks.compare.result import (
    ChangeErrors,
    Comparison,
    ComparisonResult,
    RuleAnswer,
    safety_by,
)
from cranktopo.tasks.fatigue import criteria
from cranktopo.tasks.throw_fatigue.result import FieldFatigue
from cranktopo.tasks.throw_fatigue.text import FatigueComparison, loads_by_target, web_safety_words
from cranktopo.tasks.throw_fea.quantities import (
    BENDING,
    COMPARED,
    SAFETY,
    STIFFNESS,
    TORSION,
    UNBALANCE,
    Quantity,
    throw_values,
)

_KINDS = ("ours_percent", "published_percent", "difference_percent")


def _value_table(comparison: Comparison) -> ResultTable:
    """Return absolute values and the error estimates of the stiffnesses, the best of each quantity marked."""
    rows = [
        {
            "target": entry.name,
            **{quantity.column: entry.values.get(quantity.key) for quantity in comparison.quantities},
            "torsion_error_percent": entry.evaluation.torsion_error_percent,
            "bending_error_percent": entry.evaluation.bending_error_percent,
        }
        for entry in comparison.entries
    ]
    columns = {quantity: (quantity.column, quantity.digits) for quantity in comparison.quantities}
    return _table(comparison, columns, "error_percent", rows)


def _percent_table(comparison: Comparison) -> ResultTable:
    """Return percent of the baseline, the best of each marked, and errors of the changes."""
    rows = [
        {
            "target": entry.name,
            **{
                q.percent_column: comparison.percent(row, q) if comparison.has_percent(row, q) else None
                for q in comparison.quantities
            },
            **{
                f"{q.key}_change_error_percent": _change_error(comparison, row, q)
                for q in (*STIFFNESS, *comparison.safety_quantities)
            },
        }
        for row, entry in enumerate(comparison.entries)
    ]
    columns = {quantity: (quantity.percent_column, 1) for quantity in comparison.quantities}
    return _table(comparison, columns, "change_error_percent", rows)


def _table(
    comparison: Comparison, named: Mapping[Quantity, tuple[str, int]], error: str, rows: Sequence[Row]
) -> ResultTable:
    columns, best = {"target": 0}, set()
    for quantity, (name, digits) in named.items():
        columns[name] = digits
        if quantity == BENDING:
            columns |= {f"{stiffness.key}_{error}": 2 for stiffness in STIFFNESS}
        if quantity.error == "safety" and f"{quantity.key}_{error}" in rows[0]:
            columns[f"{quantity.key}_{error}"] = 1
        row = comparison.best(quantity)
        best |= set() if row is None else {(row, name)}
    return ResultTable(columns, tuple(rows), frozenset(best))


def _change_error(comparison: Comparison, row: int, quantity: Quantity) -> float | None:
    """Return the error of a change in percent of the baseline; None where one of both has no value."""
    if not comparison.has_percent(row, quantity):
        return None
    error = comparison.change_error_percent(row, comparison.baseline, quantity)
    return comparison.percent(row, quantity) / 100 * error


@dataclass(frozen=True)
class _Published:
    """A target beside what was printed, by the keys of quantities.

    Attributes:
        ours: percent of the baseline as computed.
        printed: printed values.
        reference: printed values of the baseline.
    """

    target: str
    ours: Mapping[str, float]
    printed: Mapping[str, float]
    reference: Mapping[str, float]

    def cells(self, key: str) -> dict[str, Cell]:
        """Return our percentage, the printed one and their difference."""
        ours, value = self.ours.get(key), self.printed.get(key)
        printed = None if value is None else 100 * value / self.reference[key]
        difference = None if ours is None or printed is None else ours - printed
        return dict(zip(_KINDS, (ours, printed, difference), strict=True))


def _beside_published(comparison: Comparison) -> list[_Published]:
    """Return all targets, and the variants that are printed only; nothing where nothing was printed."""
    base = comparison.base.published
    if base is None or not any(e.published for e in comparison.entries if e.published is not base):
        return []
    reference = _printed_values(base)
    found = [
        _Published(entry.name, _ours(comparison, row), _printed_values(entry.published), reference)
        for row, entry in enumerate(comparison.entries)
    ]
    only = [_Published(f"{one.name} (printed)", {}, _printed_values(one), reference) for one in base.variant]
    return [*found, *only]


def _ours(comparison: Comparison, row: int) -> dict[str, float]:
    named = {quantity.key: quantity for quantity in COMPARED}
    named |= {safety_by(method).key: quantity for method, quantity in comparison.safeties.items()}
    return {key: comparison.percent(row, q) for key, q in named.items() if comparison.has_percent(row, q)}


def _published_table(comparison: Comparison) -> ResultTable | None:
    """Return the published percentages beside ours, a row for each quantity of each target."""
    base, found = comparison.base.published, _beside_published(comparison)
    if base is None or not found:
        return None
    methods = {safety_by(one.method).key: f"{one.method} {one.printed_as}" for one in base.fatigue}
    rows = []
    for key in found[0].reference:
        quantity = next((q for q in COMPARED if q.key == key), SAFETY)
        label = f"{quantity.key} {methods.get(key, '')}".replace("_", " ").strip()
        for one in found:
            value = one.printed.get(key)
            printed = _with_unit(value, stem_and_unit(quantity.column)[1])
            row = {"quantity": label, "target": one.target, "printed": printed, **one.cells(key)}
            rows += [row] if value or key in one.ours else []
    return ResultTable({"quantity": 0, "target": 0, "printed": 0, **dict.fromkeys(_KINDS, 1)}, tuple(rows))


def _with_unit(value: float | None, unit: str) -> str | None:
    return None if value is None else f"{value:{'.0f' if value >= 1000 else '.4g'}} {unit}".strip()


def _published_rows(comparison: Comparison) -> list[Row]:
    """Return the same with a row for each target."""
    return [
        {"target": one.target}
        | {f"{key}_{kind}": v for key in one.reference for kind, v in one.cells(key).items()}
        for one in _beside_published(comparison)
    ]


def balance_lines(comparison: Comparison) -> list[str]:
    """Return a line for every target whose balance factor left the baseline's; no limit holds it there."""
    base = comparison.base.name
    return [f"{name}: {moved.words} as {base} has." for name, moved in comparison.balance.items()]


def fillet_lines(bare: Sequence[str]) -> list[str]:
    """Return the line that a comparison beside the surfaces of these runs is without fillets."""
    if not bare:
        return []
    return [
        f"Mass and stiffness of all designs are without fillets, as the surface of {', '.join(bare)} has "
        "none (cranktopo remodel adds them)."
    ]


def safety_method(comparison: Comparison) -> list[str]:
    """Return a sentence that names the method of the fatigue safety in limits; none where none is limited."""
    limits = (limit for goal in comparison.goals.values() for limit in goal.limits)
    if comparison.fatigue is None or all(limit.quantity != "fatigue_safety" for limit in limits):
        return []
    return [f"fatigue_safety in limits is by {comparison.fatigue.result.method}, the first method asked for."]


def left_off_lines(comparison: Comparison) -> list[str]:
    """Return a line for every target whose safety leaves out loads above the threshold."""
    entries = (entry for one in comparison.fatigues for entry in one.result.fatigue if entry.left_off)
    return list(dict.fromkeys(f"{entry.target}: {entry.left_off}." for entry in entries))


def safety_places(fatigue: FatigueComparison) -> list[str]:
    """Return lines on the place of the least safety of each target, and on either web; none by the rule."""
    places = [
        f"{entry.target} {entry.safety:.{SAFETY.digits}f} at {entry.critical.place}"
        for entry in fatigue.result.fatigue
        if isinstance(entry, FieldFatigue)
    ]
    return [*([f"Least safety: {'; '.join(places)}."] if places else []), *_safety_of_webs(fatigue)]


def _safety_of_webs(fatigue: FatigueComparison) -> list[str]:
    """Return the line with the least safety of either web of each target whose webs differ."""
    targets = [
        f"{entry.target} {web_safety_words(entry.web_safety)}"
        for entry in fatigue.result.fatigue
        if isinstance(entry, FieldFatigue) and entry.web_safety
    ]
    return [f"Least safety by web: {'; '.join(targets)}."] if targets else []


def star_lines(comparison: Comparison) -> list[str]:
    """Return what the star of the unbalance marks where the best is not the least."""
    balanced_kg_mm = comparison.balanced_kg_mm
    if not balanced_kg_mm or comparison.best(UNBALANCE) is None:
        return []
    return [
        f"The star of the unbalance is at the nearest to {plain_number(balanced_kg_mm, 4)} kg mm, with which "
        "throw and rods together are balanced as the engine asks for."
    ]


def method_lines(comparison: Comparison) -> list[str]:
    """Return the line on why the numbers of several methods do not compare; none for a single one."""
    methods = list(comparison.safeties)
    if len(methods) < 2:
        return []
    inclusions = " ".join(f"{method}: {criteria.safety_method(method).includes}." for method in methods)
    return [f"Safeties of different methods do not compare as numbers. {inclusions}"]


def comparison_tables(comparison: Comparison) -> list[ResultTable]:
    """Return values, percentages and, where something was published, published percentages."""
    tables = (
        _by_method(comparison, _value_table(comparison)),
        _by_method(comparison, _percent_table(comparison)),
        _published_table(comparison),
    )
    return [table for table in tables if table is not None]


def _by_method(comparison: Comparison, table: ResultTable) -> ResultTable:
    """Return the table with the first of several methods in the head of its safety; files keep `safety`."""
    if len(comparison.safeties) < 2:
        return table
    first = safety_by(next(iter(comparison.safeties)))
    heads = {SAFETY.column: first.column, SAFETY.percent_column: first.percent_column}
    heads[f"{SAFETY.key}_change_error_percent"] = f"{first.key}_change_error_percent"
    return ResultTable(
        {heads.get(name, name): digits for name, digits in table.columns.items()},
        tuple({heads.get(name, name): cell for name, cell in row.items()} for row in table.rows),
        frozenset((row, heads.get(name, name)) for row, name in table.best),
    )


def flat_table(comparison: Comparison) -> ResultTable:
    """Return all tables of a comparison side by side: one header for a CSV file, a row for each target."""
    parts = [_value_table(comparison), _percent_table(comparison)]
    published = _published_rows(comparison)[: len(comparison.entries)]
    parts += [ResultTable(dict.fromkeys(published[0], 1), tuple(published))] if published else []
    parts += [_loads_table(comparison)] if comparison.fatigue else []
    parts += _answer_columns(comparison)
    parts += [ResultTable({"fillets": 0}, tuple({"fillets": entry.fillets} for entry in comparison.entries))]
    columns = {name: digits for part in parts for name, digits in part.columns.items()}
    rows = zip(*(part.rows for part in parts), strict=True)
    return ResultTable(columns, tuple({k: v for part in row for k, v in part.items()} for row in rows))


def _loads_table(comparison: Comparison) -> ResultTable:
    """Return the load states that the safeties are over, one column."""
    loads = {target: one for by in comparison.fatigues for target, one in loads_by_target(by.result).items()}
    return ResultTable(
        {"safety_loads": 0}, tuple({"safety_loads": loads.get(one.name)} for one in comparison.entries)
    )


def _answers(comparison: Comparison) -> dict[str, RuleAnswer]:
    """Return the rule's answers by target; none where it was not asked."""
    return {
        name: RuleAnswer(verdict=one.verdict, reason=one.reason)
        for fatigue in comparison.fatigues
        for name, one in fatigue.answers.items()
    }


def _answer_columns(comparison: Comparison) -> list[ResultTable]:
    """Return the columns of the rule's answers; none where it was not asked."""
    found = _answers(comparison)
    answers = [found.get(entry.name) for entry in comparison.entries]
    rows: list[Row] = [
        {"verdict": one.verdict if one else None, "verdict_reason": one.reason if one else None}
        for one in answers
    ]
    return [ResultTable({"verdict": 0, "verdict_reason": 0}, tuple(rows))] if found else []


def comparison_result(comparison: Comparison) -> ComparisonResult:
    """Return the comparison as `compare --format json` prints it."""
    published = _published_rows(comparison)
    best = {quantity.column: comparison.best(quantity) for quantity in comparison.quantities}
    return ComparisonResult(
        baseline=comparison.base.name,
        fillets={entry.name: entry.fillets for entry in comparison.entries},
        pitch_mm={e.name: mm for e, mm in zip(comparison.entries, comparison.pitch_mm, strict=False)} or None,
        mirrored_web=comparison.mirrored or None,
        evaluations=[entry.evaluation.result for entry in comparison.entries],
        percent_of_baseline=records(_percent_table(comparison)),
        change_error_percent=[
            ChangeErrors(
                target=entry.name,
                torsion=_change_error(comparison, row, TORSION) or 0.0,
                bending=_change_error(comparison, row, BENDING) or 0.0,
                safety=_change_error(comparison, row, SAFETY),
            )
            for row, entry in enumerate(comparison.entries)
        ],
        best={column: None if row is None else comparison.entries[row].name for column, row in best.items()},
        published=[dict(row) for row in published] or None,
        fatigue=None if comparison.fatigue is None else comparison.fatigue.result,
        further_fatigue=[one.result for one in comparison.further_fatigue] or None,
        safety_by_method=_safeties(comparison) or None,
        verdicts=_answers(comparison) or None,
        not_judged={o.result.method: dict(o.not_judged) for o in comparison.fatigues if o.not_judged} or None,
        goals=dict(comparison.goals) or None,
        balance=dict(comparison.balance) or None,
    )


def _safeties(comparison: Comparison) -> dict[str, dict[str, float | None]]:
    return {
        method: {entry.name: entry.values.get(quantity.key) for entry in comparison.entries}
        for method, quantity in comparison.safeties.items()
    }


def _printed_values(printed: PublishedValues | None) -> dict[str, float]:
    """Return what is printed, by key, in the units of the tables."""
    if printed is None:
        return {}
    mass, bending = printed.mass_kg, printed.bending_stiffness_kN_per_mm or 0.0
    stiffness = throw_values(mass, 1e3 * printed.torsional_stiffness_kNm_per_rad, 1e3 * bending)
    safeties = {safety_by(one.method).key: one.safety for one in printed.fatigue}
    return {key: value for key, value in stiffness.items() if value} | safeties
