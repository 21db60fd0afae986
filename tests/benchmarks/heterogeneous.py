"""Cycles and seconds on 27 heterogeneous cantilevers: `python -m tests.benchmarks.heterogeneous`.

Fields and sizes: `tests.studies.heterogeneous`. Seconds: hierarchy and cycles, nothing to compile.
"""

from __future__ import annotations

from cranktopo.numerics.precision import double_precision
from tests.studies.heterogeneous import CONTRASTS, LENGTHS, SIZES, answer

THEIRS = {64_000: "7 of 9", 216_000: "4 of 9", 512_000: "1 of 9"}
"""Cases that end within the cap in the paper's own sweep."""


def main() -> None:
    """Print the table as Markdown."""
    lengths = [f"{length:g} cells: cycles | s" for length in LENGTHS]
    print(f"| cells | contrast | {' | '.join(lengths)} | converged | in the paper, all contrasts |")
    print(f"|{'---|' * (2 * len(LENGTHS) + 4)}", flush=True)
    with double_precision():
        for cells, padded in SIZES.items():
            count = cells[0] * cells[1] * cells[2]
            for contrast in CONTRASTS:
                found = [answer(cells, contrast, length, padded) for length in LENGTHS]
                columns = [f"{one.cycles} | {one.seconds:.2f}" for one in found]
                passed = f"{sum(one.converged for one in found)} of {len(found)}"
                print(
                    f"| {count:,} | {contrast:.0e} | {' | '.join(columns)} | {passed} | {THEIRS[count]} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
