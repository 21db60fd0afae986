"""Errors of the bench's live ring against the settled one: stiffness and safety of the same random moves.

    python -m tests.studies.live_ring FILE FIRST LAST [THROW ...] > live.csv

Moves FIRST to LAST - 1, each drawn by its own number: one dimension that the design of a throw gives, by at
most 5 mm (10 deg), in proportion on journals of less than 42 mm, and by at most half of itself. A line for
each quantity: what elements say the change is, what the bench says, its error and the one that it states; a
quantity that waits has no number there. FILE keeps what was solved, so that a stopped campaign goes on and
a changed rule is judged by the same moves. Elements are asked for nothing that waits. With
OMP_NUM_THREADS=1 a move takes 2 to 6 s of processor time for the stiffness by elements, 2 to 10 s for the
safety, 0.3 s for all else.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import silent
from cranktopo.design.edits import changed_data
from cranktopo.design.halves import usual_scale
from cranktopo.design.loading import design_text, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.coarse import coarse_stiffness
from cranktopo.tasks.bench.coarse_error import MOST_DEG, MOST_MM, stated_errors
from cranktopo.tasks.bench.live import live_numbers
from cranktopo.tasks.bench.live_safety import BY_RULE, SettledSafety, estimated_safety, rule_of_fillets
from cranktopo.tasks.bench.settled import settled_safety, settled_stiffness
from tests.random_engines import random_engine
from tests.studies.own_webs import DESIGNS

THROWS = (*DESIGNS, *map(str, range(1, 10)))
"""Designs that are built in, and random engines by their seeds."""
STIFFNESSES = ("torsion", "bending", "torsion_per_mass", "bending_per_mass")
SAFETIES = (*BY_RULE, "fatigue_safety")
_PARTS: Mapping[str, Callable[[dict[str, Any], dict[str, Any]], dict[str, Any]]] = {
    "cells": coarse_stiffness,
    "rule": lambda data, _: rule_of_fillets(live_numbers(data)),
    "stiffness": lambda data, _: dict(settled_stiffness(data)["gauges"]),
    "safety": lambda data, _: settled_safety(data),
}
"""What is solved of a web, by elements or not, and of what it moved from."""


@dataclass(frozen=True)
class Move:
    """One dimension of a settled web that is dragged."""

    number: int
    throw: str
    key: str
    before: float
    after: float
    data: dict[str, Any]
    moved: dict[str, Any]


@dataclass(frozen=True)
class Row:
    """What is said of one quantity after a move, in percent; None where it waits or elements refuse it.

    Attributes:
        settled: change by elements.
        rule: change that the rule says of a fillet, its strength included.
        told: change that the bench tells.
        stated: its error, as the bench states it.
    """

    move: Move
    quantity: str
    settled: float | None = None
    rule: float | None = None
    told: float | None = None
    stated: float | None = None

    @property
    def error(self) -> float | None:
        """Of the told value."""
        return None if self.told is None or self.settled is None else _error(self.told, self.settled)

    @property
    def line(self) -> str:
        """As comma-separated values."""
        move, found = self.move, (self.settled, self.rule, self.told, self.error, self.stated)
        texts = ("" if value is None else f"{value:.3f}" for value in found)
        return ",".join(
            [f"{move.number},{move.throw},{move.key},{move.before},{move.after}", self.quantity, *texts]
        )


class Known:
    """What was solved of webs, kept in a file of one line each."""

    def __init__(self, path: Path) -> None:
        self._path = path
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        self._found = {(web, part): found for web, part, found in map(json.loads, lines)}

    def of(self, web: str, part: str, data: dict[str, Any], first: dict[str, Any]) -> dict[str, Any]:
        """Return a part of a web that was moved from a first one, solved unless it is known.

        Nothing where it is refused.
        """
        if (web, part) not in self._found:
            try:
                found = _PARTS[part](data, first)
            except CranktopoError:
                found = {}
            self._found[web, part] = found
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps([web, part, found]) + "\n")
        return self._found[web, part]


def drawn_move(number: int, throws: Sequence[str] = THROWS) -> Move:
    """Return the move of a number, redrawn until the moved design is sound."""
    dice = random.Random(number)
    while True:
        throw = dice.choice(throws)
        data = throw_data(throw)
        key, value = dice.choice(list(_dimensions(data)))
        far_mm = MOST_MM / max(usual_scale(scene_from_dict(data)), 1.0)
        most = MOST_DEG if key.endswith("_deg") else min(far_mm, abs(value) / 2)
        new = round(value + dice.uniform(-most, most), 3)
        moved = changed_data(data, {key: new})
        if new != value and "broken" not in live_numbers(moved):
            return Move(number, throw, key, value, new, data, moved)


@lru_cache(maxsize=64)
def throw_data(throw: str) -> dict[str, Any]:
    """Return the tables of a built-in design, or of a random engine by its seed."""
    return random_engine(int(throw)) if throw.isdigit() else parse_toml(design_text(throw), throw)


def _dimensions(data: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """Yield the dimensions of throw and web that are not 0, by key path."""
    for table in ("throw", "web"):
        yield from _in_table(data[table], table)


def _in_table(value: Any, path: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _in_table(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from _in_table(inner, f"{path}[{number}]")
    elif path.endswith(("_mm", "_deg")) and value:
        yield path, float(value)


def rows_of(move: Move, known: Known) -> Iterator[Row]:
    """Yield what the bench says of a move beside what elements say."""
    yield from _stiffness_rows(move, known)
    yield from _safety_rows(move, known)


def _stiffness_rows(move: Move, known: Known) -> Iterator[Row]:
    cells, first = _of_both(move, "cells", known)
    changes = {name: _percent(cells[name], first[name]) for name in STIFFNESSES if cells and first}
    stated = stated_errors(move.data, move.moved, changes)
    after, before = _of_both(move, "stiffness", known) if stated else ({}, {})
    for name in STIFFNESSES:
        yield Row(
            move,
            name,
            _percent(after[name], before[name]) if after and before else None,
            told=changes[name] if name in stated else None,
            stated=stated.get(name),
        )


def _of_both(move: Move, part: str, known: Known) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a part of the moved web, and of the one that it moved from."""
    after = known.of(f"move {move.number}", part, move.moved, move.data)
    return after, known.of(move.throw, part, move.data, move.data)


def _safety_rows(move: Move, known: Known) -> Iterator[Row]:
    rule, first_rule = _of_both(move, "rule", known)
    before = known.of(move.throw, "safety", move.data, move.data)
    settled = SettledSafety(move.data, before["gauges"], before.get("elsewhere", 0.0), first_rule)
    told, stated = estimated_safety(settled, move.moved, rule).values()
    after = known.of(f"move {move.number}", "safety", move.moved, move.data)["gauges"] if told else {}
    for name in SAFETIES:
        yield Row(
            move,
            name,
            _percent(after[name], settled.safety[name]) if name in after else None,
            _percent(rule[BY_RULE[name]], first_rule[BY_RULE[name]]) if BY_RULE.get(name) in rule else None,
            _percent(told[name], settled.safety[name]) if name in told else None,
            stated.get(name),
        )


def main(path: str, first: int, last: int, *throws: str) -> None:
    """Print a table of moves, and how many of the told values are within their stated error."""
    known, rows = Known(Path(path)), list[Row]()
    percents = ",".join(f"{name}_percent" for name in ("settled", "rule", "told", "error", "stated"))
    print(f"move,throw,key,from,to,quantity,{percents}", flush=True)
    moves = [drawn_move(number, throws or THROWS) for number in range(first, last)]
    for move in sorted(moves, key=lambda move: move.throw):  # a mesh follows what moves, as in the bench
        found = list(rows_of(move, known))
        print(*(row.line for row in found), sep="\n", flush=True)
        rows += found
    for names in (STIFFNESSES[:2], STIFFNESSES[2:], SAFETIES):
        print(summary([row for row in rows if row.quantity in names], names), file=sys.stderr)


def summary(rows: Sequence[Row], names: Sequence[str]) -> str:
    """Return how many values were told, how many of these are within their stated error, and the worst."""
    told = [row for row in rows if row.error is not None]
    within = sum(abs(row.error or 0.0) <= (row.stated or 0.0) for row in told)
    widest = max((row.stated or 0.0 for row in told), default=0.0)
    moves, throws = ({getattr(row.move, name) for row in rows} for name in ("number", "throw"))
    errors = {
        "told": [row.error or 0.0 for row in told],
        "the last settled": [_error(0.0, row.settled or 0.0) for row in told],
        "the rule": [_error(row.rule, row.settled or 0.0) for row in told if row.rule is not None],
    }
    return (
        f"{', '.join(names)}: {len(moves)} moves of {len(throws)} throws; told {len(told)} of {len(rows)}, "
        f"within what is stated {within}; largest stated {widest:.2f} %; refused by elements "
        f"{sum(row.stated is not None and row.settled is None for row in rows)}; error, mean, 95 of 100, "
        f"largest: {'; '.join(f'{name} {_spread(found)}' for name, found in errors.items() if found)}"
    )


def _spread(errors: Sequence[float]) -> str:
    """Return mean, 95th percentile and maximum of errors in percent as text."""
    sizes = np.abs(errors)
    return " ".join(f"{value:.2f}" for value in (sizes.mean(), np.percentile(sizes, 95), sizes.max()))


def _error(told: float, settled: float) -> float:
    return 100 * ((100 + told) / (100 + settled) - 1)


def _percent(one: float, other: float) -> float:
    return 100 * (one / other - 1)


if __name__ == "__main__":
    with silent():
        main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), *sys.argv[4:])
