"""Peak memory of an optimisation against the estimate that refuses too fine a resolution.

Run with `python -m tests.benchmarks.memory`: each row is a process of its own that evaluates two designs,
with nothing compiled before.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from cranktopo.bodies.memory import optimiser_memory_MiB
from cranktopo.design.loading import load_scene
from tests.benchmarks.solver import COMPILED_ANEW

CELLS_MM = (3.0, 2.0, 1.5, 1.0, 0.8)
CASES = {2: "", 4: 'tangential = "on"\ncentrifugal = "on"\n[optimise.weights]\ncentrifugal = 0.5\n'}
DESIGN = Path(__file__).parents[2] / "designs" / "mikron-iiic-plain.toml"


def measured_MiB(design: Path, cell_mm: float) -> tuple[int, float]:
    """Cells, padding included, and peak memory of one process."""
    program = "import sys; from cranktopo.app.main import main; sys.exit(main())"
    command = [sys.executable, "-c", program, "optimise", str(design), "--json"]
    command += ["--resolution-mm", str(cell_mm), "--max-iterations", "2"]
    command += ["--out", str(design.parent / f"{design.stem}-{cell_mm:g}")]
    here = os.environ | COMPILED_ANEW
    done = subprocess.run(command, capture_output=True, text=True, env=here)
    metrics = json.loads(done.stdout)
    return math.prod(metrics["grid"]["cells"]), metrics["peak_memory_MiB"]


def main() -> None:
    """Print the table as Markdown."""
    print("| load cases | cell mm | cells | measured MiB | estimated MiB |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for cases, extra in CASES.items():
            design = Path(folder) / f"cases-{cases}.toml"
            text = DESIGN.read_text(encoding="utf-8")
            design.write_text(
                text.replace('tangential = "off"\n', extra) if extra else text, encoding="utf-8"
            )
            scene = load_scene(str(design))
            for cell in CELLS_MM:
                count, peak = measured_MiB(design, cell)
                estimate = optimiser_memory_MiB(scene, cell, True, cases)
                print(f"| {cases} | {cell:g} | {count:,} | {peak:,.0f} | {estimate:,.0f} |", flush=True)


if __name__ == "__main__":
    main()
