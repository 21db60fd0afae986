"""What the die's constraint changes: the same optimisation free and forged without draft, on three engines.

Run with `python -m tests.benchmarks.die_cost [MM]`, cell edge 3 mm by default: stiffnesses of the forged web
against the free one of the same volume, in the optimiser's model.
"""

from __future__ import annotations

import sys
from copy import deepcopy
from typing import Any

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import stage
from cranktopo.tasks.density.assess import assess
from cranktopo.tasks.density.problem import Assessment
from tests.studies.example_throws import CAR

ENVELOPE = {"shape": "box", "half_width_mm": 50.0, "y_min_mm": -45.0, "y_max_mm": 85.0}


def engines() -> list[dict[str, Any]]:
    """Three engines with a design space each."""
    names = ("mikron-iiic-plain", "opposed-piston")
    builtin = [load_scene(name).model_dump(mode="json", exclude_none=True) for name in names]
    return [*builtin, deepcopy(CAR) | {"envelope": ENVELOPE}]


def optimised(data: dict[str, Any], process: str, cell_mm: float) -> Assessment:
    """Stiffness and mass of the last design."""
    settings = {"process": process, "draft_deg": 0.0, "resolution_mm": cell_mm}
    settings = data.get("optimise", {}) | settings
    ready = stage.prepare(scene_from_dict(data | {"optimise": settings}))
    found = stage.optimise_density(ready)
    return assess(found.problem, ready.scene, ready.domain, found.design.physical)


def main() -> None:
    """Print the table as Markdown."""
    cell_mm = float(sys.argv[1]) if len(sys.argv) > 1 else 3.0
    print("| engine | torsion % | bending % | mass of throw % |")
    print("|---|---|---|---|")
    for data in engines():
        with double_precision():
            free, forged = (optimised(data, process, cell_mm) for process in ("free", "forged"))
        changes = {
            new.kind: 100 * ((new.stiffness or 0.0) / (old.stiffness or 1.0) - 1)
            for old, new in zip(free.cases, forged.cases, strict=True)
        }
        mass = 100 * (forged.throw_kg / free.throw_kg - 1)
        row = f"{changes['torsion']:+.1f} | {changes['bending']:+.1f} | {mass:+.2f}"
        print(f"| {data['name']} | {row} |", flush=True)


if __name__ == "__main__":
    main()
