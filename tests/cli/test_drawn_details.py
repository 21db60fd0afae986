"""The detail of a fillet is drawn where the fillet is, not where the bore of the other journal opens it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from cranktopo.design.loading import load_scene
from cranktopo.tasks.crank_drawing.detail import details


def _places_mm(name: str) -> list[float]:
    sheet: Any = SimpleNamespace(scene=load_scene(name))
    return [detail.at_mm[1] for detail in details(sheet, "KL")]


def test_a_detail_is_toward_the_other_axis_unless_a_bore_opens_the_fillet_there() -> None:
    whole, opened = load_scene("opposed-piston").throw, load_scene("opposed-piston-variant-1").throw
    pin = whole.radius_mm - whole.crankpin.radius_mm
    assert _places_mm("opposed-piston") == [whole.main_journal.radius_mm, pin]
    assert _places_mm("opposed-piston-variant-1")[0] == -opened.main_journal.radius_mm
