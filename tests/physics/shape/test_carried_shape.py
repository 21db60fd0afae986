"""What is bolted to a web follows it in `shape`: masses by closed forms, its pull by differences."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from skfem import MeshTet2

from cranktopo.base.arrays import Array
from cranktopo.base.units import density_tonne_per_mm3
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.tetrahedra.elasticity import assemble, centrifugal_force
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.tasks.refit.family import Layout, exact_web_of
from cranktopo.tasks.refit.fit import scene_with_web, usual_limits
from cranktopo.tasks.throw_fea.condense import Lateral
from cranktopo.tasks.throw_fea.turning_load import pull_slopes, pull_totals, turning_load
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.tasks.web_shape.start import scene_start
from tests.physics.fatigue.test_least_safety import single

TUNGSTEN = 17500.0
WEIGHT: dict[str, Any] = {"outer_radius_mm": 70.0, "half_angle_deg": 60.0, "density_kg_m3": TUNGSTEN}
PLUGGED: dict[str, Any] = {
    "outer_radius_mm": 70.0,
    "half_angle_deg": 60.0,
    "plug": [
        {"axis": "axial", "x_mm": 18.0, "y_mm": -45.0, "diameter_mm": 12.0, "length_mm": 9.0}
        | {"density_kg_m3": TUNGSTEN}
    ],
}


@pytest.mark.parametrize("counterweight", [WEIGHT, PLUGGED], ids=["bolted", "plug aside"])
def test_the_pull_s_derivative_by_nodes_is_that_of_differences(counterweight: dict[str, Any]) -> None:
    """On one side of x = 0, and on both with a plug that is on one. What bounds the seat stays."""
    scene, random = single(counterweight=counterweight), np.random.default_rng(5)
    mesh = mesh_throw(scene, 14.0).mesh
    body = MeshTet2(mesh.points_mm, mesh.cells)  # its order of nodes is that of slopes
    mesh = TetMesh(body.doflocs, body.dofs.element_dofs, mesh.mirrored)
    assert mesh.mirrored == (counterweight is WEIGHT)
    lateral: Lateral = "even" if mesh.mirrored else "none"
    field = random.standard_normal(mesh.points_mm.size)
    way = 1e-5 * random.standard_normal(mesh.points_mm.shape)
    for face in scene.web_z_mm:
        way[2, np.abs(mesh.points_mm[2] - face) < 1e-6] = 0.0
    way[1, np.abs(mesh.points_mm[1]) < 1e-6] = 0.0
    density = density_tonne_per_mm3(scene.material.density_kg_m3)

    def work(share: float) -> float:
        model = assemble(replace(mesh, points_mm=mesh.points_mm + share * way), 1.0, 0.3)
        pull = turning_load(model, scene, "symmetric", lateral) - centrifugal_force(model, density)
        return float(pull @ field)

    slopes, by_totals = pull_slopes(assemble(mesh, 1.0, 0.3), scene, lateral, field)
    assert 2 * float((slopes * way).sum()) == pytest.approx(work(1) - work(-1), rel=1e-5)
    assert by_totals @ pull_totals(scene) == pytest.approx(work(0), rel=1e-9)  # linear in the totals


@pytest.fixture(scope="module")
def heavy() -> tuple[MeshModel, Layout, Array]:
    """A tungsten counterweight, bolted to a web that shape would search."""
    scene = single(counterweight=WEIGHT)
    start = scene_start(scene, usual_limits(scene))
    return MeshModel(scene, start.layout, start.values, 14.0, 0.7), start.layout, start.values


def test_masses_follow_the_inner_face_of_a_bolted_counterweight(
    heavy: tuple[MeshModel, Layout, Array],
) -> None:
    """Closed forms of webs a little wider: below, the heavy part loses more than they gain."""
    model, layout, values = heavy
    found = model.responses(values, ())

    def exact(values: Array) -> Array:
        scene = scene_with_web(model.scene, exact_web_of(layout, values, model.scene))
        balance = throw_balance(scene)
        return np.array([balance.mass_kg, balance.throw_unbalance_kg_mm, balance.inertia_kg_mm2])

    for name, lighter in (("half_width_1", True), ("half_width_2", False)):
        step = 1e-2 * np.eye(len(values))[layout.names.index(name)]
        slopes = (exact(values + step) - exact(values - step)) / 2e-2
        by_mesh = [found.gradients[one][layout.names.index(name)] for one in ("mass", "unbalance", "inertia")]
        assert by_mesh == pytest.approx(slopes.tolist(), rel=1e-2), name
        assert (by_mesh[0] < 0) == lighter, name


@pytest.mark.slow
def test_the_safety_s_derivative_follows_the_pull(heavy: tuple[MeshModel, Layout, Array]) -> None:
    """Differences of the very same mesh, in a direction of all parameters."""
    model, _, values = heavy
    wanted, direction = ("fatigue_safety",), np.random.default_rng(7).standard_normal(len(values))
    found = model.responses(values, wanted)
    above, below = (model.responses(values + s * 1e-3 * direction, wanted).values for s in (1, -1))
    measured = (above["fatigue_safety"] - below["fatigue_safety"]) / 2e-3
    assert found.gradients["fatigue_safety"] @ direction == pytest.approx(measured, rel=1e-4)
