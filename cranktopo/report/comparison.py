"""Targets beside a baseline: absolute values, percent, the best of each column, published percentages."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.evaluate.evaluation import SCHEMA_VERSION, Evaluation
from cranktopo.report.fatigue_tables import SAME, FatigueComparison
from cranktopo.report.tables import ResultTable, records
from cranktopo.scene.schema import Published

_TORSION_ERROR, _BENDING_ERROR = "torsion_error_percent", "bending_error_percent"


class Column(NamedTuple):
    """A compared quantity.

    Attributes:
        name: machine name, unit included.
        digits: decimals.
        better: +1 where more is better, -1 where less is.
        error: name of the evaluation's bound of its error, or a fixed one, %; None where it is exact.
    """

    name: str
    digits: int
    better: int
    error: str | float | None = None


_COLUMNS = (
    Column("mass_kg", 3, -1),
    Column("torsion_kNm_per_rad", 2, 1, _TORSION_ERROR),
    Column("bending_kN_per_mm", 2, 1, _BENDING_ERROR),
    Column("torsion_per_mass_kNm_per_rad_kg", 2, 1, _TORSION_ERROR),
    Column("bending_per_mass_kN_per_mm_kg", 2, 1, _BENDING_ERROR),
    Column("inertia_kg_mm2", 0, -1),
    Column("unbalance_kg_mm", 2, -1),
)
_SAFETY = Column("safety", 3, 1, 100 * SAME)
_ERRORS_AT = 4
"""Where the error estimates stand in the table of values: behind the target, its mass and stiffnesses."""


@dataclass(frozen=True)
class Entry:
    """A compared target.

    Attributes:
        evaluation: its mass and stiffness.
        published: what was published for it, if anything.
        safety: least fatigue safety of its fillets, where it was asked for.
    """

    evaluation: Evaluation
    published: Published | None = None
    safety: float | None = None

    @property
    def values(self) -> tuple[float, ...]:
        """The values of the columns, in order."""
        e = self.evaluation
        torsion, bending = e.torsion_Nm_per_rad / 1000, e.bending_N_per_mm / 1000
        return (
            e.throw_kg,
            torsion,
            bending,
            torsion / e.throw_kg,
            bending / e.throw_kg,
            e.inertia_kg_mm2,
            e.unbalance_kg_mm,
            *(() if self.safety is None else (self.safety,)),
        )


@dataclass(frozen=True)
class Comparison:
    """Entries and which of them is the baseline.

    Attributes:
        entries: what is compared.
        baseline: position of the baseline.
        fatigue: of the same targets, where it was asked for.
    """

    entries: tuple[Entry, ...]
    baseline: int
    fatigue: FatigueComparison | None = None

    @property
    def columns(self) -> tuple[Column, ...]:
        """What is compared, in the order of the entries' values."""
        return _COLUMNS if self.fatigue is None else (*_COLUMNS, _SAFETY)

    def percent(self, row: int, column: int) -> float:
        """A value in percent of the baseline's.

        Args:
            row: position of the entry.
            column: position of the value in `columns`.
        """
        return 100 * self.entries[row].values[column] / self.entries[self.baseline].values[column]

    def differ(self, row: int, other: int, column: int) -> bool:
        """Whether two entries differ in a column by at least the larger of their error estimates.

        Not by their sum: finite elements are too stiff, so both errors go the same way.

        Args:
            row, other: positions of the entries.
            column: position of the column.
        """
        values = [self.entries[i].values[column] for i in (row, other)]
        error = self.columns[column].error
        if error is None:
            return True
        if isinstance(error, str):
            error = max(getattr(self.entries[i].evaluation, error) for i in (row, other))
        return bool(100 * abs(values[0] / values[1] - 1) >= error)


def compare(entries: list[Entry], baseline: str, fatigue: FatigueComparison | None = None) -> Comparison:
    """A comparison against one of the entries.

    Args:
        entries: what is compared.
        baseline: name of the entry that counts as 100 %.
        fatigue: of the same targets in the same order, each entry then holding its safety.

    Raises:
        CranktopoError: the baseline is not among the entries, or the supports differ.
    """
    names = [entry.evaluation.target for entry in entries]
    if baseline not in names:
        raise CranktopoError(
            f"baseline '{baseline}' is not among the targets {', '.join(names)}.", code=ExitCode.USAGE
        )
    check_supports((e.evaluation.torsion_support, e.evaluation.bending_support) for e in entries)
    return Comparison(tuple(entries), names.index(baseline), fatigue)


def check_supports(supports: Iterable[tuple[str, str]]) -> None:
    """Check, before long work, that the stiffnesses of targets can be compared.

    Args:
        supports: of each target in torsion and in bending.

    Raises:
        CranktopoError: they differ.
    """
    found = dict.fromkeys(supports)
    if len(found) > 1:
        named = "; ".join(f"torsion '{torsion}', bending '{bending}'" for torsion, bending in found)
        raise CranktopoError(
            f"the targets have different [supports], so their stiffnesses do not compare: {named}.",
            hint="Give all of them the same.",
        )


def value_table(comparison: Comparison) -> ResultTable:
    """Absolute values and the error estimates of the stiffnesses, the best of each column marked."""
    names = [column.name for column in comparison.columns]
    table = _table(comparison, names, [entry.values for entry in comparison.entries])
    estimates = [
        (e.evaluation.torsion_error_percent, e.evaluation.bending_error_percent) for e in comparison.entries
    ]
    at = _ERRORS_AT
    return ResultTable(
        columns=(*table.columns[:at], _TORSION_ERROR, _BENDING_ERROR, *table.columns[at:]),
        rows=tuple((*row[:at], *pair, *row[at:]) for row, pair in zip(table.rows, estimates, strict=True)),
        digits=(*table.digits[:at], 2, 2, *table.digits[at:]),
        marks=frozenset((row, column + 2 * (column >= at)) for row, column in table.marks),
    )


def percent_table(comparison: Comparison) -> ResultTable:
    """Percent of the baseline, the best of each column marked."""
    columns = range(len(comparison.columns))
    rows = [tuple(comparison.percent(r, c) for c in columns) for r in range(len(comparison.entries))]
    names = [f"{_quantity(column.name)}_percent" for column in comparison.columns]
    return _table(comparison, names, rows, digits=1)


def published_table(comparison: Comparison) -> ResultTable | None:
    """Our percentages, the published ones and their difference; None where nothing was published."""
    base = comparison.entries[comparison.baseline].published
    if base is None or not any(e.published for e in comparison.entries if e.published is not base):
        return None
    rows = []
    for index, entry in enumerate(comparison.entries):
        row: list[str | float | None] = [entry.evaluation.target]
        for column, printed in zip((0, 1, 3), _published(entry.published, base), strict=True):
            ours = comparison.percent(index, column)
            row += [ours, printed, None if printed is None else ours - printed]
        rows.append(tuple(row))
    names = [
        f"{quantity}_{kind}_percent"
        for quantity in ("mass", "torsion", "torsion_per_mass")
        for kind in ("ours", "published", "difference")
    ]
    return ResultTable(("target", *names), tuple(rows), (0, *[1] * len(names)))


def flat_table(comparison: Comparison) -> ResultTable:
    """Values, percentages and published percentages side by side: one header for a CSV file."""
    parts = [value_table(comparison), percent_table(comparison)]
    published = published_table(comparison)
    if published is not None:
        parts.append(published)
    return ResultTable(
        columns=("target", *(name for part in parts for name in part.columns[1:])),
        rows=tuple(
            (entry.evaluation.target, *(value for part in parts for value in part.rows[row][1:]))
            for row, entry in enumerate(comparison.entries)
        ),
        digits=(0, *(d for part in parts for d in part.digits[1:])),
    )


def as_json(comparison: Comparison) -> dict[str, Any]:
    """The comparison as the object that `compare --json` prints."""
    published = published_table(comparison)
    return {
        "schema_version": SCHEMA_VERSION,
        "baseline": comparison.entries[comparison.baseline].evaluation.target,
        "evaluations": [entry.evaluation.as_json() for entry in comparison.entries],
        "percent_of_baseline": records(percent_table(comparison)),
        "best": {
            column.name: None if row is None else comparison.entries[row].evaluation.target
            for column, row in zip(comparison.columns, best_rows(comparison), strict=True)
        },
        "published": None if published is None else records(published),
        "fatigue": None if comparison.fatigue is None else comparison.fatigue.json,
    }


def _table(
    comparison: Comparison,
    names: list[str],
    values: list[tuple[float, ...]],
    digits: int | None = None,
) -> ResultTable:
    best = best_rows(comparison)
    return ResultTable(
        columns=("target", *names),
        rows=tuple(
            (entry.evaluation.target, *row) for entry, row in zip(comparison.entries, values, strict=True)
        ),
        digits=(0, *(column.digits if digits is None else digits for column in comparison.columns)),
        marks=frozenset((row, column + 1) for column, row in enumerate(best) if row is not None),
    )


def leading_rows(comparison: Comparison) -> list[int]:
    """Row of the entry with the best value of each column of the comparison, by however little."""
    values = [entry.values for entry in comparison.entries]
    rows = range(len(values))
    return [
        max(rows, key=lambda row: column.better * values[row][number])
        for number, column in enumerate(comparison.columns)
    ]


def level_rows(comparison: Comparison, column: int) -> list[int]:
    """Rows that the best value of a column does not beat by as much as the error estimates.

    Args:
        comparison: what is compared.
        column: position of the column.
    """
    best = leading_rows(comparison)[column]
    others = (row for row in range(len(comparison.entries)) if row != best)
    return [row for row in others if not comparison.differ(best, row, column)]


def best_rows(comparison: Comparison) -> list[int | None]:
    """Row of the best entry of each column, None where another one is level with it."""
    leading = enumerate(leading_rows(comparison))
    return [None if level_rows(comparison, column) else row for column, row in leading]


def _quantity(name: str) -> str:
    for unit in (
        "_kNm_per_rad_kg",
        "_kN_per_mm_kg",
        "_kNm_per_rad",
        "_kN_per_mm",
        "_kg_mm2",
        "_kg_mm",
        "_kg",
    ):
        if name.endswith(unit):
            return name.removesuffix(unit)
    return name


def _published(printed: Published | None, base: Published) -> tuple[float | None, float | None, float | None]:
    """Published mass, stiffness and stiffness per mass in percent of the published baseline."""
    if printed is None:
        return None, None, None
    mass = printed.mass_kg / base.mass_kg
    stiffness = printed.torsional_stiffness_kNm_per_rad / base.torsional_stiffness_kNm_per_rad
    return 100 * mass, 100 * stiffness, 100 * stiffness / mass
