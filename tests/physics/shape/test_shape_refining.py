"""Refining by few meshed webs: the rough model is trusted for curvature, never for where the optimum is."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.mesh_model import MeshedWebs
from cranktopo.tasks.web_shape.refining import CorrectedSurrogate, Refinement, merit, refined
from cranktopo.tasks.web_shape.search_goal import Quantities, SearchGoal
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.physics.shape.shape_cases import Array

LAYOUT = Layout(7, (FittedBevel("journal"), FittedBevel("pin")))
START = np.array([-24.5, 73.0, 17.0, 28.0, 29.0, 27.0, 17.0, 40.0, 9.0, 1.0, 10.0, 8.0, 0.8])
MIDDLE = np.arange(3, 6)
"""Half-widths in the middle, which no rule of this web holds."""
TRUE, ROUGH = np.array([28.6, 30.0, 26.4]), np.array([27.0, 31.5, 28.0])
EXTENT = Refinement(8, 30, 3.0, 1e-9)


@dataclass
class Bowls:
    """Mass as 100 and a bowl over three half-widths, torsion by the second of them and its square.

    Attributes:
        steepness: of the bowl along each of them.
        widest_mm: second half-width above which a web cannot be solved.
    """

    scene: Scene
    lowest: Array
    steepness: Array
    knows_torsion: bool = True
    widest_mm: float = np.inf
    solved: int = 0

    def web(self, layout: Layout) -> ParametricWeb:
        return MeshedWebs(self.scene, ManufacturingLimits(), 10.0).web(layout)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> Quantities:
        if values[4] > self.widest_mm:
            raise CranktopoError("mesh: an element folds.", hint="Smaller steps.", code=ExitCode.SOLVER)
        self.solved += 1
        away = values[MIDDLE] - self.lowest
        slope, second = np.zeros(len(values)), np.zeros(len(values))
        slope[MIDDLE], second[4] = 2 * self.steepness * away, 1 + 0.02 * values[4]
        found = {"mass": (100 + float(self.steepness @ away**2), slope)}
        if self.knows_torsion:
            found["torsion"] = (values[4] + 0.01 * values[4] ** 2, second)
        return Quantities({k: v for k, (v, _) in found.items()}, {k: s for k, (_, s) in found.items()})


def bowls(widest_mm: float = np.inf) -> tuple[Bowls, Bowls]:
    """A rough model with another bowl that knows no torsion, and the true one."""
    scene = load_scene("mikron-iiic-plain")
    rough = Bowls(scene, ROUGH, np.array([1.5, 0.7, 1.2]), knows_torsion=False)
    return rough, Bowls(scene, TRUE, np.array([1.0, 1.0, 1.4]), widest_mm=widest_mm)


def test_a_matched_web_has_the_value_and_the_slopes_of_the_exact_one() -> None:
    rough, exact = bowls()
    web, names = exact.web(LAYOUT), ("mass", "torsion")
    at = START + 0.3
    truth = exact.responses(web, at, names)
    matched = CorrectedSurrogate(rough, at, rough.responses(web, at, names), truth)
    found = matched.responses(web, at, names)
    assert found.values == pytest.approx(truth.values, rel=1e-14)
    for name in names:
        assert found.gradients[name] == pytest.approx(truth.gradients[name], abs=1e-12)
    step = np.linspace(-1, 1, len(at))
    away = matched.responses(web, at + step, ("torsion",))
    assert away.values["torsion"] == pytest.approx(
        truth.values["torsion"] + truth.gradients["torsion"] @ step
    )


def test_the_optimum_is_that_of_the_meshed_webs() -> None:
    rough, exact = bowls()
    found = refined(rough, exact, LAYOUT, START, SearchGoal("mass", 1.0, 100.0, ()), StageMemory(), EXTENT)
    assert found.values[MIDDLE] == pytest.approx(TRUE, abs=0.02)
    assert exact.solved < 10
    assert found.solved == rough.solved + exact.solved


def test_a_limit_that_only_the_meshed_webs_know_is_kept() -> None:
    """With the second half-width held at 29 mm or less the bowl's lowest point is out of reach."""
    rough, exact = bowls()
    goal = SearchGoal("mass", 1.0, 100.0, (Constraint("torsion", "<=", 29.0 + 0.01 * 29.0**2),))
    found = refined(rough, exact, LAYOUT, START, goal, StageMemory(), EXTENT)
    assert found.values[MIDDLE] == pytest.approx([TRUE[0], 29.0, TRUE[2]], abs=0.02)
    assert merit(goal, found.quantities.values) == pytest.approx(1.01, abs=1e-4)


def test_a_web_that_cannot_be_solved_shortens_the_step() -> None:
    (rough, exact), told = bowls(widest_mm=29.5), list[str]()
    goal = SearchGoal("mass", 1.0, 100.0, ())
    with redirected(told.append):
        found = refined(rough, exact, LAYOUT, START, goal, StageMemory(), EXTENT)
    assert 29.0 < found.values[4] <= 29.5
    assert "an element folds" in told[0]


def test_a_start_that_cannot_be_solved_is_an_error() -> None:
    rough, exact = bowls(widest_mm=20.0)
    with pytest.raises(CranktopoError, match="folds"):
        refined(rough, exact, LAYOUT, START, SearchGoal("mass", 1.0, 100.0, ()), StageMemory(), EXTENT)
