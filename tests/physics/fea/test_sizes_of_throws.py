"""A throw of any size is meshed and evaluated as one of usual size, only larger or smaller."""

from __future__ import annotations

import pytest

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scaled_throw
from cranktopo.tasks.throw_fea.evaluation import evaluate_on_mesh
from cranktopo.tasks.throw_fea.targets import Target

COARSE_MM = 14.0


@pytest.mark.parametrize("factor", [1 / 7, 14.0])
def test_mesh_follows_the_throw(mikron: Scene, factor: float) -> None:
    """The same shape needs the same elements; the mesher's own rounding moves a few of them."""
    base = 2.0 if factor > 1 else 1.0  # from 42 to 84 mm of journal a fillet's size counts in mm
    usual, other = scaled_throw(mikron, base), scaled_throw(mikron, base * factor)
    nodes = [
        mesh_throw(scene, COARSE_MM * scene.throw.radius_mm / mikron.throw.radius_mm).mesh.points_mm.shape[1]
        for scene in (usual, other)
    ]
    assert nodes[1] == pytest.approx(nodes[0], rel=0.05)


def test_stiffness_follows_the_throw(mikron: Scene) -> None:
    """Torsional stiffness goes with the third power of the size, bending stiffness with the first."""
    one, other = (
        evaluate_on_mesh(Target(scene.name, scene), COARSE_MM * factor).stiffness
        for factor, scene in ((factor, scaled_throw(mikron, factor)) for factor in (1.0, 1 / 7))
    )
    for name, power in (("free", 3), ("held", 3), ("pinned", 1), ("clamped", 1)):
        expected, found = ((each.torsion | each.bending)[name] or 0.0 for each in (one, other))
        assert found * 7**power == pytest.approx(expected, rel=1e-2), name  # of the mesh
