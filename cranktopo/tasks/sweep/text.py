"""A finished sweep as text: how the points ended, the front, the picks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cranktopo.report.result_table import ResultTable, Row, terminal
from cranktopo.tasks.sweep.result import COARSE, DONE, PointResult, SweepResult

_QUANTITIES = {"mass_kg": 3, "torsion_Nm_per_rad": 0, "bending_N_per_mm": 0, "fatigue_safety": 3}
_MOST_ROWS = 20
_MOST_REASONS = 3


def sweep_summary(data: SweepResult, folder: Path) -> str:
    """Return a finished sweep as text."""
    by_id = {row.id: row for row in data.points}
    ends = ", ".join(f"{count} {end}" for end, count in data.ends.items())
    lines = [f"{len(data.points)} points: {ends}", *_reasons(data), *_accuracy(data), ""]
    if data.front:
        objectives = ", ".join(data.objectives)
        lines += [f"Pareto front of {objectives}: {len(data.front)} points", terminal(_front_table(data))]
        more = len(data.front) - _MOST_ROWS
        lines += [f"and {more} more, in {data.files.table}"] * (more > 0) + [""]
    lines += [f"{name}: {one} ({point_words(data.points, by_id[one])})" for name, one in data.picks.items()]
    lines += [str(folder / file) for file in (data.files.page, data.files.table, data.files.parquet)]
    return "\n".join(lines)


def _front_table(data: SweepResult) -> ResultTable:
    """Return the points of the front, the original first where it is known."""
    original = data.original
    chosen = [row for row in data.points if row.id in set(data.front)][:_MOST_ROWS]
    known = {name: digits for name, digits in _QUANTITIES.items() if name in chosen[0].numbers}
    keys = dict.fromkeys(data.varied, 4)
    apart = {"design": 0} if _designs(data.points) > 1 else {}
    rows: list[Row] = [_row(row, row.id, keys, known) for row in chosen]
    if original.status == DONE:
        rows.insert(0, _row(original, "original", keys, known))
    return ResultTable({"point": 0, **apart, **keys, **known}, tuple(rows))


def _designs(points: Sequence[PointResult]) -> int:
    """Return how many designs the points are variants of."""
    return len({point.design for point in points})


def _row(
    row: PointResult, name: str, keys: Mapping[str, int], quantities: Mapping[str, int]
) -> dict[str, Any]:
    cells = {key: _cell(row.varied.get(key)) for key in keys}
    told = {quantity: row.number(quantity) for quantity in quantities}
    return {"point": name, "design": row.design, **cells, **told}


def _cell(value: Any) -> str | None:
    if value is None:
        return None
    return f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else str(value)


def point_words(points: Sequence[PointResult], row: PointResult) -> str:
    """Return what tells a point from the others: its design where there are several, and what varied."""
    values = [f"{key} = {_cell(value)}" for key, value in row.varied.items()]
    return ", ".join([row.design, *values] if _designs(points) > 1 or not values else values)


def _reasons(data: SweepResult) -> list[str]:
    """Return the first reasons why points have no numbers."""
    found = list(dict.fromkeys(f"{row.status}: {row.reason}" for row in data.points if row.reason))
    more = [f"  and {len(found) - _MOST_REASONS} other reasons"] * (len(found) > _MOST_REASONS)
    return [f"  {line}" for line in found[:_MOST_REASONS]] + more


def _accuracy(data: SweepResult) -> list[str]:
    """How many points stand at full accuracy where not all do, and whether that is enough for the front."""
    coarse = sum(row.number("accuracy") == COARSE for row in data.points)
    left = len(data.undecided or ())
    told = f"{len(data.points) - coarse} points at full accuracy, {coarse} coarse"
    may = f"{left} coarse points may be on the front: the budget is used" if left else ""
    return [line for line in (may, told) if line] if coarse else []
