"""The page of a re-model holds the statistics of its fit, and so does the page of its run."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.report.report_file import html, markdown_text
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.refit.page import refit_page, refit_section, refit_text
from cranktopo.tasks.refit.result import RefitResult
from tests.told_evaluation import told_evaluation
from tests.unit.refit.remodel_cases import WHOLE, body_of, known_scene


def evaluated(torsion: float, bending: float) -> dict[str, Any]:
    return told_evaluation(torsion, bending, error_percent=(0.48, 1.4))


@pytest.fixture
def data() -> RefitResult:
    """What remodel.json holds, of an invented fit."""
    region = {"kind": "recess", "volume_mm3": 1037.2, "centre_mm": [24.3, -5.8, 34.2], "pair": True}
    region |= {"face": "pin", "low_mm": [13.8, -16.2, 27.0], "high_mm": [32.6, 5.8, 39.0]}
    trial = {"parameters": 7, "iou_percent": 87.94, "gain_percent": 0.0, "kept": True}
    kinds = ("report", "design", "step", "stl", "drawing", "drawing_svg", "json")
    found: dict[str, Any] = {
        "run": "some_run",
        "design": "mikron-iiic-remodel",
        "iou": {"web": 0.936, "half_throw": 0.956},
        "distance_mm": {"mean": 0.32, "max": 4.7, "max_at": [-26.7, -6.4, 37.3]},
        "web_mass_kg": {"fitted": 0.618, "body": 0.610, "difference_percent": 1.3},
        "stiffness": {
            "body": evaluated(178.8e3, 253.8e3),
            "fitted_without_fillets": evaluated(179.0e3, 254.6e3),
            "fitted": evaluated(183.6e3, 267.9e3),
            "difference_percent": {"torsion": 0.1, "bending": 0.3},
        },
        "trials": [{"step": "outline", **trial}, {"step": "5 stations", **trial}],
        "overlap_by_start": [0.936, 0.935],
        "not_represented": [{**region, "share_percent": 1.33}],
        "rules": {"min_wall_mm": 3.0, "least_gain_percent": 0.2},
        "web": {},
        "parameters": [],
        "seconds": {"total": 1.0},
        "files": dict.fromkeys(kinds, "a_file"),
        "folder": "folder",
    }
    return RefitResult.of_json(found, "remodel.json")


def test_the_page_holds_what_the_command_prints(data: RefitResult, mikron: Scene) -> None:
    scene = known_scene(mikron, WHOLE)
    body = ShownBody("re-modelled", mesh_of(body_of(scene, 3.0)), scene.web_z_mm, scene.pitch_mm / 2)
    page = refit_page(data, (body, body), {"python": "3.11"}, "2026-01-01")
    text, printed = markdown_text(page, "pictures"), refit_text(data)
    for number in ("93.6", "95.6", "0.32", "4.70", "0.618", "178.8", "179.0", "183.6", "87.94", "1037"):
        assert number in text
        assert number in printed
    assert "recess in the pin face" in text
    assert "some\\_run" in text
    assert html(page).count("<option") == 2


def test_without_evaluation_and_without_rest(data: RefitResult) -> None:
    bare = data.model_copy(update={"stiffness": None, "not_represented": []})
    (_, shape), (_, trials) = refit_section(bare).tables
    assert [row["what"] for row in shape.rows] == ["overlap (IoU)", "surface distance", "mass of the web"]
    assert len(trials.rows) == 2
    assert "represents the whole body" in refit_text(bare)


def test_text_and_page_say_what_is_not_released(data: RefitResult) -> None:
    found = {"volume_mm3": 812.0, "deepest_mm": 6.5, "released": False, "process": "forged"}
    looked = ShapedUndercuts(**found, held_by="web.pocket[0]")
    held = data.model_copy(update={"undercuts": looked})
    words = "no, 812 mm3 of undercuts along x: no die that parts in x = 0 releases it, held by web.pocket[0]"
    assert words in " ".join(refit_text(held).split())
    (_, shape), *_ = refit_section(held).tables
    assert next(row["value"] for row in shape.rows if row["what"] == "die releases it").startswith(words)
