"""An effect that is off costs nothing: solves, load columns, cells and meshes are counted per scene."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import jax.numpy as jnp
import pytest

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.grid.equilibrium import Solution
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import loop, proposals, response, stage
from cranktopo.tasks.density.build import build_problem


@dataclass
class Counts:
    """What one design iteration asked of the solver."""

    solves: int = 0
    columns: int = 0
    body_forces: int = 0
    meshes: int = 0
    cases: tuple[str, ...] = field(default=())


@pytest.fixture
def count(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Count one design iteration of a scene; the linear solve returns the load, mass slopes are zero."""

    def run(scene: Scene) -> Counts:
        counts = Counts()

        def fake(tables: Any, system: Any, *_: Any) -> Solution:
            counts.solves += 1
            counts.columns += system.forces.shape[0]
            return Solution(system.forces, jnp.zeros(system.forces.shape[0]), 1)

        def body(model: Any, u: Any, solid: Any) -> Any:
            counts.body_forces += 1
            return jnp.zeros((len(u), *solid.shape))

        def mesh(*_: object) -> None:
            counts.meshes += 1

        monkeypatch.setattr(response, "solve_system", fake)
        monkeypatch.setattr(proposals, "compliance_gradients_by_solid", body)
        monkeypatch.setattr("gmsh.initialize", mesh)
        with double_precision():
            prepared = stage.prepare(scene)
            problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
            loop.step(problem, loop.init(problem))
        counts.cases = problem.model.case_names
        return counts

    return run


def variant(mikron: Scene, **changes: Any) -> Scene:
    """The Mikron on a coarse grid with dotted keys changed."""
    data = mikron.model_dump(mode="json", exclude_none=True)
    data["optimise"]["resolution_mm"] = 4.5
    for key, value in changes.items():
        table: Any = data
        *path, last = key.split("__")
        for part in path:
            table = table.setdefault(part, {})
        table[last] = value
    return scene_from_dict(data)


def cells(prepared: stage.Prepared) -> int:
    return math.prod(prepared.domain.grid.cells)


@pytest.mark.parametrize(
    ("changes", "cases"),
    [
        ({}, ("bending", "torsion")),
        ({"effects__bending": "off"}, ("torsion",)),
        ({"effects__torsion": "off"}, ("bending",)),
        ({"effects__tangential": "on"}, ("bending", "torsion", "tangential")),
        (
            {"engine__overspeed_rpm": 9000.0, "optimise__weights__centrifugal": 0.5},
            ("bending", "torsion", "centrifugal"),
        ),
        (
            {"throw__main_journal__bore_diameter_mm": 0.0, "throw__crankpin__bore_diameter_mm": 0.0},
            ("bending", "torsion"),
        ),
        ({"effects__fatigue": "on", "effects__fillets": "on"}, ("bending", "torsion")),
        ({"supports__torsion": "held", "supports__bending": "clamped"}, ("bending", "torsion")),
    ],
    ids=[
        "default",
        "torsion only",
        "bending only",
        "tangential",
        "high speed",
        "no bores",
        "with fatigue",
        "held bearings",
    ],
)
def test_what_a_scene_costs(
    count: Any, mikron: Scene, changes: dict[str, Any], cases: tuple[str, ...]
) -> None:
    counts = count(variant(mikron, **changes))
    assert counts.cases == cases
    assert (counts.solves, counts.meshes) == (1, 0)
    assert counts.columns == len(cases)
    assert counts.body_forces == ("centrifugal" in cases)


def test_the_mirror_halves_the_cells(mikron: Scene) -> None:
    """An envelope that is not its own mirror image needs the half model, and no other scene does."""
    points = [(-48, -34), (48, -34), (48, 82), (-48, 82)]
    symmetric = stage.prepare(variant(mikron, envelope={"shape": "outline", "points_mm": points}))
    lopsided = stage.prepare(
        variant(mikron, envelope={"shape": "outline", "points_mm": [(-40, -34), *points[1:]]})
    )
    assert cells(symmetric) == cells(stage.prepare(variant(mikron)))
    assert cells(lopsided) >= 1.5 * cells(symmetric)
    assert len(lopsided.cases) == len(symmetric.cases)
