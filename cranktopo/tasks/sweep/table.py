"""One table of all points: a pandas frame, as CSV and as Parquet."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.base.files import replacing, write_text
from cranktopo.tasks.sweep.result import PointResult

if TYPE_CHECKING:
    import pandas

_FIRST = ("id", "status", "design", "stage", "accuracy")
_LAST = ("optimiser_status", "iterations", "limits_hold", "seconds", "reason", "run", "sha256", "version")
_LEFT_OUT = ("varied", "target")


def frame_of(rows: Sequence[PointResult], front: Sequence[str] = ()) -> pandas.DataFrame:
    """Return a frame with one row per point: its keys, its quantities, how it ended, its hash and version.

    Args:
        rows: one per point.
        front: ids of the Pareto front, told in a column of its own.
    """
    import pandas as pd

    flat = [_flat(row) | {"on_front": row.id in set(front)} for row in rows]
    names = list(dict.fromkeys(name for row in flat for name in row))
    middle = [name for name in names if name not in (*_FIRST, *_LAST)]
    order = [name for name in (*_FIRST, *middle, *_LAST) if name in names]
    frame = pd.DataFrame([{name: row.get(name) for name in order} for row in flat], columns=order)
    return frame.apply(_plain)


def write_tables(frame: pandas.DataFrame, folder: Path, stem: str) -> dict[str, str]:
    """Write the frame as CSV and Parquet; returns their names by kind.

    Raises:
        CranktopoError: a file cannot be written.
    """
    files = {"table": f"{stem}.csv", "parquet": f"{stem}.parquet"}
    text = io.StringIO()
    frame.to_csv(text, index=False, lineterminator="\n")
    write_text(folder / files["table"], text.getvalue())
    with replacing(folder / files["parquet"]) as temporary:
        frame.to_parquet(temporary, index=False)
    return files


def _flat(point: PointResult) -> dict[str, Any]:
    """Return what varied beside what came of it; a quantity that is called like a key is the quantity."""
    told = {name: value for name, value in point.row().items() if name not in _LEFT_OUT}
    return {**{name: told[name] for name in _FIRST if name in told}, **point.varied, **told}


def _plain(column: pandas.Series) -> pandas.Series:
    """Return a column of words and numbers, as of a key that takes both, is one of words."""
    kinds = {type(value) for value in column if value is not None and value == value}
    mixed = len(kinds) > 1 and not kinds <= {int, float}
    return column.map(lambda value: value if value is None else str(value)) if mixed else column
