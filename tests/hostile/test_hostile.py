"""Generated hostile inputs: no internal error, no traceback, no hang, nothing written.

`python -m tests.hostile.test_hostile FIRST COUNT` prints a summary by exit code and every fault.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest

from tests.hostile.commands import case
from tests.hostile.outcome import run_case, stubbed

QUICK, SLOW = 60, 5000


def faults_of(seeds: range, folder: Path) -> tuple[list[str], Counter[int], float]:
    """Faults by seed, number of cases by exit code, and the longest time, s."""
    faults, codes, longest = [], Counter[int](), 0.0
    with stubbed():
        for seed in seeds:
            place = folder / str(seed)
            place.mkdir()
            made = case(seed)
            outcome = run_case(made, place)
            codes[outcome.code] += 1
            longest = max(longest, outcome.seconds)
            if outcome.faults:
                what = "; ".join(outcome.faults)
                faults.append(f"seed {seed}: {made.arguments!r:.200}: {what}: {outcome.stderr[:300]}")
    return faults, codes, longest


def test_hostile_inputs(tmp_path: Path) -> None:
    faults, codes, _ = faults_of(range(QUICK), tmp_path)
    assert not faults, "\n".join(faults)
    assert codes[0] > QUICK / 50, "some are harmless, or the generator breaks everything"
    assert codes[3] > QUICK / 3
    assert codes[2] > QUICK / 20


@pytest.mark.slow
def test_thousands_of_hostile_inputs(tmp_path: Path) -> None:
    faults, codes, longest = faults_of(range(QUICK, QUICK + SLOW), tmp_path)
    print(dict(sorted(codes.items())), f"longest {longest:.1f} s")
    assert not faults, "\n".join(faults)


if __name__ == "__main__":
    first, count = int(sys.argv[1]), int(sys.argv[2])
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as name:
        found, by_code, most = faults_of(range(first, first + count), Path(name))
    print("\n".join(found))
    took = time.perf_counter() - started
    print(f"{count} cases in {took:.0f} s, longest {most:.2f} s, {len(found)} faults; cases by exit code:")
    print(dict(sorted(by_code.items())))
