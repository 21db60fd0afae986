"""What straight elements add to a stiffness: the derivative beside another solve of the curved mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.hierarchical_error import straightened
from cranktopo.numerics.tetrahedra.mesh import EDGES, TetMesh
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    bending_stiffness_N_per_mm,
    condense,
    torsional_stiffness_Nm_per_rad,
)
from cranktopo.tasks.throw_fea.error_bound import bending_shares, torsion_shares
from tests.physics.fea.evaluation_cases import elastic, mikron_with

HOLE = {"shape": "cylinder", "x_mm": 12.0, "y_mm": 24.0, "diameter_mm": 12.0}
PART = 0.1


def partly_straight(mesh: TetMesh, below_mm: float) -> TetMesh:
    """The mesh with its edges a little less curved below z, at the section too."""
    way = np.zeros_like(mesh.points_mm)
    for k, (a, b) in enumerate(EDGES):
        ends = mesh.points_mm[:, mesh.cells[a]] + mesh.points_mm[:, mesh.cells[b]]
        way[:, mesh.cells[4 + k]] = PART * (mesh.points_mm[:, mesh.cells[4 + k]] - ends / 2)
    way[:, mesh.points_mm[2] > below_mm] = 0.0
    return replace(mesh, points_mm=mesh.points_mm - way, off_surface_mm=way)


def solved(mesh: TetMesh, scene: Scene) -> tuple[Elasticity, Superelement, Superelement]:
    model = elastic(mesh, scene)
    twist = condense(model, scene, "antisymmetric", "odd" if mesh.mirrored else "none")
    return model, twist, condense(model, scene, "symmetric", "even" if mesh.mirrored else "none")


@pytest.mark.slow
@pytest.mark.parametrize("pocket", [[], [HOLE]], ids=["symmetric", "lopsided"])
def test_what_straight_elements_add(pocket: list[dict[str, object]]) -> None:
    scene = mikron_with(fillet_mm=2.5, pocket=pocket)
    curved = replace(mesh_throw(scene, 14.0).mesh, off_surface_mm=None)
    straight = partly_straight(curved, scene.web_z_mm[1] - 1.0)
    model, *blocks = solved(straight, scene)
    target, *curved_blocks = solved(curved, scene)
    youngs = scene.material.E_GPa * MPA_PER_GPA
    forms, added_mm3 = straightened(model, straight, blocks, youngs, scene.material.poisson)
    assert added_mm3 == pytest.approx(model.volume_mm3 - target.volume_mm3, rel=0.05)
    twists = [torsional_stiffness_Nm_per_rad(block, "free") for block in (blocks[0], curved_blocks[0])]
    bends = [bending_stiffness_N_per_mm(block, "pinned") for block in (blocks[1], curved_blocks[1])]
    (twist,) = torsion_shares(blocks[0], forms[:1], "free")
    (bend,) = bending_shares(blocks[1], forms[1:], "pinned")
    assert twist == pytest.approx(twists[0] / twists[1] - 1, rel=0.05)
    assert bend == pytest.approx(bends[0] / bends[1] - 1, rel=0.1)
    assert abs(bend) > 1e-5
    none, nothing = straightened(target, curved, curved_blocks, youngs, scene.material.poisson)
    assert nothing == 0.0
    assert not any(form.any() for form in none)
