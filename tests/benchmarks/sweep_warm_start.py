"""Rising demands one after the other, each from the web before, or side by side from the design's own.

    python -m tests.benchmarks.sweep_warm_start [DEMANDS]

Least mass of `mikron-iiic-plain` for torsional stiffness from 95 to 115 %: the chain in one process with
all cores, the others on two workers as `cranktopo sweep` runs them. Masses are those of the evaluation.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from cranktopo import sweep
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.web_shape.run import shape_design

LOW, HIGH = 95, 115


def main(demands: int = 4) -> None:
    """Print the table as Markdown."""
    limits = [f"{LOW + (HIGH - LOW) * n / (demands - 1):g}" for n in range(demands)]
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        chained = chain(limits, Path(folder))
        middle = time.perf_counter()
        frame = sweep(
            vary={"effects.bound": ["off"]},
            stage="shape",
            minimise="mass",
            limits=[f"torsion >= {LOW}:{HIGH}:{demands} %"],
            workers=2,
            out=Path(folder) / "sweep",
        )
        end = time.perf_counter()
    heads = " | ".join(f"kg at >= {limit} %" for limit in limits)
    print(f"| | s | {heads} |\n|{'---|' * (demands + 2)}")
    for name, seconds, masses in (
        ("one after the other, from the web before", middle - began, chained),
        ("side by side, from the design", end - middle, frame["mass_kg"].tolist()),
    ):
        print(f"| {name} | {seconds:.0f} | {' | '.join(f'{mass:.4f}' for mass in masses)} |")


def chain(limits: list[str], folder: Path) -> list[float]:
    """Masses of the webs, each the start of the next search, kg."""
    begun: Scene | None = None
    found: list[float] = []
    for limit in limits:
        plain = load_scene("mikron-iiic-plain").with_effect("bound", "off")
        scene = with_goal(plain, minimise="mass", limits=[f"torsion >= {limit} %"])
        done = shape_design(scene, out=folder / limit, begun=begun)
        found.append(done.result.result.mass_kg.throw)
        begun = load_scene(str(done.folder / done.result.files.design))
    return found


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
