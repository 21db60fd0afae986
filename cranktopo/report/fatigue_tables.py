"""Tables, verdicts and JSON of the fatigue command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.evaluate.evaluation import SCHEMA_VERSION
from cranktopo.evaluate.rule_check import RuleCheck
from cranktopo.evaluate.safety_field import FatigueField
from cranktopo.report.tables import ResultTable

SAME = 0.02
"""Relative difference of safety below which two variants count as equal: the scatter of the worst node."""


@dataclass(frozen=True)
class FatigueComparison:
    """Fatigue of several targets beside a baseline.

    Attributes:
        safeties: least safety of each target.
        verdicts: for each other target whether it lives as long as the baseline.
        json: the object that `fatigue --json` prints.
    """

    safeties: tuple[float, ...]
    verdicts: tuple[str, ...]
    json: dict[str, Any]


def compare_fatigue(
    results: Sequence[FatigueField] | Sequence[RuleCheck], loads: str, baseline: int
) -> FatigueComparison:
    """What a comparison shows of the fatigue of its targets.

    Args:
        results: of all targets by one method.
        loads: "extremes" or "cycle".
        baseline: position of the baseline.
    """
    fields = [r for r in results if isinstance(r, FatigueField)]
    checks = [r for r in results if isinstance(r, RuleCheck)]
    json = fields_json(fields, loads, baseline) if fields else checks_json(checks, loads, baseline)
    return FatigueComparison(tuple(_columns(results)[2]), tuple(verdicts(results, baseline)), json)


def field_table(fields: Sequence[FatigueField], baseline: int | None) -> ResultTable:
    """One row per target: mass, safety, cyclic stress, gradient and place of the critical point.

    Args:
        fields: the assessments.
        baseline: position of the target that counts as 100 %, if any.
    """
    columns = (
        "target",
        "throw_kg",
        "safety",
        "amplitude_MPa",
        "mean_MPa",
        "gradient_per_mm",
        "strength_MPa",
        "pin_safety",
        "journal_safety",
        "decided_by",
        "critical_place",
    )
    rows = tuple(_field_row(f) for f in fields)
    return _with_percent(ResultTable(columns, rows, (0, 3, 3, 1, 1, 3, 1, 3, 3, 0, 0)), baseline)


def rule_table(checks: Sequence[RuleCheck], baseline: int | None) -> ResultTable:
    """One row per target: acceptability of both fillets by closed form and by finite elements.

    Args:
        checks: the checks by the rule.
        baseline: position of the target that counts as 100 %, if any.
    """
    columns = (
        "target",
        "throw_kg",
        "least_Q",
        "pin_Q_rule",
        "pin_Q_FE",
        "journal_Q_rule",
        "journal_Q_FE",
        "strength_MPa",
        "accepted",
    )
    rows = tuple(_rule_row(c) for c in checks)
    return _with_percent(ResultTable(columns, rows, (0, 3, 3, 3, 3, 3, 3, 1, 0)), baseline)


def factor_table(checks: Sequence[RuleCheck]) -> ResultTable:
    """Concentration factors by closed form and by finite elements."""
    rows = tuple(
        (c.name, name, getattr(c.closed, name), value, 100 * (value / getattr(c.closed, name) - 1))
        for c in checks
        for name, value in vars(c.elements).items()
    )
    return ResultTable(("target", "factor", "rule", "FE", "FE_over_rule_percent"), rows, (0, 0, 3, 3, 1))


def verdicts(results: Sequence[FatigueField] | Sequence[RuleCheck], baseline: int) -> list[str]:
    """For each target whether it lives as long as the baseline, and how its mass compares.

    Args:
        results: of all targets by one method.
        baseline: position of the baseline.
    """
    names, masses, safeties = _columns(results)
    lines = []
    for index, name in enumerate(names):
        if index == baseline:
            continue
        ratio = safeties[index] / safeties[baseline]
        lives = "as long as" if abs(ratio - 1) <= SAME else "longer than" if ratio > 1 else "less long than"
        mass = 100 * (masses[index] / masses[baseline] - 1)
        lines.append(
            f"{name}: {mass:+.1f} % mass, {100 * (ratio - 1):+.1f} % safety: it lives {lives} "
            f"{names[baseline]}."
        )
    return lines


def fields_json(fields: Sequence[FatigueField], loads: str, baseline: int | None) -> dict[str, Any]:
    """The object that `fatigue --json` prints for the methods of local stresses.

    Args:
        fields: the assessments, at least one.
        loads: "extremes" or "cycle".
        baseline: position of the target that counts as 100 %, if any.
    """
    entries = [_field_json(f) for f in fields]
    return _object(fields[0].method, loads, entries, fields, baseline)


def checks_json(checks: Sequence[RuleCheck], loads: str, baseline: int | None) -> dict[str, Any]:
    """The object that `fatigue --method m53 --json` prints.

    Args:
        checks: the checks by the rule.
        loads: "extremes" or "cycle".
        baseline: position of the target that counts as 100 %, if any.
    """
    return _object("m53", loads, [c.as_json() for c in checks], checks, baseline)


def _object(
    method: str,
    loads: str,
    entries: list[dict[str, Any]],
    results: Sequence[FatigueField] | Sequence[RuleCheck],
    baseline: int | None,
) -> dict[str, Any]:
    names, masses, safeties = _columns(results)
    comparison = None
    if baseline is not None:
        comparison = [
            {
                "target": name,
                "safety_percent": 100 * safety / safeties[baseline],
                "mass_percent": 100 * mass / masses[baseline],
            }
            for name, mass, safety in zip(names, masses, safeties, strict=True)
        ]
    return {
        "schema_version": SCHEMA_VERSION,
        "method": method,
        "loads": loads,
        "baseline": None if baseline is None else names[baseline],
        "fatigue": entries,
        "percent_of_baseline": comparison,
    }


def _field_json(field: FatigueField) -> dict[str, Any]:
    return {
        "target": field.model.name,
        "throw_kg": field.model.throw_kg,
        "safety": field.critical.safety,
        "fillet_safety": field.fillet_safety,
        "critical": field.critical.as_json(),
        "off_the_fillets": field.elsewhere.as_json(),
        "load_states": len(field.history.labels),
        "unit_loads": list(field.model.kinds),
        "quality": {**vars(field.model.quality), "within_rule": field.model.quality.within_rule},
    }


def _columns(
    results: Sequence[FatigueField] | Sequence[RuleCheck],
) -> tuple[list[str], list[float], list[float]]:
    rows = [
        (r.model.name, r.model.throw_kg, r.critical.safety)
        if isinstance(r, FatigueField)
        else (r.name, r.throw_kg, r.safety)
        for r in results
    ]
    return [r[0] for r in rows], [r[1] for r in rows], [r[2] for r in rows]


def _field_row(f: FatigueField) -> tuple[str | float | None, ...]:
    c = f.critical
    return (
        f.model.name,
        f.model.throw_kg,
        c.safety,
        c.amplitude_MPa,
        c.mean_MPa,
        c.gradient_per_mm,
        c.strength_MPa,
        f.fillet_safety["pin"],
        f.fillet_safety["journal"],
        c.decided_by,
        str(c.place),
    )


def _rule_row(c: RuleCheck) -> tuple[str | float | None, ...]:
    closed, found = c.closed_checks, c.element_checks
    rule = {name: None if c.outside else check.acceptability for name, check in closed.items()}
    return (
        c.name,
        c.throw_kg,
        c.safety,
        rule["pin"],
        found["pin"].acceptability,
        rule["journal"],
        found["journal"].acceptability,
        min(check.strength_MPa for check in found.values()),
        "yes" if c.accepted else "no",
    )


def _with_percent(table: ResultTable, baseline: int | None) -> ResultTable:
    """The table with mass and safety in percent of the baseline after the first three columns."""
    if baseline is None:
        return table
    base = table.rows[baseline]

    def percent(row: tuple[str | float | None, ...], column: int) -> float:
        value, reference = row[column], base[column]
        return 100 * float(value or 0.0) / float(reference or 1.0)

    return ResultTable(
        (*table.columns[:3], "mass_percent", "safety_percent", *table.columns[3:]),
        tuple((*row[:3], percent(row, 1), percent(row, 2), *row[3:]) for row in table.rows),
        (*table.digits[:3], 1, 1, *table.digits[3:]),
    )
