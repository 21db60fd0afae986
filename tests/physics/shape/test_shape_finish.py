"""The finish on body-fitted elements: limits of stiffness and fatigue, prices, webs that cannot be solved."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.base.progress import StageMemory
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.dimension_search import SearchBudget
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.tasks.refit.family import Layout, web_of
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs, MeshResponses
from cranktopo.tasks.web_shape.search import best_values
from cranktopo.tasks.web_shape.search_goal import SearchGoal
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.physics.shape.shape_cases import COARSE_MM, Array

LAYOUT = Layout(7, (FittedBevel("journal"), FittedBevel("pin")))
START = np.array([-24.5, 73.0, 17.0, 28.0, 29.0, 27.0, 17.0, 40.0, 9.0, 1.0, 10.0, 8.0, 0.8])
LIMITS = ManufacturingLimits()


@dataclass
class Brittle:
    """Mass of a web by a plane: sum of its dimensions; webs beyond a width cannot be solved."""

    scene: Scene
    widest_mm: float
    solved: int = 0

    def web(self, layout: Layout) -> ParametricWeb:
        return MeshedWebs(self.scene, LIMITS, COARSE_MM).web(layout)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> MeshResponses:
        if values[4] > self.widest_mm:
            raise CranktopoError("mesh: an element folds.", hint="Smaller steps.", code=ExitCode.SOLVER)
        self.solved += 1
        slopes = {"mass": np.ones(len(values)), "torsion": np.eye(len(values))[4]}
        return MeshResponses({"mass": values.sum(), "torsion": values[4]}, slopes)


def test_a_search_goes_on_in_smaller_steps_where_a_web_cannot_be_solved() -> None:
    webs, told = Brittle(load_scene("mikron-iiic-plain"), 31.0), list[str]()
    goal = SearchGoal("torsion", -1.0, 30.0, ())
    effort = SearchBudget(40, 8.0)
    with redirected(told.append):
        found, _ = best_values(lambda: webs, LAYOUT, START, goal, "a", StageMemory(), effort)
    assert found is not None
    assert 30.0 < found[4] <= 31.0
    assert "an element folds" in told[0]
    assert "smaller steps" in told[0]


def test_a_first_web_that_cannot_be_solved_is_an_error() -> None:
    webs, goal = Brittle(load_scene("mikron-iiic-plain"), 10.0), SearchGoal("mass", 1.0, 1.0, ())
    with pytest.raises(CranktopoError, match="folds"):
        best_values(lambda: webs, LAYOUT, START, goal, "a", StageMemory(), SearchBudget(40, 8.0))


def test_a_web_on_which_the_usual_meshes_fold_is_meshed() -> None:
    """A deep crowned bevel over a narrow end: gmsh's Delaunay algorithms fold triangles on its long face."""
    found = np.array([-23.72, 71.82, 16.06, 26.05, 32.39, 28.58, 16.3, 25.91, 16.0, 3.27])
    scene = load_scene("mikron-iiic-plain")
    shaped = scene_with_web(scene, web_of(Layout(7, (FittedBevel("journal"),)), found, scene))
    meshed = mesh_throw(shaped, 8.0)
    volume = assemble(meshed.mesh, 1.0, 0.3).volume_mm3
    assert 2 * volume == pytest.approx(meshed.body.volume_mm3, rel=5e-3)
