"""What each process costs: both engines free, from a die, with 5 deg of draft, cast and milled.

Run with `python -m tests.benchmarks.processes [MM]`, cell edge 3 mm by default: stiffnesses by the cells and
of the extracted surface by body-fitted elements, mass, and what was measured on the surface. One line per
run as Markdown.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

from cranktopo.design.loading import load_scene
from cranktopo.tasks.optimise.stage import optimise_design
from cranktopo.tasks.throw_fea.stage import evaluate_target

ENGINES = ("mikron-iiic-plain", "opposed-piston")
PROCESSES: dict[str, dict[str, Any]] = {
    "free": {"process": "free"},
    "die": {"process": "forged", "draft_deg": 0.0},
    "die, 5 deg": {"process": "forged", "draft_deg": 5.0},
    "die through the faces, 5 deg": {"process": "forged", "parting": "web_faces", "draft_deg": 5.0},
    "cast": {"process": "cast", "draft_deg": 0.0},
    "cast, 3 deg": {"process": "cast", "draft_deg": 3.0},
    "milled": {"process": "milled"},
}


HEAD = (
    "engine",
    "process",
    "cells: kN m/rad",
    "kN/mm",
    "surface: kN m/rad",
    "kN/mm",
    "mass kg",
)
WALLS = ("undercuts mm3", "draft deg", "member mm", "gap mm", "closed hollows")


def row(engine: str, process: str, cell_mm: float) -> list[str]:
    """One line of the table."""
    scene = load_scene(engine).with_optimise(resolution_mm=cell_mm, **PROCESSES[process])
    with tempfile.TemporaryDirectory() as folder:
        run = optimise_design(scene, Path(folder) / "run")
        surface, cases = run.metrics.as_json()["surface"], run.metrics.load_cases
        body = evaluate_target(str(run.folder))
    walls = surface.get("walls") or {}
    stiffness = [
        cases["torsion"].stiffness,
        cases["bending"].stiffness,
        body.torsion_Nm_per_rad,
        body.bending_N_per_mm,
    ]
    sizes = [walls.get(f"least_{name}") for name in ("draft_deg", "member_mm", "gap_mm")]
    return [
        engine,
        process,
        *(f"{value / 1000:.1f}" for value in stiffness),
        f"{body.throw_kg:.4f}",
        f"{surface['undercuts']['volume_mm3']:.0f}",
        *("-" if size is None else f"{size:.1f}" for size in sizes),
        str(surface["cavities"]),
    ]


def main() -> None:
    """Print the table as Markdown."""
    cell_mm = float(sys.argv[1]) if len(sys.argv) > 1 else 3.0
    head = [*HEAD, *WALLS]
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}", flush=True)
    for engine in ENGINES:
        for process in PROCESSES:
            print(f"| {' | '.join(row(engine, process, cell_mm))} |", flush=True)


if __name__ == "__main__":
    main()
