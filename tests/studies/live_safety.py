"""Error of the bench's live fatigue safety against the settled one, on random moves of several throws.

    python -m tests.studies.live_safety [MOVES] [SEED] [THROW ...] > live.csv

Moves are those of `coarse_ring`. A line for each safety: what body-fitted elements say the change is, what
the rule says it is, what the bench tells, and the error that it states; a safety that it does not tell has no
number there. The gains of `live_safety` were fitted to 72 moves of seed 1 and to 11 chosen ones, of
mikron-iiic, car-diesel, opposed-piston, mikron-iiic-plain and industrial-gas.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from cranktopo.base.notes import silent
from cranktopo.tasks.bench.live import live_numbers
from cranktopo.tasks.bench.live_safety import SettledSafety, estimated_safety
from cranktopo.tasks.bench.settled import settled_safety
from tests.studies.coarse_ring import THROWS, random_moves

_RULE = {"pin_fillet_safety": "m53_pin", "journal_fillet_safety": "m53_journal"}


def main(moves: int = 120, seed: int = 2, throws: Sequence[str] = THROWS) -> None:
    """Print a table of moves, and how many of the told safeties are within their stated error."""
    print(
        "throw,key,from,to,safety,settled_percent,rule_percent,told_percent,error_percent,stated", flush=True
    )
    errors = list[tuple[float, float]]()
    asked = 0
    for throw, key, value, new, first, data in _moves(moves, seed, throws):
        by_rule, found = live_numbers(data)["gauges"], settled_safety(data)["gauges"]
        told = estimated_safety(first, data, by_rule)
        for name in (*_RULE, "fatigue_safety"):
            asked += 1
            settled = _percent(found[name], first.safety[name])
            rule = _percent(by_rule[_RULE[name]], first.by_rule[_RULE[name]]) if name in _RULE else math.nan
            line = [throw, key, f"{value}", f"{new}", name, f"{settled:.3f}", f"{rule:.3f}"]
            if name in told["gauges"]:
                error, stated = _percent(told["gauges"][name], found[name]), told["error_percent"][name]
                errors.append((error, stated))
                line += [f"{_percent(told['gauges'][name], first.safety[name]):.3f}"]
                line += [f"{error:.3f}", f"{stated:.3f}"]
            print(",".join(line + [""] * (10 - len(line))), flush=True)
    kept = sum(abs(error) <= stated for error, stated in errors)
    worst = max(abs(error) for error, _ in errors)
    print(
        f"told: {len(errors)} of {asked}; within what is stated: {kept}; worst {worst:.2f} %", file=sys.stderr
    )


def _moves(
    count: int, seed: int, throws: Sequence[str]
) -> Iterator[tuple[str, str, float, float, SettledSafety, dict[str, Any]]]:
    """Yield throw, dimension, its value before and after, the settled web and the moved design."""
    settled, done = dict[str, SettledSafety](), 0
    for throw, key, value, new, data, moved in random_moves(seed, throws):
        if done == count:
            break
        if throw not in settled:
            settled[throw] = settled_web(data)
        if "broken" in live_numbers(moved) or "missing" in settled_safety(moved):
            continue
        yield throw, key, value, new, settled[throw], moved
        done += 1


def settled_web(data: dict[str, Any]) -> SettledSafety:
    """Return a design as the bench knows it when its safety has settled."""
    found = settled_safety(data)
    return SettledSafety(data, found["gauges"], found["elsewhere"], live_numbers(data)["gauges"])


def _percent(one: float, other: float) -> float:
    return 100 * (one / other - 1)


if __name__ == "__main__":
    with silent():
        main(*map(int, sys.argv[1:3]), *([sys.argv[3:]] if sys.argv[3:] else []))
