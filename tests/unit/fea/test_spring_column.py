"""Table of an evaluation: the stiffness that its errors and its last line are of has a column."""

from __future__ import annotations

import pytest

from cranktopo.report.result_table import terminal
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.quantities import evaluation_table, result_line
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness


def evaluated(torsion: str = "free", bending: str = "pinned") -> Evaluation:
    """A single-cylinder diesel on plain bearings."""
    fine = Stiffness(
        {"free": 438650.0, "held": 574890.0, "spring": 501230.0},
        {"pinned": 947710.0, "clamped": 3511300.0, "spring": 683580.0},
        45222,
        4.8,
        1.0,
        1.0,
    )
    error = 0.47 if bending == "spring" else 0.63
    return Evaluation(bending, 6.152, 2.547, 12982.0, -37.22, fine, torsion, bending, 0.23, error, 26.2)


@pytest.mark.parametrize(
    ("torsion", "bending", "expected"),
    [
        ("free", "pinned", {}),
        ("free", "clamped", {}),
        ("free", "spring", {"bending_spring_kN_per_mm": 683.58}),
        ("spring", "pinned", {"torsion_spring_kNm_per_rad": 501.23}),
    ],
)
def test_the_stiffness_that_is_judged_has_a_column(
    torsion: str, bending: str, expected: dict[str, float]
) -> None:
    """With `supports.bending = "spring"` the table had its error beside those of rigid bearings."""
    (row,) = evaluation_table([evaluated(torsion, bending)]).rows
    found = {name: value for name, value in row.items() if "spring" in name}
    assert found == pytest.approx(expected)


def test_beside_a_design_on_rigid_bearings_each_row_has_its_own_error() -> None:
    table = evaluation_table([evaluated(bending="spring"), evaluated()])
    assert [row["bending_spring_kN_per_mm"] for row in table.rows] == [683.58, 683.58]
    assert [row["bending_error_percent"] for row in table.rows] == [0.47, 0.63]
    assert "bending spring" in terminal(table)


def test_the_line_names_a_support_that_is_not_the_default() -> None:
    assert "bending (spring) 683.58 kN/mm, +-0.47 %" in result_line(evaluated(bending="spring"))
    assert "torsion 438.65 kN m/rad, +-0.23 %; bending 947.71 kN/mm" in result_line(evaluated())
