"""Pockets from a face with draft and round corners: volumes by formula, by the CAD kernel and by cells."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder
from cranktopo.throw.primitives import Circle, Polyline
from tests.step_volume import step_volume_mm3
from tests.unit.refit.remodel_cases import table
from tests.unit.throw.pocket_volumes import check_volumes
from tests.unit.throw.test_web_features import removed_mm3

BOX = {"shape": "box", "face": "pin", "x_mm": 0.0, "y_mm": 17.0, "depth_mm": 8.0}
BOX |= {"size_x_mm": 30.0, "size_y_mm": 6.0}
"""On the pin face between the bore of the main journal and the pin."""
ROUND = {
    "shape": "cylinder",
    "face": "journal",
    "x_mm": 24.0,
    "y_mm": 30.0,
    "depth_mm": 7.0,
    "diameter_mm": 8.0,
}
SIDE = {"shape": "side", "y_mm": 24.0, "length_mm": 20.0, "height_mm": 8.0, "depth_mm": 6.0, "offset_mm": 0.7}
DRAFT = {"draft_deg": 8.0}
SLOPE = math.tan(math.radians(8.0))


def prismoid_mm3(depth_mm: float, area_mm2: Any) -> float:
    """Volume between a floor and a mouth; exact, as areas are quadratic in the height."""
    return depth_mm / 6 * (area_mm2(0.0) + 4 * area_mm2(SLOPE * depth_mm / 2) + area_mm2(SLOPE * depth_mm))


def test_a_rounded_box_with_draft_takes_its_prismoid(mikron: Scene) -> None:
    def area_mm2(growth: float) -> float:
        return (30 + 2 * growth) * (6 + 2 * growth) - (4 - math.pi) * (2.5 + growth) ** 2

    pocket = {**BOX, **DRAFT, "corner_radius_mm": 2.5}
    assert removed_mm3(mikron, pocket=[pocket]) == pytest.approx(prismoid_mm3(8.0, area_mm2), rel=1e-9)


def test_a_side_pocket_with_round_corners_takes_two_prismoids(mikron: Scene) -> None:
    def area_mm2(growth: float) -> float:
        return (20 + 2 * growth) * (8 + 2 * growth) - (4 - math.pi) * (3 + growth) ** 2

    pocket = {**SIDE, **DRAFT, "corner_radius_mm": 3.0}
    assert removed_mm3(mikron, pocket=[pocket]) == pytest.approx(2 * prismoid_mm3(6.0, area_mm2), rel=1e-9)


def test_sharp_corners_stay_sharp_and_a_round_pocket_is_a_cone(mikron: Scene) -> None:
    def box_mm2(growth: float) -> float:
        return (30 + 2 * growth) * (6 + 2 * growth)

    def disc_mm2(growth: float) -> float:
        return math.pi * (4 + growth) ** 2

    sharp, cone = ([{**one, **DRAFT}] for one in (BOX, ROUND))
    assert removed_mm3(mikron, pocket=sharp) == pytest.approx(prismoid_mm3(8.0, box_mm2), rel=1e-9)
    assert removed_mm3(mikron, pocket=cone) == pytest.approx(prismoid_mm3(7.0, disc_mm2), rel=1e-9)


@pytest.mark.parametrize(
    "pocket",
    [
        {**BOX, **DRAFT, "corner_radius_mm": 2.5},
        pytest.param({**BOX, "corner_radius_mm": 3.0}, marks=pytest.mark.slow),
        pytest.param({**BOX, **DRAFT}, marks=pytest.mark.slow),
        {**ROUND, **DRAFT},
        {**BOX, **DRAFT, "corner_radius_mm": 2.0, "size_x_mm": 90.0},
        {**BOX, **DRAFT, "corner_radius_mm": 2.5, "floor_radius_mm": 2.5},
        pytest.param({**BOX, "corner_radius_mm": 2.0, "floor_radius_mm": 2.0}, marks=pytest.mark.slow),
        pytest.param({**ROUND, **DRAFT, "floor_radius_mm": 3.0}, marks=pytest.mark.slow),
        pytest.param(
            {**BOX, **DRAFT, "corner_radius_mm": 2.0, "floor_radius_mm": 1.5, "size_x_mm": 90.0},
            marks=pytest.mark.slow,
        ),
        pytest.param({**SIDE, **DRAFT, "corner_radius_mm": 3.0}, marks=pytest.mark.slow),
        pytest.param({**SIDE, "corner_radius_mm": 2.0}, marks=pytest.mark.slow),
        pytest.param(
            {**SIDE, **DRAFT, "corner_radius_mm": 2.0, "y_mm": 2.0, "depth_mm": 14.0},
            marks=pytest.mark.slow,
        ),
        {
            **BOX,
            **DRAFT,
            "corner_radius_mm": 2.0,
            "x_mm": 25.0,
            "face": "journal",
            "y_mm": 24.5,
            "size_y_mm": 4.5,
        },
    ],
    ids=[
        "round corners",
        "no draft",
        "sharp",
        "cone",
        "runs out at both sides",
        "round floor",
        "round floor without draft",
        "round floor of a cone",
        "round floor that runs out at both sides",
        "side",
        "side without draft",
        "side where the outline is round",
        "runs out at one side",
    ],
)
def test_solid_cells_and_sections_agree(mikron: Scene, pocket: dict[str, Any], tmp_path: Path) -> None:
    check_volumes(mikron, pocket, tmp_path)


def test_a_round_floor_leaves_what_a_torus_has(mikron: Scene) -> None:
    """A cylinder with a floor rounded by r leaves a ring of the section r2 (1 - pi/4), by Pappus."""
    radius, floor = 4.0, 2.0
    away = radius - floor + floor / 6 / (1 - math.pi / 4)
    ring = 2 * math.pi * away * floor**2 * (1 - math.pi / 4)
    taken = removed_mm3(mikron, pocket=[{**ROUND, "x_mm": 19.0, "floor_radius_mm": floor}])
    assert taken == pytest.approx(math.pi * radius**2 * 7.0 - ring, rel=1e-6)


@pytest.mark.parametrize("kind", [BOX | {"corner_radius_mm": 2.5}, ROUND])
def test_the_distance_of_the_search_is_that_of_the_solid(mikron: Scene, kind: dict[str, Any]) -> None:
    """Points are in the pocket by its signed distance where its sections say so, to 0.001 mm."""
    scene = scene_with_web(mikron, table(pocket=[{**kind, **DRAFT, "floor_radius_mm": 2.0}]))
    (pocket,) = scene.web.pocket
    (body,) = pocket.bodies(scene, "web.pocket[0]")
    fitted = FittedBox if pocket.shape == "box" else FittedCylinder
    part, values = fitted.read(pocket, pair=True, frame_mm=(0.0, 0.0, 0.0))
    random = np.random.default_rng(3)
    x = random.uniform(pocket.x_mm, pocket.x_mm + 16.0, 40)
    y = random.uniform(pocket.y_mm - 6.0, pocket.y_mm + 6.0, 41)
    z = np.linspace(*body.z_mm, 42)[1:-1]
    inside = part.field_mm(values, np.zeros(2), (x, y, z), scene.web_z_mm)
    cut = np.stack([body.contains(x[:, None], y[None, :], height) for height in z], axis=-1)
    assert 0.02 < cut.mean() < 0.9
    assert (cut == (inside < 0))[np.abs(inside) > 1e-3].all()


def test_the_half_throw_is_cut_above_a_mouth_in_a_fillet(mikron: Scene, tmp_path: Path) -> None:
    """The mouth lies in the pin's fillet, the floor does not: the fillet opens above the mouth."""
    pocket = {**BOX, **DRAFT, "corner_radius_mm": 2.5, "y_mm": 20.6}
    volume = export_solid(scene_with_web(mikron, table(pocket=[pocket])), "half", tmp_path / "half.step")
    assert step_volume_mm3(tmp_path / "half.step") == pytest.approx(volume, rel=1e-6)


def test_a_round_pocket_may_open_under_a_fillet(mikron: Scene, tmp_path: Path) -> None:
    """Its round floor leaves the ring of Pappus in the half throw, as it does in the web alone."""
    flat = {**ROUND, "face": "pin", "x_mm": 0.0, "y_mm": 24.0, "diameter_mm": 14.0, "depth_mm": 5.0}
    ring = 2 * math.pi * ((7.0 - 1.0) * (1 - math.pi / 4) + 1 / 6)
    taken = [
        export_solid(scene_with_web(mikron, table(pocket=[one])), "half", tmp_path / "half.step")
        for one in (flat, {**flat, "floor_radius_mm": 1.0})
    ]
    assert taken[1] - taken[0] == pytest.approx(ring, abs=1e-9 * taken[0])


@pytest.mark.parametrize("draft", [pytest.param({}, marks=pytest.mark.slow), DRAFT])
def test_ends_that_are_half_circles_are_those_of_almost_half_circles(
    mikron: Scene, tmp_path: Path, draft: dict[str, float]
) -> None:
    box = {**BOX, **draft, "y_mm": 22.0}
    whole, almost = (
        export_solid(
            scene_with_web(mikron, table(pocket=[{**box, "corner_radius_mm": radius}])),
            "half",
            tmp_path / "half.step",
        )
        for radius in (3.0, 3.0 - 1e-6)
    )
    assert whole == pytest.approx(almost, abs=1e-3)


@pytest.mark.parametrize(
    ("pocket", "key"),
    [
        ({**BOX, "corner_radius_mm": 3.1}, "corner_radius_mm"),
        ({**BOX, "draft_deg": 46.0}, "draft_deg"),
        ({**SIDE, "corner_radius_mm": 4.1}, "corner_radius_mm"),
        ({"shape": "cylinder", "x_mm": 24.0, "y_mm": 30.0, "diameter_mm": 8.0, **DRAFT}, "draft_deg"),
        ({**BOX, "draft_deg": 30.0}, "cuts the bore"),
        ({**BOX, "floor_radius_mm": 1.0}, "needs a corner_radius_mm of at least 1 mm"),
        ({**BOX, "corner_radius_mm": 3.0, "floor_radius_mm": 3.0}, "leaves no flat floor"),
        (
            {**BOX, "depth_mm": 1.5, "corner_radius_mm": 2.5, "floor_radius_mm": 2.0},
            "rises 2 mm over the floor",
        ),
        ({**ROUND, "floor_radius_mm": 4.5}, "at most that of the floor"),
        (
            {"shape": "cylinder", "x_mm": 24.0, "y_mm": 30.0, "diameter_mm": 8.0, "floor_radius_mm": 1.0},
            "floor_radius_mm = 1.0: has no meaning",
        ),
    ],
)
def test_impossible_ones_are_refused(mikron: Scene, pocket: dict[str, Any], key: str) -> None:
    """The last one meets the bore of the main journal at its mouth only."""
    with pytest.raises(CranktopoError, match=key):
        scene_with_web(mikron, table(pocket=[pocket]))


def test_the_drawing_shows_mouth_and_floor_and_says_draft_and_radius(mikron: Scene) -> None:
    (box, cone) = (
        scene_with_web(mikron, table(pocket=[{**one, **DRAFT}])).web.pocket[0] for one in (BOX, ROUND)
    )
    box = box.model_copy(update={"corner_radius_mm": 2.5, "floor_radius_mm": 1.5})
    drawn = box.drawing(mikron)
    assert [type(stroke) for stroke in drawn.front] == [Polyline, Polyline]
    wide = [2 * np.abs([x for x, _ in stroke.points]).max() for stroke in drawn.front]
    assert wide == pytest.approx([30 + 16 * SLOPE, 30.0])
    assert {"   corner radius 2.50", "   draft 8.00°", "   floor radius 1.50"} <= set(drawn.lines)
    radii = [stroke.radius for stroke in cone.drawing(mikron).front if isinstance(stroke, Circle)]
    assert radii == pytest.approx([4.0, 4 + 7 * SLOPE])
