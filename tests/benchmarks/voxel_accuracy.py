"""How exact the optimiser's own stiffness is: its model of whole webs against body-fitted elements.

- `python -m tests.benchmarks.voxel_accuracy`: error and time on finer and finer cells, the Mikron's own web.
- `... --throws [NAME...]`: errors and their bound on built-in designs and random throws (random-SEED).
- `... --features`: the same with counterweights and oil drillings.
- `... --volumes`: errors of the half throw's volume on cells and of its exact solid, with every feature.
- `... --ranking`: whether the ranking of eleven webs is kept at the default cell size.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from functools import partial

from cranktopo.design.loading import load_scene
from cranktopo.numerics.precision import double_precision
from tests.studies.cell_models import (
    REFERENCE,
    every_feature,
    featured,
    model_errors,
    own_model,
    ranking,
    solid_error,
    volume_error,
)
from tests.studies.error_bounds import held_text, target_of

CELLS_MM = (4.0, 3.0, 2.0, 1.5, 1.0, 0.75, 0.5)
FEATURE_CELLS = (4, 6, 9)
"""Cells through the web."""
DESIGNS = ("opposed-piston", "opposed-piston-casting", "opposed-piston-forging")
DESIGNS += tuple(f"random-{seed}" for seed in (0, 2, 4, 5, 7))


def print_cell_sizes() -> None:
    """Error and time on finer and finer cells."""
    scene = load_scene("mikron-iiic-plain")
    print("| cell mm | unknowns | CG | s, solve | s, first time | torsion error % | bending error % |")
    print("|---|---|---|---|---|---|---|")
    with double_precision():
        for cell in CELLS_MM:
            seconds = []
            for _ in range(2):
                began = time.perf_counter()
                own = own_model(scene, cell)
                seconds.append(time.perf_counter() - began)
            errors = {name: 100 * (own.stiffness[name] / value - 1) for name, value in REFERENCE.items()}
            cost = f"{own.unknowns:,} | {own.iterations} | {seconds[1]:.1f} | {seconds[0]:.1f}"
            print(f"| {cell:g} | {cost} | {errors['torsion']:+.2f} | {errors['bending']:+.2f} |", flush=True)


def print_throws(names: Sequence[str]) -> None:
    """Errors of the model and their bounds."""
    print("| design | stiffness | cell mm | cells through the web | bound % | error % | holds |")
    print("|---" * 7 + "|")
    rows = []
    for name in names:
        for row in model_errors(target_of(name).scene):
            rows.append(row)
            cell = f"{row.cell_mm:.2f} | {row.cells_through_web:.1f}"
            numbers = f"{row.bound_percent:.2f} | {row.error_percent:+.2f}"
            held = "yes" if row.holds else "NO"
            print(f"| {row.design} | {row.quantity} | {cell} | {numbers} | {held} |", flush=True)
    print(held_text(rows))


def print_features() -> None:
    """Errors of stiffness with counterweights and oil drillings."""
    print("| Mikron with | cell mm | torsion error % | bound | bending error % | bound |")
    print("|---" * 6 + "|")
    rows = []
    for name, scene in featured().items():
        found = list(model_errors(scene, FEATURE_CELLS))
        rows += found
        for bending, torsion in zip(found[::2], found[1::2], strict=True):
            pairs = " | ".join(
                f"{row.error_percent:+.2f} | {row.bound_percent:.2f}" for row in (torsion, bending)
            )
            print(f"| {name} | {bending.cell_mm:.2f} | {pairs} |", flush=True)
    print(held_text(rows))


def print_volumes() -> None:
    """Errors of the half throw's volume on cells, and of its exact solid, for every feature."""
    print("| Mikron with | cell mm | cells, ppm | exact solid, ppm |")
    print("|---" * 4 + "|")
    for name, scene in every_feature().items():
        solid = 1e6 * solid_error(scene)
        for count in FEATURE_CELLS:
            cell_mm = scene.web.thickness_mm / count
            cells = 1e6 * volume_error(scene, cell_mm)
            print(f"| {name} | {cell_mm:.2f} | {cells:+.3f} | {solid:+.3f} |", flush=True)


def print_ranking() -> None:
    """Stiffnesses of the variants by both models, and how well the ranks agree."""
    print("| web | torsion own | evaluated kN m/rad | error % | bending own | evaluated kN/mm | error % |")
    print("|---" * 7 + "|")
    found = ranking(progress=partial(print, flush=True))
    for quantity in ("torsion", "bending"):
        tau, rho = found.agreement(quantity)
        print(f"\n{quantity}: Kendall {tau:.3f}, Spearman {rho:.3f} over {len(found.own)} webs")


def main() -> None:
    """Print a table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--throws", nargs="*", metavar="NAME")
    parser.add_argument("--features", action="store_true")
    parser.add_argument("--volumes", action="store_true")
    parser.add_argument("--ranking", action="store_true")
    chosen = parser.parse_args()
    if chosen.throws is not None:
        print_throws(chosen.throws or DESIGNS)
    elif chosen.features:
        print_features()
    elif chosen.volumes:
        print_volumes()
    elif chosen.ranking:
        print_ranking()
    else:
        print_cell_sizes()


if __name__ == "__main__":
    main()
