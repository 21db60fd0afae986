"""The script for large grids: what it expects of a GPU, when designs agree, and that it runs without one."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.benchmarks.gpu import SHEETS, differences, expectation

# A million cells in 1 000 bytes each, 5 s per iteration at 4 GB/s: 20 GB are moved.
ROW = {"cells": 1_000_000, "peak_MiB": 1e9 / 2**20, "iteration_s": 5.0, "GB_s": 4.0}


def test_seconds_follow_the_bytes_moved_and_room_the_bytes_kept() -> None:
    head, _, small, large = expectation(ROW, ("100x100x100", "400x400x500"))
    names = [cell.split(",")[0].strip() for cell in head.split("|")[2:-1]]
    told = dict(zip(names, (cell.strip() for cell in large.split("|")[2:-1]), strict=True))
    assert names == list(SHEETS)
    assert f"{20 / 484:.2g} s" in small
    assert told["GTX 1080 Ti"] == "no room"  # 80 GB into 11
    assert told["H200"] == f"{80 * 20 / 4800:.2g} s"


def test_designs_are_compared_where_two_devices_have_them() -> None:
    rows = [
        {"grid": "a", "compliance": 200.0},
        {"grid": "b", "compliance": 1.0},
        {"grid": "a", "compliance": 201.0},
        {"grid": "b", "failure": "exit 1"},
    ]
    assert differences(rows) == {"a": pytest.approx(0.5)}


@pytest.mark.slow
def test_the_script_runs_without_a_gpu() -> None:
    """Two compilations: `pytest -m slow tests/unit/house/test_gpu_script.py`."""
    command = [sys.executable, "-m", "tests.benchmarks.gpu", "8x4x6", "1000x1000x1000", "--cpu-cells", "1000"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    rows = [line for line in done.stdout.splitlines() if line.startswith("| cpu")]
    assert len(rows) == 1
    assert "8x4x6 | 192 |" in rows[0]
    assert "exit" not in rows[0]
