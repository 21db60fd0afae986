"""Tables of a comparison, and its JSON."""

from __future__ import annotations

from collections.abc import Mapping

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


def value_table(comparison: Comparison) -> ResultTable:
    """Absolute values and the error estimates of the stiffnesses, the best of each quantity marked."""
    columns = {"target": 0}
    for quantity in comparison.quantities:
        columns[quantity.column] = quantity.digits
        if quantity == BENDING:
            columns |= {f"{kind}_error_percent": 2 for kind in ("torsion", "bending")}
    rows: tuple[Row, ...] = tuple(
        {
            "target": entry.name,
            **{quantity.column: entry.values.get(quantity.key) for quantity in comparison.quantities},
            "torsion_error_percent": entry.evaluation.torsion_error_percent,
            "bending_error_percent": entry.evaluation.bending_error_percent,
        }
        for entry in comparison.entries
    )
    best = {quantity.column: comparison.best(quantity) for quantity in comparison.quantities}
    return ResultTable(columns, rows, _marks(best))


def percent_table(comparison: Comparison) -> ResultTable:
    """Percent of the baseline, the best of each quantity marked; bounds of the stiffnesses' changes."""
    columns = {"target": 0}
    for quantity in comparison.quantities:
        columns[quantity.percent_column] = 1
        if quantity == BENDING:
            columns |= {f"{stiffness.key}_change_error_percent": 2 for stiffness in STIFFNESS}
    rows: tuple[Row, ...] = tuple(
        {
            "target": entry.name,
            **{
                q.percent_column: comparison.percent(row, q) if row in comparison.having(q) else None
                for q in comparison.quantities
            },
            **{f"{kind}_change_error_percent": error for kind, error in _change_errors(comparison, row)},
        }
        for row, entry in enumerate(comparison.entries)
    )
    best = {quantity.percent_column: comparison.best(quantity) for quantity in comparison.quantities}
    return ResultTable(columns, rows, _marks(best))


def _change_errors(comparison: Comparison, row: int) -> list[tuple[str, float]]:
    """Bounds of the error of both stiffnesses in percent of the baseline."""
    base = comparison.baseline
    return [
        (q.key, comparison.percent(row, q) / 100 * comparison.change_error_percent(row, base, q))
        for q in STIFFNESS
    ]


def published_table(comparison: Comparison) -> ResultTable | None:
    """Our percentages, the published ones and their difference; None where nothing was published."""
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


def flat_table(comparison: Comparison) -> ResultTable:
    """Values, percentages and published percentages side by side: one header for a CSV file."""
    tables = (value_table(comparison), percent_table(comparison), published_table(comparison))
    parts = [table for table in tables if table is not None]
    columns = {name: digits for part in parts for name, digits in part.columns.items()}
    rows = zip(*(part.rows for part in parts), strict=True)
    return ResultTable(columns, tuple({k: v for part in row for k, v in part.items()} for row in rows))


def comparison_result(comparison: Comparison) -> ComparisonResult:
    """Return the comparison as `compare --format json` prints it."""
    published = published_table(comparison)
    best = {quantity.column: comparison.best(quantity) for quantity in comparison.quantities}
    return ComparisonResult(
        baseline=comparison.base.name,
        evaluations=[entry.evaluation.result for entry in comparison.entries],
        percent_of_baseline=records(percent_table(comparison)),
        change_error_percent=[
            ChangeErrors(target=entry.name, **dict(_change_errors(comparison, row)))
            for row, entry in enumerate(comparison.entries)
        ],
        best={column: None if row is None else comparison.entries[row].name for column, row in best.items()},
        published=None if published is None else records(published),
        fatigue=None if comparison.fatigue is None else comparison.fatigue.result,
        goals=dict(comparison.goals) or None,
    )


def _marks(best: Mapping[str, int | None]) -> frozenset[tuple[int, str]]:
    return frozenset((row, column) for column, row in best.items() if row is not None)


def _published_columns(quantity: Quantity) -> list[str]:
    return [f"{quantity.key}_{kind}_percent" for kind in ("ours", "published", "difference")]


def _values(printed: Published) -> dict[str, float]:
    """Published mass, torsional stiffness and their ratio by key."""
    torsion = printed.torsional_stiffness_kNm_per_rad
    return {
        MASS.key: printed.mass_kg,
        TORSION.key: torsion,
        TORSION_PER_MASS.key: torsion / printed.mass_kg,
    }
