"""Safety of the webs of a shaft alone: that of the whole evaluation, from fields to a larger residual."""

from __future__ import annotations

import pytest

from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.shaft.stage import evaluate_shaft, of_stiffness, with_stiffness_of
from cranktopo.tasks.shaft_safety.judged import judged_shaft, judged_webs
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import mikron_with
from tests.physics.shaft.test_continuous_shaft import meshed_body

COARSE = 2.0
"""Elements of two fillet radii: what is compared is the same mesh."""
SPEEDS_RPM = (900.0, 2100.0)


def vibrating() -> Scene:
    """Four throws with a propeller, whose table has no stiffness."""
    data = mikron_with().model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"cylinder_damping_Nms_per_rad": 0.5, "propeller": {"inertia_kg_m2": 0.6}}
    return scene_from_dict(data)


def test_throws_get_the_stiffness_that_the_shaft_evaluates() -> None:
    scene, body = vibrating(), meshed_body(vibrating(), 20.0)
    target = Target("mikron", scene)
    throws = evaluate_shaft(target, "rigid", bodies={"mikron": body}).stiffness.throws_Nm_per_rad
    assert with_stiffness_of(target, "rigid", {"mikron": body}) == of_stiffness(scene, throws) != scene
    still = Target("mikron", mikron_with())
    assert with_stiffness_of(still, "rigid", {}) is still.scene


@pytest.mark.slow
def test_webs_alone_have_the_safety_of_the_evaluation() -> None:
    """Of the places too; the residual counts 1e-7."""
    target = Target("mikron", vibrating().with_effect("torsional_vibration", "on"))
    whole = judged_shaft(target, "rigid", "lsa", SPEEDS_RPM, COARSE)[1].safety()
    webs = judged_webs(target, "rigid", "lsa", SPEEDS_RPM, COARSE)
    assert len(webs) == len(whole.webs) == 8
    for one, told in zip(webs, whole.webs, strict=True):
        assert one.over_speeds == pytest.approx(told.over_speeds, rel=1e-6)
        assert (one.web, one.part, one.speed_rpm) == (told.web, told.part, told.speed_rpm)
    assert min(web.safety for web in webs) == pytest.approx(whole.safety, rel=1e-6)
