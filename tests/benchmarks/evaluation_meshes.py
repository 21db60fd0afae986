"""What the mesh of the evaluation costs and gives: the sharp Mikron throw, graded at its rings and uniform.

Run with `python -m tests.benchmarks.evaluation_meshes`. Each mesh is a fresh process, so that peak memory is
its own. Errors are against the reference of tests/physics/fea/test_evaluation_reference.py (no fillets).
"""

from __future__ import annotations

import resource
import subprocess
import sys

from cranktopo.design.halves import default_element_size_mm
from tests.physics.fea.evaluation_cases import mikron_with
from tests.physics.fea.test_evaluation_reference import errors_percent, stiffness_on

MESHES = (
    *((size, True) for size in (9.45, 6.3, 4.2, 2.8)),
    *((size, False) for size in (6.3, 4.2, 2.8, 2.0)),
)


def row(size_mm: float, graded: bool) -> str:
    """One line of the table; runs in a process of its own."""
    found = stiffness_on(size_mm, graded)
    values = {**found.torsion, **found.bending}
    errors = errors_percent(found)
    kind = "graded" if graded else "uniform"
    default = " (default)" if graded and size_mm == default_element_size_mm(mikron_with()) else ""
    cells = [f"{values[name] / 1e3:.2f} ({error:+.2f})" for name, error in errors.items()]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    seconds = f"{found.mesh_seconds:.1f} | {found.solve_seconds:.1f}"
    return (
        f"| {kind} {size_mm:g} mm{default} | {found.nodes:,} | {' | '.join(cells)} | {seconds} | {peak:.0f} |"
    )


def main() -> None:
    """Print the table as Markdown."""
    if len(sys.argv) == 3:
        print(row(float(sys.argv[1]), sys.argv[2] == "graded"))
        return
    torsion, bending = "free | held", "pinned | clamped"
    print(
        f"| mesh | nodes | torsion kN m/rad (error %): {torsion} | bending kN/mm (error %): {bending} ",
        end="",
    )
    print("| s, mesh | s, solve | peak MiB |")
    print("|---" * 9 + "|")
    for size, graded in MESHES:
        command = [sys.executable, "-m", __spec__.name, f"{size}", "graded" if graded else "uniform"]
        print(subprocess.run(command, capture_output=True, text=True, check=True).stdout, end="", flush=True)


if __name__ == "__main__":
    main()
