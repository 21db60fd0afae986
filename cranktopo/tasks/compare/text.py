"""Tables of a comparison, and its JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cranktopo.design.schema import Published
from cranktopo.report.result_table import Cell, ResultTable, Row, records
from cranktopo.tasks.compare.result import ChangeErrors, Comparison, ComparisonResult
from cranktopo.tasks.fea.quantities import (
    BENDING,
    MASS,
    STIFFNESS,
    TORSION,
    TORSION_PER_MASS,
    Quantity,
    percent_of,
)

_PUBLISHED = (MASS, TORSION, TORSION_PER_MASS)


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
    """Return percent of the baseline, the best of each marked, and bounds of the changes of stiffness."""
    rows = [
        {
            "target": entry.name,
            **{
                q.percent_column: comparison.percent(row, q) if row in comparison.having(q) else None
                for q in comparison.quantities
            },
            **{f"{kind}_change_error_percent": error for kind, error in _change_errors(comparison, row)},
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
        row = comparison.best(quantity)
        best |= set() if row is None else {(row, name)}
    return ResultTable(columns, tuple(rows), frozenset(best))


def _change_errors(comparison: Comparison, row: int) -> list[tuple[str, float]]:
    base = comparison.baseline
    return [
        (q.key, comparison.percent(row, q) / 100 * comparison.change_error_percent(row, base, q))
        for q in STIFFNESS
    ]


def _published_table(comparison: Comparison) -> ResultTable | None:
    """Return our percentages, the published ones and their difference; None where nothing was published."""
    base = comparison.base.published
    if base is None or not any(e.published for e in comparison.entries if e.published is not base):
        return None
    rows = []
    for number, entry in enumerate(comparison.entries):
        row: dict[str, Cell] = {"target": entry.name}
        printed = {} if entry.published is None else percent_of(_values(entry.published), _values(base))
        for quantity in _PUBLISHED:
            ours, theirs = comparison.percent(number, quantity), printed.get(quantity.key)
            difference = None if theirs is None else ours - theirs
            row |= dict(zip(_published_columns(quantity), (ours, theirs, difference), strict=True))
        rows.append(row)
    names = [name for quantity in _PUBLISHED for name in _published_columns(quantity)]
    return ResultTable({"target": 0, **dict.fromkeys(names, 1)}, tuple(rows))


def comparison_tables(comparison: Comparison) -> list[ResultTable]:
    """Return values, percentages and, where something was published, published percentages."""
    tables = (_value_table(comparison), _percent_table(comparison), _published_table(comparison))
    return [table for table in tables if table is not None]


def flat_table(comparison: Comparison) -> ResultTable:
    """Return all tables of a comparison side by side: one header for a CSV file."""
    parts = comparison_tables(comparison)
    columns = {name: digits for part in parts for name, digits in part.columns.items()}
    rows = zip(*(part.rows for part in parts), strict=True)
    return ResultTable(columns, tuple({k: v for part in row for k, v in part.items()} for row in rows))


def comparison_result(comparison: Comparison) -> ComparisonResult:
    """Return the comparison as `compare --format json` prints it."""
    published = _published_table(comparison)
    best = {quantity.column: comparison.best(quantity) for quantity in comparison.quantities}
    return ComparisonResult(
        baseline=comparison.base.name,
        evaluations=[entry.evaluation.result for entry in comparison.entries],
        percent_of_baseline=records(_percent_table(comparison)),
        change_error_percent=[
            ChangeErrors(target=entry.name, **dict(_change_errors(comparison, row)))
            for row, entry in enumerate(comparison.entries)
        ],
        best={column: None if row is None else comparison.entries[row].name for column, row in best.items()},
        published=None if published is None else records(published),
        fatigue=None if comparison.fatigue is None else comparison.fatigue.result,
        goals=dict(comparison.goals) or None,
    )


def _published_columns(quantity: Quantity) -> list[str]:
    return [f"{quantity.key}_{kind}_percent" for kind in ("ours", "published", "difference")]


def _values(printed: Published) -> dict[str, float]:
    torsion = printed.torsional_stiffness_kNm_per_rad
    return {
        MASS.key: printed.mass_kg,
        TORSION.key: torsion,
        TORSION_PER_MASS.key: torsion / printed.mass_kg,
    }
