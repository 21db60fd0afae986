"""Ranges above the permitted stress end where it is reached; speeds passed through are not judged."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import torque_amplitude_Nm
from cranktopo.engine.judged_speeds import barred_remarks, rated_speeds, runs_at, speeds_of_range
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.study import VibrationStudy, study_vibration
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.engine.vibration.vibrating_shaft import vibrating_shaft, worst_speed_rpm
from cranktopo.tasks.vibration.barred import barred_sentence, passed_sentence

SHAFT = {
    "throw_stiffness_Nm_per_rad": 1.5e5,
    "speed_max_rpm": 2800.0,
    "propeller": {"inertia_kg_m2": 0.6},
}


def scene_with(threshold: float = 0.5, **shaft: object) -> Scene:
    """A high threshold leaves the varying inertia out, with which every speed takes far longer."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {**SHAFT, **shaft}
    data["effects"] |= {"torsional_vibration": "on", "threshold": threshold}
    data["engine"].pop("overspeed_rpm", None)
    return scene_from_dict(data)


@cache
def study(threshold: float = 0.5, **shaft: object) -> VibrationStudy:
    scene = scene_with(threshold, **shaft)
    return study_vibration(scene, estimated_chain(scene), 1e4, "given")


def permitted_MPa() -> float:
    """A stress that the shaft exceeds around its worst speed alone."""
    return round(0.8 * float(study().response.shear_MPa.max()), 3)


def enabled(scene: Scene) -> frozenset[str]:
    return plan_for_stress(scene).enabled


def test_ranges_end_where_the_permitted_stress_is_reached() -> None:
    """Not at the last of the speeds that were solved: then some above it would be permitted."""
    found = study(permitted_shear_MPa=permitted_MPa())
    assert found.barred_rpm
    scene = scene_with()
    harmonics = torque_harmonics(scene)
    assert harmonics is not None
    model = vibrating_shaft(scene, estimated_chain(scene), harmonics)
    for low, high in found.barred_rpm:
        ends = model.at(np.array([low - 0.1, low + 0.1, high - 0.1, high + 0.1])).shear_MPa
        to_the_last = high == scene.shaft.speed_max_rpm if scene.shaft else False
        assert (ends > permitted_MPa()).tolist() == [False, True, True, to_the_last]
        assert low not in found.response.speeds_rpm


def test_a_range_that_is_passed_through_is_not_judged() -> None:
    """The worst speed, load states, torque of the rule and even speeds are then others; the curve stays."""
    free = scene_with()
    worst = worst_speed_rpm(free, enabled(free))
    low, high = worst - 150.0, worst + 150.0
    passing = scene_with(barred_rpm=[[low, high]])
    assert not runs_at(passing, worst)
    assert runs_at(passing, low)
    other = worst_speed_rpm(passing, enabled(passing))
    assert not low < other < high
    for of in (rated_speeds, speeds_of_range):
        assert all(runs_at(passing, at.engine.speed_rpm) for at in of(passing, enabled(passing)) if at.engine)
    for kind in ("extremes", "cycle"):
        before, after = (torque_amplitude_Nm(one, kind, enabled(one)) for one in (free, passing))
        assert after < 0.95 * before
    whole, part = study(), study(barred_rpm=((low, high),))
    assert part.response.shear_MPa.max() == pytest.approx(whole.response.shear_MPa.max(), rel=1e-9)
    assert part.response.worst_Nm < 0.95 * whole.response.worst_Nm
    # Largest of a shaft that never runs in the range, by hand from its curve.
    rpm, inside = part.response.speeds_rpm, np.array(part.shaft.in_crankshaft)
    outside = part.response.torque_amplitude_Nm[(rpm <= low) | (rpm >= high)][:, inside]
    assert part.response.worst_Nm == outside.max()
    assert f"{worst:.0f} rpm" in passed_sentence(part)
    assert passed_sentence(whole) == ""


@pytest.mark.slow
def test_it_is_told_what_is_left_out_and_what_should_be() -> None:
    """With the loads of the plan as it is, the same as `vibration` tells."""
    exceeding = scene_with(0.02, permitted_shear_MPa=permitted_MPa())
    (remark, *_) = barred_remarks(exceeding, enabled(exceeding))
    key = remark[remark.index("shaft.barred_rpm = ") :].removesuffix(".")
    assert key in barred_sentence(study(0.02, permitted_shear_MPa=permitted_MPa()))
    ranges = json.loads(key.partition(" = ")[2])
    passing = scene_with(0.02, permitted_shear_MPa=permitted_MPa(), barred_rpm=ranges)
    (told, *_) = barred_remarks(passing, enabled(passing))
    assert told.startswith(f"the engine only passes through {ranges[0][0]} to ")
    assert "judged like all others" not in " ".join(barred_remarks(passing, enabled(passing)))


@pytest.mark.parametrize(("share", "near"), [(0.7, False), (0.9, True)])
def test_the_rule_allows_no_barred_range_near_the_engine_speed(share: float, near: bool) -> None:
    scene = scene_with()
    assert scene.engine is not None
    rpm = share * scene.engine.speed_rpm
    passing = scene_with(barred_rpm=[[rpm - 20.0, rpm + 20.0]])
    assert (
        "reaches above 0.8 of the engine's speed" in " ".join(barred_remarks(passing, enabled(passing)))
    ) == near


@pytest.mark.parametrize(
    ("ranges", "said"),
    [
        ([[900.0, 800.0]], "from its lower to its higher end"),
        ([[1200.0, 1300.0], [1250.0, 1400.0]], "behind the range before it"),
        ([[2000.0, 2200.0]], "holds engine.speed_rpm = 2100"),
    ],
)
def test_ranges_that_make_no_sense_are_refused(ranges: list[list[float]], said: str) -> None:
    with pytest.raises(CranktopoError, match=said):
        scene_with(barred_rpm=ranges)
