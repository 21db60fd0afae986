"""Safety on meshes that followed a drag, beside that on meshes made anew, of the moves of the live ring.

    python -m tests.studies.followed_meshes FIRST LAST > followed.csv

Of each of the moves FIRST to LAST - 1 of `tests.studies.live_ring`: the least safeties, their difference in
percent, and processor seconds of both. A mesh that cannot follow is made anew, so both are the same there.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from itertools import groupby

import numpy as np

from cranktopo.base.notes import silent
from cranktopo.tasks.bench import settled
from cranktopo.tasks.bench.kept_mesh import KeptMesh
from tests.studies.live_ring import SAFETIES, Move, drawn_move


def rows_of(moves: list[Move]) -> Iterator[tuple[Move, str, float, float, float, float]]:
    """Yield move, quantity, its value on the followed and on a new mesh, and the seconds of both.

    Args:
        moves: of one throw, whose own mesh follows them all.
    """
    settled.KEPT = own = KeptMesh()
    settled.settled_safety(moves[0].data)
    for move in moves:
        settled.KEPT = own
        began, followed = time.process_time(), settled.settled_safety(move.moved)["gauges"]
        between, settled.KEPT = time.process_time(), KeptMesh()
        settled.solved_field.cache_clear()
        anew = settled.settled_safety(move.moved)["gauges"]
        ended = time.process_time()
        for name in SAFETIES:
            if name in anew:
                yield move, name, followed[name], anew[name], between - began, ended - between


def main(first: int, last: int) -> None:
    """Print a table of the moves, and mean and largest difference."""
    print("move,throw,key,from,to,quantity,followed,anew,difference_percent,followed_s,anew_s")
    moves, differences = sorted(map(drawn_move, range(first, last)), key=lambda one: one.throw), list[float]()
    for _, own in groupby(moves, key=lambda one: one.throw):
        for move, name, followed, anew, one_s, other_s in rows_of(list(own)):
            differences.append(100 * (followed / anew - 1))
            told = f"{followed:.4f},{anew:.4f},{differences[-1]:.3f},{one_s:.2f},{other_s:.2f}"
            print(
                f"{move.number},{move.throw},{move.key},{move.before},{move.after},{name},{told}", flush=True
            )
    sizes = np.abs(differences)
    print(
        f"differences, mean {sizes.mean():.3f} %, 95 of 100 {np.percentile(sizes, 95):.3f} %, largest "
        f"{sizes.max():.3f} %",
        file=sys.stderr,
    )


if __name__ == "__main__":
    with silent():
        main(int(sys.argv[1]), int(sys.argv[2]))
