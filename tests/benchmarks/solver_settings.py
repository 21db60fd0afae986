"""Do loose solves and float32 change the design? `python -m tests.benchmarks.solver_settings [CELL_MM]`.

The same optimisation of the Mikron's web with every setting of the solver. Each final shape is judged on
elements of 1.5 times the default size, and compared with the exact one (residual 1e-8 throughout, float64
cycle); its stiffness in the optimiser's model, solved to 1e-8, has no scatter of meshes.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cranktopo.accuracy.evaluation_study import stiffnesses
from cranktopo.accuracy.level import BENDING, NAME_OF_CASE, TORSION
from cranktopo.accuracy.optimiser_study import OptimiserModel, optimise_once
from cranktopo.evaluate.evaluation import RATIO, default_element_size_mm, evaluate_on_mesh
from cranktopo.optimise.loop import Solving
from cranktopo.scene import load_scene

EXACT = Solving(tolerance_early=1e-8, tolerance=1e-8, precision="float64")
SETTINGS = {
    "1e-8, float64": EXACT,
    "1e-8, float32 inside": Solving(tolerance_early=1e-8, tolerance=1e-8),
    "1e-5, float32 inside": Solving(tolerance_early=1e-5, tolerance=1e-5),
    "1e-2 early, 1e-5 last": Solving(tolerance=1e-5),
    "1e-2 early, 1e-3 last (default)": Solving(),
    "1e-2 throughout": Solving(tolerance=1e-2),
}
CELL_MM = 3.0


@dataclass(frozen=True)
class Shape:
    """A final design: what it took, and its stiffnesses by the optimiser's model and by the judge."""

    setting: str
    iterations: int
    own: dict[str, float]
    judged: dict[str, float]

    def change_percent(self, exact: Shape, by: str = "judged") -> dict[str, float]:
        """Stiffness against that of the exact design, by the judge or by the optimiser's "own" model."""
        values, reference = getattr(self, by), getattr(exact, by)
        return {name: 100 * (value / reference[name] - 1) for name, value in values.items()}


def shapes(cell_mm: float, names: tuple[str, ...] = tuple(SETTINGS)) -> Iterator[Shape]:
    """The designs of some settings, the exact one first."""
    scene = load_scene("mikron-iiic")
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            found = optimise_once(scene, OptimiserModel(cell_mm, name, SETTINGS[name]), Path(folder))
            assert found.target is not None
            own = {NAME_OF_CASE[case.name]: case.stiffness or 0.0 for case in found.own.cases}
            judged = evaluate_on_mesh(found.target, RATIO * default_element_size_mm(scene))
            yield Shape(name, found.iterations, own, stiffnesses(judged))


def main() -> None:
    """Print the table as Markdown."""
    cell = float(sys.argv[1]) if len(sys.argv) > 1 else CELL_MM
    print(
        "| residual, cycle | iterations | judged torsion kN m/rad | change % | judged bending kN/mm ", end=""
    )
    print("| change % | own torsion, change % | own bending, change % |")
    print("|---" * 8 + "|")
    exact: Shape | None = None
    for shape in shapes(cell):
        exact = exact or shape
        change, own = (shape.change_percent(exact, by) for by in ("judged", "own"))
        values = [f"{shape.judged[name] / 1e3:.2f} | {change[name]:+.3f}" for name in (TORSION, BENDING)]
        cells = [*values, f"{own[TORSION]:+.3f}", f"{own[BENDING]:+.3f}"]
        print(f"| {shape.setting} | {shape.iterations} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
