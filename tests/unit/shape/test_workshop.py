"""What the process of a scene asks of pockets: the way they open, their draft, corners and depth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import Layout, exact_web_of
from cranktopo.tasks.refit.fit import scene_with_web, usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.refit.process import process_limits
from cranktopo.tasks.web_shape.feature_starts import end_starts
from cranktopo.tasks.web_shape.start import outline_start, scene_start
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.side_pocket import SidePocket
from tests.unit.refit.remodel_cases import table

DRAFT_DEG = 5.0
FACES = {"process": "forged", "parting": "web_faces"}
KINDS = {
    "box": FittedBox("pin"),
    "round": FittedCylinder("pin"),
    "hole": FittedCylinder("through"),
    "groove": FittedSlot(through=True),
    "side": FittedSlot(),
    "bevel": FittedBevel("pin"),
}


def made_by(scene: Scene, **process: Any) -> tuple[Scene, ManufacturingLimits]:
    own = scene.with_optimise(**{"parting": "lateral", "draft_deg": DRAFT_DEG, **process})
    return own, process_limits(own, usual_limits(own))


@pytest.mark.parametrize(
    ("process", "possible"),
    [
        ({"process": "forged"}, {"groove", "side", "bevel"}),
        ({"process": "cast"}, {"groove", "side", "bevel"}),
        (FACES, {"box", "round", "bevel"}),
        ({**FACES, "process": "cast"}, {"box", "round", "bevel"}),
        ({"process": "milled"}, set(KINDS)),
        ({"process": "free"}, set(KINDS)),
    ],
)
def test_a_feature_opens_the_way_of_the_process(
    mikron: Scene, process: dict[str, Any], possible: set[str]
) -> None:
    scene, limits = made_by(mikron, **process)
    assert {name for name, kind in KINDS.items() if kind.manufactured(limits) is not None} == possible
    ends = {part.label for part, _ in end_starts(scene, limits)}
    assert ("groove" in ends) == ("groove" in possible)
    groove = dict(zip(KINDS["groove"].names, KINDS["groove"].bounds(scene, limits), strict=True))
    if process["process"] in ("forged", "cast"):
        assert groove["draft"][0] == DRAFT_DEG


@pytest.mark.parametrize(
    ("process", "draft", "corner", "floor"),
    [
        (FACES, DRAFT_DEG, 6.0, 4.75),
        ({**FACES, "process": "cast", "draft_deg": 2.0}, 3.0, 6.0, 6.0),
        ({"process": "milled"}, 0.0, 6.0, 6.0),
        ({"process": "milled", "tool_radius_mm": 7.0}, 0.0, 7.0, 7.0),
        ({"process": "milled", "tool_radius_mm": 9.0}, 0.0, 9.0, 8.0),
        ({"process": "free"}, 0.0, 6.0, 0.0),
    ],
)
def test_a_pocket_has_draft_and_radii_of_the_process(
    mikron: Scene, process: dict[str, Any], draft: float, corner: float, floor: float
) -> None:
    """The least draft of the workshop (3 deg) and the least radius (6 mm) count besides.

    The edge of a floor is rounded by no more than half of the greatest depth, 9.5 mm of a die and 16 mm.
    """
    scene, limits = made_by(mikron, **process)
    box = FittedBox("pin").manufactured(limits)
    assert box == FittedBox("pin", False, draft, corner, floor)
    least = max(1.0, floor * (1 - np.sin(np.deg2rad(draft))))
    assert box.bounds(scene, limits)[3][0] == pytest.approx(least, abs=0.03)
    named = box.named(np.array([20.0, 30.0, 14.0, 5.0]))
    (written,) = box.tables(named, (-25.0, 73.0, 30.0))
    assert written.get("draft_deg", 0.0) == draft
    assert written["corner_radius_mm"] == corner
    assert written.get("floor_radius_mm", 0.0) == floor
    assert min(low for low, _ in box.bounds(scene, limits)[1:3]) > 2 * corner


@pytest.mark.parametrize(
    ("process", "radius"),
    [
        ({"process": "forged"}, 6.0),
        ({"process": "cast"}, 6.0),
        ({"process": "milled", "tool_radius_mm": 7.0}, 7.0),
    ],
)
def test_a_side_pocket_has_corners_and_floor_of_the_process_and_a_groove_its_floor(
    mikron: Scene, process: dict[str, Any], radius: float
) -> None:
    """The edges of a groove take no more than half of the 13 mm that are between flanges of 3 mm."""
    scene, limits = made_by(mikron, **process)
    side, groove = (KINDS[name].manufactured(limits) for name in ("side", "groove"))
    assert (side, groove) == (FittedSlot(False, radius, radius), FittedSlot(True, 0.0, 3.25))
    named = side.named(np.array([24.0, 20.0, 14.0, 20.0, 0.0, 5.0]))
    (written,) = side.tables(named, (-25.0, 73.0, 25.0))
    assert written["corner_radius_mm"] == written["floor_radius_mm"] == radius
    assert FittedSlot.read(SidePocket(**written), False, (-25.0, 73.0, 25.0))[0] == side
    (starts,) = [own for part, own in end_starts(scene, limits) if part == groove]
    web = ParametricWeb(Layout(7, (groove,)), scene, limits, (np.zeros(0),) * 3)
    values = np.array([*outline_start(scene, limits), *starts])
    rules = dict(zip(web.rule_names(values), web.constraints(values), strict=True))
    assert max(value for name, value in rules.items() if "groove" in name) < 0
    least, most = np.array(groove.bounds(scene, limits)).T
    assert (least <= starts).all()
    assert (starts <= most).all()


def test_a_free_process_asks_for_no_radius_in_the_sides(mikron: Scene) -> None:
    _, limits = made_by(mikron, process="free")
    assert KINDS["groove"].manufactured(limits) == FittedSlot(through=True)
    assert KINDS["side"].manufactured(limits) == FittedSlot(False, 6.0)


def test_a_groove_is_as_deep_as_its_floor_needs(mikron: Scene) -> None:
    """An edge of 3 mm at 5 degrees rises 3 (1 - sin 5) = 2.74 mm; a shallower groove breaks the rule."""
    scene, limits = made_by(mikron, process="forged")
    groove = FittedSlot(True, 0.0, 3.0)
    web = ParametricWeb(Layout(7, (groove,)), scene, limits, (np.zeros(0),) * 3)
    outline = outline_start(scene, limits)
    for depth, kept in ((2.7, False), (2.8, True)):
        values = np.array([*outline, 8.0, web.points(outline)[0][:, 0].max() - depth, 0.0, 5.0])
        rules = dict(zip(web.rule_names(values), web.constraints(values), strict=True))
        assert (rules["least depth of the groove, 2.76 mm"] < 0) == kept


def test_a_flat_parting_in_mid_web_is_no_deeper_than_that(mikron: Scene) -> None:
    """A mould parts anywhere: only the wall counts."""
    for process, deepest in (("forged", 9.5), ("cast", 16.0)):
        scene, limits = made_by(mikron, **{**FACES, "process": process})
        for kind in (FittedBox("pin"), FittedBevel("journal")):
            assert kind.bounds(scene, limits)[kind.names.index("depth")][1] == deepest


def test_a_start_takes_over_what_the_process_can_make(mikron: Scene) -> None:
    box = {"shape": "box", "face": "pin", "y_mm": 18.0, "size_x_mm": 16.0, "size_y_mm": 8.0, "depth_mm": 5.0}
    scene = scene_with_web(mikron, table(pocket=[box]))
    own, limits = made_by(scene, process="forged")
    found = scene_start(own, limits)
    assert found.layout.parts == ()
    assert len(found.values) == found.layout.stations
    assert "box pocket of the pin face, as the process opens from the sides only" in found.left_out
    own, limits = made_by(scene, **FACES)
    assert scene_start(own, limits).layout.parts == (FittedBox("pin", False, DRAFT_DEG, 6.0, 4.75),)


@pytest.mark.parametrize(("crown_mm", "kept"), [(0.0, True), (5.0, False), (-5.0, False)])
def test_a_bevel_keeps_the_draft_where_it_is_steepest(mikron: Scene, crown_mm: float, kept: bool) -> None:
    """A bevel of 20 mm, 9 mm deep: its chord is at 66 deg, and 2 atan(2 crown / chord) steeper at an end."""
    scene, limits = made_by(mikron, **{**FACES, "draft_deg": 20.0})
    bevel = FittedBevel("journal", hollow=True)
    outline = outline_start(scene, limits)
    web = ParametricWeb(Layout(7, (bevel,)), scene, limits, (np.zeros(0),) * 3)
    values = np.array([*outline, outline[1] - 20.0, 9.0, crown_mm])
    rules = dict(zip(web.rule_names(values), web.constraints(values), strict=True))
    chord, turn = np.hypot(20, 9), 2 * np.arctan(2 * abs(crown_mm) / np.hypot(20, 9))
    missing = chord * (np.sin(np.deg2rad(20)) - np.sin(np.arctan2(20, 9) - turn))
    assert rules["least draft of the journal bevel, 20 deg"] == pytest.approx(missing)
    assert (missing < 0) == kept


@pytest.mark.parametrize("pair", [False, True])
def test_rules_know_the_mouth(mikron: Scene, pair: bool) -> None:
    """A pocket with draft is nearer to bore, journal and twin by what it opens, 5 mm deep at 5 deg."""
    values = np.array([*([14.0] if pair else []), 24.0, 13.5, 13.5, 5.0])
    growth = 5 * np.tan(np.deg2rad(DRAFT_DEG))
    found = []
    for box in (FittedBox("journal", pair, 0.0, 6.0), FittedBox("journal", pair, DRAFT_DEG, 6.0)):
        limits = usual_limits(mikron)
        web = ParametricWeb(Layout(7, (box,)), mikron, limits, (np.zeros(0),) * 3)
        both = np.concatenate([outline_start(mikron, limits), values])
        found.append(dict(zip(web.rule_names(both), web.constraints(both), strict=True)))
    plain, drafted = found
    nearer = np.array([drafted[name] - plain[name] for name in plain])
    assert np.count_nonzero(nearer) >= 3
    assert nearer.max() == pytest.approx(growth, rel=1e-6)
    assert nearer.min() >= 0


def test_written_and_read_back_it_is_the_same(mikron: Scene) -> None:
    scene, limits = made_by(mikron, **FACES)
    box = FittedBox("pin", True, DRAFT_DEG, 6.0, 4.75)
    layout = Layout(7, (box,))
    values = np.array([*outline_start(scene, limits), 10.0, 18.0, 13.5, 13.5, 4.5])
    with_box = scene.model_copy(
        update={"web": scene_with_web(wide(scene), exact_web_of(layout, values, scene)).web}
    )
    found = scene_start(with_box, limits)
    assert found.layout == layout
    assert found.values == pytest.approx(values, abs=1e-9)


def wide(scene: Scene) -> Scene:
    """The scene without bores and fillets, which would be in the way."""
    throw = scene.throw.model_copy(
        update={
            name: getattr(scene.throw, name).model_copy(update={"bore_diameter_mm": 0.0, "fillet_mm": 0.0})
            for name in ("main_journal", "crankpin")
        }
    )
    return scene.model_copy(update={"throw": throw})
