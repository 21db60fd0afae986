"""What accuracy of the optimiser's model costs in time: the original Mikron web on finer and finer cells.

Run with `python -m tests.benchmarks.voxel_accuracy`. Errors are against body-fitted quadratic tetrahedra
refined at the re-entrant rings (138.2 kN m/rad torsion, free; 217.6 kN/mm bending, pinned; no fillets).
"""

from __future__ import annotations

import time

import jax.numpy as jnp

from cranktopo.domain.build import build_domain
from cranktopo.fem.model import build_model
from cranktopo.fem.precision import double_precision
from cranktopo.fem.response import compliances, solve, stiffness
from cranktopo.loads.cases import load_cases
from cranktopo.scene import load_scene

REFERENCE = {"torsion": 138.2e3, "bending": 217.6e3}
CELLS_MM = (4.0, 3.0, 2.0, 1.5, 1.0, 0.75, 0.5)


def main() -> None:
    """Print the table as Markdown."""
    scene = load_scene("mikron-iiic")
    print("| cell mm | unknowns | CG | s, solve | s, first time | torsion error % | bending error % |")
    print("|---|---|---|---|---|---|---|")
    with double_precision():
        for cell in CELLS_MM:
            domain = build_domain(scene, cell, "web")
            model = build_model(scene, domain, load_cases(scene, frozenset(REFERENCE)))
            seconds = []
            for _ in range(2):
                began = time.perf_counter()
                solution = solve(model, jnp.asarray(domain.fixed), tolerance=1e-8)
                work = [float(c) for c in compliances(model, solution.displacements)]
                seconds.append(time.perf_counter() - began)
            errors = {
                case.name: 100 * (stiffness(model, c, case.name) / REFERENCE[case.name] - 1)
                for case, c in zip(model.cases, work, strict=True)
            }
            unknowns = model.forces[0].size
            cost = f"{unknowns:,} | {int(solution.iterations)} | {seconds[1]:.1f} | {seconds[0]:.1f}"
            error = f"{errors['torsion']:+.2f} | {errors['bending']:+.2f}"
            print(f"| {cell:g} | {cost} | {error} |", flush=True)


if __name__ == "__main__":
    main()
