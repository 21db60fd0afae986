"""How the bound moves with the cell, and what cells of size zero would give.

`python -m tests.benchmarks.bound_cells [DESIGN] [--cells 4 3 2 1.5]`
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.numerics.extrapolation import extrapolate
from cranktopo.tasks.bound.stage import bound_of

GOALS = (
    {"minimise": "mass"},
    {"maximise": "torsion", "limits": ("bending none",)},
    {"maximise": "torsion_per_mass"},
)


def print_cells(design: str, cells_mm: Sequence[float]) -> None:
    """Bounds in percent of the original in the same cells, by cell size, and their limit."""
    print(f"| {design}, goal | " + " | ".join(f"{h:g} mm" for h in cells_mm) + " | limit | +- |")
    print("|---" * (len(cells_mm) + 3) + "|")
    for goal in GOALS:
        scene = with_goal(load_scene(design), **goal)
        percent = [bound_of(scene, h).bound.percent_of_original for h in cells_mm]
        limit = extrapolate(cells_mm, percent)
        told = (
            "- | -"
            if limit is None
            else f"{limit.value:.1f} | {limit.value * limit.uncertainty_percent / 100:.1f}"
        )
        label = " ".join(str(part) for part in (*next(iter(goal.items())), *goal.get("limits", ())))
        print(f"| {label} | " + " | ".join(f"{p:.1f}" for p in percent) + f" | {told} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("design", nargs="?", default="mikron-iiic-plain")
    parser.add_argument("--cells", type=float, nargs="+", default=[4.0, 3.0, 2.0, 1.5])
    asked = parser.parse_args()
    print_cells(asked.design, asked.cells)
