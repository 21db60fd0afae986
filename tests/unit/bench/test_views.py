"""Handles of the drawing stay under the pointer; the section has the area of the parts that it cuts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.design.edits import changed_data
from cranktopo.design.loading import design_text, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.tasks.bench.live_picture import live_picture

PLAIN = parse_toml(design_text("mikron-iiic-plain"), "plain")
DRAGGED = 0.4


def handles_of(data: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Handles of front view and section by their dimension."""
    front = live_picture(data)["front"]
    return {one["key"]: one for one in (*front["handles"], *front["side"]["handles"])}


@pytest.mark.parametrize("key", sorted(handles_of(PLAIN)))
def test_a_handle_stays_under_the_pointer(key: str) -> None:
    before = handles_of(PLAIN)[key]
    after = handles_of(changed_data(PLAIN, {key: before["value"] + DRAGGED}))[key]
    way = np.array(before["way"]) * DRAGGED / before["per_mm"]
    assert np.subtract(after["at"], before["at"]) == pytest.approx(way, abs=1e-9)


def test_every_dimension_of_throw_and_web_is_dragged_on_the_drawing() -> None:
    """Thickness, lengths, fillets and bores were in the forms alone."""
    scene = scene_from_dict(PLAIN, "plain", whole=True)
    journals = [f"throw.{name}" for name, journal in (("main_journal", 0), ("crankpin", 1))]
    wanted = {f"{journal}.{name}" for journal in journals for name in (
        "outer_diameter_mm", "length_mm", "fillet_mm", "bore_diameter_mm"
    )}  # fmt: skip
    assert {"throw.radius_mm", "web.thickness_mm", "web.width_mm"} | wanted == set(handles_of(PLAIN))
    assert scene.throw.crankpin.bore_diameter_mm > 0


def test_the_section_has_the_area_of_journals_and_web() -> None:
    """Without fillets: two half journals less their bores, and the web less the bores that end in it."""
    bare = {f"throw.{name}.fillet_mm": 0.0 for name in ("main_journal", "crankpin")}
    data = changed_data(PLAIN, bare)
    scene = scene_from_dict(data, "plain", whole=True)
    corners = [np.array(path["points"]) for path in live_picture(data)["front"]["side"]["paths"]]
    area = sum(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() for x, y in (c.T for c in corners))
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    journals = [scene.throw.main_journal, scene.throw.crankpin]
    by_hand = sum((j.outer_diameter_mm - j.bore_diameter_mm) * j.length_mm / 2 for j in journals)
    by_hand += (high - low - sum(j.bore_diameter_mm for j in journals)) * scene.web.thickness_mm
    assert area == pytest.approx(by_hand, rel=2e-3)
    assert max(c[:, 0].max() for c in corners) == pytest.approx(scene.pitch_mm / 2, rel=1e-9)


def test_what_cannot_be_drawn_tells_what_is_broken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture is begun unchecked, as the numbers beside it check; a sound design that fails is a fault."""
    broken = changed_data(PLAIN, {"throw.crankpin.bore_diameter_mm": 1e3})

    def fails(_: object) -> dict[str, Any]:
        raise ZeroDivisionError

    monkeypatch.setattr("cranktopo.tasks.bench.live_picture._shown", fails)
    (rule,) = live_picture(broken)["broken"]
    assert rule["key"] == "throw.crankpin.bore_diameter_mm"
    with pytest.raises(ZeroDivisionError):
        live_picture(PLAIN)


def test_a_picture_of_tables_that_are_no_design_tells_what_is_broken() -> None:
    (rule,) = live_picture(changed_data(PLAIN, {"throw.radius_mm": -1.0}))["broken"]
    assert rule["key"] == "throw.radius_mm"
