"""Thousands of scenes with all features through the commands that need no elements, in one warm process.

Nothing is held back: each ends in a result without NaN, or in one line that says why not.
`python -m tests.hostile.test_full_scenes FIRST COUNT` prints the counts by command and exit code, and faults.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NoReturn

import pytest

from tests.hostile.full_scenes import full_case
from tests.hostile.outcome import Outcome, run_case

QUICK, SLOW = 9, 5000
_NO_NUMBER = re.compile(r"(?<![\w.'-])[+-]?(nan|inf)(?![\w'-])", re.IGNORECASE)


def untold(ended: Outcome) -> list[str]:
    """Return what a command printed amiss: a number that is none, or JSON that is not strict."""
    faults = [f"tells {found[0]}" for found in [_NO_NUMBER.search(ended.stdout + ended.stderr)] if found]
    if ended.stdout.startswith(("{", "[")):
        try:
            json.loads(ended.stdout, parse_constant=_refused)
        except ValueError as error:
            faults.append(f"its JSON: {error}")
    return faults


def _refused(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number")


def faults_of(seeds: range, folder: Path) -> tuple[list[str], Counter[tuple[str, int]], float]:
    """Faults by seed, number of cases by command and exit code, and the longest time, s."""
    faults, codes, longest = list[str](), Counter[tuple[str, int]](), 0.0
    for seed in seeds:
        place = folder / str(seed)
        place.mkdir()
        case = full_case(seed)
        ended = run_case(case, place)
        codes[case.arguments[0], int(ended.code)] += 1
        longest = max(longest, ended.seconds)
        found = [*ended.faults, *untold(ended)]
        if found:
            faults.append(
                f"seed {seed}: {' '.join(case.arguments)}: {'; '.join(found)}: {ended.stderr[-300:]}"
            )
        if (seed - seeds.start) % 100 == 99:
            print(seed, sum(codes.values()), *faults[-3:], file=sys.stderr, flush=True)
    return faults, codes, longest


def test_full_scenes(tmp_path: Path) -> None:
    faults, codes, _ = faults_of(range(QUICK), tmp_path)
    assert not faults, "\n".join(faults)
    assert sum(count for (_, code), count in codes.items() if code == 0) > QUICK / 3, "most are valid"


@pytest.mark.slow
def test_thousands_of_full_scenes(tmp_path: Path) -> None:
    faults, _, _ = faults_of(range(QUICK, QUICK + SLOW), tmp_path)
    assert not faults, "\n".join(faults)


if __name__ == "__main__":
    first, count = int(sys.argv[1]), int(sys.argv[2])
    began = time.process_time()
    with tempfile.TemporaryDirectory() as where:
        told, by_code, most = faults_of(range(first, first + count), Path(where))
    print("\n".join(told))
    print(f"{count} scenes, {time.process_time() - began:.0f} s of the processor, longest {most:.1f} s")
    print(f"{len(told)} faults; by command and exit code: {dict(sorted(by_code.items()))}")
