"""Pages tell the reasons of the design as it was written, where they show the plan of its planned scene."""

from __future__ import annotations

import pytest

from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan, planned_scene, with_own_reasons
from cranktopo.tasks.throw_fea.targets import resolve_target
from cranktopo.throw.face_pocket import CylinderPocket
from tests.unit.engine.plan_cases import MIKRON, with_effects, with_part

POCKET = CylinderPocket(shape="cylinder", x_mm=8.0, y_mm=24.0, diameter_mm=6.0)
SETTLED = {
    "manufacturing_constraint": MIKRON,
    "lateral_symmetry": with_part(MIKRON, "web", pocket=(POCKET,)),
    "bores": with_effects(MIKRON, bores="off"),
    "fillets": with_effects(MIKRON, fillets="off", fatigue="off"),
}
"""A design for each effect whose reason the planned scene gives as another one."""


@pytest.mark.parametrize("name", SETTLED)
def test_a_planned_scene_has_the_reasons_of_its_design(name: str) -> None:
    design = SETTLED[name]
    again = plan(planned_scene(design))
    told = with_own_reasons(again, design)
    assert again[name].reason != plan(design)[name].reason
    assert told[name].reason == plan(design)[name].reason
    assert told.enabled == again.enabled
    assert with_own_reasons(again, None) == again


def test_a_feature_that_a_scene_lost_by_other_ways_is_off_for_its_own_reason() -> None:
    """The surface of a run has no fillets, which its design has on."""
    bare = with_part(MIKRON, "throw", **{key: _sharp(MIKRON, key) for key in ("main_journal", "crankpin")})
    assert plan(MIKRON)["fillets"].state == "on"
    assert with_own_reasons(plan(bare), MIKRON)["fillets"].reason == "no fillet in the scene"


def _sharp(scene: Scene, journal: str) -> object:
    return getattr(scene.throw, journal).model_copy(update={"fillet_mm": 0.0})


def test_a_target_knows_the_design_that_it_was_made_of() -> None:
    target = resolve_target(MIKRON)
    assert target.design == MIKRON
    assert target.scene != MIKRON
