"""The judge's two solvers on the built-in throw: factorisation against p-multigrid conjugate gradients.

Run with `python -m tests.benchmarks.judge_solvers`; seconds for both condensations, each in a process of its
own so that peak memory is its own.
"""

from __future__ import annotations

import resource
import subprocess
import sys

from cranktopo.evaluate import linear
from cranktopo.evaluate.evaluation import condensed_stiffness
from cranktopo.remodel.meshing import mesh_throw
from cranktopo.scene import load_scene

SIZES_MM = (9.45, 6.3, 4.2)
LIMITS = {"direct": 10**9, "multigrid": 0}


def row(size_mm: float, method: str) -> str:
    """One line of the table."""
    linear.DIRECT_LIMIT = LIMITS[method]
    scene = load_scene("mikron-iiic")
    found = condensed_stiffness(mesh_throw(scene, size_mm), scene, size_mm, 0.0)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    cost = f"{found.solve_seconds:.1f} | {peak:.0f}"
    torsion = (found.torsion["free"] or 0.0) / 1e3
    return f"| {size_mm:g} | {3 * found.nodes:,} | {method} | {cost} | {torsion:.6f} |"


def main() -> None:
    """Print the table as Markdown."""
    if len(sys.argv) == 3:
        print(row(float(sys.argv[1]), sys.argv[2]))
        return
    print("| element mm | unknowns | solver | s, both condensations | peak MiB | torsion kN m/rad |")
    print("|---|---|---|---|---|---|")
    for size in SIZES_MM:
        for method in LIMITS:
            command = [sys.executable, "-m", __spec__.name, str(size), method]
            done = subprocess.run(command, capture_output=True, text=True, check=True)
            print(done.stdout, end="", flush=True)


if __name__ == "__main__":
    main()
