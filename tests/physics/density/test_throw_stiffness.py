"""The throw model against a body-fitted reference, and against itself in other extents and supports."""

from __future__ import annotations

import jax.numpy as jnp
import pytest

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.grid import Extent
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.model import build_model
from cranktopo.tasks.density.response import compliances, solve, stiffness
from tests.physics.density.throw_cases import BENDING, TANGENTIAL, TORSION

# Body-fitted quadratic tetrahedra, refined at the re-entrant rings, E = 210 GPa, no fillets.
FREE_NM_PER_RAD, PINNED_N_PER_MM = 138.2e3, 217.6e3


def stiffnesses(
    scene: Scene, resolution_mm: float, extent: Extent | None = None, **supports: object
) -> dict[str, float]:
    scene = scene.model_copy(update={"supports": scene.supports.model_copy(update=supports)})
    domain = build_domain(scene, resolution_mm, "web", extent)
    cases = (BENDING, TORSION, TANGENTIAL)
    model = build_model(scene, domain, cases)
    solution = solve(model, jnp.asarray(domain.passive_fraction), tolerance=1e-10)
    work = compliances(model, solution.displacements)
    return {case.name: stiffness(model, float(c), case.name) for case, c in zip(cases, work, strict=True)}


@pytest.mark.slow
def test_original_web_at_1_mm(float64: None, mikron: Scene) -> None:
    result = stiffnesses(mikron, 1.0)
    assert result["torsion"] == pytest.approx(FREE_NM_PER_RAD, rel=0.015)
    assert result["bending"] == pytest.approx(PINNED_N_PER_MM, rel=0.03)


@pytest.mark.slow
def test_original_web_at_half_a_mm(float64: None, mikron: Scene) -> None:
    result = stiffnesses(mikron, 0.5)
    assert result["torsion"] == pytest.approx(FREE_NM_PER_RAD, rel=0.0075)
    assert result["bending"] == pytest.approx(PINNED_N_PER_MM, rel=0.015)


CELL_MM = 10.0
"""Coarse: what follows holds on any grid, and its programs are those of test_gradients.py."""
FREE = {"torsion": "free", "bending": "pinned"}
SPRINGS = {"torsion": "spring", "bending": "spring", "bearing_spring_N_per_mm": 2e5}


@pytest.mark.parametrize(
    ("supports", "extents"),
    [
        pytest.param(SPRINGS, ("quarter", "half"), marks=pytest.mark.slow),
        pytest.param(FREE, ("quarter", "half"), marks=pytest.mark.slow),
        pytest.param(SPRINGS, ("half", "full"), marks=pytest.mark.slow),
        pytest.param(FREE, ("half", "full"), marks=pytest.mark.slow),
    ],
)
def test_extents_agree(
    float64: None, mikron: Scene, supports: dict[str, object], extents: tuple[Extent, Extent]
) -> None:
    small, large = (stiffnesses(mikron, CELL_MM, extent, **supports) for extent in extents)
    assert small == pytest.approx(large, rel=1e-6)


@pytest.mark.slow
def test_half_and_full_agree_on_an_asymmetric_web(float64: None, mikron: Scene) -> None:
    """A pocket beside the mirror plane: both load cases then move the section in all six motions."""
    data = mikron.model_dump()
    data["web"]["pocket"] = [{"shape": "cylinder", "x_mm": 15.0, "y_mm": 20.0, "diameter_mm": 14.0}]
    lopsided = Scene.model_validate(data)
    half, full = (stiffnesses(lopsided, CELL_MM, extent, **SPRINGS) for extent in ("half", "full"))
    assert full == pytest.approx(half, rel=1e-6)
    assert half["torsion"] < 0.99 * stiffnesses(mikron, CELL_MM, "half", **SPRINGS)["torsion"]


@pytest.mark.slow
def test_supports_order_the_stiffnesses(float64: None, mikron: Scene) -> None:
    """Springs lie between free and held, and approach them at the ends of their range."""
    free = stiffnesses(mikron, CELL_MM, torsion="free", bending="pinned")
    held = stiffnesses(mikron, CELL_MM, torsion="held", bending="clamped")
    stiff, soft = (
        stiffnesses(mikron, CELL_MM, torsion="spring", bending="spring", bearing_spring_N_per_mm=k)
        for k in (1e9, 1e5)
    )
    assert held["torsion"] > 1.3 * free["torsion"]
    assert held["bending"] > 4.0 * free["bending"]
    assert stiff["torsion"] == pytest.approx(free["torsion"], rel=1e-3)
    assert stiff["bending"] == pytest.approx(free["bending"], rel=1e-3)
    # A rigid pin on two springs moves by F / (2 k) in addition.
    assert 1 / soft["bending"] - 1 / free["bending"] == pytest.approx(1 / 2e5, rel=1e-6)


def test_scaling_of_loads_does_not_change_stiffness(float64: None, mikron: Scene) -> None:
    domain = build_domain(mikron, CELL_MM, "web")
    values = []
    for factor in (1.0, 1e4):
        case = BENDING.model_copy(update={"radial_N": factor})
        model = build_model(mikron, domain, (case, TORSION, TANGENTIAL))
        work = compliances(model, solve(model, jnp.asarray(domain.passive_fraction)).displacements)
        values.append(stiffness(model, float(work[0]), "bending"))
    assert values[1] == pytest.approx(values[0], rel=1e-9)
