"""A finished sweep as text: how the points ended, the front, the picks."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.files import replacing, write_text
from cranktopo.base.units import plain_number
from cranktopo.engine.judged_histories import states_words
from cranktopo.report.result_table import ResultTable, Row, no_formula, terminal
from cranktopo.tasks.sweep.result import COARSE, DONE, PointResult, SweepResult
from cranktopo.tasks.throw_fea.quantities import SAFETY

if TYPE_CHECKING:
    import pandas


_FIRST = ("id", "original", "status", "design", "stage", "accuracy")
_LAST = ("optimiser_status", "iterations", "limits_hold", "seconds", "reason", "run", "sha256", "version")
_LEFT_OUT = ("varied", "target")


def frame_of(
    points: Sequence[PointResult], original: PointResult, front: Sequence[str] = ()
) -> pandas.DataFrame:
    """Return one row per point: its keys, its quantities, how it ended, its hash and version.

    The first row is the original, unless it is one of the points.
    """
    import pandas as pd

    rows = points if any(point.id == original.id for point in points) else (original, *points)
    flat = [
        _flat(row) | {"original": row.id == original.id, "on_front": row.id in set(front)} for row in rows
    ]
    names = list(dict.fromkeys(name for row in flat for name in row))
    middle = [name for name in names if name not in (*_FIRST, *_LAST)]
    order = [name for name in (*_FIRST, *middle, *_LAST) if name in names]
    frame = pd.DataFrame([{name: row.get(name) for name in order} for row in flat], columns=order)
    return frame.apply(_plain)


def write_tables(frame: pandas.DataFrame, folder: Path, stem: str) -> dict[str, str]:
    """Write the frame as CSV and Parquet, and return their names by kind."""
    table, parquet = f"{stem}.csv", f"{stem}.parquet"
    text = io.StringIO()
    frame.map(no_formula).to_csv(text, index=False, lineterminator="\n")
    write_text(folder / table, text.getvalue())
    with replacing(folder / parquet) as temporary:
        frame.to_parquet(temporary, index=False)
    return {"table": table, "parquet": parquet}


def _flat(point: PointResult) -> dict[str, Any]:
    """Return what varied beside what came of it; a quantity that is called like a key is the quantity."""
    values = {name: value for name, value in point.row().items() if name not in _LEFT_OUT}
    return {**{name: values[name] for name in _FIRST if name in values}, **point.varied, **values}


def _plain(column: pandas.Series) -> pandas.Series:
    """Return a column of words and numbers, as of a key that takes both, is one of words."""
    kinds = {type(value) for value in column if value is not None and value == value}
    mixed = len(kinds) > 1 and not kinds <= {int, float}
    return column.map(lambda value: value if value is None else str(value)) if mixed else column


_QUANTITIES = {"mass_kg": 3, "torsion_Nm_per_rad": 2, "bending_N_per_mm": 2, "fatigue_safety": 3}
"""Decimals as they are shown."""
_IN_THOUSANDS = {
    "torsion_Nm_per_rad": "torsion_kNm_per_rad",
    "bending_N_per_mm": "bending_kN_per_mm",
    "torsion_per_mass_Nm_per_rad_kg": "torsion_per_mass_kNm_per_rad_kg",
    "bending_per_mass_N_per_mm_kg": "bending_per_mass_kN_per_mm_kg",
}
"""Stiffnesses as every table for readers has them, by their names in CSV and JSON."""
_MOST_ROWS = 20
_MOST_REASONS = 3


def sweep_summary(data: SweepResult, folder: Path) -> str:
    """Return a finished sweep as text."""
    by_id = {row.id: row for row in data.points}
    ends = ", ".join(f"{count} {end}" for end, count in data.ends.items())
    lines = [
        f"{len(data.points)} points: {ends}",
        *(data.left_off or ()),
        *_reasons(data),
        *_accuracy(data),
        *_conditions(data),
        "",
    ]
    if data.front:
        objectives = ", ".join(ResultTable({}, ()).head(name)[0] for name in data.objectives)
        lines += [f"Pareto front of {objectives}: {len(data.front)} points", terminal(_front_table(data))]
        more = len(data.front) - _MOST_ROWS
        lines += [f"and {more} more, in {data.files.table}"] * (more > 0) + [""]
    for name, one in data.picks.items():
        lines.append(f"{name}: {one} ({point_words(data.points, by_id[one])}){safety_words(by_id[one])}")
    lines += [str(folder / file) for file in (data.files.page, data.files.table, data.files.parquet)]
    return "\n".join(lines)


def _front_table(data: SweepResult) -> ResultTable:
    chosen = [row for row in data.points if row.id in set(data.front)][:_MOST_ROWS]
    known = {name: digits for name, digits in _QUANTITIES.items() if name in chosen[0].numbers}
    apart = {"design": 0} if _designs(data.points) > 1 else {}
    original = [("original", data.original)] if data.original.status == DONE else []
    rows: list[Row] = [
        {
            "point": name,
            "design": row.design,
            **{key: _cell(row.varied.get(key)) for key in data.varied},
            **{reader_name(quantity): reader_number(quantity, row.number(quantity)) for quantity in known},
        }
        for name, row in [*original, *((row.id, row) for row in chosen)]
    ]
    columns = {reader_name(quantity): digits for quantity, digits in known.items()}
    return ResultTable({"point": 0, **apart, **dict.fromkeys(data.varied, 4), **columns}, tuple(rows))


def reader_name(quantity: str) -> str:
    """Return the name of a quantity in the unit that readers are shown."""
    return _IN_THOUSANDS.get(quantity, quantity)


def reader_number(quantity: str, value: float | None) -> float | None:
    """Return a value of a quantity in the unit that readers are shown."""
    return value / 1000 if value is not None and quantity in _IN_THOUSANDS else value


def _designs(points: Sequence[PointResult]) -> int:
    return len({point.design for point in points})


def _cell(value: Any) -> str | None:
    if value is None:
        return None
    return (
        plain_number(value, 6)
        if isinstance(value, int | float) and not isinstance(value, bool)
        else str(value)
    )


def point_words(points: Sequence[PointResult], row: PointResult) -> str:
    """Return what tells a point from the others: its design where there are several, and what varied."""
    values = [f"{key} = {_cell(value)}" for key, value in row.varied.items()]
    return ", ".join([row.design, *values] if _designs(points) > 1 or not values else values)


def safety_words(row: PointResult) -> str:
    """Return the least safety of a point, its load states and place; empty where none is known."""
    safety, place = row.number("fatigue_safety"), row.number("fatigue_place")
    loads = row.number("fatigue_loads")
    over = f" {states_words(loads)}" if loads else ""
    lost = f"; {less}" if (less := row.number("less_safe_in_shaft")) else ""
    return f", least {SAFETY.label} {safety:.{SAFETY.digits}f}{over} at {place}{lost}" if place else ""


def _reasons(data: SweepResult) -> list[str]:
    found = list(dict.fromkeys(f"{row.status}: {row.reason}" for row in data.points if row.reason))
    more = [f"  and {len(found) - _MOST_REASONS} other reasons"] * (len(found) > _MOST_REASONS)
    return [f"  {line}" for line in found[:_MOST_REASONS]] + more


def condition_words(data: SweepResult) -> str:
    """Tell which keys that vary are no choice of the designer; empty where all are."""
    keys = data.operating_conditions
    if not keys:
        return ""
    are = "is an operating condition" if len(keys) == 1 else "are operating conditions"
    consequence = (
        "every web counts by its condition of least safety"
        if data.front
        else "so there is no front and no pick"
    )
    return f"{' and '.join(keys)} {are}, not a choice: {consequence}"


def fillet_words(data: SweepResult) -> str:
    """Tell which webs have no fillets, as surfaces of runs have none; empty where all have theirs."""
    bare = [row.stage == "optimise" for row in data.points]
    if all(bare):
        return "All webs, the original among them, are without fillets, as the surface of a run has none"
    if any(bare):
        return "Points of the stage optimise are without fillets, the original and the others have theirs"
    return ""


def _conditions(data: SweepResult) -> list[str]:
    return [words for words in (condition_words(data), fillet_words(data)) if words]


def _accuracy(data: SweepResult) -> list[str]:
    """Tell how many points stand at full accuracy where not all do, and whether the front is decided."""
    coarse = sum(row.number("accuracy") == COARSE for row in data.points)
    left = len(data.undecided or ())
    counts = f"{len(data.points) - coarse} points at full accuracy, {coarse} coarse"
    may = f"{left} coarse points may be on the front: the budget is used" if left else ""
    return [line for line in (may, counts) if line] if coarse else []
