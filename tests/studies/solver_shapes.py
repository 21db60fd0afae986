"""The same optimisation of the Mikron's web with every setting of the solver.

Each final shape is evaluated on elements of 1.5 times the default size; its stiffness in the optimiser's
model, solved to 1e-8, has no scatter of meshes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.accuracy.optimiser_levels import OptimiserModel, optimise_once
from cranktopo.tasks.density.problem import SolverSettings
from cranktopo.tasks.throw_fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.throw_fea.levels import stiffnesses
from cranktopo.tasks.throw_fea.studies import NAME_OF_CASE

EXACT = SolverSettings(tolerance_early=1e-8, tolerance=1e-8, precision="float64")
SETTINGS = {
    "1e-8, float64": EXACT,
    "1e-8, float32 inside": SolverSettings(tolerance_early=1e-8, tolerance=1e-8),
    "1e-5, float32 inside": SolverSettings(tolerance_early=1e-5, tolerance=1e-5),
    "1e-2 early, 1e-5 last": SolverSettings(tolerance=1e-5),
    "1e-2 early, 1e-3 last (default)": SolverSettings(),
    "1e-2 throughout": SolverSettings(tolerance=1e-2),
}


@dataclass(frozen=True)
class Shape:
    """A final design: what it took, and its stiffnesses by the optimiser's model and by the evaluation."""

    setting: str
    iterations: int
    own: dict[str, float]
    evaluated: dict[str, float]

    def change_percent(self, exact: Shape, by: str = "evaluated") -> dict[str, float]:
        """Stiffness against that of the exact design, "evaluated" or by the optimiser's "own" model."""
        values, reference = getattr(self, by), getattr(exact, by)
        return {name: 100 * (value / reference[name] - 1) for name, value in values.items()}


def shapes(cell_mm: float, names: tuple[str, ...] = tuple(SETTINGS)) -> Iterator[Shape]:
    """The designs of some settings, the exact one first."""
    scene = load_scene("mikron-iiic-plain").with_optimise(process="free")
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            found = optimise_once(scene, OptimiserModel(cell_mm, name, SETTINGS[name]), Path(folder))
            assert found.target is not None
            own = {NAME_OF_CASE[case.name]: case.stiffness or 0.0 for case in found.own.cases}
            mesh = evaluate_on_mesh(found.target, RATIO * default_element_size_mm(scene))
            yield Shape(name, found.iterations, own, stiffnesses(mesh))
