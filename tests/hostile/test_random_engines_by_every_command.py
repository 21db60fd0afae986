"""Random engines with all features through every command, free and by every process, at 1 to 3 mm cells.

`python -m tests.hostile.test_random_engines_by_every_command FIRST COUNT [cheap|dear]` prints a table; an
engine takes minutes. Of the dear commands, one engine goes through one, in turn; the third word leaves them
out, or all others. They are shorter than at their defaults, which the built-in designs go through.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.hostile.featured_engines import featured_engine
from tests.hostile.scenes import dumped
from tests.hostile.test_every_design_by_every_command import CHEAP, DEAR, LEFT, OF_A_RUN, Row, rows
from tests.hostile.watched import ENVIRONMENT

ENGINES = 60
CELLS_MM = 1.0, 3.0
_JOURNAL_MM = 55.0
"""Main journal that those cells are meant for; others have cells in proportion."""
_LACKING = {"film", "bolts", "rod", "balancer"}
"""Commands whose tables they do not have; built-in designs go through these."""
_OF_ONE_WEB = ("optimise", "bound", "shape", "iterate")
_SHORTER = {
    "accuracy": ["--budget", "30s"],
    "shape": ["--no-bound"],
    "iterate": ["--steps", "2", "--no-shape", "--no-bound"],
}
"""Options of dear commands: what they leave out, other engines go through."""
_SAFE = 3
"""Of so many engines that go through `shape`, one is searched for with its safety, which takes minutes."""


def rows_of(seed: int, folder: Path, only: str = "") -> Iterator[Row]:
    """Run the engine of a seed through the commands, only the cheap or only the dear ones if so told."""
    data = featured_engine(seed)
    folder.mkdir(parents=True)
    (folder / "engine.toml").write_text(dumped(data), encoding="utf-8")
    low, high = (math.log(cell) for cell in CELLS_MM)
    cell = math.exp(np.random.default_rng((seed, 1)).uniform(low, high)) / _JOURNAL_MM
    size = f"{cell * data['throw']['main_journal']['outer_diameter_mm']:.4g}"
    web = ["--web", ("first", "second")[seed % 2]] if "second_web" in data else []
    more = {name: list(web) for name in _OF_ONE_WEB}
    for name, options in _SHORTER.items():
        more[name] = [*more.get(name, ()), *options]
    for name in ("optimise", "iterate"):
        more[name] += ["--resolution-mm", size]
    cheap = [name for name in (*CHEAP, *OF_A_RUN) if name not in _LACKING]
    dear = [list(DEAR)[seed % len(DEAR)]]
    if seed // len(DEAR) % _SAFE:
        more["shape"] += ["--limit", "fatigue_safety none"]
    dear = ["optimise", *dear] if only == "dear" and dear[0] in LEFT else dear  # a run for it
    names = {"": cheap + dear, "cheap": cheap, "dear": dear}[only]
    yield from rows("engine.toml", names, folder, more)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(ENGINES))
def test_a_random_engine_by_every_command(seed: int, tmp_path: Path) -> None:
    assert not [str(row) for row in rows_of(seed, tmp_path / "engine") if row.fault]


if __name__ == "__main__":
    first, count = int(sys.argv[1]), int(sys.argv[2])
    found = list[Row]()
    print("| design | command | exit code | s | last line | fault |\n|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as where:
        ENVIRONMENT["XDG_CACHE_HOME"] = str(Path(where) / "cache")  # `accuracy` keeps its studies there
        for number in range(first, first + count):
            for row in rows_of(number, Path(where) / str(number), *sys.argv[3:4]):
                print(str(row).replace("engine.toml", f"engine {number}"), flush=True)
                found.append(row)
    print(f"{len(found)} tries, {sum(bool(row.fault) for row in found)} faults")
