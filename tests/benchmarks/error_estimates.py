"""Do the error bounds of the evaluation hold? `python -m tests.benchmarks.error_estimates [NAME...]`.

Built-in designs and random throws (by default all) on meshes from coarse to fine, each bound against the true
error. A name is a design or random-SEED; `--finest STEPS` sets the finest mesh of the truth.
"""

from __future__ import annotations

import argparse
from statistics import median

from cranktopo.evaluate.evaluation import RATIO
from tests.studies.error_bounds import (
    STEPS,
    EvaluationError,
    evaluation_errors,
    every_name,
    held_text,
    target_of,
)


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--finest", type=int, default=-2, help="1.5 to this power times the default size")
    chosen = parser.parse_args()
    print("| design | default mm | ", end="")
    print(" | ".join(f"{q}, x{RATIO**step:.3g}" for step in STEPS for q in ("torsion", "bending")) + " |")
    print("|---" * (2 + 2 * len(STEPS)) + "|")
    every: list[EvaluationError] = []
    for name in chosen.names or every_name():
        rows = sorted(evaluation_errors(target_of(name), finest=chosen.finest), key=lambda row: -row.steps)
        every += rows
        cells = [f"{r.error_percent:+.2f} ({r.bound_percent:.2f}{'' if r.holds else ' NO'})" for r in rows]
        none = ["no such mesh"] * (2 * len(STEPS) - len(rows))
        print(f"| {name} | {rows[-1].size_mm:.2f} | {' | '.join([*none, *cells])} |", flush=True)
    print(held_text(every))
    for step in STEPS:
        worst: dict[str, float] = {}
        for row in (row for row in every if row.steps == step):
            worst[row.design] = max(worst.get(row.design, 0.0), row.bound_percent)
        print(f"median bound at {RATIO**step:.3g} times the default size: {median(worst.values()):.2f} %")


if __name__ == "__main__":
    main()
