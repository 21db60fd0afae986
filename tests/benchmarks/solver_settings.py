"""Do loose solves and float32 change the design? `python -m tests.benchmarks.solver_settings [CELL_MM]`.

Every shape of `tests.studies.solver_shapes` against the exact one (residual 1e-8 throughout, float64 cycle).
"""

from __future__ import annotations

import sys

from cranktopo.tasks.throw_fea.studies import BENDING, TORSION
from tests.studies.solver_shapes import Shape, shapes

CELL_MM = 3.0


def main() -> None:
    """Print the table as Markdown."""
    cell = float(sys.argv[1]) if len(sys.argv) > 1 else CELL_MM
    header = "residual, cycle | iterations | torsion kN m/rad | change % | bending kN/mm | change %"
    print(f"| {header} | own torsion, change % | own bending, change % |")
    print("|---" * 8 + "|")
    exact: Shape | None = None
    for shape in shapes(cell):
        exact = exact or shape
        change, own = (shape.change_percent(exact, by) for by in ("evaluated", "own"))
        values = [f"{shape.evaluated[name] / 1e3:.2f} | {change[name]:+.3f}" for name in (TORSION, BENDING)]
        cells = [*values, f"{own[TORSION]:+.3f}", f"{own[BENDING]:+.3f}"]
        print(f"| {shape.setting} | {shape.iterations} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
