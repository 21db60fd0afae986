"""Oil outlets across the middle of the main journal: the place from which each one is judged."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fatigue.cut_outlets import judged_places
from cranktopo.tasks.throw_fatigue.fillets import cut_outlet_nodes
from tests.physics.fatigue.test_least_safety import drilled

EVERYWHERE: Array = np.stack(np.meshgrid([0.0], [-24.0], np.linspace(0.0, 12.0, 25))).reshape(3, -1)
"""Points (3, n) along the journal, on the side where the drilling begins."""


def changed(drilling: dict[str, Any], length_mm: float = 30.0) -> Scene:
    data = drilled().model_dump(mode="json", by_alias=True, exclude_none=True)
    data["throw"]["drilling"][0].update(drilling)
    data["throw"]["main_journal"]["length_mm"] = length_mm
    return scene_from_dict(data, "v-twin")


def start(place_mm: float) -> dict[str, Any]:
    return {"from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": place_mm}}


def cut(scene: Scene) -> bool:
    return bool(cut_outlet_nodes(scene, EVERYWHERE).any())


@pytest.mark.parametrize("place_mm", [0.0, 3.0])
def test_an_outlet_is_judged_from_the_place_that_is_told(place_mm: float) -> None:
    told = judged_places(changed(start(place_mm)), whole=False)
    found = re.fullmatch(r"It is judged from throw\.drilling\[0\]\.from\.place_mm = ([\d.]+) on\.", told)
    assert found
    least = float(found[1])
    assert not cut(changed(start(least)))
    assert cut(changed(start(least - 0.1)))


def test_an_outlet_at_the_other_end_has_its_own_key() -> None:
    turned = {
        "from": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 11.0},
        "to": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 0.0},
    }
    assert "throw.drilling[0].to.place_mm = " in judged_places(changed(turned), whole=False)


def test_a_drilling_of_the_second_web_has_the_key_of_the_scene() -> None:
    to = {"on": "crankpin", "angle_deg": 0.0, "place_mm": 11.0}
    one = {"diameter_mm": 5.0, "web": "first", **start(7.0), "to": to}
    data = drilled().model_dump(mode="json", by_alias=True, exclude_none=True)
    data["throw"]["drilling"] = [one, {**one, "web": "second", **start(0.0)}]
    scene = scene_from_dict(data, "v-twin", whole=True)
    assert "throw.drilling[1].from.place_mm = " in judged_places(scene, whole=True)
    assert judged_places(scene, whole=False) == ""


def test_a_journal_too_short_for_a_judged_outlet_is_told_so() -> None:
    told = judged_places(changed(start(0.0), length_mm=20.0), whole=False)
    assert told == "On this journal no throw.drilling[0].from.place_mm is judged."


def test_an_outlet_that_is_judged_is_not_told() -> None:
    assert judged_places(changed(start(6.0)), whole=False) == ""
