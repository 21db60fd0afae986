"""Colours of a settled web: what removal costs against webs that were made thinner and solved anew."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.stress import hooke, strain_energy_density
from cranktopo.tasks.bench.colours import removal_cost
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.throw_fatigue.stress_model import StressModel, solve_stresses
from cranktopo.tasks.throw_fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness
from tests.unit.throw.test_web_features import RECTANGLE

STEP_MM, SIZE_MM = 1.5, 8.0


def wide(mikron: Scene, more_mm: float = 0.0) -> Target:
    return Target(
        "wide", scene_with_web(mikron, {**RECTANGLE, "width_mm": RECTANGLE["width_mm"] + 2 * more_mm})
    )


@pytest.fixture(scope="module")
def model(mikron: Scene) -> StressModel:
    return solve_stresses(wide(mikron), ("bending", "torsion"), 0.5)


def of_sides(model: StressModel, cost: np.ndarray, half_mm: float) -> float:
    """Integral of the cost over both sides of the web of the whole throw, over the throw's volume, per mm."""
    points, corners = model.surface.points_mm, model.surface.faces[:3]
    on_side = np.all(np.abs(np.abs(points[0, corners]) - half_mm) < 1e-6, axis=0)
    a, b, c = points[:, corners[:, on_side]].transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a, axis=0), axis=0) / 2
    held = cost[model.surface.faces[3:][:, on_side]].mean(axis=0)
    return float(len(model.images) * area @ held * 7.85e-6 / model.throw_kg)


@pytest.fixture(scope="module")
def solved(mikron: Scene) -> tuple[Stiffness, ...]:
    """Stiffness of webs whose sides are moved in, left, and moved out, on meshes of their own."""
    return tuple(evaluate_on_mesh(wide(mikron, step), SIZE_MM).stiffness for step in (-STEP_MM, 0.0, STEP_MM))


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "support"), [("torsion", "free"), ("bending", "pinned")])
def test_cost_of_removal_is_that_of_narrower_webs(
    model: StressModel, solved: tuple[Stiffness, ...], kind: str, support: str
) -> None:
    less, here, more = (float(getattr(stiffness, kind)[support]) for stiffness in solved)
    found = of_sides(model, removal_cost(model, kind, here), RECTANGLE["width_mm"] / 2)
    assert found == pytest.approx((more - less) / (2 * STEP_MM * here), rel=0.03)


def test_energy_of_any_stress() -> None:
    """Half of stress times strain, by Hooke's law the other way round."""
    strain = np.random.default_rng(3).standard_normal((5, 6))
    stress = hooke(strain, 2e5, 0.3)
    work = (stress[:, :3] * strain[:, :3]).sum(axis=1) + 2 * (stress[:, 3:] * strain[:, 3:]).sum(axis=1)
    np.testing.assert_allclose(strain_energy_density(stress, 2e5, 0.3), work / 2, rtol=1e-12)
