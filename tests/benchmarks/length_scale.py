"""Least member and gap: what was asked for against what is measured on the extracted surface, in 30 runs.

Run with `python -m tests.benchmarks.length_scale [ENGINE...]`: both engines by default, three volume
fractions, cells of 3.5 mm, a free process. One line per run as Markdown; lengths in mm of 99 % of the walls
that were shaped, a dash where no two of them face each other.
"""

from __future__ import annotations

import sys

from cranktopo.design.loading import load_scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.assess import assess
from cranktopo.tasks.density.stage import optimise_density, prepare
from cranktopo.tasks.extraction.checked_surface import checked_surface

ENGINES = ("mikron-iiic-plain", "opposed-piston")
FRACTIONS = (0.2, 0.3, 0.4)
CELL_MM = 3.5
LENGTHS: tuple[dict[str, float], ...] = (
    {},
    {"min_member_mm": 7.0},
    {"min_member_mm": 11.0},
    {"min_gap_mm": 11.0},
    {"min_member_mm": 9.0, "min_gap_mm": 9.0},
)
HEAD = (
    "engine",
    "fraction",
    "member asked",
    "measured",
    "gap asked",
    "measured",
    "kN m/rad",
    "kN/mm",
    "iterations",
    "status",
)


def row(engine: str, fraction: float, lengths: dict[str, float]) -> list[str]:
    """One line of the table."""
    scene = load_scene(engine).with_optimise(
        resolution_mm=CELL_MM, volume_fraction=fraction, process="free", **lengths
    )
    ready = prepare(scene)
    with double_precision():
        found = optimise_density(ready)
        surface = checked_surface(ready.scene, ready.domain, found.design)
        result = assess(found.problem, ready.scene, ready.domain, found.design.physical).quantities
    walls = surface.walls(ready.scene)
    sizes = [lengths.get("min_member_mm"), walls.least_member_mm]
    sizes += [lengths.get("min_gap_mm"), walls.least_gap_mm]
    return [
        engine,
        f"{fraction:g}",
        *("-" if size is None else f"{size:.1f}" for size in sizes),
        *(f"{result[name] / 1000:.1f}" for name in ("torsion", "bending")),
        str(len(found.state.history)),
        found.state.status,
    ]


def main() -> None:
    """Print the table as Markdown."""
    print(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}", flush=True)
    for engine in sys.argv[1:] or ENGINES:
        for fraction in FRACTIONS:
            for lengths in LENGTHS:
                print(f"| {' | '.join(row(engine, fraction, lengths))} |", flush=True)


if __name__ == "__main__":
    main()
