"""The check by rays of a web that was found: die, mould and mill, and how the result says it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.draft import kept_without_draft
from cranktopo.design.schema import Scene
from cranktopo.tasks.compare.stage import design_undercuts
from cranktopo.tasks.extraction.release import shaped_undercuts
from cranktopo.tasks.extraction.result import ShapedUndercuts
from cranktopo.tasks.extraction.text import release_text, release_verdict
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.web_shape.page import release_fact
from cranktopo.tasks.web_shape.result import ShapeResult
from cranktopo.tasks.web_shape.text import shape_headline, shape_summary
from tests.unit.refit.remodel_cases import table
from tests.unit.shape.shape_results import invented_data

FACET_MM = 2.0
BOX = {"shape": "box", "face": "pin", "x_mm": 0.0, "y_mm": 18.0, "depth_mm": 9.0}
BOX |= {"size_x_mm": 20.0, "size_y_mm": 8.0}
SIDE = {"shape": "side", "y_mm": 24.0, "length_mm": 20.0, "height_mm": 6.0, "depth_mm": 5.0, "draft_deg": 5.0}


def made(scene: Scene, pocket: dict[str, Any], **process: Any) -> Scene:
    free = {"parting": "lateral", "draft_deg": 0.0}
    return scene_with_web(scene.with_optimise(**{**free, **process}), table(pocket=[{**pocket}]))


@pytest.mark.parametrize(
    ("pocket", "process", "released"),
    [
        (BOX, {"process": "forged"}, False),
        pytest.param(BOX, {"process": "forged", "parting": "web_faces"}, True, marks=pytest.mark.slow),
        pytest.param(SIDE, {"process": "forged"}, True, marks=pytest.mark.slow),
        pytest.param(SIDE, {"process": "cast", "parting": "web_faces"}, False, marks=pytest.mark.slow),
        pytest.param(SIDE, {"process": "milled"}, True, marks=pytest.mark.slow),
    ],
)
def test_the_process_decides_and_the_pocket_is_named(
    mikron: Scene, pocket: dict[str, Any], process: dict[str, Any], released: bool
) -> None:
    """A web that `shape` calls makeable is called so by `compare` as well."""
    scene = made(mikron, {**pocket}, **process)
    surface = surface_of(scene, "half", FACET_MM)
    found = shaped_undercuts(surface, scene)
    assert (found.released, found.makeable) == (released, released)
    assert found.held_by == (None if released else "web.pocket[0]")
    assert design_undercuts("same", surface, scene).free == released


@pytest.mark.parametrize(
    ("asked", "straight"),
    [
        ({"process": "forged", "draft_deg": 5.0}, ("web.bevel[0]",)),
        pytest.param(
            {"process": "cast", "parting": "web_faces", "draft_deg": 5.0},
            ("web.outline",),
            marks=pytest.mark.slow,
        ),
        pytest.param({"process": "forged", "draft_deg": 0.0}, (), marks=pytest.mark.slow),
        pytest.param({"process": "milled", "draft_deg": 5.0}, (), marks=pytest.mark.slow),
    ],
)
def test_what_a_die_releases_without_draft_is_named(
    mikron: Scene, asked: dict[str, Any], straight: tuple[str, ...]
) -> None:
    bevel = {"face": "journal", "y_mm": 54.0, "depth_mm": 9.0}
    scene = scene_with_web(mikron, table(bevel=[bevel])).with_optimise(**asked)
    found = shaped_undercuts(surface_of(scene, "half", FACET_MM), scene)
    assert found.without_draft == straight
    ends = f" it; too little draft: {', '.join(straight)}" if straight else " it"
    released = found.model_copy(update={"released": True})
    assert release_text(released).endswith(ends)
    assert release_verdict(released) == ("yes, too little draft" if straight else "yes")


@pytest.mark.parametrize(
    ("weight", "asked", "named"),
    [
        ({"half_angle_deg": 88.0}, {}, True),
        ({"half_angle_deg": 85.0}, {}, False),
        ({"half_angle_deg": 88.0}, {"draft_deg": 2.0}, False),
        ({"half_angle_deg": 85.0}, {"process": "cast", "parting": "web_faces"}, True),
        ({"half_angle_deg": 88.0}, {"process": "milled"}, False),
        ({"half_angle_deg": 88.0, "density_kg_m3": 17500.0}, {}, False),
    ],
    ids=["2 deg of 5", "5 of 5", "2 of 2", "along the crank axis", "a mill", "bolted on"],
)
def test_flanks_of_a_counterweight_with_less_draft_than_asked(
    mikron: Scene, weight: dict[str, Any], asked: dict[str, Any], named: bool
) -> None:
    made_by = {"process": "forged", "parting": "lateral", "draft_deg": 5.0, **asked}
    web = table(counterweight={"outer_radius_mm": 34.0, **weight})
    scene = scene_with_web(mikron.with_optimise(**made_by), web)
    assert kept_without_draft(scene) == (("web.counterweight",) if named else ())


def test_flanks_within_the_outline_are_no_walls(mikron: Scene) -> None:
    """The outline is 34 mm wide at the main journal's axis and ends 26 mm below it."""
    made_by = mikron.with_optimise(process="forged", parting="lateral", draft_deg=5.0)
    web = table(counterweight={"outer_radius_mm": 34.0, "half_angle_deg": 90.0})
    assert kept_without_draft(scene_with_web(made_by, web)) == ()


def told(undercuts: ShapedUndercuts | None) -> ShapeResult:
    data = invented_data() | {"worst_case_percent": {"tolerance": 0.5}, "seconds": {"total": 1.0}}
    return ShapeResult.of_json(data, "shape.json").model_copy(update={"undercuts": undercuts})


def held(process: str) -> ShapedUndercuts:
    values = {"volume_mm3": 812.4, "deepest_mm": 14.5, "released": False, "held_by": "web.pocket[0]"}
    return ShapedUndercuts.model_validate({**values, "process": process})


def test_a_web_that_cannot_be_made_is_said_first() -> None:
    headline = shape_headline(told(held("forged")))
    assert headline.startswith("CANNOT BE MADE: 812 mm3 of undercuts along x: no die that parts in x = 0")
    assert "held by web.pocket[0], 14.5 mm deep at most" in headline


@pytest.mark.parametrize(
    ("process", "released", "verdict", "status"),
    [("forged", True, "yes", "good"), ("forged", False, "no", "bad"), ("free", False, "no", "neutral")],
)
def test_page_and_terminal_say_it(
    tmp_path: Path, process: str, released: bool, verdict: str, status: str
) -> None:
    undercuts = held(process)
    if released:
        undercuts = undercuts.model_copy(update={"released": True, "volume_mm3": 0.0, "held_by": None})
    found = told(undercuts)
    assert f"\ndie releases it: {verdict}, " in shape_summary(found, tmp_path)
    fact = release_fact(found)
    assert (fact.value, fact.status) == (verdict, status)
    assert found.makeable == (status != "bad")
    assert found.as_json()["undercuts"]["released"] == released
