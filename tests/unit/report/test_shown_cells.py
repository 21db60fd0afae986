"""Cells of tables on a page: as many digits as their error leaves sense, thousands in groups."""

from __future__ import annotations

import pytest

from cranktopo.report.result_table import ResultTable


def shown(column: str, digits: int, *values: float | str | None) -> list[str]:
    table = ResultTable({"name": 0, column: digits}, tuple({"name": "a", column: value} for value in values))
    return [table.page_cell(row, column) for row in range(len(values))]


@pytest.mark.parametrize(
    ("column", "digits", "values", "cells"),
    [
        ("force_N", 1, (2364.82, 61.47, -0.04), ["2365", "61", "0"]),
        ("torsion_kNm_per_rad", 2, (137.331, 99.404), ["137.3", "99.4"]),
        ("moment_Nm", 2, (16675.57, 2240.14), ["16,676", "2240"]),
        ("mass_kg", 3, (1.4752, None), ["1.475", "-"]),
        ("width_mm", 2, (1165.004, 3.0), ["1165.00", "3.00"]),
        ("value", 1, (154051.14, 9.72), ["154,051", "9.7"]),
        ("life_h", 0, (float("inf"), 12.0), ["inf", "12"]),
        ("part", 0, ("pin fillet",), ["pin fillet"]),
        ("inertia_kg_mm2", 0, (0.48712, 0.00211), ["0.487", "0.002"]),
    ],
)
def test_digits(column: str, digits: int, values: tuple[float | str | None, ...], cells: list[str]) -> None:
    assert shown(column, digits, *values) == cells


def test_the_best_keeps_its_star() -> None:
    table = ResultTable({"mass_kg": 3}, ({"mass_kg": 12345.0},), frozenset({(0, "mass_kg")}))
    assert table.page_cell(0, "mass_kg") == "12,345*"
    assert table.cell(0, "mass_kg") == "12345.000*"


@pytest.mark.parametrize(
    ("column", "digits", "values", "cells"),
    [
        ("unbalance_kg_mm", 2, (0.03614, -0.0082), ["0.0361", "-0.0082"]),
        ("inertia_kg_mm2", 0, (0.48712,), ["0.487"]),
        ("max_N", 0, (9.744, None), ["9.74", "-"]),
        ("max_N", 0, (97.44, None), ["97", "-"]),
        ("unbalance_kg_mm", 2, (113.38, 0.004), ["113.38", "0.00"]),
        ("moment_Nm", 2, (3e-13,), ["0.00"]),
        ("error_percent", 1, (0.04,), ["0.0"]),
        ("time_s", 1, (2.71,), ["2.7"]),
    ],
)
def test_what_a_small_crank_has_is_no_zero(
    column: str, digits: int, values: tuple[float | None, ...], cells: list[str]
) -> None:
    """A model engine's crank had an inertia of 0 kg mm2 and an unbalance of 0.01 kg mm."""
    table = ResultTable({"name": 0, column: digits}, tuple({"name": "a", column: value} for value in values))
    assert [table.cell(row, column) for row in range(len(values))] == cells
