"""Solves on several simulated devices against one: mirrors, sections and springs of two lopsided cases."""

from typing import Any

import pytest

from cranktopo.numerics.grid.conjugate_gradients import devices_for, partition_of
from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.numerics.grid.multigrid import build_tables
from cranktopo.numerics.grid.partition import Partition
from tests.studies.parts import TOLERANCE, in_own_process


@pytest.mark.slow
def test_parts_find_the_displacements_of_the_whole() -> None:
    """Two parts of the grid cut every level but the coarsest, eight the finest alone."""
    rows = in_own_process("8x12x24", (2, 8))
    assert [row["levels"] for row in rows] == [2, 1]
    for row in rows:
        _agrees(row)


@pytest.mark.slow
def test_devices_share_the_memory() -> None:
    """What is left on each beyond its share are interfaces and the coarsest grids."""
    one, *shared = in_own_process("64x64x128", (1, 2, 4, 8))
    for row in shared:
        _agrees(row)
        assert row["device_bytes"] < 2 * one["device_bytes"] / row["parts"]


def _agrees(row: dict[str, Any]) -> None:
    assert row["residual"] <= TOLERANCE
    assert row["difference"] < 1e-12
    assert row["iterations"] == row["iterations_on_one"]


@pytest.mark.parametrize(("layers", "parts", "levels"), [(32, 2, 3), (32, 4, 3), (24, 8, 1), (24, 3, 3)])
def test_levels_are_cut_while_their_parts_are_equal(layers: int, parts: int, levels: int) -> None:
    """Layers 32, 16, 8 and 24, 12, 6: the dense coarsest level is never cut."""
    tables = build_tables(Lattice((16, 16, layers), 1.0, 1.0, (1.0,) * layers, 0.3), 3)
    assert partition_of(tables, parts) == Partition(parts, levels)


def test_one_device_is_all_that_this_process_has() -> None:
    """However large the grid."""
    assert devices_for((512, 512, 512)) == 1
