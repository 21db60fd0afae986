"""The radius of rounded outlets follows from the volume of a half throw, in few evaluations of that."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo import load_scene
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import import oil_drillings


def test_the_radius_of_an_outlet_is_found_in_few_rounds(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene("industrial-gas")
    radius = scene.throw.drilling[0].outlet_radius_mm
    body: Any = SimpleNamespace(solid=SimpleNamespace(volume_mm3=half_throw_volume_mm3(scene)))
    calls: list[Scene] = []

    def counted(one: Scene) -> float:
        calls.append(one)
        return half_throw_volume_mm3(one)

    monkeypatch.setattr(oil_drillings, "half_throw_volume_mm3", counted)
    found = oil_drillings.with_outlet_radius(body, scene)
    assert found is not None
    assert found.throw.drilling[0].outlet_radius_mm == radius
    assert len(calls) <= 10  # 15 where the radius itself was sought
