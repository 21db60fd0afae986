"""The registry of fatigue criteria: its names, and an assessment by a criterion that the package lacks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criteria import METHODS, safety_method
from cranktopo.tasks.fatigue.criterion import FatigueCriterion, LocalStress, PointSafety
from cranktopo.tasks.fatigue.stage import assess_fatigue


def limit_MPa(scene: Scene) -> float:
    return 0.4 * (scene.material.ultimate_MPa or 0.0)


def without_mean(scene: Scene, stress: LocalStress) -> PointSafety:
    limit = np.full(stress.amplitude_MPa.shape, limit_MPa(scene))
    one = np.ones_like(limit)
    return PointSafety(limit / np.maximum(stress.amplitude_MPa, 1e-9), limit, one, {"share": 0.4 * one})


def level_line(scene: Scene, strength_MPa: float, gradient_per_mm: float, mean_MPa: Array) -> Array:
    return np.full(mean_MPa.shape, strength_MPa)


AMPLITUDE = FatigueCriterion("amplitude", ("ultimate_MPa",), without_mean, level_line)


def test_the_registry_names_every_method_as_it_names_itself() -> None:
    assert list(METHODS) == ["lsa", "fkm", "m53"]
    assert [safety_method(name).name for name in METHODS] == list(METHODS)


def test_a_registered_criterion_is_assessed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(METHODS, "amplitude", f"{__name__}:AMPLITUDE")
    found = assess_fatigue(["mikron-iiic-plain"], "amplitude", fillet_fraction=0.8, out=tmp_path)
    (field,) = found.fields
    limit = limit_MPa(field.model.scene)
    assert field.critical.strength_MPa == limit
    assert field.critical.safety == pytest.approx(limit / field.amplitude_MPa[:, field.model.on_fillet].max())
    data = found.as_json()
    assert data["method"] == "amplitude"
    assert data["fatigue"][0]["critical"]["factors"] == {"share": 0.4}
    assert (tmp_path / "fatigue-amplitude-mikron-iiic-plain.png").exists()
