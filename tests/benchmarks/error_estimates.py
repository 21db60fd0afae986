"""Do the judge's error bounds hold? `python -m tests.benchmarks.error_estimates [NAME...] [--finest STEPS]`.

Built-in designs and random throws (by default all) on meshes from coarse to fine, each bound against the true
error: against the limit of two finer meshes, extrapolated with order 1.3. A name is a design or random-SEED.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import median

from cranktopo.effects import planned_scene
from cranktopo.errors import CranktopoError
from cranktopo.evaluate.evaluation import (
    RATIO,
    MeshResult,
    default_element_size_mm,
    evaluate_on_mesh,
    evaluation,
)
from cranktopo.evaluate.targets import Target, load_simulated
from cranktopo.scene.loading import builtin_designs
from tests.random_throws import random_throw

SEEDS = range(8)
STEPS = (2, 1, 0)
"""How many times 1.5 the judged meshes are coarser than the default."""
_ORDER = 1.3
_RANDOM = "random-"


def limit(coarse: float, fine: float) -> float:
    """What two meshes, the finer one by a factor of 1.5, converge to with order 1.3."""
    return fine + (fine - coarse) / (RATIO**_ORDER - 1)


@dataclass(frozen=True, kw_only=True)
class Bounded:
    """A stiffness of a design, the bound of its error, and its true error, %."""

    design: str
    quantity: str
    bound_percent: float
    error_percent: float

    @property
    def holds(self) -> bool:
        """Whether the bound is one."""
        return abs(self.error_percent) <= self.bound_percent


def held_text(rows: Sequence[Bounded]) -> str:
    """How many bounds hold."""
    held = sum(row.holds for row in rows)
    return f"\n{held} of {len(rows)} within their bound: {100 * held / len(rows):.1f} %"


@dataclass(frozen=True, kw_only=True)
class Judgement(Bounded):
    """A stiffness on one mesh of the judge."""

    steps: int
    size_mm: float


def target_of(name: str) -> Target:
    """A built-in design, or random-SEED."""
    drawn = name.startswith(_RANDOM)
    scene = planned_scene(random_throw(int(name[len(_RANDOM) :]))) if drawn else load_simulated(name)
    return Target(scene.name, scene)


def every_name(seeds: Sequence[int] = SEEDS) -> list[str]:
    """The built-in designs and random throws."""
    return [*builtin_designs(), *(f"{_RANDOM}{seed}" for seed in seeds)]


def judgements(target: Target, steps: Sequence[int] = STEPS, finest: int = -2) -> Iterator[Judgement]:
    """Bounds and true errors of a design.

    Args:
        target: the design.
        steps: judged meshes, coarse to fine; left out where the web is too thin for elements so large.
        finest: steps of the finest mesh of the truth; the other one is 1.5 times coarser.
    """
    size = default_element_size_mm(target.scene)
    needed = sorted({*steps, *(step + 1 for step in steps), finest, finest + 1}, reverse=True)
    tried = {step: _judged(target, size * RATIO**step) for step in needed}
    found = {step: judged for step, judged in tried.items() if judged}
    known = {step: evaluation(found.get(step + 1, found[step]), found[step], 0.0) for step in found}

    for quantity in ("torsion_Nm_per_rad", "bending_N_per_mm"):
        name = quantity.split("_")[0]
        true = limit(*(float(getattr(known[step], quantity)) for step in (finest + 1, finest)))
        for step in (step for step in steps if step + 1 in found):
            error = 100 * (getattr(known[step], quantity) / true - 1)
            bound = getattr(known[step], f"{name}_error_percent")
            yield Judgement(
                design=target.name,
                quantity=name,
                bound_percent=bound,
                error_percent=error,
                steps=step,
                size_mm=size * RATIO**step,
            )


def _judged(target: Target, size_mm: float) -> MeshResult | None:
    """A target on one mesh; None where the web is too thin for elements so large."""
    try:
        return evaluate_on_mesh(target, size_mm)
    except CranktopoError as error:
        if "thinnest parts" not in str(error):
            raise
        return None


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--finest", type=int, default=-2, help="1.5 to this power times the default size")
    chosen = parser.parse_args()
    print("| design | default mm | ", end="")
    print(" | ".join(f"{q}, x{RATIO**step:.3g}" for step in STEPS for q in ("torsion", "bending")) + " |")
    print("|---" * (2 + 2 * len(STEPS)) + "|")
    every: list[Judgement] = []
    for name in chosen.names or every_name():
        rows = sorted(judgements(target_of(name), finest=chosen.finest), key=lambda row: -row.steps)
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
