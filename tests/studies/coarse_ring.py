"""Error of the bench's coarse ring against the settled one, on random moves of several throws.

    python -m tests.studies.coarse_ring [MOVES] [SEED] [THROW ...] > coarse.csv

Each move changes one dimension of a settled web by at most 5 mm (10 deg), in proportion on journals of less
than 42 mm. A line for each quantity: what the cells say the change is, what body-fitted elements say, and the
error that the bench states, if it tells the quantity.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.design.edits import changed_data
from cranktopo.design.halves import usual_scale
from cranktopo.design.loading import design_text, scene_from_dict, value_at
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.coarse import coarse_stiffness
from cranktopo.tasks.bench.coarse_error import stated_errors
from cranktopo.tasks.bench.settled import settled_stiffness
from tests.random_engines import random_engine
from tests.studies.own_webs import DESIGNS

THROWS = (*DESIGNS, *map(str, range(1, 10)))
"""Designs that are built in, and random engines by their seeds."""
KEYS = (
    "web.width_mm",
    "web.thickness_mm",
    "throw.radius_mm",
    "throw.main_journal.outer_diameter_mm",
    "throw.main_journal.bore_diameter_mm",
    "throw.main_journal.length_mm",
    "throw.main_journal.fillet_mm",
    "throw.crankpin.outer_diameter_mm",
    "throw.crankpin.bore_diameter_mm",
    "throw.crankpin.length_mm",
    "throw.crankpin.fillet_mm",
    "web.counterweight.outer_radius_mm",
    "web.counterweight.half_angle_deg",
)
_MOST_MM, _MOST_DEG = 5.0, 10.0
QUANTITIES = ("torsion", "bending")


def random_moves(
    seed: int, throws: Sequence[str]
) -> Iterator[tuple[str, str, float, float, dict[str, Any], dict[str, Any]]]:
    """Yield throw, dimension, its value before and after, the design and the moved one, without end."""
    dice = random.Random(seed)
    while True:
        throw, key = dice.choice(throws), dice.choice(KEYS)
        data = random_engine(int(throw)) if throw.isdigit() else parse_toml(design_text(throw), throw)
        value = value_at(data, key)
        if not value:
            continue
        far_mm = _MOST_MM / max(usual_scale(scene_from_dict(data)), 1.0)
        most = _MOST_DEG if key.endswith("_deg") else min(far_mm, value / 2)
        new = round(value + dice.uniform(-most, most), 2)
        yield throw, key, value, new, data, changed_data(data, {key: new})


def main(moves: int = 200, seed: int = 1, throws: Sequence[str] = THROWS) -> None:
    """Print a table of moves, and how many of the told stiffnesses are within their stated error."""
    print("throw,key,from,to,quantity,settled_percent,coarse_percent,error_percent,stated", flush=True)
    errors = list[tuple[float, float]]()
    known: dict[str, Any] = {}
    done = 0
    for throw, key, value, new, data, moved in random_moves(seed, throws):
        if done == moves:
            break
        try:
            cells, truth = coarse_stiffness(moved), settled_stiffness(moved)["gauges"]
        except CranktopoError:
            continue
        if throw not in known:
            known[throw] = coarse_stiffness(data), settled_stiffness(data)["gauges"]
        first_cells, first_truth = known[throw]
        for name in QUANTITIES:
            settled = 100 * (truth[name] / first_truth[name] - 1)
            coarse = 100 * (cells[name] / first_cells[name] - 1)
            error = 100 * ((1 + coarse / 100) / (1 + settled / 100) - 1)
            line = f"{throw},{key},{value},{new},{name},{settled:.3f},{coarse:.3f},{error:.3f}"
            stated = stated_errors(data, moved, {name: coarse}).get(name)
            print(line + ("," if stated is None else f",{stated:.3f}"), flush=True)
            errors += [] if stated is None else [(abs(error), stated)]
        done += 1
    kept, worst = sum(error <= stated for error, stated in errors), max(error for error, _ in errors)
    told = f"told: {len(errors)} of {done * len(QUANTITIES)}"
    print(f"{told}; within what is stated: {kept}; worst {worst:.2f} %", file=sys.stderr)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]), *([sys.argv[3:]] if sys.argv[3:] else []))
