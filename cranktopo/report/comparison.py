"""Targets beside a baseline: absolute values, percent, the best of each column, published percentages."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.evaluate.evaluation import SCHEMA_VERSION, Evaluation
from cranktopo.report.fatigue_tables import Judged
from cranktopo.report.tables import Table, records
from cranktopo.scene.schema import Published

_COLUMNS: tuple[tuple[str, int, int], ...] = (
    ("mass_kg", 3, -1),
    ("torsion_kNm_per_rad", 2, 1),
    ("bending_kN_per_mm", 2, 1),
    ("torsion_per_mass_kNm_per_rad_kg", 2, 1),
    ("bending_per_mass_kN_per_mm_kg", 2, 1),
    ("inertia_kg_mm2", 0, -1),
    ("unbalance_kg_mm", 2, -1),
)
"""Name, decimals, and which way is better (+1 more, -1 less)."""
_SAFETY = ("safety", 3, 1)


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
    fatigue: Judged | None = None

    @property
    def columns(self) -> tuple[tuple[str, int, int], ...]:
        """Name, decimals, and which way is better of each column."""
        return _COLUMNS if self.fatigue is None else (*_COLUMNS, _SAFETY)

    def percent(self, row: int, column: int) -> float:
        """A value in percent of the baseline's.

        Args:
            row: position of the entry.
            column: position of the value in `columns`.
        """
        return 100 * self.entries[row].values[column] / self.entries[self.baseline].values[column]


def compare(entries: list[Entry], baseline: str, fatigue: Judged | None = None) -> Comparison:
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


def value_table(comparison: Comparison) -> Table:
    """Absolute values, the best of each column marked."""
    names = [name for name, _, _ in comparison.columns]
    return _table(comparison, names, [entry.values for entry in comparison.entries])


def percent_table(comparison: Comparison) -> Table:
    """Percent of the baseline, the best of each column marked."""
    columns = range(len(comparison.columns))
    rows = [tuple(comparison.percent(r, c) for c in columns) for r in range(len(comparison.entries))]
    names = [f"{_quantity(name)}_percent" for name, _, _ in comparison.columns]
    return _table(comparison, names, rows, digits=1)


def published_table(comparison: Comparison) -> Table | None:
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
    return Table(("target", *names), tuple(rows), (0, *[1] * len(names)))


def flat_table(comparison: Comparison) -> Table:
    """Values, percentages and published percentages side by side: one header for a CSV file."""
    parts = [value_table(comparison), percent_table(comparison)]
    published = published_table(comparison)
    if published is not None:
        parts.append(published)
    return Table(
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
            name: comparison.entries[row].evaluation.target
            for (name, _, _), row in zip(comparison.columns, best_rows(comparison), strict=True)
        },
        "published": None if published is None else records(published),
        "fatigue": None if comparison.fatigue is None else comparison.fatigue.json,
    }


def _table(
    comparison: Comparison,
    names: list[str],
    values: list[tuple[float, ...]],
    digits: int | None = None,
) -> Table:
    best = best_rows(comparison)
    return Table(
        columns=("target", *names),
        rows=tuple(
            (entry.evaluation.target, *row) for entry, row in zip(comparison.entries, values, strict=True)
        ),
        digits=(0, *(decimals if digits is None else digits for _, decimals, _ in comparison.columns)),
        marks=frozenset((row, column + 1) for column, row in enumerate(best)),
    )


def best_rows(comparison: Comparison) -> list[int]:
    """Row of the best entry of each column of the value table, in the order of its columns."""
    values = [entry.values for entry in comparison.entries]
    rows = range(len(values))
    return [
        max(rows, key=lambda row: better * values[row][column])
        for column, (_, _, better) in enumerate(comparison.columns)
    ]


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
