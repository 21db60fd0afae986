"""A run on one core and on two: the same but for the last digits, in which XLA's sums differ."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

WORDS = (
    "optimise mikron-iiic-plain --volume-fraction 0.3 --resolution-mm 4.5 --max-iterations 5 --no-bound -q"
)
SAME = 1e-9
"""Relative difference of what two runs tell of every iteration."""
TIMES = ("seconds",)
"""Columns of the history that no two runs share."""


def history(out: Path, cores: set[int]) -> list[dict[str, str]]:
    """Return the iterations of a run on some cores."""
    subprocess.run(
        [sys.executable, "-m", "cranktopo", *WORDS.split(), "--out", str(out)],
        preexec_fn=lambda: os.sched_setaffinity(0, cores),
        check=False,  # it ends by its number of iterations
        capture_output=True,
    )
    with (out / "history.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system does not bind to cores")
def test_histories_agree(tmp_path: Path) -> None:
    cores = sorted(os.sched_getaffinity(0))
    if len(cores) < 2:
        pytest.skip("one core alone")
    one, two = (history(tmp_path / f"on-{count}", set(cores[:count])) for count in (1, 2))
    assert len(one) == len(two) == 5
    for row, other in zip(one, two, strict=True):
        assert row.keys() == other.keys()
        for name in (name for name in row if not name.endswith(TIMES)):
            assert float(row[name] or 0) == pytest.approx(float(other[name] or 0), rel=SAME), name
