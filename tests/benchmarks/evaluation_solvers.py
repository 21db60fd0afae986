"""Direct against multigrid solver of the body-fitted evaluation.

    python -m tests.benchmarks.evaluation_solvers [ENGINE]

Seconds of both condensations, mesh and assembly apart, as Markdown.
"""

from __future__ import annotations

import sys
import time
from unittest.mock import patch

from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.tetrahedra import solver
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.tasks.throw_fea.condense import condense, torsional_stiffness_Nm_per_rad

SIZES = (2.8, 2.25, 1.9, 1.5, 1.0)
"""Element sizes over the default one."""
METHODS = {"direct": sys.maxsize, "multigrid CG": 0}


def main(engine: str = "mikron-iiic-plain") -> None:
    """Print the table as Markdown."""
    scene = planned_scene(load_scene(engine), ("fillets",))
    print("| element mm | unknowns | solver | s | torsion kN m/rad |\n|---|---|---|---|---|")
    for share in SIZES:
        size = share * default_element_size_mm(scene)
        mesh = mesh_throw(scene, size).mesh
        model = assemble(mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
        for name, most in METHODS.items():
            with patch.object(solver, "DIRECT_LIMIT", most):
                began = time.perf_counter()
                twist, _ = side_by_side(
                    lambda m=model, h=mesh: condense(
                        m, scene, "antisymmetric", "odd" if h.mirrored else "none"
                    ),
                    lambda m=model, h=mesh: condense(m, scene, "symmetric", "even" if h.mirrored else "none"),
                )
                seconds = time.perf_counter() - began
            stiffness = torsional_stiffness_Nm_per_rad(twist, "free") / 1000
            cells = (f"{size:.3g}", f"{model.nodes_mm.size:,}", name, f"{seconds:.2f}", f"{stiffness:.6f}")
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
