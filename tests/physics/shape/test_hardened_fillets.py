"""Hardened fillets on the coarse mesh of a search: its safety and gradient are those of the assessment."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.hardening import Hardening
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import load_history
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.stress import nodal_stress, outer_surface, surface_stress
from cranktopo.tasks.throw_fatigue.fillets import fillet_nodes
from cranktopo.tasks.throw_fatigue.mesh_quality import Quality
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, safety_field
from cranktopo.tasks.throw_fatigue.stress_model import StressModel, images_of
from cranktopo.tasks.throw_fatigue.text import field_remarks
from cranktopo.tasks.throw_fea.unit_fields import unit_fields
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from tests.physics.shape.shape_cases import COARSE_FILLET, COARSE_MM, full_web

INDUCTION: dict[str, Any] = {
    "process": "induction",
    "case_depth_mm": 0.6,
    "surface_hardness_HV": 550.0,
}
CORE: dict[str, Any] = {
    "process": "induction",
    "case_depth_mm": 1.0,
    "surface_hardness_HV": 340.0,
    "core_hardness_HV": 340.0,
    "transition_hardness_HV": 340.0,
    "residual_stress_MPa": ((0.0, 0.0),),
}


def hardened(scene: Scene, **table: Any) -> Scene:
    fatigue = scene.fatigue.model_copy(update={"hardening": Hardening.model_validate(table)})
    return scene.model_copy(update={"fatigue": fatigue})


def untreated(scene: Scene) -> Scene:
    return scene.model_copy(update={"fatigue": scene.fatigue.model_copy(update={"hardening": None})})


def stress_model(scene: Scene, mesh: TetMesh) -> StressModel:
    elastic = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(mesh, *elastic)
    kinds = load_kinds(scene, "extremes")[1]
    fields = unit_fields(model, scene, mesh.mirrored, kinds)
    found = nodal_stress(model, np.stack([f.displacement_mm for f in fields]), *elastic)
    surface = outer_surface(model, found.elements, ((2, 0.0), (2, scene.pitch_mm / 2), (0, 0.0)))
    on = [fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin")]
    stresses, images = surface_stress(model, surface, found), images_of(fields, mirrored=True)
    quality = Quality(1.0, 1.0, 1, 0.0, 0.0, 0.0, 0.0)
    return StressModel("web", scene, 1.0, kinds, surface, stresses, images, on[0], on[1], quality)


def assessed(model: StressModel, scene: Scene, method: str = "lsa") -> FatigueField:
    history = load_history(scene, "extremes", load_kinds(scene, "extremes")[0])
    return safety_field(StressModel(**{**vars_of(model), "scene": scene}), method, history)


def vars_of(model: StressModel) -> dict[str, Any]:
    return {name: getattr(model, name) for name in model.__dataclass_fields__}


@pytest.fixture(scope="module")
def coarse() -> tuple[Scene, MeshModel, StressModel]:
    scene, layout, values = full_web()
    treated = hardened(scene, **INDUCTION)
    model = MeshModel(treated, layout, values, COARSE_MM, COARSE_FILLET)
    return model.scene, model, stress_model(model.scene, model.moved.mesh)


@pytest.mark.slow
def test_the_search_has_the_safety_of_the_assessment(coarse: tuple[Scene, MeshModel, StressModel]) -> None:
    scene, search, model = coarse
    values = full_web()[2]
    found = search.responses(values)
    treated = assessed(model, scene)
    assert found.values["fatigue_safety"] == pytest.approx(treated.critical.safety, rel=1e-9)
    direction, step = np.random.default_rng(7).standard_normal(len(values)), 1e-3
    above, below = (search.responses(values + s * step * direction) for s in (1, -1))
    for name in (key for key in found.gradients if "fatigue" in key):
        measured = (above.values[name] - below.values[name]) / (2 * step)
        assert found.gradients[name] @ direction == pytest.approx(measured, rel=2e-2, abs=1e-5)


@pytest.mark.parametrize("method", ["lsa", pytest.param("fkm", marks=pytest.mark.slow)])
def test_a_core_of_one_hardness_is_the_untreated_crank(
    coarse: tuple[Scene, MeshModel, StressModel], method: str
) -> None:
    scene, _, model = coarse
    plain, core = assessed(model, untreated(scene), method), assessed(model, hardened(scene, **CORE), method)
    assert core.safety == pytest.approx(plain.safety, rel=1e-12)
    assert core.critical.strength_MPa == pytest.approx(plain.critical.strength_MPa, rel=1e-12)
    assert not plain.hardening
    assert plain.critical.depth_mm is None
    assert {told.depth_mm for told in core.hardening.values()} == {0.0}


def test_only_the_treated_fillet_changes(coarse: tuple[Scene, MeshModel, StressModel]) -> None:
    scene, _, model = coarse
    plain = assessed(model, untreated(scene))
    pin = assessed(model, hardened(scene, fillets="pin", **INDUCTION))
    off = ~model.on_pin
    assert (pin.safety[:, off] == plain.safety[:, off]).all()
    assert pin.fillet_safety["journal"] == plain.fillet_safety["journal"]
    assert set(pin.hardening) == {"pin"}
    told = pin.hardening["pin"]
    assert told.safety == pytest.approx(pin.fillet_safety["pin"], rel=1e-12)
    assert told.safety == min(told.safety_surface, told.safety_below)
    (line,) = field_remarks([pin])
    where = "at the surface" if told.depth_mm == 0 else f"{told.depth_mm:.2g} mm below the surface"
    assert f"pin fillet, induction: decided {where}, safety {told.safety:.3f}" in line
