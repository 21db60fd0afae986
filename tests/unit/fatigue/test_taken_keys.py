"""Every key of `[fatigue]` changes the safety by a method, or is told as not used and is not assumed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from cranktopo import load_scene, with_values
from cranktopo.design.assumed import FATIGUE, assumptions
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criteria import LOCAL_METHODS, METHODS, criterion, safety_method
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.lsa import lsa_strength
from cranktopo.tasks.fatigue.taken_keys import assumed_by, taken_keys, unused_keys
from cranktopo.tasks.throw_fatigue import stage
from cranktopo.tasks.throw_fatigue.assessment import FatigueMethod
from cranktopo.tasks.throw_fea.targets import Target, resolve_target

OTHERS = {
    "surface_treatment_factor": 1.2,
    "size_factor": 0.5,
    "survival_factor": 0.4,
    "specimen_diameter_mm": 10.0,
    "roughness_um": 60.0,
    "process_factor": 0.9,
    "additional_stress_MPa": 20.0,
    "m53_factors": "elements",
}
LOCAL = LocalStress(np.array([200.0]), np.array([60.0]), np.array([0.7]))


def mikron(**fatigue: Any) -> Scene:
    scene = load_scene("mikron-iiic")
    return scene.model_copy(update={"fatigue": type(scene.fatigue)(**fatigue)})  # as a file gives them


@pytest.mark.parametrize("method", LOCAL_METHODS)
@pytest.mark.parametrize("key", OTHERS)
def test_a_key_acts_where_the_method_takes_it(method: str, key: str) -> None:
    judge = criterion(method).point_safety
    changed = judge(mikron(**{key: OTHERS[key]}), LOCAL).safety != judge(mikron(), LOCAL).safety
    assert bool(changed[0]) == (key in taken_keys([method]))


@pytest.mark.parametrize("method", ["findley", "dang_van"])
@pytest.mark.parametrize("key", OTHERS)
def test_planes_take_what_the_strength_of_a_point_follows_from(method: str, key: str) -> None:
    """Their severity is of the stress; their strength is that of local stress analysis."""
    acts = asdict(lsa_strength(mikron(**{key: OTHERS[key]}))) != asdict(lsa_strength(mikron()))
    assert acts == (key in taken_keys([method]))


@pytest.mark.parametrize(
    ("methods", "unused"),
    [
        (["lsa"], ("roughness_um", "process_factor", "additional_stress_MPa", "m53_factors")),
        (["fkm"], ("size_factor", "survival_factor", "specimen_diameter_mm", *list(OTHERS)[5:])),
        (["findley"], ("roughness_um", "process_factor", "additional_stress_MPa", "m53_factors")),
        (["m53"], ("size_factor", "survival_factor", "specimen_diameter_mm", "roughness_um")),
        (["lsa", "fkm"], ("process_factor", "additional_stress_MPa", "m53_factors")),
        (["fkm", "m53"], ("size_factor", "survival_factor", "specimen_diameter_mm")),
        (list(METHODS), ()),
    ],
)
def test_keys_that_no_method_takes(methods: Sequence[str], unused: tuple[str, ...]) -> None:
    assert unused_keys(mikron(**OTHERS).fatigue, methods) == unused
    told = {item.key for item in assumed_by(assumptions(mikron(), (FATIGUE,)), methods)}
    assert told == {f"fatigue.{key}" for key in OTHERS if key not in (*unused, "m53_factors")}


def test_only_what_a_design_gives_is_told() -> None:
    assert unused_keys(mikron().fatigue, ["fkm"]) == ()
    assert unused_keys(mikron(size_factor=0.89).fatigue, ["fkm"]) == ("size_factor",)
    stored = with_values(load_scene("mikron-iiic"), {"fatigue.survival_factor": 0.4})  # has every key
    assert unused_keys(stored.fatigue, ["fkm"]) == ("survival_factor",)


def test_tables_that_a_method_has_no_use_for_are_not_assumed() -> None:
    scene = mikron(scatter={"load_percent": 5.0})
    keys = {item.key for item in assumed_by(assumptions(scene, (FATIGUE,)), ["fkm"])}
    assert not any(key.startswith("fatigue.scatter") for key in keys)
    assert "fatigue.scatter.strength_percent" in {
        item.key for item in assumed_by(assumptions(scene, (FATIGUE,)), ["lsa"])
    }
    assert all(set(safety_method(name).takes) <= set(type(scene.fatigue).model_fields) for name in METHODS)


@pytest.mark.parametrize(
    ("methods", "words"), [(["fkm"], "method 'fkm'"), (["fkm", "m53"], "methods 'fkm' and 'm53'")]
)
def test_one_line_names_the_keys_and_nothing_else_is_assumed(
    methods: list[FatigueMethod],
    words: str,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`fatigue --method fkm` was silent about a size factor of 0.5, and told the specimen as assumed."""

    def stop(target: Target) -> Target:
        raise InterruptedError(target.name)

    monkeypatch.setattr(stage, "with_throw_stiffness", stop)
    caplog.set_level("INFO")
    target = resolve_target(mikron(size_factor=0.5, survival_factor=0.4), fillets=True)
    with pytest.raises(InterruptedError):
        stage.assess_by_methods([target], methods)
    line = f"mikron-iiic: not used by {words}: fatigue.size_factor, fatigue.survival_factor"
    assert caplog.messages.count(line) == 1
    assumed = next(one for one in caplog.messages if "assumed:" in one)
    assert "fatigue.roughness_um" in assumed
    assert "specimen" not in assumed
