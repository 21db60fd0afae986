"""What of a web lies outside of its own envelope, against closed forms; and who says so."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.outside import OutsideEnvelope, outside_envelope, outside_words
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.loading import design_text, load_scene
from cranktopo.design.named import with_values
from cranktopo.tasks.bound.result import BoundStatements
from cranktopo.tasks.bound.text import bound_sections
from cranktopo.tasks.density.stage import notices

SCENE = load_scene("mikron-iiic-plain")
RADIUS_MM, CUT_MM, THICKNESS_MM = 25.0, 20.0, 19.0
SEGMENT_MM3 = THICKNESS_MM * (
    RADIUS_MM**2 * math.acos(CUT_MM / RADIUS_MM) - CUT_MM * math.sqrt(RADIUS_MM**2 - CUT_MM**2)
)
"""Of the round end of the web about the main journal, below the envelope's lower end."""
SHORT = with_values(SCENE, {"envelope.y_min_mm": -CUT_MM})
WORDS = "1,942 mm3 of the original web, 2.95 % of it, lie outside of the envelope"


def test_the_end_of_an_obround_web() -> None:
    found = outside_envelope(SHORT)
    assert found is not None
    assert found.volume_mm3 == pytest.approx(SEGMENT_MM3, rel=2e-3)
    assert found.percent == pytest.approx(100 * SEGMENT_MM3 / web_volume_mm3(SCENE), rel=2e-3)


def test_what_a_clearance_takes() -> None:
    """All of the web beside the bearing but the journal itself."""
    found = outside_envelope(with_values(SCENE, {"envelope.bearing_clearance_mm": 1.5}))
    journal = math.pi * (21.0**2 - 12.0**2)
    assert found is not None
    assert found.volume_mm3 == pytest.approx(1.5 * (web_volume_mm3(SCENE) / THICKNESS_MM - journal), rel=1e-3)


def test_nothing_to_tell() -> None:
    whole = outside_envelope(SCENE)
    assert whole is not None
    assert whole.volume_mm3 == 0.0
    assert outside_words(whole) == ""
    assert outside_envelope(load_scene("mikron-iiic-hollow")) is None, "it has no envelope"


def test_plan_optimise_and_bounds_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "short.toml"
    text = design_text("mikron-iiic-plain")
    assert "y_min_mm = -34.0" in text
    path.write_text(text.replace("y_min_mm = -34.0", "y_min_mm = -20.0"), encoding="utf-8")
    assert main(["plan", str(path)]) == 0
    assert capsys.readouterr().out.count(WORDS) == 1
    assert main(["plan", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["outside_envelope"]
    assert told["volume_mm3"] == pytest.approx(SEGMENT_MM3, rel=2e-3)
    assert any(WORDS in line for line in notices(SHORT, build_domain(SHORT, 6.0)))
    statement = {"quantity": "mass", "value": 1.3, "percent_of_original": 81.0, "reached_percent": 89.0}
    statement |= {"dropped": [], "model": {"cell_mm": 3.0, "error_percent": {}}}
    outside = OutsideEnvelope(volume_mm3=1942.0, percent=2.953)
    data = {"statements": [statement], "stiffest": {}, "outside_envelope": outside.as_json()}
    (section,) = bound_sections(BoundStatements.of_json(data, "bound"), "cells")
    assert WORDS in section.text
