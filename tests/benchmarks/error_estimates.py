"""Do the evaluation's error bounds hold? `python -m tests.benchmarks.error_estimates [--pairs | NAME...]`.

Single bounds: the designs whose truth is stored, or those named (random-SEED-0 or a built-in one), at the
default element size. With --pairs: differences between the webs of random throws on meshes 1.5 times coarser.
--make solves the truth of the named ones first where it is not stored yet.
"""

from __future__ import annotations

import argparse
from statistics import median

from tests.studies.error_bounds import (
    Bounded,
    Difference,
    family,
    held_text,
    make_truth,
    pair_errors,
    single_errors,
    stored_families,
    stored_names,
)


def main() -> None:
    """Print a table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--pairs", nargs="*", type=int, metavar="SEED", help="by default all that are stored")
    parser.add_argument("--make", action="store_true", help="solve the truth where it is not stored")
    chosen = parser.parse_args()
    if chosen.pairs is not None:
        names = [name for seed in chosen.pairs for name in family(seed)]
    else:
        names = chosen.names
    for name in names if chosen.make else []:
        make_truth(name)
    if chosen.pairs is not None:
        _pairs(chosen.pairs or stored_families())
    else:
        _singles(chosen.names or stored_names())


def _singles(names: list[str]) -> None:
    print("| design | torsion error % | bound % | bending error % | bound % |\n|---|---|---|---|---|")
    rows: list[Bounded] = []
    for name in names:
        found = list(single_errors(name))
        cells = (f"{row.error_percent:.3f} | {_bound(row)}" for row in found)
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
        rows += found
    print(held_text(rows))
    print(
        f"median bound over error: {median(row.bound_percent / abs(row.error_percent) for row in rows):.2f}"
    )


def _pairs(seeds: list[int]) -> None:
    print("| webs | torsion change % | its error % | bound % | bending change % | its error % | bound % |")
    print("|---|---|---|---|---|---|---|")
    rows: list[Difference] = []
    for seed in seeds:
        found = list(pair_errors(seed))
        rows += found
        for pair in zip(found[::2], found[1::2], strict=True):
            cells = (f"{r.change_percent:+.2f} | {r.error_percent:+.3f} | {_bound(r)}" for r in pair)
            print(f"| {pair[0].design} | {' | '.join(cells)} |", flush=True)
    print(held_text(rows))
    shares = (row.bound_percent / row.single_percent for row in rows)
    print(f"median bound over mean single bound: {median(shares):.2f}")


def _bound(row: Bounded) -> str:
    return f"{row.bound_percent:.3f}{'' if row.holds else ' NO'}"


if __name__ == "__main__":
    main()
