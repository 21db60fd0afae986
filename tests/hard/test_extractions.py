"""No density of an optimisation is refused: 300 of them, half in boxes and half in re-modelled webs.

`python -m pytest tests/hard/test_extractions.py -m slow -n 0 -s` takes many minutes, most of them for
compiling; `python -m tests.hard.extractions 0 150` prints the same surfaces one by one.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from tests.hard.extractions import Case, case, line, results, way_of

CHUNKS, IN_CHUNK = 6, 25
"""Optimisations; each gives two surfaces."""


@pytest.fixture(scope="module")
def envelopes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Re-modelled webs, written where a case first asks for them."""
    return tmp_path_factory.mktemp("envelopes")


def check(cases: dict[int, Case], folder: Path) -> None:
    ways: Counter[str] = Counter()
    refused = []
    for seed, made in cases.items():
        for result in results(made, folder):
            ways[way_of(result)] += 1
            refused += [line(seed, result)] if result.found is None else []
    print(dict(ways))
    assert not refused, "\n".join(refused)
    assert ways.total() == 2 * len(cases)


@pytest.mark.slow
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_no_surface_is_refused(chunk: int, envelopes: Path) -> None:
    seeds = range(chunk * IN_CHUNK, (chunk + 1) * IN_CHUNK)
    check({seed: case(seed) for seed in seeds}, envelopes)


def test_the_cases_are_spread() -> None:
    """Both engines, envelopes and processes alike; fractions and cells over their ranges."""
    cases = [case(seed) for seed in range(CHUNKS * IN_CHUNK)]
    kinds = Counter((made.engine, made.web is None, made.process) for made in cases)
    assert len(kinds) == 8
    assert min(kinds.values()) >= 18
    fractions = [made.volume_fraction for made in cases]
    assert min(fractions) < 0.15
    assert max(fractions) > 0.55
    assert {made.cell_mm for made in cases} >= {2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0}
    assert len({made.web for made in cases if made.web is not None}) == 7
