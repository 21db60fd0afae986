"""The judge's two solvers on the built-in throw, beside those it could have used.

Run with `python -m tests.benchmarks.evaluation_solvers [MM ...]`; seconds for both condensations, each row in
a process of its own so that peak memory is its own. pypardiso, pyamg and scikit-sparse (CHOLMOD; Debian's
`libsuitesparse-dev`, 0.4.16 suits its version) are measured where they are installed and left out elsewhere.
"""

from __future__ import annotations

import importlib.util
import resource
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.evaluate import condense, linear
from cranktopo.evaluate.evaluation import condensed_stiffness
from cranktopo.meshing.solid_mesh import mesh_throw
from cranktopo.scene import load_scene

Array = NDArray[np.float64]
Solve = Callable[[Any, Array, Any], Array]
SIZES_MM = (9.45, 6.3, 4.2)
NEEDS = {
    "SuperLU": "scipy",
    "own multigrid CG": "scipy",
    "CHOLMOD": "sksparse",
    "PARDISO": "pypardiso",
    "pyamg CG": "pyamg",
}
LIMIT_S = 300


def solver(name: str, rigid: Callable[[], Array]) -> Solve:
    """Solve of a matrix (n, n) for loads (n, k); `rigid` gives the rigid motions (n, 6) of its unknowns."""
    if name in ("SuperLU", "own multigrid CG"):
        method = "direct" if name == "SuperLU" else "multigrid"
        return lambda matrix, loads, prolongation: linear.solve(matrix, loads, prolongation, method)
    if name == "CHOLMOD":
        from sksparse.cholmod import cholesky

        return lambda matrix, loads, _: cholesky(matrix.tocsc())(loads)
    if name == "PARDISO":
        import pypardiso

        return lambda matrix, loads, _: pypardiso.PyPardisoSolver(mtype=2).solve(
            sp.triu(matrix, format="csr"), loads
        )
    return lambda matrix, loads, _: _pyamg(matrix, loads, rigid())


def _pyamg(matrix: Any, loads: Array, rigid: Array) -> Array:
    """Smoothed aggregation with the rigid motions as near null space, to the tolerance of our own CG."""
    import pyamg

    levels = pyamg.smoothed_aggregation_solver(matrix, B=rigid, symmetry="symmetric", max_coarse=300)
    columns = [levels.solve(load, tol=1e-10, maxiter=2000, accel="cg") for load in loads.T]
    return np.column_stack(columns)


def row(size_mm: float, name: str) -> str:
    """One line of the table."""
    seen: dict[str, Any] = {}
    original = condense._constraints

    def constraints(model: Any, *rest: Any) -> Any:
        section, held = original(model, *rest)
        seen.update(nodes=model.nodes_mm, held=held)
        return section, held

    def rigid() -> Array:
        motions = condense.section_motions(seen["nodes"], np.arange(seen["nodes"].shape[1]))
        z = seen["nodes"][2]
        motions[1::3, condense.RX], motions[0::3, condense.RY] = -z, z
        return np.delete(motions, seen["held"], axis=0)

    solve, worst = solver(name, rigid), [0.0]

    def checked(matrix: Any, loads: Array, prolongation: Any) -> Array:
        found = solve(matrix, loads, prolongation)
        misses = np.linalg.norm(matrix @ found - loads, axis=0) / np.linalg.norm(loads, axis=0)
        worst[0] = max(worst[0], float(misses.max()))
        return found

    condense._constraints, condense.solve = constraints, checked
    scene = load_scene("mikron-iiic")
    found = condensed_stiffness(mesh_throw(scene, size_mm), scene, size_mm, 0.0)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    cost = f"{found.solve_seconds:.1f} | {peak:.0f} | {worst[0]:.0e}"
    torsion = (found.torsion["free"] or 0.0) / 1e3
    return f"| {size_mm:g} | {3 * found.nodes:,} | {name} | {cost} | {torsion:.6f} |"


def main() -> None:
    """Print the table as Markdown."""
    if len(sys.argv) == 3 and sys.argv[2] in NEEDS:
        print(row(float(sys.argv[1]), sys.argv[2]))
        return
    print(
        "| element mm | unknowns | solver | s, both condensations | peak MiB | residual | torsion kN m/rad |"
    )
    print("|---|---|---|---|---|---|---|")
    for size in sys.argv[1:] or SIZES_MM:
        for name, package in NEEDS.items():
            if importlib.util.find_spec(package):
                print(_in_own_process(str(size), name), flush=True)


def _in_own_process(size: str, name: str) -> str:
    command = [sys.executable, "-m", __spec__.name, size, name]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        return f"| {size} | - | {name} | not within {LIMIT_S} | - | - | - |"
    if done.returncode:
        return f"| {size} | - | {name} | {done.stderr.strip().splitlines()[-1]} | - | - | - |"
    return done.stdout.strip()


if __name__ == "__main__":
    main()
