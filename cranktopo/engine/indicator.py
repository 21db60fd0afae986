"""A measured indicator diagram: CSV of crank angle and absolute cylinder pressure."""

from __future__ import annotations

import csv
import math
import re
from itertools import pairwise
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import read_text_file
from cranktopo.engine.indicator_header import (
    HEADER_HINT,
    UnusableError,
    is_row_of_units,
    trace_columns,
    with_units,
)

TRACE_ENCODING = "cp1252"
"""Of a file that is not in UTF-8: German Windows programs write it. Numbers are the same in both."""
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LARGEST = 1e9
_HIGHEST_MPA = 50.0
_SAME_POINT = 0.05
"""Part of the peak by which begin and end of a cycle may differ: cycles of an engine scatter."""
_LARGEST_STEP_DEG = 5.0


def read_indicator(
    path: str | Path, cycle_deg: float, ambient_pressure_MPa: float, firing_deg: float = 0.0
) -> tuple[Array, Array]:
    """Return ascending angles (deg) and absolute pressures (MPa) of an indicator diagram over one cycle.

    The header, or a row of units below it, names the columns and their units: an angle in deg and an absolute
    pressure in bar, MPa, kPa, hPa, mbar or Pa. Text is UTF-8 or cp1252. Angles of the file ascend and cover
    one cycle from any start; those returned count from firing top dead centre, which the file has at
    `firing_deg`. Comma, semicolon or tab stand between columns; lines with # are skipped. A decimal comma is
    read where the columns are not separated by commas.

    Raises:
        CranktopoError: unreadable, no unit, several pressures, missing, duplicate or descending angles, wrong
            period, a value that is not a number, a pressure below vacuum or out of any engine's range.
    """
    name = f"engine.gas.indicator_csv = {quoted(str(path), 400)}"
    try:
        lines = _read_lines(path, name)
        mark = _separator(lines[0][1])
        header, *rows = [_cells(number, line, mark) for number, line in lines]
        numbers = [number for number, _ in lines[1:]]
        _check_width(header, rows, numbers, mark)
        if is_row_of_units(rows[0]):
            header, rows, numbers = with_units(header, rows[0]), rows[1:], numbers[1:]
        columns = trace_columns(header)
        angle = _column(rows, numbers, columns.angle, mark)
        pressure = _column(rows, numbers, columns.pressure, mark) * columns.factor
        _check_ascending(angle, numbers)
        _check_pressure(pressure, numbers, ambient_pressure_MPa)
        return _one_cycle(angle, pressure, cycle_deg, firing_deg)
    except UnusableError as error:
        raise CranktopoError(f"{name}: {error}.", hint=error.hint) from None


def _read_lines(path: str | Path, name: str) -> list[tuple[int, str]]:
    hint = "Names are relative to the folder of the design."
    text = read_text_file(path, name, hint=hint, otherwise=TRACE_ENCODING)
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1)]
    lines = [(number, line) for number, line in lines if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 3:
        raise UnusableError("has no rows of numbers", HEADER_HINT)
    return lines


def _separator(header: str) -> str:
    """A name may hold a comma where semicolons or tabs stand between the columns."""
    return next((mark for mark in ";\t" if mark in header), ",")


def _cells(number: int, line: str, mark: str) -> list[str]:
    """Cells of one line; a line break inside quotes is no part of a table of numbers."""
    try:
        (cells,) = csv.reader([line], delimiter=mark, strict=True)
    except csv.Error:
        raise UnusableError(f"line {number}: a quote is not closed", "Remove the quotes.") from None
    return [cell.strip() for cell in cells]


def _check_width(header: list[str], rows: list[list[str]], numbers: list[int], mark: str) -> None:
    """No row may hold more cells than the header: a decimal comma would become a column."""
    width = len(header)
    for number, row in zip(numbers, rows, strict=True):
        if any(row[width:]):
            hint = "With a decimal comma, put semicolons between the columns." if mark == "," else ""
            raise UnusableError(f"line {number}: {len(row)} cells under a header of {width}", hint)


def _column(rows: list[list[str]], numbers: list[int], column: int, mark: str) -> Array:
    cells = [row[column] if column < len(row) else "" for row in rows]
    decimal_comma = mark != "," and any("," in cell for cell in cells)
    values = []
    for number, cell in zip(numbers, cells, strict=True):
        text = cell.replace(",", ".") if decimal_comma and "." not in cell else cell
        if not _NUMBER.fullmatch(text):
            raise UnusableError(
                f"line {number}: {quoted(cell)} is not a number", "Correct or remove that row."
            )
        if abs(float(text)) > _LARGEST:
            raise UnusableError(f"line {number}: {quoted(cell)} is out of any range", "Correct that row.")
        if decimal_comma and "." in cell:
            raise UnusableError(f"line {number}: {quoted(cell)} beside decimal commas", "Use one of the two.")
        values.append(float(text))
    return np.array(values)


def _check_ascending(angle: Array, numbers: list[int]) -> None:
    for number, (before, after) in zip(numbers[1:], pairwise(angle), strict=True):
        if after <= before:
            what = "repeats" if after == before else "falls below"
            raise UnusableError(
                f"line {number}: angle {after:g} deg {what} the one before ({before:g} deg)",
                "Angles must ascend; sort the rows and remove duplicates.",
            )


def _check_pressure(pressure: Array, numbers: list[int], ambient_MPa: float) -> None:
    lowest = int(pressure.argmin())
    if pressure[lowest] < 0:
        raise UnusableError(
            f"line {numbers[lowest]}: pressure {pressure[lowest]:g} MPa is below vacuum",
            "Pressures must be absolute, not gauge.",
        )
    peak = float(pressure.max())
    if not 2 * ambient_MPa < peak < _HIGHEST_MPA:
        raise UnusableError(
            f"peak pressure {peak:g} MPa is outside {2 * ambient_MPa:.3g} to {_HIGHEST_MPA:g} MPa",
            "Check the unit in the header.",
        )


def _one_cycle(angle: Array, pressure: Array, cycle_deg: float, firing_deg: float) -> tuple[Array, Array]:
    """Points from firing top dead centre, after a check that they cover one cycle and without gaps."""
    span = float(angle[-1] - angle[0])
    if not cycle_deg - _LARGEST_STEP_DEG <= span <= cycle_deg * (1 + 1e-9):
        raise UnusableError(
            f"angles span {span:g} deg, not one cycle of {cycle_deg:g} deg",
            "Correct the file or engine.strokes.",
        )
    if math.isclose(span, cycle_deg):  # the last point is the first one of the next cycle
        if abs(pressure[-1] - pressure[0]) > _SAME_POINT * pressure.max():
            raise UnusableError(
                f"the rows at {angle[0]:g} and {angle[-1]:g} deg are the same point of the cycle and have "
                f"{pressure[0]:.4g} and {pressure[-1]:.4g} MPa",
                "Correct one of them, or leave the last row out.",
            )
        angle, pressure = angle[:-1], pressure[:-1]
    _check_gaps(angle, np.diff(np.append(angle, angle[0] + cycle_deg)))
    wrapped = np.mod(angle - firing_deg, cycle_deg)
    order = np.argsort(wrapped)
    return wrapped[order], pressure[order]


def _check_gaps(angle: Array, gaps: Array) -> None:
    """A step may change along the file, but none may stand out against both of its neighbours."""
    usual = np.maximum(np.roll(gaps, 1), np.roll(gaps, -1))
    worst = int((gaps / usual).argmax())
    if gaps[worst] > 1.5 * usual[worst] or gaps.max() > _LARGEST_STEP_DEG:
        worst = worst if gaps[worst] > 1.5 * usual[worst] else int(gaps.argmax())
        raise UnusableError(
            f"angles are missing between {angle[worst]:g} and {angle[worst] + gaps[worst]:g} deg",
            f"Steps may not exceed {_LARGEST_STEP_DEG:g} deg nor 1.5 times the steps around them.",
        )
