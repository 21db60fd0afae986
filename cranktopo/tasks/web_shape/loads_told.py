"""Loads and strength to be known before a web is made by them."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.notes import note
from cranktopo.design.assumed import Assumption, assumed_text
from cranktopo.design.schema import Scene
from cranktopo.design.strength import note_strength
from cranktopo.engine.histories import Loads, WebLoads
from cranktopo.engine.performance import note_pressure
from cranktopo.engine.plan.planning import note_left_off
from cranktopo.tasks.fatigue.taken_keys import note_unused
from cranktopo.tasks.shaft.stage import shaft_left_off
from cranktopo.tasks.throw_fatigue.needs import alone_left_off

METHODS = ("lsa",)
"""Methods that judge the safety of every web of a search."""


def loads_left_off(scene: Scene, loads: Loads | None) -> str:
    """Name the loads that safety and stress leave out although they are above the threshold.

    Args:
        loads: None for those of a whole shaft, before they are known.
    """
    in_shaft = loads is None or isinstance(loads, WebLoads)
    return shaft_left_off(scene) if in_shaft else alone_left_off(scene)


def note_loads(scene: Scene, loads: Loads | None, assumed: Sequence[Assumption]) -> None:
    """Tell what is to be known of loads and strength before a web is made by them; `loads` as above."""
    note_left_off(scene.name, loads_left_off(scene, loads))
    note_strength(scene.name, scene)
    note_pressure(scene.name, scene)
    note_unused(scene.name, scene.fatigue, METHODS)
    if assumed:
        note(assumed_text(assumed))
