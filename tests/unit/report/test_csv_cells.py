"""CSV for spreadsheets: a name that looks like a formula is text there, numbers and plain names stay."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pandas as pd
import pytest

from cranktopo.report.result_table import ResultTable, comma_separated
from cranktopo.tasks.sweep.text import write_tables


@pytest.mark.parametrize("name", ["=1+1|cmd", "+1+1", "-1+1", "@SUM(A1)", "\t=1"])
def test_a_formula_is_text(name: str, tmp_path: Path) -> None:
    table = ResultTable({"target": 0, "change_percent": 1}, ({"target": name, "change_percent": -1.5},))
    (row,) = csv.DictReader(io.StringIO(comma_separated(table)))
    assert row == {"target": f"'{name}", "change_percent": "-1.5"}
    write_tables(pd.DataFrame([{"design": name, "mass_kg": -1.5}]), tmp_path, "sweep")
    (row,) = csv.DictReader(io.StringIO((tmp_path / "sweep.csv").read_text(encoding="utf-8")))
    assert row == {"design": f"'{name}", "mass_kg": "-1.5"}


def test_names_and_dashes_stay() -> None:
    table = ResultTable({"target": 0}, ({"target": "mikron-iiic"}, {"target": "-"}))
    assert comma_separated(table).splitlines() == ["target", "mikron-iiic", "-"]
