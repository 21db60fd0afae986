"""Grooves and side pockets with a round floor edge: volumes by formula, by the CAD kernel and by cells."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.side_pocket import SidePocket
from tests.unit.refit.remodel_cases import table
from tests.unit.throw.pocket_volumes import check_volumes
from tests.unit.throw.test_web_features import RECTANGLE, removed_mm3

SIDE = {"shape": "side", "y_mm": 24.0, "length_mm": 20.0, "height_mm": 9.0, "depth_mm": 6.0, "offset_mm": 0.7}
GROOVE = {**SIDE, "length_mm": 200.0}
ROUND = {"corner_radius_mm": 3.0, "floor_radius_mm": 2.0}
DRAFT_DEG = 8.0
DRAFT = {"draft_deg": DRAFT_DEG}


@pytest.mark.parametrize("draft_deg", [0.0, DRAFT_DEG])
def test_the_floor_of_a_groove_leaves_four_spandrels(mikron: Scene, draft_deg: float) -> None:
    """Between an arc of radius r and both sides of an angle t: r2 (cot(t/2) - (pi - t)/2), along the web."""
    groove, radius, corner = {**GROOVE, "draft_deg": draft_deg}, 3.0, math.radians(90 + draft_deg)
    spandrel = radius**2 * (1 / math.tan(corner / 2) - (math.pi - corner) / 2)
    sharp, rounded = (
        removed_mm3(mikron, pocket=[{**groove, **more}]) for more in ({}, {"floor_radius_mm": radius})
    )
    length = mikron.throw.radius_mm + 2 * RECTANGLE["overhang_mm"]
    assert sharp - rounded == pytest.approx(4 * spandrel * length, rel=1e-6)


def test_the_floor_of_a_side_pocket_leaves_what_pappus_says(mikron: Scene) -> None:
    """Along the straight sides, and around the four corners, of both pockets; walls without draft."""
    radius, corner = ROUND["floor_radius_mm"], ROUND["corner_radius_mm"]
    area = radius**2 * (1 - math.pi / 4)
    straight = 2 * (20.0 - 2 * corner) + 2 * (9.0 - 2 * corner)
    around = 2 * math.pi * (corner - radius + radius / 6 / (1 - math.pi / 4))
    sharp, rounded = (
        removed_mm3(mikron, pocket=[{**SIDE, "corner_radius_mm": corner, **more}])
        for more in ({}, {"floor_radius_mm": radius})
    )
    assert sharp - rounded == pytest.approx(2 * area * (straight + around), rel=1e-6)


@pytest.mark.parametrize(
    "pocket",
    [
        {**SIDE, **DRAFT, **ROUND},
        pytest.param({**SIDE, **ROUND}, marks=pytest.mark.slow),
        pytest.param({**SIDE, **DRAFT, **ROUND, "y_mm": 2.0, "depth_mm": 14.0}, marks=pytest.mark.slow),
        pytest.param({**GROOVE, **DRAFT, "floor_radius_mm": 3.5}, marks=pytest.mark.slow),
        pytest.param({**GROOVE, "floor_radius_mm": 3.0, "depth_mm": 3.0}, marks=pytest.mark.slow),
    ],
    ids=["side", "side without draft", "side where the outline is round", "groove", "groove without draft"],
)
def test_solid_cells_and_sections_agree(mikron: Scene, pocket: dict[str, Any], tmp_path: Path) -> None:
    check_volumes(mikron, pocket, tmp_path)


@pytest.mark.parametrize("draft_deg", [0.0, DRAFT_DEG])
@pytest.mark.parametrize("kind", [{**SIDE, **ROUND}, {**GROOVE, "floor_radius_mm": 3.5}])
def test_the_distance_of_the_search_is_that_of_the_solid(
    mikron: Scene, kind: dict[str, Any], draft_deg: float
) -> None:
    """Points are in the pocket by its signed distance where its sections say so, to 0.001 mm."""
    scene = scene_with_web(mikron, table(pocket=[{**kind, "draft_deg": draft_deg}]))
    (pocket,), ends = scene.web.pocket, scene.web.y_range_mm(scene.throw.radius_mm)
    (body,) = pocket.bodies(scene, "web.pocket[0]")
    part, values = FittedSlot.read(pocket, pair=False, frame_mm=(*ends, scene.web.largest_half_width_mm))
    assert part.through == (kind["length_mm"] > 100)
    random = np.random.default_rng(3)
    x = random.uniform(body.floor_mm - 1.0, body.floor_mm + pocket.depth_mm, 40)
    y = random.uniform(pocket.y_mm - 14.0, pocket.y_mm + 14.0, 41)
    z = random.uniform(*scene.web_z_mm, 42)
    inside = part.field_mm(values, np.zeros(2), (x, y, z), scene.web_z_mm)
    cut = np.stack([body.contains(x[:, None], y[None, :], height) for height in z], axis=-1)
    inside = np.broadcast_to(inside, cut.shape)
    assert 0.02 < cut.mean() < 0.9
    assert (cut == (inside < 0))[np.abs(inside) > 1e-3].all()


@pytest.mark.parametrize(
    ("pocket", "key"),
    [
        ({**SIDE, "floor_radius_mm": 1.0}, "needs a corner_radius_mm of at least 1 mm"),
        ({**SIDE, "corner_radius_mm": 4.5, "floor_radius_mm": 4.5}, "leaves no flat floor"),
        ({**GROOVE, "floor_radius_mm": 4.5}, "leaves no flat floor"),
        ({**GROOVE, "depth_mm": 1.5, "floor_radius_mm": 2.0}, "rises 2 mm over the floor"),
        ({**GROOVE, "corner_radius_mm": 1.0, "floor_radius_mm": 2.0}, "needs a corner_radius_mm of at least"),
    ],
)
def test_impossible_ones_are_refused(mikron: Scene, pocket: dict[str, Any], key: str) -> None:
    with pytest.raises(CranktopoError, match=f"web.pocket.0..floor_radius_mm = .*{key}"):
        scene_with_web(mikron, table(pocket=[pocket]))


def test_a_groove_with_round_corners_beyond_the_web_is_read_as_a_groove(mikron: Scene) -> None:
    """Its corners are no part of the web; one whose corners reach into it is no groove of the family."""
    ends = (-26.0, 75.0, 38.0)
    long, short = (
        SidePocket(**{**SIDE, **ROUND, "y_mm": 24.5, "length_mm": length}) for length in (110.0, 103.0)
    )
    assert FittedSlot.read(long, False, ends)[0] == FittedSlot(True, 0.0, 2.0)
    assert FittedSlot.read(short, False, ends)[0] == FittedSlot(False, 3.0, 2.0)


def test_the_drawing_says_the_radius_where_there_is_one(mikron: Scene) -> None:
    lines = [
        scene_with_web(mikron, table(pocket=[one])).web.pocket[0].drawing(mikron).lines
        for one in ({**GROOVE, "floor_radius_mm": 3.5}, GROOVE)
    ]
    assert ["   floor radius 3.50" in own for own in lines] == [True, False]
