"""Time of an evaluation for the same bound: a second, coarser mesh against what the mesh itself misses.

    python -m tests.benchmarks.evaluation_bounds [ENGINE]

Prints bounds and seconds of both on four meshes as Markdown, then the seconds for the bound of the default
mesh, on a line through the logarithms; inf: on none of these meshes. On a quiet machine.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch

import numpy as np

from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.tetrahedra.mesh import RATIO
from cranktopo.tasks.throw_fea import evaluation
from cranktopo.tasks.throw_fea.error_bound import change_bound_percent
from cranktopo.tasks.throw_fea.evaluation import MeshResult, evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target

STEPS = (3, 2, 1, 0, -1)
"""Element sizes as powers of 1.5 over the default; the first one is only the coarser one of the next."""


@dataclass(frozen=True)
class Timed:
    """A mesh, and the seconds that its own bound took."""

    found: MeshResult
    bound_s: float

    @property
    def own_percent(self) -> float:
        """Bound by what the mesh misses, the larger of torsion and bending."""
        fine = self.found.stiffness
        values = (*fine.torsion_error_percent.values(), *fine.bending_error_percent.values())
        return max(value for value in values if value is not None)

    def pair_percent(self, coarse: MeshResult) -> float:
        """Bound by the change from a coarser mesh, the larger of torsion and bending."""
        one, other = coarse.stiffness, self.found.stiffness
        return max(
            change_bound_percent(one.torsion, other.torsion),
            change_bound_percent(one.bending, other.bending),
        )

    @property
    def bare_s(self) -> float:
        """Seconds of mesh and solve without a bound."""
        return self.found.seconds - self.bound_s


def timed(target: Target, steps: int) -> Timed:
    """A target on one mesh."""
    taken, own = [], evaluation.discretisation_errors

    def missed(*args: Any) -> Any:
        began = time.perf_counter()
        energies = own(*args)
        taken.append(time.perf_counter() - began)
        return energies

    with patch.object(evaluation, "discretisation_errors", missed):
        found = evaluate_on_mesh(target, default_element_size_mm(target.scene) * RATIO**steps)
    return Timed(found, taken[0])


def seconds_for(percent: float, bounds: list[float], seconds: list[float]) -> float:
    """Seconds for a bound, from the coarsest mesh to the finest."""
    return float(np.exp(np.interp(-np.log(percent), -np.log(bounds), np.log(seconds), right=np.inf)))


def main(engine: str = "mikron-iiic-plain") -> None:
    """Print the table as Markdown."""
    target = Target(engine, planned_scene(load_scene(engine)))
    timed(target, STEPS[0])  # imports and caches
    coarse, *meshes = (timed(target, steps) for steps in STEPS)
    print("| element mm | bound of its own % | s | bound by a second mesh % | s, both |\n" + "|---" * 5 + "|")
    own: tuple[list[float], list[float]] = [], []
    pairs: tuple[list[float], list[float]] = [], []
    for mesh in meshes:
        for (bounds, seconds), percent, taken in (
            (own, mesh.own_percent, mesh.found.seconds),
            (pairs, mesh.pair_percent(coarse.found), mesh.bare_s + coarse.bare_s),
        ):
            bounds.append(percent)
            seconds.append(taken)
        cells = (own[0][-1], own[1][-1], pairs[0][-1], pairs[1][-1])
        size = mesh.found.stiffness.element_size_mm
        print(f"| {size:.3g} | {' | '.join(f'{cell:.2f}' for cell in cells)} |")
        coarse = mesh
    percent = own[0][STEPS.index(0) - 1]
    print(f"\n{percent:.2f} %: {seconds_for(percent, *own):.1f} s by the mesh itself, ", end="")
    print(f"{seconds_for(percent, *pairs):.1f} s by a second mesh")


if __name__ == "__main__":
    main(*sys.argv[1:])
